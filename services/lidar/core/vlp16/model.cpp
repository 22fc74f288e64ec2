#include "services/lidar/core/vlp16/model.hpp"

#include <algorithm>
#include <numeric>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/foreign_sensor.hpp"

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

std::vector<lidar::ReturnKind> ReturnsOf(ReturnMode mode) {
  switch (mode) {
    case ReturnMode::kStrongest:
      return {lidar::ReturnKind::kStrongest};
    case ReturnMode::kLast:
      return {lidar::ReturnKind::kLast};
    default:
      return {lidar::ReturnKind::kLast, lidar::ReturnKind::kStrongest};  // as transmitted
  }
}

lidar::Head MakeHead(Model model, ReturnMode mode, bool use_vertical_origin_offsets) {
  const Beams& beams = BeamsOf(model);
  lidar::Head head;
  head.model = beams.name;
  head.range_unit_m = kRangeUnitM;
  head.returns = ReturnsOf(mode);
  head.stamp = lidar::StampKind::kPastHour;
  for (std::size_t ring = 0; ring < kNumLasers; ++ring) {
    const int laser = beams.laser_of_ring[ring];
    const auto time_offset = laser * kLaserPeriod;
    head.beams.push_back({.elevation_rad = beams.elevation_rad[ring],
                          .azimuth_offset_rad = 0.0,
                          .origin_height_m = use_vertical_origin_offsets ? beams.origin_height_m[ring] : 0.0,
                          .time_offset = time_offset,
                          .turning_time = time_offset,
                          .channel = laser});
  }
  return head;
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

const lidar::Head& HeadOf(Model model, ReturnMode mode, bool use_vertical_origin_offsets) {
  constexpr std::size_t kNumModels = 2;
  constexpr std::size_t kNumModes = 3;
  static const auto heads = [] {
    std::array<lidar::Head, kNumModels * kNumModes * 2> made;
    for (std::size_t i = 0; i < made.size(); ++i) {
      made.at(i) = MakeHead(static_cast<Model>(i / (kNumModes * 2)), static_cast<ReturnMode>(i / 2 % kNumModes), i % 2 == 1);
    }
    return made;
  }();
  const auto row = static_cast<std::size_t>(model) * kNumModes + static_cast<std::size_t>(mode);
  return heads.at(2 * row + (use_vertical_origin_offsets ? 1 : 0));
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
