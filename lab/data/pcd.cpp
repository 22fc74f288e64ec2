#include "lab/data/pcd.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "tools/import/file_bytes.hpp"

namespace lookout::data {

namespace {

using importer::PointFileError;
using importer::ReadFileBytes;
using importer::RefuseByte;
using importer::RefuseLine;

static_assert(std::endian::native == std::endian::little, "binary PCD files are little-endian");

struct PcdField {
  enum class Type { kSigned, kUnsigned, kFloat };

  std::string name;
  Type type = Type::kFloat;
  std::size_t size_bytes = 4;  // of one number: 1, 2, 4 or 8; a float 4 or 8
  std::size_t count = 1;
  std::size_t offset_bytes = 0;    // in a point of the binary form
  std::size_t offset_columns = 0;  // in a line of the text form
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t num_points = 0;
  std::size_t point_bytes = 0;    // of the binary form
  std::size_t point_columns = 0;  // of the text form
  bool is_binary = false;
  std::size_t data_offset = 0;  // of the first byte behind the header
  int data_line = 0;            // number of the first line behind the header, from 1
};

// More than any writer makes, and small enough that sums cannot overflow.
constexpr std::size_t kMaxFields = 64;
constexpr std::size_t kMaxCount = 1024;

using Words = std::vector<std::string_view>;

struct HeaderLine {
  int number = 0;
  Words values;
};

// The lines of the header by their first words.
class Lines {
 public:
  explicit Lines(const std::string& name) : name_(name) {}

  void Add(int number, const Words& words) {
    const auto [at, is_new] = lines_.try_emplace(std::string(words.front()));
    if (!is_new) RefuseLine(name_, number, at->first + " stands in line " + std::to_string(at->second.number) + " already");
    at->second = {number, Words(words.begin() + 1, words.end())};
    last_ = number;
  }

  const HeaderLine* Find(const std::string& key) const {
    const auto found = lines_.find(key);
    return found == lines_.end() ? nullptr : &found->second;
  }
  const HeaderLine& At(const std::string& key) const {
    const auto* line = Find(key);
    if (line == nullptr) RefuseLine(name_, last_, "the header has no " + key);
    return *line;
  }
  // @return the whole numbers of a line with as many values as there are fields, or of one value
  std::vector<std::size_t> Numbers(const HeaderLine& line, std::size_t expected, std::size_t max_value) const {
    if (line.values.size() != expected) {
      RefuseLine(name_, line.number, std::to_string(line.values.size()) + " values where " + std::to_string(expected) + " belong");
    }
    std::vector<std::size_t> numbers;
    for (const auto word : line.values) {
      std::size_t number = 0;
      const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (fault != std::errc() || end != word.data() + word.size() || number > max_value) {
        RefuseLine(name_, line.number, "no whole number from 0 to " + std::to_string(max_value) + ": " + std::string(word.substr(0, 32)));
      }
      numbers.push_back(number);
    }
    return numbers;
  }

 private:
  const std::string& name_;
  std::map<std::string, HeaderLine, std::less<>> lines_;
  int last_ = 1;
};

std::optional<PcdField::Type> ToType(std::string_view word) {
  if (word == "F") return PcdField::Type::kFloat;
  if (word == "I") return PcdField::Type::kSigned;
  if (word == "U") return PcdField::Type::kUnsigned;
  return std::nullopt;
}

void AddFields(const Lines& lines, const std::string& name, PcdHeader& header) {
  const auto& names = lines.At("FIELDS");
  const std::size_t num_fields = names.values.size();
  if (num_fields == 0 || num_fields > kMaxFields) RefuseLine(name, names.number, "from 1 to " + std::to_string(kMaxFields) + " fields");
  const auto& size_line = lines.At("SIZE");
  const auto sizes = lines.Numbers(size_line, num_fields, 8);
  const auto& types = lines.At("TYPE");
  if (types.values.size() != num_fields) RefuseLine(name, types.number, "as many types as fields belong here");
  const auto* count_line = lines.Find("COUNT");
  const auto counts = count_line != nullptr ? lines.Numbers(*count_line, num_fields, kMaxCount) : std::vector<std::size_t>(num_fields, 1);
  for (std::size_t i = 0; i < num_fields; ++i) {
    const auto type = ToType(types.values[i]);
    if (!type) RefuseLine(name, types.number, "a type is F, I or U, not " + std::string(types.values[i].substr(0, 32)));
    const bool is_float = *type == PcdField::Type::kFloat;
    if (sizes[i] != 4 && sizes[i] != 8 && (is_float || (sizes[i] != 1 && sizes[i] != 2))) {
      RefuseLine(name, size_line.number,
                 "there is no number of type " + std::string(types.values[i]) + " with " + std::to_string(sizes[i]) + " bytes");
    }
    header.fields.push_back({std::string(names.values[i]), *type, sizes[i], counts[i], header.point_bytes, header.point_columns});
    header.point_bytes += sizes[i] * counts[i];
    header.point_columns += counts[i];
  }
  if (header.point_bytes == 0) RefuseLine(name, names.number, "a point holds nothing");
}

void CheckViewpoint(const Lines& lines, const std::string& name) {
  const auto* line = lines.Find("VIEWPOINT");
  if (line == nullptr) return;
  static const std::vector<double> kOrigin{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};  // place, and a quaternion with its scalar first
  std::vector<double> values;
  for (const auto word : line->values) {
    double value = 0.0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size()) RefuseLine(name, line->number, "not a number: " + std::string(word.substr(0, 32)));
    values.push_back(value);
  }
  if (values != kOrigin) {
    RefuseLine(name, line->number, "the sensor must be at the origin and upright (0 0 0 1 0 0 0): bring the points into its frame");
  }
}

// Takes the next line off, without its end. @return false at the end
bool NextLine(std::string_view& rest, std::string_view& line) {
  if (rest.empty()) return false;
  const auto end = rest.find('\n');
  line = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

// Words between blanks and tabs, into `words`, which is cleared first.
void SplitWords(std::string_view line, Words& words) {
  constexpr std::string_view kBlanks = " \t";
  words.clear();
  for (auto begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

// The counts of the header are compared with the size of the file, so the arrays are never larger than a small multiple of it. Source: "The PCD
// (Point Cloud Data) file format", pointclouds.org, version 0.7
PcdHeader ParsePcdHeader(std::string_view bytes, const std::string& name) {
  static const std::vector<std::string_view> kKeys{"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  PcdHeader header;
  Lines lines(name);
  std::string_view rest = bytes;
  std::string_view line;
  Words words;
  int number = 0;
  while (lines.Find("DATA") == nullptr) {
    ++number;
    if (!NextLine(rest, line)) RefuseLine(name, number, "the file ends before the line DATA");
    SplitWords(line, words);
    if (words.empty() || words.front().front() == '#') continue;
    if (std::ranges::find(kKeys, words.front()) == kKeys.end()) {
      RefuseLine(name, number, "no line of a PCD header: " + std::string(words.front().substr(0, 32)));
    }
    lines.Add(number, words);
  }
  header.data_offset = bytes.size() - rest.size();
  header.data_line = number + 1;

  AddFields(lines, name, header);
  CheckViewpoint(lines, name);
  const auto size_of = [&](const std::string& key) { return lines.Numbers(lines.At(key), 1, static_cast<std::size_t>(kMaxCloudPoints)).front(); };
  header.num_points = size_of("WIDTH") * size_of("HEIGHT");
  if (const auto* points = lines.Find("POINTS"); points != nullptr && size_of("POINTS") != header.num_points) {
    RefuseLine(name, points->number, "POINTS is not WIDTH times HEIGHT, " + std::to_string(header.num_points));
  }
  if (header.num_points > static_cast<std::size_t>(kMaxCloudPoints)) {
    RefuseLine(name, lines.At("WIDTH").number, std::to_string(header.num_points) + " points are no scan");
  }
  const auto& data = lines.At("DATA");
  if (data.values.size() != 1 || (data.values[0] != "ascii" && data.values[0] != "binary")) {
    RefuseLine(name, data.number,
               "DATA is ascii or binary here; binary_compressed is not read: pcl_convert_pcd_ascii_binary makes one of the others");
  }
  header.is_binary = data.values[0] == "binary";
  // A number of the text form takes a character and a blank or the end of its line, but for the last one of the file.
  const std::size_t num_needed = header.num_points * (header.is_binary ? header.point_bytes : 2 * header.point_columns);
  const std::size_t num_there = rest.size() + (header.is_binary ? 0 : 1);
  if (num_needed > num_there || (header.is_binary && num_needed != num_there)) {
    RefuseLine(name, data.number,
               std::to_string(header.num_points) + " points take " + (header.is_binary ? "" : "at least ") + std::to_string(num_needed) + " bytes; " +
                   std::to_string(rest.size()) + " follow");
  }
  return header;
}

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

  /// @param number_of  gives the number of a field. @return the fault of the point; empty = none
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
  Words words;
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

}  // namespace lookout::data
