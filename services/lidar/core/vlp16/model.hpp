// Which sensor it is: its beams, and how that is found out.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

#include "services/lidar/core/models/packet_reader.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"

namespace lookout::vlp16 {

enum class Model { kVlp16, kPuckHiRes };

/// Beams of a model. Ring 0 is the lowest.
struct Beams {
  std::string_view name;
  std::array<int, format::kNumLasers> ring_of_laser{};
  std::array<int, format::kNumLasers> laser_of_ring{};
  std::array<double, format::kNumLasers> elevation_rad{};    // by ring
  std::array<double, format::kNumLasers> origin_height_m{};  // by ring
};

const Beams& BeamsOf(Model model);

/// The beams of a model as the driver's Head.
const lidar::Head& HeadOf(Model model, ReturnMode mode, bool use_vertical_origin_offsets);

enum class ModelChoice { kAuto, kVlp16, kPuckHiRes };

enum class ModelVerdict { kVlp16, kPuckHiRes, kUndecided, kHdl32e, kUnknown };

/// Decides by the product byte, and for byte 0x21, which the HDL-32E and some early VLP-16 share, by the interval between packets: 1327 us
/// (664 us dual) or 553 us (276 us dual). The least of three intervals counts, since a lost packet only makes one longer. Once taken the
/// decision about 0x21 stays. A choice by config accepts packets of the whole family (0x21, 0x22, 0x24) and of unknown product bytes for what it
/// says, at once; but intervals of an HDL-32E overrule it.
class ModelDetector {
 public:
  explicit ModelDetector(ModelChoice choice) : choice_(choice) {}

  /// @return kUndecided: hold the packet, its like and their order until another verdict comes
  ModelVerdict Detect(const DataPacket& packet);

  /// Decides about 0x21 with the intervals that are there; kUndecided when there is none.
  ModelVerdict Decide();

 private:
  ModelVerdict DetectByInterval(const DataPacket& packet);

  ModelChoice choice_;
  std::optional<ModelVerdict> shared_byte_verdict_;
  std::optional<std::uint32_t> last_stamp_us_;
  int num_intervals_ = 0;
  double least_interval_ = 0.0;  // in periods of a VLP-16 in the same return mode
};

}  // namespace lookout::vlp16
