// Spinning lidars as tables: beams, firing times, what they measure. A further head is a further row.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/sim/shots.hpp"

namespace lookout::sim {

/// One laser.
struct HeadBeam {
  double elevation_deg = 0.0;
  double azimuth_offset_deg = 0.0;  // clockwise, to be added to the azimuth of the column
  double time_offset_us = 0.0;      // since the column
};

struct Head {
  std::string_view name;        // on the command line and in scene files
  std::string_view model;       // in LIDAR_SCAN
  std::vector<HeadBeam> beams;  // lowest first
  /// Columns by time: all so long. 0: by the encoder, columns_per_turn of them, all beams of a column at once.
  double column_period_us = 0.0;
  int columns_per_turn = 0;
  double beam_radius_m = 0.0;  // from the axis to where beams start; ranges count from the axis
  RangeFacts ranges;
};

/// All heads but those whose packets Lidar makes (vlp16, hi-res).
std::span<const Head> Heads();

/// @return nullptr for a name that is none
const Head* FindHead(std::string_view name);

inline constexpr std::string_view kVlp16Name = "vlp16";
inline constexpr std::string_view kHiResName = "hi-res";

/// Names of all heads, those with packets first.
std::vector<std::string> HeadNames();

}  // namespace lookout::sim
