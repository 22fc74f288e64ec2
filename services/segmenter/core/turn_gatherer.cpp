#include "services/segmenter/core/turn_gatherer.hpp"

#include <utility>

namespace lookout::segmenter {

namespace {

template <typename T>
void Append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// nullopt unless the parts cover the turn, each column once.
std::optional<Scan> Assemble(std::map<int, ScanPart> parts) {
  auto part = parts.begin();
  Scan scan{std::move(part->second.head), {}, {}};
  for (bool is_first = true; part != parts.end(); ++part, is_first = false) {
    auto& columns = part->second.columns;
    if (part->second.first_column != scan.columns.size()) return std::nullopt;
    scan.parts.push_back({part->second.first_column, columns.size()});
    if (is_first) {
      scan.columns = std::move(columns);
    } else {
      Append(scan.columns.azimuth_rad, columns.azimuth_rad);
      Append(scan.columns.time_ns, columns.time_ns);
      Append(scan.columns.range, columns.range);
      Append(scan.columns.reflectivity, columns.reflectivity);
    }
  }
  if (scan.columns.size() != scan.head.num_turn_columns) return std::nullopt;
  return scan;
}

}  // namespace

std::optional<Scan> TurnGatherer::Add(ScanPart part) {
  if (!parts_.empty()) {
    const ScanHead& head = parts_.begin()->second.head;
    if (part.head.seq != head.seq || part.head.time != head.time) {
      ++counts_.incomplete_turns;
      parts_.clear();
    } else if (part.head != head) {
      ++counts_.inconsistent_parts;
      return std::nullopt;
    } else if (parts_.contains(part.part_index)) {
      ++counts_.duplicate_parts;
      return std::nullopt;
    }
  }
  const auto num_parts = static_cast<std::size_t>(part.head.num_parts);
  const int part_index = part.part_index;
  parts_.emplace(part_index, std::move(part));
  if (parts_.size() < num_parts) return std::nullopt;
  auto scan = Assemble(std::exchange(parts_, {}));
  if (!scan) ++counts_.inconsistent_turns;
  return scan;
}

}  // namespace lookout::segmenter
