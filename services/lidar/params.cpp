#include "services/lidar/params.hpp"

#include <charconv>
#include <fstream>
#include <functional>
#include <sstream>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/network.hpp"
#include "config/schema/lidar.pb.h"

namespace lookout::lidar {

namespace {

// The enumerators of the schema count from 1, in the order of ours.
template <typename Choice, typename Field>
Choice ToChoice(Field field) {
  return static_cast<Choice>(static_cast<int>(field) - 1);
}
using Schema = config::Lidar;
constexpr int kFirstOtherModel = Schema::MODEL_VLP32C;
static_assert(Schema::MODEL_HDL32E - kFirstOtherModel == static_cast<int>(OtherModel::kHdl32e) &&
              Schema::MODEL_OUSTER - kFirstOtherModel == static_cast<int>(OtherModel::kOuster) &&
              Schema::MODEL_PANDAR64 - kFirstOtherModel == static_cast<int>(OtherModel::kPandar64));
static_assert(Schema::MODEL_AUTO == 1 && Schema::MODEL_VLP16 == 2 && Schema::MODEL_PUCK_HI_RES == 3);
static_assert(Schema::TIME_AUTO == 1 && Schema::TIME_SENSOR == 2 && Schema::TIME_HOST == 3);
static_assert(Schema::UDP == 1 && Schema::CAPTURE == 2 && Schema::LOG == 3 && Schema::INTERFACE == 4);

// Checks fields that are each right but do not go together.
void CheckRelations(const std::filesystem::path& file, const config::Lidar& message, std::vector<std::string>& faults) {
  const auto require = [&](bool is_fine, const char* field, const std::string& reason, int index = 0) {
    if (!is_fine) faults.push_back(config::FaultLine(file, field, reason, static_cast<std::size_t>(index)));
  };
  const bool are_ports_apart = message.data_port() != message.position_port();
  // The fault names the port that stands in the file.
  if (message.has_position_port() || !message.has_data_port()) {
    require(are_ports_apart, "position_port", "must differ from data_port, which is " + std::to_string(message.data_port()));
  } else {
    require(are_ports_apart, "data_port", "must differ from position_port, which is " + std::to_string(message.position_port()));
  }
  require(message.interface() != "any", "interface", "must be one interface: 'any' is none");
  switch (message.source()) {
    case config::Lidar::UDP:
      require(!message.bind_address().empty(), "bind_address", "must be set when source is UDP");
      require(message.bpf_filter().empty(), "bpf_filter", "is for source INTERFACE; UDP takes allowed_source_address");
      break;
    case config::Lidar::CAPTURE:
      require(message.capture_file_size() > 0, "capture_file", "must be set when source is CAPTURE");
      break;
    case config::Lidar::INTERFACE:
      require(!message.interface().empty(), "interface", "must be set when source is INTERFACE");
      require(message.multicast_group().empty(), "multicast_group", "is for source UDP; INTERFACE joins no group");
      break;
    default:
      break;
  }
  for (int i = 0; i < message.capture_file_size(); ++i) require(!message.capture_file(i).empty(), "capture_file", "must not be empty", i);
}

// Beam tables and metadata of the makers have some kilobytes.
constexpr std::size_t kMaxBeamTextBytes = 64 << 10;

std::string TextOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error("cannot be read");
  return text.str();
}

// "192.168.1.201", or with the port of a forwarder "127.0.0.1:8080".
void ReadSensorAddress(const config::Lidar& message, const ModelRow& row, const std::function<void(const char*, const std::string&)>& fault,
                       OtherLidar& other) {
  const auto& text = message.sensor_address();
  if (text.empty()) return;
  if (row.usual_control_port == 0) return fault("sensor_address", std::string(row.name) + " has the angles of the maker's table: it is not asked");
  const auto colon = text.find(':') == text.rfind(':') ? text.find(':') : std::string::npos;  // of IPv6 none is a port's
  const auto address = io::ParseIpAddress(text.substr(0, colon));
  int port = row.usual_control_port;
  if (colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data() + colon + 1, end, port);
    if (error != std::errc() || last != end || port < 1 || port > 65'535) port = 0;
  }
  if (!address || address->is_multicast() || address->is_any() || port == 0) {
    return fault("sensor_address", "'" + text + "' is no numeric address of a sensor, with or without a port");
  }
  other.sensor_address = io::ToText(*address);
  other.sensor_port = port;
}

std::optional<OtherLidar> ToOtherLidar(const std::filesystem::path& file, const config::Lidar& message, std::vector<std::string>& faults) {
  const auto config_folder = file.parent_path();
  const auto fault = [&](const char* field, const std::string& reason) { faults.push_back(config::FaultLine(file, field, reason, 0)); };
  if (message.model() < kFirstOtherModel) {
    if (!message.beam_file().empty()) fault("beam_file", "is for other models than the VLP-16 and Puck Hi-Res");
    if (!message.sensor_address().empty()) fault("sensor_address", "is for other models than the VLP-16 and Puck Hi-Res");
    return std::nullopt;
  }
  OtherLidar other{.model = static_cast<OtherModel>(message.model() - kFirstOtherModel)};
  const auto& row = RowOf(other.model);
  const auto name = std::string(row.name);
  ReadSensorAddress(message, row, fault, other);
  if (message.beam_file().empty()) {
    if (row.needs_beam_file && message.sensor_address().empty()) fault("beam_file", "must be set for " + name + ": " + std::string(row.beam_file_is));
  } else if (row.beam_file_is.empty()) {
    fault("beam_file", name + " has the angles of the maker's table: none is read");
  } else {
    try {
      const auto path = config_folder / message.beam_file();
      if (std::filesystem::file_size(path) > kMaxBeamTextBytes) throw std::runtime_error("is larger than 64 KiB: no such file of a maker is");
      other.beam_text = TextOf(path);
      other.beam_origin = message.beam_file();
      if (const auto reason = BeamFault(other.model, other.beam_text); !reason.empty()) throw std::runtime_error(reason);
    } catch (const std::exception& error) {
      fault("beam_file", message.beam_file() + ": " + error.what());
    }
  }
  const bool is_port_of_velodyne = message.data_port() == vlp16::format::kDataPort && row.usual_data_port != message.data_port();
  if (is_port_of_velodyne && !message.has_data_port()) {
    fault("data_port", "must be set for " + name + ": " + std::to_string(row.usual_data_port) + " as delivered");
  }
  return other;
}

Sources ToSources(const std::filesystem::path& config_folder, const config::Lidar& message) {
  Sources sources;
  sources.kind = ToChoice<Sources::Kind>(message.source());
  for (const auto& name : message.capture_file()) sources.capture_files.push_back(config_folder / name);
  sources.capture_speed = message.capture_speed();
  sources.bind_address = message.bind_address();
  sources.interface = message.interface();
  sources.multicast_group = message.multicast_group();
  for (const auto& text : message.allowed_source_address()) {
    const auto address = io::ParseIpAddress(text);
    sources.allowed_source_addresses.push_back(address ? io::ToText(*address) : text);
  }
  sources.bpf_filter = message.bpf_filter();
  sources.receive_buffer_bytes = message.receive_buffer_bytes();
  return sources;
}

}  // namespace

namespace {

// Faults of boat.txtpb are told by who needs it.
std::optional<Eigen::Matrix3d> MountingOf(const std::filesystem::path& config_folder, int number) {
  config::FaultList untold;
  const auto boat = untold.Take([&] { return config::LoadBoat(config_folder); });
  if (!boat) return std::nullopt;
  if (number == 1) return boat->T_vessel_lidar.linear();
  if (!boat->lidar_2) return std::nullopt;
  return TransformVesselSensor(*boat->lidar_2).linear();
}

}  // namespace

std::string BeamFault(OtherModel model, const std::string& text) {
  if (text.empty()) return "is empty";
  if (text.size() > kMaxBeamTextBytes) return "is larger than 64 KiB: no such file of a maker is";
  try {
    MakeReader(model, text);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

std::string ModelWord(const std::optional<OtherModel>& other) {
  return Schema::Model_Name(other ? static_cast<Schema::Model>(kFirstOtherModel + static_cast<int>(*other)) : Schema::MODEL_AUTO);
}

std::string ConfigFileName(int number) { return number == 1 ? "lidar.txtpb" : "lidar_2.txtpb"; }

bool HasSecond(const std::filesystem::path& config_folder) { return std::filesystem::exists(config_folder / ConfigFileName(2)); }

Params LoadParams(const std::filesystem::path& config_folder, int number) {
  std::vector<std::string> faults;
  auto params = LoadParams(config_folder, number, faults);
  if (!faults.empty()) throw config::ConfigError(faults);
  return params;
}

Params LoadParams(const std::filesystem::path& config_folder, int number, std::vector<std::string>& faults) {
  const auto file = config_folder / ConfigFileName(number);
  const auto message = config::Load<config::Lidar>(config_folder, ConfigFileName(number));
  CheckRelations(file, message, faults);

  Params params;
  params.number = number;
  params.input = message.source() == config::Lidar::LOG ? Input::kLog : Input::kOutside;
  params.data_port = message.data_port();
  params.position_port = message.position_port();
  params.other = ToOtherLidar(file, message, faults);
  if (!params.other) params.decoder.model = ToChoice<vlp16::ModelChoice>(message.model());
  params.decoder.time = ToChoice<TimeChoice>(message.time_source());
  params.decoder.cut_azimuth_rad = DegToRad(message.cut_azimuth_deg());
  params.decoder.use_vertical_origin_offsets = message.use_vertical_origin_offsets();
  params.sources = ToSources(config_folder, message);
  params.R_vessel_lidar = MountingOf(config_folder, number);
  return params;
}

}  // namespace lookout::lidar
