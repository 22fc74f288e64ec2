#include "lab/eval/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/core/outlines.hpp"
#include "lab/data/csv_file.hpp"

namespace lookout::eval {
namespace {

// As lookout-export has it: the nearest microsecond.
std::int64_t ToMicroseconds(std::int64_t time_ns) { return static_cast<std::int64_t>(std::floor((static_cast<double>(time_ns) + 500.0) / 1000.0)); }

std::tuple<std::int64_t, int, int, int> OrderOf(const Truth::Return& made) { return {made.utime_us, made.column, made.ring, made.return_index}; }

}  // namespace

OutlineDistance DistanceToOutline(const Eigen::Vector2d& p_m, const Polygon& outline_m) {
  double edge_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, previous = outline_m.size() - 1; i < outline_m.size(); previous = i++) {
    edge_m = std::min(edge_m, DistanceToEdge(p_m, outline_m[previous], outline_m[i]));
  }
  return {edge_m, Contains(outline_m, p_m) ? 0.0 : edge_m};
}

std::optional<Polygon> Outlines::At(int object_id, std::int64_t utime_us) const {
  const auto object = by_object_.find(object_id);
  if (object == by_object_.end()) return std::nullopt;
  const auto& outlines = object->second;
  const auto after = outlines.upper_bound(utime_us);
  if (after == outlines.begin()) return after->second;
  const auto before = std::prev(after);
  if (after == outlines.end() || before->second.size() != after->second.size()) return before->second;
  const double share = static_cast<double>(utime_us - before->first) / static_cast<double>(after->first - before->first);
  Polygon outline_m;
  for (std::size_t i = 0; i < before->second.size(); ++i) {
    outline_m.emplace_back((1.0 - share) * before->second[i] + share * after->second[i]);
  }
  return outline_m;
}

std::optional<TruthSpan> Outlines::SpanOf(int object_id) const {
  const auto object = by_object_.find(object_id);
  if (object == by_object_.end()) return std::nullopt;
  return TruthSpan{object->second.begin()->first, object->second.rbegin()->first};
}

Truth::Truth(const std::filesystem::path& folder) {
  constexpr auto kMaxTime = std::numeric_limits<std::int64_t>::max();
  constexpr auto kMinId = std::numeric_limits<int>::min();
  constexpr auto kMaxId = std::numeric_limits<int>::max();
  const auto whole = [](const data::CsvFile& file, std::size_t column) { return static_cast<int>(file.WholeNumber(column, kMinId, kMaxId)); };

  data::CsvFile objects(folder / "objects.csv", {"object_id", "name", "kind", "is_moving"}, {"is_in_water"});
  while (objects.Next()) {
    const bool is_in_water = objects.Has(4) && whole(objects, 4) != 0;
    objects_[whole(objects, 0)] = {std::string(objects.Text(1)), std::string(objects.Text(2)), whole(objects, 3) != 0, is_in_water};
  }

  data::CsvFile outlines(folder / "outlines.csv", {"object_id", "utime_us", "latitude_deg", "longitude_deg"});
  while (outlines.Next()) {
    outlines_[whole(outlines, 0)][outlines.WholeNumber(1, 0, kMaxTime)].push_back({outlines.Number(2), outlines.Number(3)});
  }
  data::CsvFile poses(folder / "pose.csv", {"utime_us", "latitude_deg", "longitude_deg", "heading_deg", "roll_deg", "pitch_deg"});
  while (poses.Next()) {
    poses_[poses.WholeNumber(0, 0, kMaxTime)] = {poses.Number(1), poses.Number(2), poses.Number(3), poses.Number(4), poses.Number(5)};
  }
  // Truths of older simulators end before the places.
  data::CsvFile returns(folder / "returns.csv", {"utime_us", "ring", "return_index", "object_id"}, {"x_m", "y_m", "z_m", "column"});
  const bool has_places = returns.Has(4) && returns.Has(5) && returns.Has(6);
  has_columns_ = returns.Has(7);
  while (returns.Next()) {
    Return made{returns.WholeNumber(0, 0, kMaxTime), whole(returns, 1), whole(returns, 2), whole(returns, 3),
                Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())};
    if (has_places) made.p_lidar_m = Eigen::Vector3d(returns.Number(4), returns.Number(5), returns.Number(6)).cast<float>();
    if (has_columns_) made.column = static_cast<int>(returns.WholeNumber(7, 0, kMaxId));
    returns_.push_back(made);
  }
  std::ranges::sort(returns_, {}, OrderOf);
}

void Truth::AddReturns(std::vector<Return> returns) {
  std::ranges::sort(returns, {}, OrderOf);
  returns_.insert(returns_.end(), returns.begin(), returns.end());
}

void Truth::ForgetReturnsBefore(std::int64_t utime_us) {
  while (!returns_.empty() && returns_.front().utime_us < utime_us) returns_.pop_front();
}

std::map<int, int> Truth::CountReturns(const TruthSpan& window) const {
  std::map<int, int> counts;
  for (auto made = std::ranges::lower_bound(returns_, window.begin_us, {}, &Return::utime_us);
       made != returns_.end() && made->utime_us <= window.end_us; ++made) {
    ++counts[made->object_id];
  }
  return counts;
}

const Truth::Return* Truth::Find(std::int64_t utime_us, int ring, int return_index, int column) const {
  if (has_columns_) {
    for (std::int64_t off_us = -tolerance_us_; off_us <= tolerance_us_; ++off_us) {
      const std::tuple wanted(utime_us + off_us, column, ring, return_index);
      const auto made = std::ranges::lower_bound(returns_, wanted, {}, OrderOf);
      if (made != returns_.end() && OrderOf(*made) == wanted) return &*made;
    }
    return nullptr;
  }
  for (auto made = std::ranges::lower_bound(returns_, utime_us - tolerance_us_, {}, &Return::utime_us);
       made != returns_.end() && made->utime_us <= utime_us + tolerance_us_; ++made) {
    if (made->ring == ring && made->return_index == return_index) return &*made;
  }
  return nullptr;
}

const Truth::Return* Truth::FindAlong(const Eigen::Vector3d& direction, double least_cosine, const TruthSpan& window, int ring,
                                      int return_index) const {
  const Return* nearest = nullptr;
  double greatest_cosine = least_cosine;
  for (auto made = std::ranges::lower_bound(returns_, window.begin_us, {}, &Return::utime_us);
       made != returns_.end() && made->utime_us <= window.end_us; ++made) {
    if (made->ring != ring || made->return_index != return_index) continue;
    const Eigen::Vector3d p_m = made->p_lidar_m.cast<double>();
    const double cosine = p_m.dot(direction) / p_m.norm();  // NaN without a place: not greater
    if (!(cosine >= greatest_cosine)) continue;
    greatest_cosine = cosine;
    nearest = &*made;
  }
  return nearest;
}

std::optional<TruthSpan> Truth::Span() const {
  std::optional<TruthSpan> span;
  const auto add = [&span](std::int64_t begin_us, std::int64_t end_us) {
    if (!span) span = TruthSpan{begin_us, end_us};
    span = TruthSpan{std::min(span->begin_us, begin_us), std::max(span->end_us, end_us)};
  };
  if (!poses_.empty()) add(poses_.begin()->first, poses_.rbegin()->first);
  if (!returns_.empty()) add(returns_.front().utime_us, returns_.back().utime_us);
  return span;
}

Outlines Truth::OutlinesIn(const GeographicLib::LocalCartesian& map) const {
  Outlines result;
  for (const auto& [object_id, by_time] : outlines_) {
    for (const auto& [utime_us, vertices] : by_time) {
      Polygon outline_m;
      for (const auto& vertex : vertices) {
        Eigen::Vector3d p_m;
        map.Forward(vertex.latitude_deg, vertex.longitude_deg, map.HeightOrigin(), p_m.x(), p_m.y(), p_m.z());
        outline_m.emplace_back(p_m.head<2>());
      }
      result.Add(object_id, utime_us, std::move(outline_m));
    }
  }
  return result;
}

void Truth::ForEachReturn(const lidar_scan_t& part,
                          const std::function<void(std::size_t cell, std::int64_t time_ns, const Return* truth)>& handle) const {
  std::size_t cell = 0;
  for (std::size_t column = 0; column < static_cast<std::size_t>(part.num_columns); ++column) {
    for (std::size_t ring = 0; ring < static_cast<std::size_t>(part.num_rings); ++ring) {
      for (int k = 0; k < part.num_returns; ++k, ++cell) {
        if (part.range[cell] == 0) continue;
        const std::int64_t time_ns = std::int64_t{part.time_ns[column]} + part.time_offset_ns[ring];
        handle(cell, time_ns, Find(part.utime_us + ToMicroseconds(time_ns), static_cast<int>(ring), k, part.first_column + static_cast<int>(column)));
      }
    }
  }
}

}  // namespace lookout::eval
