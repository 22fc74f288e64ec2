#include "tools/import/pcd.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "tools/import/file_bytes.hpp"
#include "tools/import/pcd_header.hpp"

namespace lookout::importer {

namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD files are little-endian");

template <typename T>
double NumberAt(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double BinaryNumber(const PcdField& field, const char* point) {
  const char* bytes = point + field.offset_bytes;
  switch (field.type) {
    case PcdField::Type::kFloat:
      return field.size_bytes == 4 ? NumberAt<float>(bytes) : NumberAt<double>(bytes);
    case PcdField::Type::kSigned:
      return field.size_bytes == 1   ? NumberAt<std::int8_t>(bytes)
             : field.size_bytes == 2 ? NumberAt<std::int16_t>(bytes)
             : field.size_bytes == 4 ? NumberAt<std::int32_t>(bytes)
                                     : NumberAt<std::int64_t>(bytes);
    case PcdField::Type::kUnsigned:
      return field.size_bytes == 1   ? NumberAt<std::uint8_t>(bytes)
             : field.size_bytes == 2 ? NumberAt<std::uint16_t>(bytes)
             : field.size_bytes == 4 ? NumberAt<std::uint32_t>(bytes)
                                     : NumberAt<std::uint64_t>(bytes);
  }
  return 0.0;
}

// Points as they are read, before their labels have numbers.
class Collector {
 public:
  Collector(const PcdHeader& header, const std::string& name)
      : x_(Need(header, name, "x")), y_(Need(header, name, "y")), z_(Need(header, name, "z")) {
    label_ = Find(header, name, "label");
    intensity_ = Find(header, name, "intensity");
    cloud_.has_labels = label_ != nullptr;
    cloud_.points.reserve(header.num_points);
  }

  /// @param number_of  gives the number of a field. @return what is wrong with the point; empty = nothing
  template <typename NumberOf>
  std::string Add(const NumberOf& number_of) {
    CloudPoint point{static_cast<float>(number_of(*x_)), static_cast<float>(number_of(*y_)), static_cast<float>(number_of(*z_)), 0, kNoTrueObject};
    double label = 0.0;
    if (label_ != nullptr) {
      label = number_of(*label_);
      if (!(std::abs(label) <= kMaxLabel) || label != std::floor(label)) return "a label is a whole number of at most 53 bits";
    }
    if (intensity_ != nullptr) {
      const double intensity = number_of(*intensity_);
      if (intensity > 0.0) point.reflectivity = static_cast<std::uint8_t>(std::lround(std::min(intensity, kMaxReflectivity)));
    }
    if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m) || !std::isfinite(point.z_m)) {
      ++cloud_.num_not_finite;
      return {};
    }
    cloud_.points.push_back(point);
    labels_.push_back(static_cast<std::int64_t>(label));
    return {};
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

  static const PcdField* Find(const PcdHeader& header, const std::string& name, std::string_view field_name) {
    const auto is_named = [field_name](const PcdField& field) { return field.name == field_name; };
    const auto found = std::ranges::find_if(header.fields, is_named);
    if (found == header.fields.end()) return nullptr;
    if (found->count != 1 || std::ranges::count_if(header.fields, is_named) != 1) {
      throw PointFileError(name + ": the field " + std::string(field_name) + " must be one number, and stand once");
    }
    return &*found;
  }
  static const PcdField* Need(const PcdHeader& header, const std::string& name, std::string_view field_name) {
    const auto* field = Find(header, name, field_name);
    if (field == nullptr) throw PointFileError(name + ": there is no field " + std::string(field_name));
    return field;
  }

  const PcdField* x_;
  const PcdField* y_;
  const PcdField* z_;
  const PcdField* label_ = nullptr;
  const PcdField* intensity_ = nullptr;
  PointCloud cloud_;
  std::vector<std::int64_t> labels_;  // [points]
};

void ReadBinary(std::string_view bytes, const PcdHeader& header, const std::string& name, Collector& collector) {
  for (std::size_t i = 0; i < header.num_points; ++i) {
    const auto offset = header.data_offset + i * header.point_bytes;
    const auto fault = collector.Add([&](const PcdField& field) { return BinaryNumber(field, bytes.data() + offset); });
    if (!fault.empty()) RefuseByte(name, offset, fault);
  }
}

void ReadText(std::string_view bytes, const PcdHeader& header, const std::string& name, Collector& collector) {
  std::string_view rest = bytes.substr(header.data_offset);
  std::string_view line;
  std::vector<std::string_view> words;
  std::size_t num_points = 0;
  for (int number = header.data_line; NextLine(rest, line); ++number) {
    SplitWords(line, words);
    if (words.empty()) continue;
    if (words.size() != header.point_columns) {
      RefuseLine(name, number, std::to_string(words.size()) + " numbers where " + std::to_string(header.point_columns) + " belong");
    }
    if (++num_points > header.num_points) RefuseLine(name, number, "more points than the header says, " + std::to_string(header.num_points));
    const auto number_of = [&](const PcdField& field) {
      const auto word = words[field.offset_columns];
      double value = 0.0;
      const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (fault != std::errc() || end != word.data() + word.size()) RefuseLine(name, number, "not a number: " + std::string(word.substr(0, 32)));
      return value;
    };
    const auto fault = collector.Add(number_of);
    if (!fault.empty()) RefuseLine(name, number, fault);
  }
  if (num_points != header.num_points) {
    throw PointFileError(name + ": " + std::to_string(num_points) + " points, where the header says " + std::to_string(header.num_points));
  }
}

}  // namespace

PointCloud ParsePcd(std::string_view bytes, const std::string& name) {
  const auto header = ParsePcdHeader(bytes, name);
  Collector collector(header, name);
  if (header.is_binary) {
    ReadBinary(bytes, header, name, collector);
  } else {
    ReadText(bytes, header, name, collector);
  }
  return collector.Finish();
}

PointCloud ReadPcd(const std::filesystem::path& file) { return ParsePcd(ReadFileBytes(file), file.string()); }

}  // namespace lookout::importer
