#include "tools/export/scans.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"

namespace lookout::exporter {

namespace {

bool HaveSameColumns(const lidar_scan_t& scan, const segments_t& segments) {
  return scan.first_column == segments.first_column && scan.num_columns == segments.num_columns && scan.num_rings == segments.num_rings &&
         scan.num_returns == segments.num_returns;
}

template <typename Message>
Taken Add(messages::ScanCollector& collector, Bytes bytes) {
  auto message = bus::Decode<Message>(bytes);
  if (!message) return Taken::kUndecodable;
  return collector.Add(std::move(*message)) ? Taken::kOk : Taken::kInconsistent;
}

bool HasObstacles(const ScanMessages& scan) { return messages::HasAllParts(scan.obstacles); }

bool IsWhole(const ScanMessages& scan, ChosenScan::Of channels) {
  if (channels == ChosenScan::Of::kObstacles) {
    return HasObstacles(scan) && std::ranges::none_of(scan.obstacles, [](const auto& part) { return messages::IsCut(part.second.scan_flags); });
  }
  return messages::HasAllParts(scan.scans) && std::ranges::none_of(scan.scans, [](const auto& part) { return messages::IsCut(part.second.flags); });
}

}  // namespace

bool IsLabelled(const ScanMessages& scan) { return messages::HasAllParts(scan.scans) && messages::HasAllParts(scan.segments); }

bool IsTracked(const ScanMessages& scan) { return IsLabelled(scan) && messages::HasAllParts(scan.tracks); }

messages::ScanCollector MakeCollector(messages::ScanCollector::Predicate is_complete, messages::ScanCollector::Handler on_scan) {
  // 6.4 s of scans at 300 rpm, some megabytes: more than the segmenter is ever behind, and less than the ten seconds of POSE that a picture keeps.
  constexpr std::size_t kMaxWaiting = 32;
  return {is_complete, messages::ScanCollector::Order::kOfArrival, kMaxWaiting, std::move(on_scan)};
}

Taken AddTo(messages::ScanCollector& collector, std::string_view channel, Bytes bytes) {
  if (channel == bus::kLidarScan.name) return Add<lidar_scan_t>(collector, bytes);
  if (channel == bus::kSegments.name) return Add<segments_t>(collector, bytes);
  if (channel == bus::kTracks.name) return Add<tracks_t>(collector, bytes);
  return Add<obstacles_t>(collector, bytes);
}

const segments_t* LabelsOf(const ScanMessages& scan, const lidar_scan_t& part) {
  const auto segments = scan.segments.find(part.part_index);
  return segments != scan.segments.end() && HaveSameColumns(part, segments->second) ? &segments->second : nullptr;
}

std::int64_t NumOrphans(const ScanMessages& scan) {
  return std::ranges::count_if(scan.segments, [&scan](const auto& entry) {
    const auto& [part_index, segments] = entry;
    if (segments.num_columns == 0 && part_index > 0) return false;  // a further part, of segments only
    const auto part = scan.scans.find(part_index);
    return part == scan.scans.end() || !HaveSameColumns(part->second, segments);
  });
}

ChosenScan::ChosenScan(Of channels, std::optional<std::int64_t> seq)
    : channels_(channels),
      seq_(seq),
      collector_(MakeCollector(channels == Of::kObstacles ? HasObstacles : IsLabelled, [this](const ScanMessages& scan) { Consider(scan); })) {}

void ChosenScan::Consider(const ScanMessages& scan) {
  if (IsDone() || (channels_ == Of::kReturns ? scan.scans.empty() : scan.obstacles.empty())) return;
  latest_utime_us_ = scan.utime_us;
  const bool is_whole = IsWhole(scan, channels_);
  if (seq_ ? scan.seq != *seq_ : is_chosen_whole_ && !is_whole) return;
  chosen_ = scan;
  is_chosen_whole_ = is_whole;
}

}  // namespace lookout::exporter
