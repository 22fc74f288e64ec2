#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "services/georeferencer/params.hpp"
#include "services/recorder/params.hpp"
#include "services/segmenter/params.hpp"
#include "services/vlp16/sources.hpp"
#include "tools/doctor/machine.hpp"

namespace lookout::doctor {

namespace {

namespace fs = std::filesystem;

// Faults of one check, into the files that their lines name: a process may find that boat.txtpb is wrong.
void AddFaults(const std::string& file_name, const std::vector<std::string>& faults, std::map<std::string, std::vector<std::string>>& by_file) {
  for (const auto& fault : faults) {
    const auto path = fault.substr(0, fault.find(".txtpb:"));
    const auto name = path == fault ? file_name : fs::path(path).filename().string() + ".txtpb";
    auto& lines = by_file[name];
    if (std::ranges::find(lines, fault) == lines.end()) lines.push_back(fault);
  }
}

}  // namespace

ConfigSeen ReadConfig(const fs::path& config_folder) {
  ConfigSeen seen;
  std::map<std::string, std::vector<std::string>> faults;  // by file
  const auto collect = [&faults](const std::string& file_name, const auto& load) {
    faults[file_name];
    try {
      load();
    } catch (const config::ConfigError& error) {
      AddFaults(file_name, error.faults(), faults);
    }
  };
  const auto check = [&](const std::string& file_name, const auto& load) {
    // By itself first: a process whose boat.txtpb is wrong looks no further.
    collect(file_name, [&] { config::EffectiveTextOfFile(config_folder / file_name); });
    collect(file_name, load);
  };
  check("boat.txtpb", [&] { seen.boat = config::LoadBoat(config_folder); });
  check("vlp16.txtpb", [&] { seen.lidar = vlp16::LoadChecked(config_folder); });
  check("segmenter.txtpb", [&] { segmenter::LoadParams(config_folder); });
  check("navigator.txtpb", [&] { seen.navigation = navigator::LoadParams(config_folder); });
  check("georeferencer.txtpb", [&] { georeferencer::LoadParams(config_folder); });
  check("recorder.txtpb", [&] {
    const auto params = recorder::LoadParams(config_folder);
    seen.log_folder = params.log_folder;
    seen.log_reserve_bytes = params.reserve_bytes;
  });
  // RUN_INFO holds every file of the folder, so the recorder does not start where any is wrong.
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(config_folder, error)) {
    const auto name = entry.path().filename().string();
    if (entry.path().extension() == ".txtpb" && !faults.contains(name)) check(name, [] {});
  }
  for (auto& [name, lines] : faults) seen.files.push_back({name, lines});
  return seen;
}

}  // namespace lookout::doctor
