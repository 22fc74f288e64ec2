#include "services/segmenter/service.hpp"

#include <string>
#include <utility>

namespace lookout::segmenter {

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), segmenter_(params) {
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan, [this](const lidar_scan_t& message) { OnScan(message); });
}

void Service::OnScan(const lidar_scan_t& message) {
  auto part = ToScanPart(message, bus::kMaxMessageBytes);
  last_refusal_.reset();
  if (const auto* refusal = std::get_if<Refusal>(&part)) {
    ++num_refused_[static_cast<std::size_t>(*refusal)];
    last_refusal_ = *refusal;
    refused_at_ = time_.passed();
    return;
  }
  const auto scan = gatherer_.Add(std::get<ScanPart>(std::move(part)));
  if (!scan) return;
  const auto& segments = segmenter_.Segment(*scan);
  for (const auto& answer : ToMessages(*scan, segments, bus::kMaxMessageBytes)) bus::Publish(bus_, bus::kSegments, answer);

  ++num_turns_;
  num_segments_ += static_cast<std::int64_t>(segments.segments.size());
  num_too_small_ += segments.num_too_small;
  num_over_limit_ += segments.num_over_limit;
  num_repeats_ += segments.num_repeats;
}

HealthReport Service::Report() const {
  HealthReport report;
  if (last_refusal_ && time_.passed() - refused_at_ < Recently::kToldFor) {
    report.state = HealthState::kDegraded;
    report.reason = "the latest LIDAR_SCAN was refused: " + std::string(kRefusalNames[static_cast<std::size_t>(*last_refusal_)]);
  }
  const auto& counts = gatherer_.counts();
  report.counters = {{"turns", num_turns_},
                     {"segments", num_segments_},
                     {"segments_too_small", num_too_small_},
                     {"segments_over_limit", num_over_limit_},
                     {"returns_repeated", num_repeats_},
                     {"turns_incomplete", counts.incomplete_turns},
                     {"turns_inconsistent", counts.inconsistent_turns},
                     {"parts_duplicate", counts.duplicate_parts},
                     {"parts_inconsistent", counts.inconsistent_parts}};
  for (std::size_t i = 0; i < kRefusalNames.size(); ++i) report.counters.push_back({kRefusalNames[i], num_refused_[i]});
  return report;
}

}  // namespace lookout::segmenter
