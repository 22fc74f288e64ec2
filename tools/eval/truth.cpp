#include "tools/eval/truth.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "tools/eval/csv_reader.hpp"

namespace lookout::eval {

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

Truth::Truth(const std::filesystem::path& folder) {
  CsvReader objects(folder / "objects.csv", "object_id,name,kind,is_moving");
  while (objects.Next()) {
    objects_[objects.Value<int>(0)] = {std::string(objects.Text(1)), std::string(objects.Text(2)), objects.Value<int>(3) != 0};
  }
  CsvReader outlines(folder / "outlines.csv", "object_id,utime_us,vertex_index,latitude_deg,longitude_deg");
  while (outlines.Next()) {
    outlines_[outlines.Value<int>(0)][outlines.Value<std::int64_t>(1)].push_back({outlines.Value<double>(3), outlines.Value<double>(4)});
  }
  CsvReader poses(folder / "pose.csv", "utime_us,latitude_deg,longitude_deg,heading_deg,roll_deg,pitch_deg");
  while (poses.Next()) {
    poses_[poses.Value<std::int64_t>(0)] = {poses.Value<double>(1), poses.Value<double>(2), poses.Value<double>(3), poses.Value<double>(4),
                                            poses.Value<double>(5)};
  }
  LoadReturns(folder / "returns.csv");
}

void Truth::LoadReturns(const std::filesystem::path& file) {
  CsvReader rows(file, "utime_us,ring,return_index,object_id");
  // Truths of older simulators end before these.
  const auto x_column = rows.ColumnOf("x_m");
  const auto z_column = rows.ColumnOf("z_m");
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  while (rows.Next()) {
    Return made{rows.Value<std::int64_t>(0), rows.Value<int>(1), rows.Value<int>(2), rows.Value<int>(3), Eigen::Vector3f::Constant(kUnknown)};
    if (x_column && z_column == *x_column + 2) {
      made.p_lidar_m = {rows.Value<float>(*x_column), rows.Value<float>(*x_column + 1), rows.Value<float>(*x_column + 2)};
    }
    returns_.push_back(made);
  }
  std::ranges::sort(returns_, {}, [](const Return& made) { return std::tuple(made.utime_us, made.ring, made.return_index); });
}

const Truth::Return* Truth::Find(std::int64_t utime_us, int ring, int return_index) const {
  for (auto made = std::ranges::lower_bound(returns_, utime_us - 1, {}, &Return::utime_us); made != returns_.end() && made->utime_us <= utime_us + 1;
       ++made) {
    if (made->ring == ring && made->return_index == return_index) return &*made;
  }
  return nullptr;
}

std::optional<int> Truth::ObjectOf(std::int64_t utime_us, int ring, int return_index) const {
  const Return* made = Find(utime_us, ring, return_index);
  return made != nullptr ? std::optional(made->object_id) : std::nullopt;
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

}  // namespace lookout::eval
