#include "common/runtime/run_info.hpp"

#include <algorithm>
#include <string_view>

#include "common/bus/schema.hpp"
#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/machine.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"

namespace lookout::runtime {

namespace {

constexpr std::string_view kBoatFile = "boat.txtpb";

std::vector<std::string> ConfigFiles(const std::filesystem::path& config_folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(config_folder)) {
    if (entry.path().extension() == ".txtpb") names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

run_info_t MakeRunInfo(const std::string& program, const std::filesystem::path& config_folder) {
  run_info_t message{};
  message.program = program;
  message.version = Version();
  message.host = HostName();
  message.schema = bus::SchemaDigest();
  config::FaultList faults;
  for (const auto& name : ConfigFiles(config_folder)) {
    faults.Try([&] { message.file_text.push_back(config::EffectiveTextOfFile(config_folder / name)); });
    message.file_name.push_back(name);
  }
  faults.ThrowIfAny();
  message.file_name.emplace_back(kMachineFile);
  message.file_text.push_back(MachineText());
  for (const auto& type : bus::TypeTexts()) {
    message.file_name.push_back(type.file_name);
    message.file_text.push_back(type.text);
  }
  message.num_files = static_cast<std::int32_t>(message.file_name.size());
  return message;
}

std::string EffectiveConfig(const std::filesystem::path& config_folder, const std::vector<std::string>& file_names) {
  std::string text;
  config::FaultList faults;
  for (const auto& name : file_names) {
    faults.Try([&] { text += "# " + name + "\n" + config::EffectiveTextOfFile(config_folder / name); });
    // Faults of more than one field are those of who uses the boat; here are words alone.
    config::FaultList untold;
    if (name == kBoatFile) untold.Try([&] { text += config::RemarksAsComments(config::LoadBoat(config_folder)); });
  }
  faults.ThrowIfAny();
  return text;
}

std::string EffectiveConfig(const std::filesystem::path& config_folder) { return EffectiveConfig(config_folder, ConfigFiles(config_folder)); }

}  // namespace lookout::runtime
