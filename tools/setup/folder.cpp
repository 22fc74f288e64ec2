#include "tools/setup/folder.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "common/config/boat.hpp"
#include "common/config/boat_sections.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "services/page/params.hpp"
#include "tools/doctor/machine.hpp"

namespace lookout::setup {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBoatFile = "boat.txtpb";
const fs::path kPackageFolder = "/etc/lookout/boat";  // of the units

// A folder beside nothing, for a boat that is not written yet.
class TrialFolder {
 public:
  TrialFolder() {
    std::string name = (fs::temp_directory_path() / "lookout-setup.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder to check the boat in: " + io::ErrnoText());
    path_ = name;
  }
  ~TrialFolder() {
    std::error_code unused;
    fs::remove_all(path_, unused);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Texts and other small files: what a config may name.
void CopyStaying(const fs::path& from, const fs::path& to, const std::vector<fs::path>& replaced) {
  std::error_code error;
  for (fs::directory_iterator entry(from, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unused;
    const bool is_replaced = std::ranges::find(replaced, entry->path()) != replaced.end();
    if (is_replaced || !entry->is_regular_file(unused) || entry->file_size(unused) > config::kMaxConfigBytes) continue;
    fs::copy_file(entry->path(), to / entry->path().filename(), unused);
  }
}

void CheckBoat(const fs::path& folder, const std::string& text) {
  const TrialFolder trial;
  CopyStaying(folder, trial.path(), ReplacedFiles(folder));
  io::OutputFile boat_file(trial.path() / kBoatFile);
  boat_file.Write(text);
  boat_file.Commit();
  config::FaultList faults;
  for (const auto& [file, lines] : doctor::ReadConfig(trial.path()).files) {
    // Lines begin with the path of a file: of the place that it will have.
    const auto trial_path = trial.path().string() + "/";
    for (const auto& line : lines) faults.Add(line.starts_with(trial_path) ? (folder / line.substr(trial_path.size())).string() : line);
  }
  faults.ThrowIfAny();
}

// Whole, or not at all.
void KeepCopy(const fs::path& file, const fs::path& kept) {
  if (fs::is_symlink(file)) return fs::copy_symlink(file, kept);
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error(Printable(file.string()) + ": cannot be read");
  io::OutputFile copy(kept);
  copy.Write(text.str());
  copy.Commit();
}

// FILE.old, FILE.old.2 ...: what stands there already is kept, too.
fs::path OldName(const fs::path& file) {
  auto name = file.native() + ".old";
  for (int number = 2; fs::exists(fs::symlink_status(name)); ++number) name = fmt::format("{}.old.{}", file.native(), number);
  return name;
}

}  // namespace

std::vector<fs::path> ReplacedFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto* name : {kBoatFile, "lidar.txtpb", "vlp16.txtpb", "navigator.txtpb", "page.txtpb", "tracker.txtpb"}) {
    if (fs::symlink_status(folder / name, error).type() != fs::file_type::not_found) files.push_back(folder / name);
  }
  return files;
}

void CheckPlace(const fs::path& folder, bool force) {
  if (fs::exists(folder) && !fs::is_directory(folder)) throw std::runtime_error(Printable(folder.string()) + " is no folder");
  const auto replaced = ReplacedFiles(folder);
  if (!replaced.empty() && !force) {
    throw std::runtime_error(Printable(replaced.front().string()) + " exists: --force keeps it as " +
                             Printable(OldName(replaced.front()).filename().string()) + " and writes a new boat");
  }
}

std::vector<fs::path> WriteBoat(const fs::path& folder, const std::string& text, bool force) {
  CheckPlace(folder, force);
  CheckBoat(folder, text);
  fs::create_directories(folder);
  io::OutputFile file(folder / kBoatFile, {.force = force});
  file.Write(text);
  file.Prepare();
  const auto replaced = ReplacedFiles(folder);
  std::vector<fs::path> kept;
  kept.reserve(replaced.size());
  for (const auto& old : replaced) kept.push_back(OldName(old));
  if (!replaced.empty() && replaced.front().filename() == kBoatFile) KeepCopy(replaced.front(), kept.front());
  // Sections of the new boat beside old files are refused by every process: a folder that was left in between starts nothing.
  file.Commit();
  for (std::size_t i = 0; i < replaced.size(); ++i) {
    if (replaced[i].filename() != kBoatFile) fs::rename(replaced[i], kept[i]);
  }
  return kept;
}

std::string DoubtsOf(const fs::path& folder) {
  std::string text;
  for (const auto& remark : config::RemarksOnBoat(config::LoadBoat(folder))) {
    if (!remark.cure.empty()) text += "warning: " + remark.words + "; " + remark.cure + "\n";
  }
  return text;
}

std::string NextSteps(const fs::path& folder) {
  const auto page = page::LoadParams(folder);
  const auto path = folder.string();
  std::string addresses = page::AddressOnThisComputer(page.bind_address, page.port);
  for (const auto& address : page::AddressesForOthers(page.bind_address, page.port)) addresses += ", " + address;
  std::error_code error;
  const bool is_package = fs::weakly_canonical(folder, error) == kPackageFolder;
  return fmt::format("next:  lookout-doctor --config {}\nthen:  {}\nthe look-out in a browser: {}\n", path,
                     is_package ? "systemctl enable --now lookout.target" : "lookout-up --config " + path, addresses);
}

}  // namespace lookout::setup
