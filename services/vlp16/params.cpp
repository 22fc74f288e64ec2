#include "services/vlp16/params.hpp"

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/network.hpp"
#include "config/schema/vlp16.pb.h"

namespace lookout::vlp16 {

namespace {

// The enumerators of the schema count from 1, in the order of ours.
template <typename Choice, typename Field>
Choice ToChoice(Field field) {
  return static_cast<Choice>(static_cast<int>(field) - 1);
}
using Schema = config::Vlp16;
static_assert(Schema::MODEL_AUTO == 1 && Schema::MODEL_VLP16 == 2 && Schema::MODEL_PUCK_HI_RES == 3);
static_assert(Schema::TIME_AUTO == 1 && Schema::TIME_SENSOR == 2 && Schema::TIME_HOST == 3);
static_assert(Schema::UDP == 1 && Schema::CAPTURE == 2 && Schema::LOG == 3 && Schema::INTERFACE == 4);

// What no field is wrong by itself in.
void CheckRelations(const std::filesystem::path& file, const config::Vlp16& message, std::vector<std::string>& faults) {
  const auto require = [&](bool is_fine, const char* field, const std::string& reason, int index = 0) {
    if (!is_fine) faults.push_back(config::FaultLine(file, field, reason, static_cast<std::size_t>(index)));
  };
  const bool are_ports_apart = message.data_port() != message.position_port();
  // The fault names the one that stands in the file.
  if (message.has_position_port() || !message.has_data_port()) {
    require(are_ports_apart, "position_port", "must differ from data_port, which is " + std::to_string(message.data_port()));
  } else {
    require(are_ports_apart, "data_port", "must differ from position_port, which is " + std::to_string(message.position_port()));
  }
  require(message.interface() != "any", "interface", "must be one interface: 'any' is none");
  switch (message.source()) {
    case config::Vlp16::UDP:
      require(!message.bind_address().empty(), "bind_address", "must be set when source is UDP");
      require(message.bpf_filter().empty(), "bpf_filter", "is for source INTERFACE; UDP takes allowed_source_address");
      break;
    case config::Vlp16::CAPTURE:
      require(message.capture_file_size() > 0, "capture_file", "must be set when source is CAPTURE");
      break;
    case config::Vlp16::INTERFACE:
      require(!message.interface().empty(), "interface", "must be set when source is INTERFACE");
      require(message.multicast_group().empty(), "multicast_group", "is for source UDP; INTERFACE joins no group");
      break;
    default:
      break;
  }
  for (int i = 0; i < message.capture_file_size(); ++i) require(!message.capture_file(i).empty(), "capture_file", "must not be empty", i);
}

Sources ToSources(const std::filesystem::path& config_folder, const config::Vlp16& message) {
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

Params LoadParams(const std::filesystem::path& config_folder) {
  std::vector<std::string> faults;
  auto params = LoadParams(config_folder, faults);
  if (!faults.empty()) throw config::ConfigError(faults);
  return params;
}

Params LoadParams(const std::filesystem::path& config_folder, std::vector<std::string>& faults) {
  const auto file = config_folder / "vlp16.txtpb";
  config::Vlp16 message;
  config::LoadText(file, message);
  CheckRelations(file, message, faults);

  Params params;
  params.input = message.source() == config::Vlp16::LOG ? Input::kLog : Input::kOutside;
  params.data_port = message.data_port();
  params.position_port = message.position_port();
  params.decoder.model = ToChoice<ModelChoice>(message.model());
  params.decoder.time = ToChoice<TimeChoice>(message.time_source());
  params.decoder.cut_azimuth_rad = DegToRad(message.cut_azimuth_deg());
  params.use_vertical_origin_offsets = message.use_vertical_origin_offsets();
  params.sources = ToSources(config_folder, message);
  return params;
}

}  // namespace lookout::vlp16
