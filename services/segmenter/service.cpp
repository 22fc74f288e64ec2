#include "services/segmenter/service.hpp"

#include <algorithm>
#include <string>

#include "services/segmenter/wire.hpp"

namespace lookout::segmenter {

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), segmenter_(params) {
  for (const auto& fault : messages::kScanFaults) refusals_.push_back({fault, 0});
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan, [this](const lidar_scan_t& message) { OnScan(message); });
}

void Service::OnScan(const lidar_scan_t& message) {
  last_fault_ = messages::FaultOf(message, bus::kMaxMessageBytes);
  if (last_fault_) {
    ++std::ranges::find(refusals_, *last_fault_, &Counter::name)->count;
    refused_at_ = time_.passed();
    return;
  }
  const auto parts = assembler_.Add(message).whole;
  if (parts.empty()) return;
  const auto scan = ToScan(parts);
  if (!scan) {
    ++num_inconsistent_scans_;
    return;
  }
  const auto& segments = segmenter_.Segment(*scan);
  for (const auto& answer : ToMessages(*scan, segments, bus::kMaxMessageBytes)) bus::Publish(bus_, bus::kSegments, answer);

  ++num_scans_;
  num_segments_ += static_cast<std::int64_t>(segments.segments.size());
  num_too_small_ += segments.num_too_small;
  num_over_limit_ += segments.num_over_limit;
  num_repeats_ += segments.num_repeats;
}

HealthReport Service::Report() const {
  HealthReport report;
  if (last_fault_ && time_.passed() - refused_at_ < Recently::kToldFor) {
    report.state = HealthState::kDegraded;
    report.reason = "the latest LIDAR_SCAN was refused: " + std::string(*last_fault_);
  }
  const auto& counts = assembler_.counts();
  report.counters = {{"scans", num_scans_},
                     {"segments", num_segments_},
                     {"segments_too_small", num_too_small_},
                     {"segments_over_limit", num_over_limit_},
                     {"returns_repeated", num_repeats_},
                     {"scans_incomplete", counts.incomplete_scans},
                     {"scans_inconsistent", num_inconsistent_scans_},
                     {"parts_duplicate", counts.duplicate_parts},
                     {"parts_inconsistent", counts.inconsistent_parts}};
  report.counters.insert(report.counters.end(), refusals_.begin(), refusals_.end());
  return report;
}

}  // namespace lookout::segmenter
