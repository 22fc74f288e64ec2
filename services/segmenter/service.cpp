#include "services/segmenter/service.hpp"

#include <algorithm>
#include <string>

#include "services/segmenter/wire.hpp"

namespace lookout::segmenter {

Service::Service(bus::Bus& bus, const Lanes& params) : bus_(bus) {
  Add(bus::kLidarScan, bus::kSegments, params.first);
  if (params.second) Add(bus::kLidarScan2, bus::kSegments2, *params.second);
}

void Service::Add(const bus::Channel& scans, const bus::Channel& segments, const Params& params) {
  auto& lane = lanes_.emplace_back(scans, segments, params);
  bus::Subscribe<lidar_scan_t>(bus_, scans, [this, &lane](const lidar_scan_t& message) { OnScan(message, lane); });
}

void Service::OnScan(const lidar_scan_t& message, Lane& lane) {
  lane.watch.Note();
  lane.last_fault = messages::FaultOf(message, bus::kMaxMessageBytes);
  if (lane.last_fault) {
    refusals_.Add(*lane.last_fault);
    lane.refused_at = time_.passed();
    return;
  }
  const auto parts = lane.assembler.Add(message).whole;
  if (parts.empty()) return;
  const auto scan = ToScan(parts);
  if (!scan) {
    ++counts_["scans_inconsistent"];
    return;
  }
  const auto& segments = lane.segmenter.Segment(*scan);
  const auto answers = ToMessages(*scan, segments, bus::kMaxMessageBytes);
  for (const auto& answer : answers) bus::Publish(bus_, lane.segments, answer);
  const bool has_pieces = std::ranges::any_of(answers, [](const segments_t& part) { return part.num_labelled > 0; });

  ++counts_["scans"];
  counts_["segments"] += static_cast<std::int64_t>(segments.segments.size());
  counts_["segments_too_small"] += segments.num_too_small;
  counts_["segments_over_limit"] += segments.num_over_limit;
  if (!has_pieces && !segments.segments.empty()) ++counts_["scans_without_pieces"];
  counts_["returns_repeated"] += segments.num_repeats;
}

HealthReport Service::Report() const {
  HealthReport report;
  for (const auto& lane : lanes_) {
    if (const auto text = lane.watch.Complaint(); !text.empty()) report.Degrade(text);
    if (lane.last_fault && time_.passed() - lane.refused_at < Recently::kToldFor) {
      report.Degrade("the latest " + std::string(lane.watch.name()) + " was refused: " + std::string(*lane.last_fault));
    }
  }
  auto counts = counts_;
  for (const auto& lane : lanes_) {
    counts["scans_incomplete"] += lane.assembler.counts().incomplete_scans;
    counts["parts_duplicate"] += lane.assembler.counts().duplicate_parts;
    counts["parts_inconsistent"] += lane.assembler.counts().inconsistent_parts;
  }
  counts.AppendTo(report.counters);
  refusals_.AppendTo(report.counters);
  return report;
}

}  // namespace lookout::segmenter
