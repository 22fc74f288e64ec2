#include "services/vlp16/core/model.hpp"

#include <algorithm>
#include <numeric>

#include "common/core/angles.hpp"
#include "services/vlp16/core/foreign_sensor.hpp"

namespace lookout::vlp16 {

namespace {

using namespace format;

Beams MakeBeams(std::string_view name, const std::array<double, kNumLasers>& elevation_deg, const std::array<double, kNumLasers>& height_mm) {
  Beams beams;
  beams.name = name;
  std::iota(beams.laser_of_ring.begin(), beams.laser_of_ring.end(), 0);
  std::ranges::sort(beams.laser_of_ring, {}, [&](int laser) { return elevation_deg[laser]; });
  for (int ring = 0; ring < kNumLasers; ++ring) {
    const int laser = beams.laser_of_ring[ring];
    beams.ring_of_laser[laser] = ring;
    beams.elevation_rad[ring] = DegToRad(elevation_deg[laser]);
    beams.origin_height_m[ring] = height_mm[laser] / 1000.0;
  }
  return beams;
}

// Half way between the two models' intervals, in periods of a VLP-16.
constexpr double kLeastIntervalOfVlp16 =
    0.5 * (1.0 + static_cast<double>(kHdl32ePacketPeriodSingle.count()) / static_cast<double>(kPacketPeriodSingle.count()));
constexpr int kNumIntervals = 3;
// A longer interval is a pause, not the time between two packets.
constexpr double kMaxInterval = 8.0;

}  // namespace

const Beams& BeamsOf(Model model) {
  static const Beams vlp16 = MakeBeams("VLP-16", kElevationDegVlp16, kOriginHeightMmVlp16);
  static const Beams puck_hi_res = MakeBeams("Puck Hi-Res", kElevationDegPuckHiRes, kOriginHeightMmPuckHiRes);
  return model == Model::kVlp16 ? vlp16 : puck_hi_res;
}

ModelVerdict ModelDetector::Detect(const DataPacket& packet) {
  const bool is_chosen = choice_ != ModelChoice::kAuto;
  const auto chosen = choice_ == ModelChoice::kPuckHiRes ? ModelVerdict::kPuckHiRes : ModelVerdict::kVlp16;
  if (packet.product != kProductHdl32e) {
    const bool is_own = packet.product == kProductVlp16 || packet.product == kProductPuckHiRes;
    if (is_chosen) return is_own || NameOfProduct(packet.product).empty() ? chosen : ModelVerdict::kUnknown;
    if (!is_own) return ModelVerdict::kUnknown;
    return packet.product == kProductVlp16 ? ModelVerdict::kVlp16 : ModelVerdict::kPuckHiRes;
  }
  const auto verdict = DetectByInterval(packet);
  return is_chosen && verdict != ModelVerdict::kHdl32e ? chosen : verdict;
}

ModelVerdict ModelDetector::DetectByInterval(const DataPacket& packet) {
  if (shared_byte_verdict_) return *shared_byte_verdict_;
  if (last_stamp_us_) {
    const std::int64_t interval_us = (packet.stamp_us + kMicrosecondsPerHour - *last_stamp_us_) % kMicrosecondsPerHour;
    const double interval = static_cast<double>(interval_us) * 1000.0 / static_cast<double>(packet.period().count());
    if (interval_us > 0 && interval <= kMaxInterval) {
      least_interval_ = num_intervals_ == 0 ? interval : std::min(least_interval_, interval);
      ++num_intervals_;
    }
  }
  last_stamp_us_ = packet.stamp_us;
  return num_intervals_ < kNumIntervals ? ModelVerdict::kUndecided : Decide();
}

ModelVerdict ModelDetector::Decide() {
  if (num_intervals_ == 0) return ModelVerdict::kUndecided;
  shared_byte_verdict_ = least_interval_ >= kLeastIntervalOfVlp16 ? ModelVerdict::kVlp16 : ModelVerdict::kHdl32e;
  return *shared_byte_verdict_;
}

}  // namespace lookout::vlp16
