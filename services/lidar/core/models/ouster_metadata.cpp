#include "services/lidar/core/models/ouster_metadata.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/printable.hpp"

namespace lookout::lidar {
namespace {

using Json = nlohmann::json;

// Metadata of sensors have 4 to 40 kB and three levels.
constexpr std::size_t kMaxMetadataBytes = std::size_t{1} << 20;
constexpr int kMaxMetadataDepth = 32;
constexpr std::size_t kMaxWordBytes = 200;

constexpr int kMaxPixels = 128;
constexpr int kMaxColumnsPerFrame = 8192;  // of today's sensors 4096
constexpr int kMaxFramesPerS = 100;        // of today's sensors 20
constexpr int kMaxColumnsPerPacket = 64;   // of today's sensors 16
constexpr double kMaxElevationDeg = 90.0;
constexpr double kMaxOffsetDeg = 180.0;
constexpr double kMaxBeamOriginMm = 200.0;
constexpr double kMaxTransformMm = 10'000.0;
constexpr double kMaxRotationError = 1e-3;

// First generation; its metadata do not say it.
constexpr std::size_t kFirstGenerationChannels = 64;
constexpr double kFirstGenerationOriginMm = 12.163;
constexpr int kFirstColumnsPerPacket = 16;

constexpr std::array<std::pair<std::string_view, OusterProfile>, 5> kProfiles{{{"LEGACY", OusterProfile::kLegacy},
                                                                               {"RNG19_RFL8_SIG16_NIR16", OusterProfile::kSingle},
                                                                               {"RNG19_RFL8_SIG16_NIR16_DUAL", OusterProfile::kDual},
                                                                               {"RNG15_RFL8_NIR8", OusterProfile::kLowBandwidth},
                                                                               {"FUSA_RNG15_RFL8_NIR8_DUAL", OusterProfile::kFusaDual}}};
constexpr std::array<std::pair<std::string_view, OusterClock>, 3> kClocks{{{"TIME_FROM_INTERNAL_OSC", OusterClock::kInternalOscillator},
                                                                           {"TIME_FROM_SYNC_PULSE_IN", OusterClock::kSyncPulse},
                                                                           {"TIME_FROM_PTP_1588", OusterClock::kPtp}}};
constexpr std::array<std::pair<std::string_view, OusterReturnOrder>, 3> kReturnOrders{
    {{"STRONGEST_TO_WEAKEST", OusterReturnOrder::kStrongestToWeakest},
     {"NEAREST_TO_FARTHEST", OusterReturnOrder::kNearestToFarthest},
     {"FARTHEST_TO_NEAREST", OusterReturnOrder::kFarthestToNearest}}};

// A field, by the name that the reason of a refusal gives it.
struct MetadataField {
  const Json* value = nullptr;
  std::string name;

  [[noreturn]] void Refuse(const std::string& reason) const { throw std::runtime_error(name + ": " + reason); }
  explicit operator bool() const { return value != nullptr; }
};

// Whoever takes a text apart level by level needs a bound before it.
void CheckDepth(std::string_view json) {
  int depth = 0;
  bool is_in_text = false;
  bool is_escaped = false;
  for (const char character : json) {
    if (is_in_text) {
      if (character == '"' && !is_escaped) is_in_text = false;
      is_escaped = character == '\\' && !is_escaped;
    } else if (character == '"') {
      is_in_text = true;
    } else if (character == '{' || character == '[') {
      if (++depth > kMaxMetadataDepth) throw std::runtime_error("metadata: nested too deep");
    } else if (character == '}' || character == ']') {
      --depth;
    }
  }
}

// The first of the places, such as "sensor_info.prod_sn", that is there.
MetadataField FindField(const Json& root, std::initializer_list<std::string_view> places) {
  for (const auto place : places) {
    const Json* value = &root;
    for (std::size_t begin = 0; value != nullptr && begin <= place.size();) {
      const auto end = std::min(place.find('.', begin), place.size());
      const auto found = value->is_object() ? value->find(std::string(place.substr(begin, end - begin))) : value->end();
      value = value->is_object() && found != value->end() && !found->is_null() ? &*found : nullptr;
      begin = end + 1;
    }
    if (value != nullptr) return {value, std::string(place)};
  }
  return {nullptr, std::string(*(places.end() - 1))};
}

MetadataField NeedField(const Json& root, std::initializer_list<std::string_view> places) {
  auto field = FindField(root, places);
  if (!field) field.Refuse("missing");
  return field;
}

// A field of the data format; `format` is an object.
MetadataField FieldOf(const MetadataField& format, const char* name) {
  const auto found = format.value->find(name);
  return {found != format.value->end() && !found->is_null() ? &*found : nullptr, format.name + "." + name};
}

double NumberOf(const MetadataField& field, const Json& value, double min, double max) {
  if (!value.is_number()) field.Refuse("must hold numbers alone");
  const auto number = value.get<double>();
  if (!(number >= min && number <= max)) field.Refuse("beyond " + std::to_string(min) + " to " + std::to_string(max));
  return number;
}

int WholeNumberOf(const MetadataField& field, const Json& value, int min, int max) {
  if (!value.is_number_integer()) field.Refuse("must be a whole number");
  const double number = NumberOf(field, value, -1e15, 1e15);
  if (number < min || number > max) field.Refuse("beyond " + std::to_string(min) + " to " + std::to_string(max));
  return static_cast<int>(number);
}

int NeedWholeNumber(const MetadataField& field, int min, int max) {
  if (!field) field.Refuse("missing");
  return WholeNumberOf(field, *field.value, min, max);
}

std::string WordOf(const MetadataField& field) {
  if (!field) return "";
  if (!field.value->is_string()) field.Refuse("must be a text");
  const auto& text = field.value->get_ref<const std::string&>();
  if (text.size() > kMaxWordBytes) field.Refuse("too long");
  return Printable(text);
}

template <typename Value, std::size_t kCount>
Value ChoiceOf(const MetadataField& field, const std::array<std::pair<std::string_view, Value>, kCount>& choices) {
  const auto word = WordOf(field);
  const auto* choice = std::ranges::find(choices, word, &std::pair<std::string_view, Value>::first);
  if (choice != choices.end()) return choice->second;
  std::string reason = "\"" + word + "\" is not known:";
  for (const auto& [name, value] : choices) reason += " " + std::string(name);
  field.Refuse(reason);
}

std::uint64_t SerialOf(const MetadataField& field) {
  constexpr std::uint64_t kMaxSerial = (std::uint64_t{1} << 40) - 1;  // 5 bytes of a packet
  std::uint64_t serial = 0;
  if (field.value->is_number_unsigned()) {
    serial = field.value->get<std::uint64_t>();
  } else {
    const auto word = WordOf(field);
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), serial);
    if (fault != std::errc() || end != word.data() + word.size()) field.Refuse("\"" + word + "\" is no number");
  }
  if (serial > kMaxSerial) field.Refuse("beyond 40 bits");
  return serial;
}

struct LidarMode {
  int columns = 0;
  int frames_per_s = 0;
};

LidarMode ModeOf(const MetadataField& field) {
  const auto word = WordOf(field);
  LidarMode mode;
  const char* const word_end = word.data() + word.size();
  const auto [middle, fault] = std::from_chars(word.data(), word_end, mode.columns);
  const bool has_rate = fault == std::errc() && middle != word_end && *middle == 'x';
  const auto [end, rate_fault] = has_rate ? std::from_chars(middle + 1, word_end, mode.frames_per_s) : std::from_chars_result{middle, fault};
  if (!has_rate || rate_fault != std::errc() || end != word_end) field.Refuse("\"" + word + "\" is none such as 1024x10");
  if (mode.columns < 1 || mode.columns > kMaxColumnsPerFrame || mode.frames_per_s < 1 || mode.frames_per_s > kMaxFramesPerS) {
    field.Refuse("\"" + word + "\" is beyond what a sensor does");
  }
  return mode;
}

std::vector<double> AnglesOf(const MetadataField& field, double max_deg) {
  if (!field.value->is_array()) field.Refuse("must be a list of angles");
  if (field.value->empty() || field.value->size() > kMaxPixels) {
    field.Refuse("holds " + std::to_string(field.value->size()) + " angles; there must be 1 to " + std::to_string(kMaxPixels));
  }
  std::vector<double> angles_rad;
  angles_rad.reserve(field.value->size());
  for (const auto& angle : *field.value) angles_rad.push_back(DegToRad(NumberOf(field, angle, -max_deg, max_deg)));
  return angles_rad;
}

// 16 numbers by row, of millimetres where they are lengths.
Eigen::Isometry3d TransformOf(const MetadataField& field) {
  if (!field.value->is_array() || field.value->size() != 16) field.Refuse("must hold 16 numbers");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = NumberOf(field, (*field.value)[static_cast<std::size_t>(i)], -kMaxTransformMm, kMaxTransformMm);
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxRotationError &&
                        rotation.determinant() > 0.0 && matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!is_rigid) field.Refuse("is no rotation with an offset");
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = rotation;
  transform.translation() = matrix.topRightCorner<3, 1>() / 1000.0;
  return transform;
}

std::optional<Eigen::Isometry3d> TransformIfSaid(const MetadataField& field) {
  if (!field) return std::nullopt;
  return TransformOf(field);
}

std::optional<int> PortOf(const MetadataField& field) {
  if (!field) return std::nullopt;
  return WholeNumberOf(field, *field.value, 0, 65'535);
}

void ReadSensorInfo(const Json& root, OusterMetadata& metadata) {
  metadata.product = WordOf(FindField(root, {"sensor_info.prod_line", "prod_line"}));
  metadata.firmware = WordOf(FindField(root, {"sensor_info.build_rev", "build_rev"}));
  const auto serial = FindField(root, {"sensor_info.prod_sn", "prod_sn"});
  const bool is_blank = serial && serial.value->is_string() && serial.value->get_ref<const std::string&>().empty();
  if (serial && !is_blank) metadata.serial_number = SerialOf(serial);
  if (const auto id = FindField(root, {"sensor_info.initialization_id", "initialization_id"})) {
    metadata.init_id = static_cast<std::uint32_t>(WholeNumberOf(id, *id.value, 0, (1 << 24) - 1));
  }
  if (const auto clock = FindField(root, {"config_params.timestamp_mode", "timestamp_mode"})) metadata.clock = ChoiceOf(clock, kClocks);
  if (const auto order = FindField(root, {"config_params.return_order", "return_order"})) metadata.return_order = ChoiceOf(order, kReturnOrders);
  metadata.lidar_port = PortOf(FindField(root, {"config_params.udp_port_lidar", "udp_port_lidar"}));
  metadata.imu_port = PortOf(FindField(root, {"config_params.udp_port_imu", "udp_port_imu"}));
}

void ReadWindow(const MetadataField& window, OusterMetadata& metadata) {
  metadata.first_column = 0;
  metadata.last_column = metadata.columns_per_frame - 1;
  if (!window) return;
  if (!window.value->is_array() || window.value->size() != 2) window.Refuse("must hold two columns");
  metadata.first_column = WholeNumberOf(window, (*window.value)[0], 0, metadata.columns_per_frame - 1);
  metadata.last_column = WholeNumberOf(window, (*window.value)[1], 0, metadata.columns_per_frame - 1);
}

// Firmware 1 has no data format, or a text in its place that says so: 16 columns a packet, all columns of the revolution, LEGACY.
void ReadDataFormat(const Json& root, OusterMetadata& metadata) {
  const auto mode_field = FindField(root, {"config_params.lidar_mode", "lidar_mode"});
  auto format = FindField(root, {"lidar_data_format", "data_format"});
  const auto named_profile = FindField(root, {"config_params.udp_profile_lidar", "udp_profile_lidar"});
  LidarMode mode;
  if (mode_field) mode = ModeOf(mode_field);
  const bool has_format = format && !format.value->is_string();
  if (!has_format) {
    if (!mode_field) mode_field.Refuse("missing");
    metadata.columns_per_frame = mode.columns;
    metadata.columns_per_packet = std::min(kFirstColumnsPerPacket, mode.columns);
    metadata.pixels_per_column = static_cast<int>(metadata.elevation_rad.size());
    metadata.profile = named_profile ? ChoiceOf(named_profile, kProfiles) : OusterProfile::kLegacy;
    ReadWindow({}, metadata);
  } else {
    if (!format.value->is_object()) format.Refuse("must be an object");
    const auto columns = FieldOf(format, "columns_per_frame");
    metadata.columns_per_frame = NeedWholeNumber(columns, 1, kMaxColumnsPerFrame);
    if (mode_field && mode.columns != metadata.columns_per_frame) {
      columns.Refuse(std::to_string(metadata.columns_per_frame) + ", but " + mode_field.name + " says " + std::to_string(mode.columns));
    }
    metadata.pixels_per_column = NeedWholeNumber(FieldOf(format, "pixels_per_column"), 1, kMaxPixels);
    metadata.columns_per_packet =
        NeedWholeNumber(FieldOf(format, "columns_per_packet"), 1, std::min(kMaxColumnsPerPacket, metadata.columns_per_frame));
    const auto own_profile = FieldOf(format, "udp_profile_lidar");
    const auto& profile = own_profile ? own_profile : named_profile;
    metadata.profile = profile ? ChoiceOf(profile, kProfiles) : OusterProfile::kLegacy;
    ReadWindow(FieldOf(format, "column_window"), metadata);
    if (!mode_field) mode.frames_per_s = NeedWholeNumber(FieldOf(format, "fps"), 1, kMaxFramesPerS);
  }
  metadata.frames_per_s = mode.frames_per_s;
}

void ReadBeams(const Json& root, OusterMetadata& metadata) {
  const auto elevations = NeedField(root, {"beam_intrinsics.beam_altitude_angles", "beam_altitude_angles"});
  const auto offsets = NeedField(root, {"beam_intrinsics.beam_azimuth_angles", "beam_azimuth_angles"});
  metadata.elevation_rad = AnglesOf(elevations, kMaxElevationDeg);
  metadata.azimuth_offset_rad = AnglesOf(offsets, kMaxOffsetDeg);
  if (metadata.elevation_rad.size() != metadata.azimuth_offset_rad.size()) {
    offsets.Refuse(std::to_string(metadata.azimuth_offset_rad.size()) + " angles, but " + elevations.name + " has " +
                   std::to_string(metadata.elevation_rad.size()));
  }
  // Where fewer beams than channels are there, the table has zeros for the others, and so have tables that were never filled.
  const auto is_zero = [&metadata](std::size_t i) { return metadata.elevation_rad[i] == 0.0 && metadata.azimuth_offset_rad[i] == 0.0; };
  std::size_t num_zeros = 0;
  for (std::size_t i = 0; i < metadata.elevation_rad.size(); ++i) num_zeros += is_zero(i) ? 1 : 0;
  const bool has_unused = metadata.elevation_rad.size() == kFirstGenerationChannels &&
                          (num_zeros == kFirstGenerationChannels / 2 || num_zeros == kFirstGenerationChannels * 3 / 4);
  std::set<std::pair<double, double>> directions;
  for (std::size_t i = 0; i < metadata.elevation_rad.size(); ++i) {
    if (has_unused && is_zero(i)) {
      metadata.elevation_rad[i] = kNan;
      continue;
    }
    if (!directions.emplace(metadata.elevation_rad[i], metadata.azimuth_offset_rad[i]).second) {
      elevations.Refuse("two channels have one direction (" + std::to_string(i) + " and one before it): the table is not filled");
    }
  }
}

void ReadBeamOrigin(const Json& root, OusterMetadata& metadata) {
  double origin_mm = kFirstGenerationOriginMm;
  if (const auto origin = FindField(root, {"beam_intrinsics.lidar_origin_to_beam_origin_mm", "lidar_origin_to_beam_origin_mm"})) {
    origin_mm = NumberOf(origin, *origin.value, 0.0, kMaxBeamOriginMm);
  }
  metadata.beam_origin_m = origin_mm / 1000.0;
  const auto field = FindField(root, {"beam_intrinsics.beam_to_lidar_transform", "beam_to_lidar_transform"});
  if (!field) return;
  const auto transform = TransformOf(field);
  const Eigen::Vector3d offset_m = transform.translation();
  const bool is_along_x = (transform.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxRotationError && offset_m.y() == 0.0;
  if (!is_along_x || offset_m.x() < 0.0 || offset_m.norm() > kMaxBeamOriginMm / 1000.0) field.Refuse("is no offset along x and z");
  // The maker's SDK (make_xyz_lut) takes the length of the offset off the range, and adds the offset.
  metadata.beam_origin_m = offset_m.norm();
  metadata.beam_origin_height_m = offset_m.z();
}

}  // namespace

std::string_view NameOf(OusterProfile profile) {
  return std::ranges::find(kProfiles, profile, &std::pair<std::string_view, OusterProfile>::second)->first;
}

std::string OusterMetadata::ModelName() const {
  if (product.empty()) return "Ouster with " + std::to_string(pixels_per_column) + " rings";
  // The maker writes OS-1-128 here and OS1-128 elsewhere.
  const bool has_number = product.size() > 3 && product.starts_with("OS-") && product[3] >= '0' && product[3] <= '9';
  return "Ouster " + (has_number ? "OS" + product.substr(3) : product);
}

OusterMetadata ParseOusterMetadata(std::string_view json) {
  if (json.size() > kMaxMetadataBytes) throw std::runtime_error("metadata: more than 1 MiB");
  CheckDepth(json);
  const auto root = Json::parse(json, nullptr, false);
  if (!root.is_object()) throw std::runtime_error("metadata: no JSON object");
  OusterMetadata metadata;
  ReadSensorInfo(root, metadata);
  ReadBeams(root, metadata);
  ReadDataFormat(root, metadata);
  if (metadata.elevation_rad.size() != static_cast<std::size_t>(metadata.pixels_per_column)) {
    throw std::runtime_error("pixels_per_column: " + std::to_string(metadata.pixels_per_column) + ", but there are angles for " +
                             std::to_string(metadata.elevation_rad.size()));
  }
  ReadBeamOrigin(root, metadata);
  metadata.T_sensor_lidar = TransformIfSaid(FindField(root, {"lidar_intrinsics.lidar_to_sensor_transform", "lidar_to_sensor_transform"}));
  metadata.T_sensor_imu = TransformIfSaid(FindField(root, {"imu_intrinsics.imu_to_sensor_transform", "imu_to_sensor_transform"}));
  return metadata;
}

}  // namespace lookout::lidar
