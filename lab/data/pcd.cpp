#include "lab/data/pcd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "tools/import/file_bytes.hpp"
#include "tools/import/pcd_file.hpp"

namespace lookout::data {

namespace {

using importer::PcdField;
using importer::PcdReader;
using importer::PointFileError;
using importer::ReadFileBytes;

// Points as they are read, before their labels have numbers.
class Collector {
 public:
  explicit Collector(PcdReader& reader) : reader_(reader), x_(Need("x")), y_(Need("y")), z_(Need("z")) {
    label_ = reader.Find("label");
    intensity_ = reader.Find("intensity");
    cloud_.has_labels = label_ != nullptr;
    cloud_.points.reserve(reader.header().num_points);
  }

  void Add() {
    CloudPoint point{static_cast<float>(reader_.Number(*x_)), static_cast<float>(reader_.Number(*y_)), static_cast<float>(reader_.Number(*z_)), 0,
                     kNoTrueObject};
    double label = 0.0;
    if (label_ != nullptr) {
      label = reader_.Number(*label_);
      if (!(std::abs(label) <= kMaxLabel) || label != std::floor(label)) reader_.Refuse("a label is a whole number of at most 53 bits");
    }
    if (intensity_ != nullptr) {
      const double intensity = reader_.Number(*intensity_);
      if (intensity > 0.0) point.reflectivity = static_cast<std::uint8_t>(std::lround(std::min(intensity, kMaxReflectivity)));
    }
    if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m) || !std::isfinite(point.z_m)) {
      ++cloud_.num_not_finite;
      return;
    }
    cloud_.points.push_back(point);
    labels_.push_back(static_cast<std::int64_t>(label));
  }

  PointCloud Finish() {
    std::map<std::int64_t, std::int32_t> object_of_label;
    for (const auto label : labels_) {
      if (label > 0) object_of_label.emplace(label, 0);
    }
    std::int32_t next = 1;
    for (auto& [label, object] : object_of_label) {
      object = next++;
      cloud_.objects[object] = {"label " + std::to_string(label), "object", false};
    }
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      if (labels_[i] > 0) cloud_.points[i].object = object_of_label.at(labels_[i]);
    }
    return std::move(cloud_);
  }

 private:
  static constexpr double kMaxLabel = 9007199254740992.0;  // 2^53: whole numbers that a double holds
  static constexpr double kMaxReflectivity = std::numeric_limits<std::uint8_t>::max();

  const PcdField* Need(const std::string& field_name) const {
    const auto* field = reader_.Find(field_name);
    if (field == nullptr) throw PointFileError(reader_.name() + ": there is no field " + field_name);
    return field;
  }

  PcdReader& reader_;
  const PcdField* x_;
  const PcdField* y_;
  const PcdField* z_;
  const PcdField* label_ = nullptr;
  const PcdField* intensity_ = nullptr;
  PointCloud cloud_;
  std::vector<std::int64_t> labels_;  // [points]
};

}  // namespace

PointCloud ParsePcd(std::string_view bytes, const std::string& name) {
  PcdReader reader(bytes, name, PcdReader::Cut::kRefused);
  Collector collector(reader);
  while (reader.Next()) collector.Add();
  return collector.Finish();
}

PointCloud ReadPcd(const std::filesystem::path& file) { return ParsePcd(ReadFileBytes(file), file.string()); }

}  // namespace lookout::data
