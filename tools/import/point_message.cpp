#include "tools/import/point_message.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <type_traits>
#include <utility>

#include "common/core/bytes.hpp"
#include "tools/import/file_bytes.hpp"
#include "tools/import/pcd_file.hpp"
#include "tools/import/ros_message.hpp"

namespace lookout::importer {

namespace {

constexpr std::size_t kKittiPointBytes = 16;
constexpr std::size_t kPointLabelBytes = 4;

struct MessageField {
  std::string_view name;
  std::uint8_t type;
  std::uint32_t size_bytes;
};

constexpr MessageField kMessageX{"x", RosPointField::kFloat32, 4};
constexpr MessageField kMessageY{"y", RosPointField::kFloat32, 4};
constexpr MessageField kMessageZ{"z", RosPointField::kFloat32, 4};
constexpr MessageField kMessageReflectivity{"reflectivity", RosPointField::kUint8, 1};
constexpr MessageField kMessageRing{"ring", RosPointField::kInt32, 4};
constexpr MessageField kMessageTime{"time", RosPointField::kFloat64, 8};
constexpr MessageField kMessageTimestamp{"timestamp", RosPointField::kFloat64, 8};
constexpr MessageField kMessageLabel{"label", RosPointField::kUint32, 4};

class MessageWriter {
 public:
  MessageWriter(std::int64_t stamp_ns, const std::vector<MessageField>& fields) {
    constexpr std::int64_t kNsPerS = 1'000'000'000;
    Put<std::uint32_t>(0);  // seq
    Put(static_cast<std::uint32_t>(stamp_ns / kNsPerS));
    Put(static_cast<std::uint32_t>(stamp_ns % kNsPerS));
    PutText("lidar");
    shape_at_ = bytes_.size();
    Put<std::uint64_t>(0);  // height, width
    Put(static_cast<std::uint32_t>(fields.size()));
    for (const auto& field : fields) {
      PutText(field.name);
      Put(point_bytes_);
      Put(field.type);
      Put<std::uint32_t>(1);
      point_bytes_ += field.size_bytes;
    }
    Put<std::uint8_t>(0);  // little-endian
    Put(point_bytes_);
    row_at_ = bytes_.size();
    Put<std::uint64_t>(0);  // bytes of a row, of all
    data_at_ = bytes_.size();
  }

  void Reserve(std::size_t num_points) { bytes_.reserve(data_at_ + num_points * point_bytes_ + 1); }

  template <typename T>
  void Put(T value) {
    if constexpr (std::is_same_v<T, float>) {
      Put(std::bit_cast<std::uint32_t>(value));
    } else if constexpr (std::is_same_v<T, double>) {
      Put(std::bit_cast<std::uint64_t>(value));
    } else {
      const auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
      bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    }
  }
  void PutText(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }

  std::vector<std::uint8_t> Finish(std::size_t height, std::size_t width) {
    Set(shape_at_, height);
    Set(shape_at_ + 4, width);
    Set(row_at_, width * point_bytes_);
    Set(row_at_ + 4, height * width * point_bytes_);
    Put<std::uint8_t>(0);  // not dense
    return std::move(bytes_);
  }

 private:
  void Set(std::size_t at, std::size_t value) {
    const auto raw = std::bit_cast<std::array<std::uint8_t, 4>>(static_cast<std::uint32_t>(value));
    std::ranges::copy(raw, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
  }

  std::vector<std::uint8_t> bytes_;
  std::uint32_t point_bytes_ = 0;
  std::size_t shape_at_ = 0;
  std::size_t row_at_ = 0;
  std::size_t data_at_ = 0;
};

static_assert(std::endian::native == std::endian::little);

Bytes RawBytes(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

// The labels of points, one after the other.
class Labeller {
 public:
  // @param fault  is told why labels are not used
  Labeller(const PointLabels& labels, std::size_t num_points, const std::string& name, std::string& fault) : labels_(labels) {
    if (!labels_.of_points || labels_.of_points->size() == num_points * kPointLabelBytes) return;
    fault = name + ": its labels are of " + std::to_string(labels_.of_points->size()) + " bytes, not " +
            std::to_string(num_points * kPointLabelBytes) + ": not used";
    labels_.of_points.reset();
  }

  bool has_labels() const { return labels_.of_points || labels_.boxes; }

  std::uint32_t Of(std::size_t point, float x_m, float y_m, float z_m) const {
    if (labels_.of_points) return ReadU32LittleEndian(RawBytes(*labels_.of_points), point * kPointLabelBytes);
    return labels_.boxes ? LabelAt(*labels_.boxes, x_m, y_m, z_m) : 0;
  }

 private:
  PointLabels labels_;
};

std::uint8_t ReflectivityOf(float reflectance) {
  constexpr float kWhite = 100.0F;  // per cent, as a VLP-16 says it
  if (!(reflectance > 0.0F)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(1.0F, reflectance) * kWhite));
}

const PcdField* FirstOf(const PcdReader& reader, std::initializer_list<std::string_view> names) {
  for (const auto name : names) {
    if (const auto* const field = reader.Find(name)) return field;
  }
  return nullptr;
}

struct PcdColumns {
  const PcdField* x = nullptr;
  const PcdField* y = nullptr;
  const PcdField* z = nullptr;
  const PcdField* ring = nullptr;
  const PcdField* time = nullptr;
  const PcdField* timestamp = nullptr;
  const PcdField* reflectivity = nullptr;
  const PcdField* label = nullptr;
};

PcdColumns ColumnsOf(const PcdReader& reader) {
  PcdColumns columns{reader.Find("x"), reader.Find("y"), reader.Find("z"), nullptr, nullptr, nullptr, nullptr, nullptr};
  if (columns.x == nullptr || columns.y == nullptr || columns.z == nullptr) throw PointFileError(reader.name() + ": there are no fields x, y and z");
  columns.ring = FirstOf(reader, {"ring", "line", "channel"});
  columns.time = FirstOf(reader, {"time", "t", "offset_time"});
  columns.timestamp = columns.time == nullptr ? reader.Find("timestamp") : nullptr;
  columns.reflectivity = FirstOf(reader, {"reflectivity", "intensity"});
  columns.label = reader.Find("label");
  return columns;
}

// Whole numbers count nanoseconds. Numbers beyond kLargestNs, whose digits a double of seconds would not hold, stay nanoseconds; the cloud's reader
// knows these.
double PointTimeOf(const PcdField& field, double value) {
  constexpr double kLargestNs = 1e14;
  const bool is_whole = field.type != PcdField::Type::kFloat;
  return is_whole && std::abs(value) <= kLargestNs ? value * 1e-9 : value;
}

std::int32_t RingNumber(double value) {
  constexpr double kMost = 1e6;  // NaN and numbers beyond this are no ring
  return value >= -1.0 && value <= kMost ? static_cast<std::int32_t>(value) : std::numeric_limits<std::int32_t>::max();
}

std::uint32_t LabelNumber(double value) {
  return value >= 0.0 && value <= static_cast<double>(std::numeric_limits<std::uint32_t>::max()) ? static_cast<std::uint32_t>(value) : 0;
}

// The least dated time of a point; nullopt where there is none.
std::optional<std::int64_t> FirstTimestamp(std::string_view bytes, const std::string& name) {
  constexpr double kLeastDatedS = 1e8;
  constexpr double kLeastDatedNs = 1e17;
  constexpr double kMostS = 4.1e9;  // the year 2099
  PcdReader reader(bytes, name, PcdReader::Cut::kRead);
  const auto* const field = reader.Find("timestamp");
  std::optional<double> first_ns;
  try {
    while (field != nullptr && reader.Next()) {
      const double value = reader.Number(*field);
      const double time_ns = value >= kLeastDatedNs ? value : value >= kLeastDatedS && value <= kMostS ? value * 1e9 : 0.0;
      if (time_ns > 0.0 && time_ns <= kMostS * 1e9 && (!first_ns || time_ns < *first_ns)) first_ns = time_ns;
    }
  } catch (const PointFileError&) {
    // The reader of points tells it.
  }
  return first_ns ? std::optional(std::llround(*first_ns)) : std::nullopt;
}

class PcdMessage {
 public:
  PcdMessage(PcdReader& reader, std::int64_t stamp_ns, const PointLabels& labels, std::string& fault)
      : reader_(reader),
        columns_(ColumnsOf(reader)),
        labeller_(labels, reader.header().num_points, reader.name(), fault),
        has_labels_(labeller_.has_labels() || columns_.label != nullptr),
        writer_(stamp_ns, Fields()) {}

  void Add() {
    const auto x_m = static_cast<float>(reader_.Number(*columns_.x));
    const auto y_m = static_cast<float>(reader_.Number(*columns_.y));
    const auto z_m = static_cast<float>(reader_.Number(*columns_.z));
    const auto number = [&](const PcdField* field) { return field != nullptr ? reader_.Number(*field) : 0.0; };
    // All numbers are read before the first is written: the line may be damaged.
    const double ring = number(columns_.ring);
    const double time = columns_.time != nullptr ? PointTimeOf(*columns_.time, number(columns_.time)) : 0.0;
    const double timestamp = columns_.timestamp != nullptr ? PointTimeOf(*columns_.timestamp, number(columns_.timestamp)) : 0.0;
    const double reflectivity = number(columns_.reflectivity);
    const double label = number(columns_.label);
    Put(x_m, y_m, z_m);
    if (columns_.ring != nullptr) writer_.Put(RingNumber(ring));
    if (columns_.time != nullptr) writer_.Put(time);
    if (columns_.timestamp != nullptr) writer_.Put(timestamp);
    if (columns_.reflectivity != nullptr)
      writer_.Put(static_cast<std::uint8_t>(reflectivity > 0.0 ? std::min(std::round(reflectivity), 255.0) : 0.0));
    if (has_labels_) writer_.Put(labeller_.has_labels() ? labeller_.Of(num_points_, x_m, y_m, z_m) : LabelNumber(label));
    ++num_points_;
  }

  std::vector<std::uint8_t> Finish() {
    const auto& header = reader_.header();
    if (header.height <= 1 || num_points_ == 0) return writer_.Finish(1, num_points_);
    // Rows may be rings, so they stay whole.
    const auto num_rows = (num_points_ + header.width - 1) / header.width;
    while (num_points_ < num_rows * header.width) AddNone();
    return writer_.Finish(num_rows, header.width);
  }

 private:
  std::vector<MessageField> Fields() const {
    std::vector<MessageField> fields{kMessageX, kMessageY, kMessageZ};
    if (columns_.ring != nullptr) fields.push_back(kMessageRing);
    if (columns_.time != nullptr) fields.push_back(kMessageTime);
    if (columns_.timestamp != nullptr) fields.push_back(kMessageTimestamp);
    if (columns_.reflectivity != nullptr) fields.push_back(kMessageReflectivity);
    if (has_labels_) fields.push_back(kMessageLabel);
    return fields;
  }

  void Put(float x_m, float y_m, float z_m) {
    for (const float value_m : {x_m, y_m, z_m}) writer_.Put(value_m);
  }

  void AddNone() {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    Put(kNone, kNone, kNone);
    if (columns_.ring != nullptr) writer_.Put<std::int32_t>(0);
    if (columns_.time != nullptr) writer_.Put(0.0);
    if (columns_.timestamp != nullptr) writer_.Put(0.0);
    if (columns_.reflectivity != nullptr) writer_.Put<std::uint8_t>(0);
    if (has_labels_) writer_.Put<std::uint32_t>(0);
    ++num_points_;
  }

  PcdReader& reader_;
  PcdColumns columns_;
  Labeller labeller_;
  bool has_labels_;
  MessageWriter writer_;
  std::size_t num_points_ = 0;
};

}  // namespace

PointMessage MessageOfKitti(std::string_view bytes, const std::string& name, std::int64_t stamp_ns, const PointLabels& labels) {
  PointMessage message{{}, stamp_ns, {}};
  const auto num_points = bytes.size() / kKittiPointBytes;
  if (num_points > kMaxRosPoints) {
    message.fault = name + ": " + std::to_string(num_points) + " points are no scan";
    return message;
  }
  if (bytes.size() % kKittiPointBytes != 0) message.fault = name + ": the file ends inside a point of 16 bytes";
  std::string label_fault;
  const Labeller labeller(labels, num_points, name, label_fault);
  if (message.fault.empty()) message.fault = label_fault;
  std::vector<MessageField> fields{kMessageX, kMessageY, kMessageZ, kMessageReflectivity};
  if (labeller.has_labels()) fields.push_back(kMessageLabel);
  MessageWriter writer(stamp_ns, fields);
  writer.Reserve(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    const auto number = [&](std::size_t field) {
      return std::bit_cast<float>(ReadU32LittleEndian(RawBytes(bytes), i * kKittiPointBytes + 4 * field));
    };
    for (std::size_t field = 0; field < 3; ++field) writer.Put(number(field));
    writer.Put(ReflectivityOf(number(3)));
    if (labeller.has_labels()) writer.Put(labeller.Of(i, number(0), number(1), number(2)));
  }
  message.bytes = writer.Finish(1, num_points);
  return message;
}

PointMessage MessageOfPcd(std::string_view bytes, const std::string& name, std::optional<std::int64_t> stamp_ns, const PointLabels& labels) try {
  PointMessage message;
  if (!stamp_ns) stamp_ns = FirstTimestamp(bytes, name);
  if (!stamp_ns) {
    message.fault = name + ": has no time";
    return message;
  }
  message.stamp_ns = *stamp_ns;
  PcdReader reader(bytes, name, PcdReader::Cut::kRead);
  std::string label_fault;
  PcdMessage points(reader, *stamp_ns, labels, label_fault);
  try {
    while (reader.Next()) points.Add();
  } catch (const PointFileError& error) {
    message.fault = error.what();
  }
  if (message.fault.empty()) message.fault = label_fault;
  message.bytes = points.Finish();
  return message;
} catch (const PointFileError& error) {
  return {{}, 0, error.what()};
}

}  // namespace lookout::importer
