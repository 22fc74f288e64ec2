#include "tools/archive/programs.hpp"

#include <array>
#include <stdexcept>

#include "common/core/printable.hpp"
#include "tools/archive/child.hpp"
#include "tools/archive/file_stamp.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

constexpr std::array kNeeded{"lookout-replay", "lookout-export", "lookout-log", "lookout-import"};
constexpr const char* kEval = "lookout-eval";  // of the laboratory: not everywhere

std::string VersionOf(const fs::path& replay) {
  const auto end = RunChild({replay.string(), "--version"}, "/");
  auto version = end.out.substr(0, end.out.find('\n'));
  constexpr std::string_view kName = "lookout-replay ";
  if (!end.IsFine() || !version.starts_with(kName)) throw std::runtime_error(replay.string() + ": tells no version: " + end.LastLine());
  return Printable(version.substr(kName.size()));
}

}  // namespace

fs::path OwnProgramFolder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

std::string DigestOfPrograms(const fs::path& folder) {
  std::string lines;
  for (const auto* name : kNeeded) lines += std::string(name) + " " + DigestOfFile(folder / name) + "\n";
  if (fs::exists(folder / kEval)) lines += std::string(kEval) + " " + DigestOfFile(folder / kEval) + "\n";
  return DigestOfText(lines);
}

std::vector<fs::path> FilesOfPrograms(const fs::path& folder) {
  std::vector<fs::path> files;
  files.reserve(kNeeded.size() + 1);
  for (const auto* name : kNeeded) files.push_back(folder / name);
  files.push_back(folder / kEval);
  return files;
}

std::string KnownPrograms::DigestOf(const fs::path& folder) {
  const auto files = FilesOfPrograms(folder);
  std::vector<std::optional<FileStamp>> stamps;
  stamps.reserve(files.size());
  for (const auto& file : files) stamps.push_back(StampOf(file));  // before they are read: a change meanwhile shows at the next look
  auto& known = known_[folder];
  if (known.digest.empty() || known.stamps != stamps) known = {stamps, DigestOfPrograms(folder)};
  return known.digest;
}

Programs ProgramsIn(const fs::path& folder) {
  if (folder.empty()) throw std::invalid_argument("--programs: needed here, since the folder of this program is not known (is /proc mounted?)");
  Programs programs;
  programs.folder = fs::canonical(folder);
  for (const auto* name : kNeeded) {
    if (!fs::exists(programs.folder / name)) throw std::runtime_error(programs.folder.string() + ": lacks " + name + ", which a unit needs");
  }
  programs.has_eval = fs::exists(programs.folder / kEval);
  programs.digest = DigestOfPrograms(programs.folder);
  programs.version = VersionOf(programs.folder / "lookout-replay");
  return programs;
}

const std::vector<UnitTable>& UnitTables() {
  static const std::vector<UnitTable> kTables{{"returns", "LIDAR_SCAN"}, {"segments", "SEGMENTS"}, {"obstacles", "OBSTACLES"},
                                              {"tracks", "TRACKS"},      {"alerts", "ALERTS"},     {"pose", "POSE"},
                                              {"clock", "LIDAR_CLOCK"},  {"fixes", "GNSS_FIX"},    {"attitude", "ATTITUDE"}};
  return kTables;
}

}  // namespace lookout::archive
