#include "tools/import/box_labels.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "common/core/elementary.hpp"

namespace lookout::importer {

namespace {

constexpr std::size_t kMaxBoxes = 512;
constexpr double kMaxBoxM = 1000.0;    // along an edge
constexpr double kMaxBoxPlaceM = 1e5;  // from the lidar
constexpr double kMaxYawRad = 100.0;

double BoxNumber(const nlohmann::json& value, double least, double greatest) {
  const double number = value.get<double>();
  if (!(number >= least && number <= greatest)) throw std::runtime_error("a number is out of range");
  return number;
}

std::uint32_t ClassOf(const std::string& category) {
  if (category == "ship") return kBoxShip;
  return category == "buoy" ? kBoxBuoy : kBoxOther;
}

LabelledBox BoxOf(const nlohmann::json& label, std::size_t place) {
  constexpr std::int64_t kNumInstances = 0xFFFF;
  const auto& box = label.at("box3d");
  const auto& size = box.at("dimension");
  const auto& centre = box.at("location");
  const double yaw_rad = BoxNumber(box.at("orientation").at("rotationYaw"), -kMaxYawRad, kMaxYawRad);
  const auto id = label.find("id");
  const bool has_id = id != label.end() && id->is_number_integer() && *id >= 0 && *id < kNumInstances;
  const auto instance = 1 + (has_id ? id->get<std::int64_t>() : static_cast<std::int64_t>(place) % kNumInstances);
  const auto half = [&](const char* edge) { return BoxNumber(size.at(edge), 0.0, kMaxBoxM) / 2.0; };
  const auto at = [&](const char* axis) { return BoxNumber(centre.at(axis), -kMaxBoxPlaceM, kMaxBoxPlaceM); };
  return {ClassOf(label.at("category").get<std::string>()) | static_cast<std::uint32_t>(instance) << 16,
          at("x"),
          at("y"),
          at("z"),
          half("width"),
          half("length"),
          half("height"),
          Cos(yaw_rad),
          Sin(yaw_rad)};
}

double VolumeOf(const LabelledBox& box) { return box.half_width_m * box.half_length_m * box.half_height_m; }

bool Holds(const LabelledBox& box, double x_m, double y_m, double z_m) {
  const double dx_m = x_m - box.x_m;
  const double dy_m = y_m - box.y_m;
  return std::abs(z_m - box.z_m) <= box.half_height_m && std::abs(box.cos_yaw * dx_m + box.sin_yaw * dy_m) <= box.half_width_m &&
         std::abs(box.cos_yaw * dy_m - box.sin_yaw * dx_m) <= box.half_length_m;
}

}  // namespace

std::optional<std::vector<LabelledBox>> ParseBoxes(std::string_view text) try {
  const auto json = nlohmann::json::parse(text);
  const auto& labels = json.at("labels");
  if (!labels.is_array() || labels.size() > kMaxBoxes) return std::nullopt;
  std::vector<LabelledBox> boxes;
  boxes.reserve(labels.size());
  for (const auto& label : labels) boxes.push_back(BoxOf(label, boxes.size()));
  std::ranges::stable_sort(boxes, {}, VolumeOf);
  return boxes;
} catch (const std::exception&) {
  return std::nullopt;
}

std::uint32_t LabelAt(std::span<const LabelledBox> boxes, double x_m, double y_m, double z_m) {
  for (const auto& box : boxes) {
    if (Holds(box, x_m, y_m, z_m)) return box.label;
  }
  return 0;
}

}  // namespace lookout::importer
