// The paper's range image: returns on a grid of columns and rings, so that neighbours are found without a search.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

/// The step from a column or ring to the next.
struct BeamStep {
  double sin_angle = 0.0;  // of the angle between the beams
  double cos_angle = 1.0;
  bool is_neighbour = false;
};

/// [columns x rings x layers], layer fastest. With columns of its own the image has one layer, the nearest return of a pixel, and the others are
/// shadowed; on the scan's columns it has a layer per return of a shot, and none is.
struct RangeImage {
  struct Place {
    std::int32_t pixel = kNone;  // index into return_at; kNone = the return was not projected
    std::int32_t column = 0;
  };
  static constexpr std::int32_t kNone = -1;

  int num_columns = 0;
  int num_rings = 0;
  int num_layers = 1;
  std::vector<std::int32_t> return_at;   // [pixels] index of the return; kNone = empty
  std::vector<Place> place_of;           // [returns]
  std::vector<BeamStep> to_next_column;  // [columns] the last one leads to the first
  std::vector<BeamStep> to_higher_ring;  // [rings] the last one leads nowhere

  std::size_t Pixel(int column, int ring) const {
    return (static_cast<std::size_t>(column) * static_cast<std::size_t>(num_rings) + static_cast<std::size_t>(ring)) *
           static_cast<std::size_t>(num_layers);
  }
  int NextColumn(int column) const { return column + 1 < num_columns ? column + 1 : 0; }
  int PreviousColumn(int column) const { return column > 0 ? column - 1 : num_columns - 1; }
  bool IsInImage(std::int32_t index) const {
    const auto pixel = place_of[static_cast<std::size_t>(index)].pixel;
    return pixel != kNone && return_at[static_cast<std::size_t>(pixel)] == index;
  }
};

/// The scan's own columns: every return has a pixel. Columns are neighbours when they follow each other in time, the first on the last, and their
/// azimuths lie at most kMaxNeighbourStep usual steps apart: so the seam of a whole scan is none, and holes and ends of a partial scan are.
RangeImage ProjectToOwnColumns(const Scan& scan, std::span<const Return> returns);

/// Columns of equal width by azimuth (the paper). In a pixel the nearest return stays, of equals the one of the smaller azimuth, then cell.
/// The circle has no seam: the last column touches the first.
///
/// @param indices      of the returns to project, increasing
/// @param num_columns  3 or more
RangeImage ProjectToAzimuths(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> indices, int num_columns);

/// More than 1, for the unevenness of a turning head; less than 2, where a column is missing.
inline constexpr double kMaxNeighbourStep = 1.5;

}  // namespace lookout::segmenter
