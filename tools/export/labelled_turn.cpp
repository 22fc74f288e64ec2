#include "tools/export/labelled_turn.hpp"

#include <algorithm>
#include <utility>

namespace lookout::exporter {

LabelledTurn::LabelledTurn(std::optional<std::int64_t> seq)
    : picker_(seq), joiner_([this](const LabelledScan& part) {
        const auto& scan = part.scan;
        picker_.Add({scan.utime_us, scan.seq, scan.part_index, scan.num_parts, scan.flags}, part);
        latest_utime_us_ = scan.utime_us;
      }) {}

Taken LabelledTurn::Take(std::string_view channel, Bytes bytes) {
  if (channel == bus::kLidarScan.name) {
    auto scan = bus::Decode<lidar_scan_t>(bytes);
    if (!scan) return Taken::kUndecodable;
    if (!IsConsistent(*scan)) return Taken::kInconsistent;
    joiner_.Add(std::move(*scan));
    return Taken::kOk;
  }
  auto segments = bus::Decode<segments_t>(bytes);
  if (!segments) return Taken::kUndecodable;
  if (!IsConsistent(*segments)) return Taken::kInconsistent;
  if (segments->num_columns == 0) {
    // Forget those of turns that are neither chosen nor can be any more. A turn has a few such parts at most.
    constexpr std::size_t kMaxFurther = 64;
    const auto is_chosen = [this](const FurtherSegments& one) { return !parts().empty() && one.utime_us == place().utime_us; };
    if (further_.size() >= kMaxFurther) {
      const auto oldest = std::ranges::find_if_not(further_, is_chosen);
      if (oldest != further_.end()) further_.erase(oldest);
    }
    if (further_.size() < kMaxFurther) further_.push_back({segments->utime_us, segments->seq, segments->segments});
  }
  joiner_.Add(std::move(*segments));
  return Taken::kOk;
}

void LabelledTurn::Finish() {
  joiner_.Flush();
  picker_.Finish();
}

std::vector<segment_t> LabelledTurn::Segments() const {
  std::vector<segment_t> segments;
  if (parts().empty()) return segments;
  for (const auto& part : parts()) {
    if (part.segments) segments.insert(segments.end(), part.segments->segments.begin(), part.segments->segments.end());
  }
  for (const auto& further : further_) {
    if (further.utime_us == place().utime_us && further.seq == place().seq) {
      segments.insert(segments.end(), further.segments.begin(), further.segments.end());
    }
  }
  return segments;
}

}  // namespace lookout::exporter
