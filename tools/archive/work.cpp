#include "tools/archive/work.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/process.hpp"
#include "tools/archive/child.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/sidecar.hpp"
#include "tools/archive/walk.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

// The unit cannot be done now: reason.
class NotNow : public std::runtime_error {
 public:
  NotNow(UnitEnd end, const std::string& reason) : std::runtime_error(reason), end_(end) {}
  UnitEnd end() const { return end_; }

 private:
  UnitEnd end_;
};

// A program refused what it was given, and always will.
class Refused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void WriteText(const fs::path& file, const std::string& text) {
  io::OutputFile output(file, {.force = true, .tell = [](const std::string&) {}});
  output.Write(text);
  output.Commit();
}

class UnitWork {
 public:
  UnitWork(const ArchiveFolder& archive, const Unit& unit, KnownPrograms& programs)
      : archive_(archive), unit_(unit), programs_(programs), folder_(archive.Work(unit.key)) {}

  // @return the sidecar; the outputs lie in folder_/out
  Sidecar Do() {
    Sidecar sidecar;
    sidecar.recipe = unit_.recipe;
    Prepare();
    try {
      Replay();
      Export(sidecar.remarks);
      Evaluate(sidecar.remarks);
      sidecar.is_done = true;
    } catch (const Refused& refused) {
      sidecar.reason = refused.what();
      fs::remove_all(folder_ / "out");
      fs::create_directory(folder_ / "out");
    }
    CheckInputs();  // throws where the inputs that were read are not those of the plan
    if (StampsOfOthers() != others_) throw NotNow(UnitEnd::kNotBegun, "its truth or the programs were changed meanwhile: scan and plan again");
    for (const auto& file : io::FilesIn(folder_ / "out")) {
      const auto stamp = StampOf(file);
      sidecar.files[file.filename().string()] = {stamp ? stamp->size_bytes : 0, DigestOfFile(file)};
    }
    return sidecar;
  }

  double programs_s() const { return programs_s_; }
  std::string UsageText(bool is_done, double wall_s) const {
    nlohmann::json json{{"wall_s", wall_s},      {"programs_s", programs_s_},   {"cpu_s", cpu_s_}, {"peak_bytes", peak_bytes_},
                        {"replay_s", replay_s_}, {"host", runtime::HostName()}, {"run", unit_.run}};
    if (!is_done) json["last_lines"] = PrintableLines(last_error_);
    return json.dump(1) + "\n";
  }

 private:
  void CheckInputs() const {
    for (const auto& input : unit_.inputs) {
      const auto stamp = StampOf(input.path);
      if (!stamp) throw NotNow(UnitEnd::kNotBegun, "its recording cannot be found: " + PrintableLines(input.path.string()));
      if (stamp->size_bytes != input.size_bytes || stamp->modified_ns != input.modified_ns) {
        throw NotNow(UnitEnd::kNotBegun, "its recording was changed since it was scanned: scan and plan again");
      }
    }
    if (DigestOfConfig(archive_.Config(unit_.recipe.config_digest)) != unit_.recipe.config_digest) {
      throw NotNow(UnitEnd::kNotBegun, "the archive's copy of the config was changed: plan again");
    }
  }

  using Stamps = std::vector<std::optional<FileStamp>>;
  // Stamps of the truth and the programs. Reading their bytes takes as long as the work, so the bytes are read only once, before the work.
  Stamps StampsOfOthers() const {
    auto files = FilesOfPrograms(unit_.programs);
    if (!unit_.truth.empty()) std::ranges::move(FilesOfTruth(unit_.truth), std::back_inserter(files));
    Stamps stamps;
    stamps.reserve(files.size());
    for (const auto& file : files) stamps.push_back(StampOf(file));
    return stamps;
  }

  void CheckOthers() {
    others_ = StampsOfOthers();
    if (programs_.DigestOf(unit_.programs) != unit_.recipe.programs_digest) {
      throw NotNow(UnitEnd::kNotBegun, "the programs in " + PathText(unit_.programs) + " are others than those of the plan");
    }
    if (unit_.truth.empty()) return;
    if (DigestOfTruth(unit_.truth, DigestOfFile) != unit_.recipe.truth_digest) {
      throw NotNow(UnitEnd::kNotBegun, "its truth was changed since it was scanned: scan and plan again");
    }
  }

  // Links of short names, so that messages and results name no place of this computer.
  void Prepare() {
    CheckInputs();
    CheckOthers();
    fs::create_directories(folder_ / "out");
    fs::create_directory_symlink(fs::absolute(archive_.Config(unit_.recipe.config_digest)), folder_ / "config");
    for (std::size_t i = 0; i < unit_.inputs.size(); ++i) {
      inputs_.push_back("recording-" + std::to_string(i));
      fs::create_symlink(unit_.inputs[i].path, folder_ / inputs_.back());
    }
    if (!unit_.truth.empty()) fs::create_directory_symlink(unit_.truth, folder_ / "truth");
  }

  // @throws NotNow; Refused for a program that crashed
  ChildEnd Run(const std::string& program, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), (unit_.programs / program).string());
    auto end = RunChild(arguments, folder_);
    programs_s_ += end.wall_s;
    cpu_s_ += end.cpu_s;
    peak_bytes_ = std::max(peak_bytes_, end.peak_bytes);
    if (!end.IsFine()) last_error_ = end.error;
    if (end.WasKilled()) throw NotNow(UnitEnd::kNotFinished, program + " was killed by signal " + std::to_string(end.signal));
    if (const auto signal = end.StoppedBy(); !signal.empty()) throw NotNow(UnitEnd::kNotFinished, program + " was stopped by " + signal);
    if (const auto fault = end.IsFine() ? "" : end.FaultOfComputer(); !fault.empty()) throw NotNow(UnitEnd::kNotFinished, program + ": " + fault);
    if (end.signal != 0) throw Refused(program + " ended by signal " + std::to_string(end.signal));
    return end;
  }

  // @throws Refused for another exit code than 0 and `also_fine`
  ChildEnd MustRun(const std::string& program, std::vector<std::string> arguments, int also_fine = 0) {
    auto end = Run(program, std::move(arguments));
    if (end.exit_code != 0 && end.exit_code != also_fine) throw Refused(program + ": " + end.LastLine());
    return end;
  }

  static void AddInputs(std::vector<std::string>& arguments, const std::vector<std::string>& inputs) {
    for (const auto& input : inputs) arguments.insert(arguments.end(), {"--in", input});
  }

  bool HoldsChannel(const fs::path& log, std::string_view channel) const {
    bus::LogReader reader(log, io::ThrowIfStopAsked);
    while (const auto event = reader.NextView([](std::string_view) { return false; })) {
      if (event->channel == channel) return true;
    }
    return false;
  }

  void Replay() {
    std::vector<std::string> arguments{"--config", "config", "--out", "replayed", "--hashes", "out/messages.csv"};
    if (unit_.recipe.run_kind == "bag") {
      constexpr int kDamaged = 3;  // the log is written all the same
      std::vector<std::string> import{"--config", "config", "--out", "imported"};
      AddInputs(import, inputs_);
      MustRun("lookout-import", import, kDamaged);
      inputs_ = {"imported"};
      if (!HoldsChannel(folder_ / "imported", bus::kLidarPackets.name)) arguments.insert(arguments.end(), {"--from", "LIDAR_SCAN"});
    } else if (unit_.recipe.from_us || unit_.recipe.to_us) {
      std::vector<std::string> slice{"slice", "--out", "part"};
      AddInputs(slice, inputs_);
      if (unit_.recipe.from_us) slice.insert(slice.end(), {"--from", std::to_string(*unit_.recipe.from_us)});
      if (unit_.recipe.to_us) slice.insert(slice.end(), {"--to", std::to_string(*unit_.recipe.to_us)});
      for (const auto& channel : bus::kChannels) {
        if (channel.is_raw || channel.name == bus::kAlerts.name) slice.insert(slice.end(), {"--channel", std::string(channel.name)});
      }
      MustRun("lookout-log", slice);
      inputs_ = {"part"};
    }
    AddInputs(arguments, inputs_);
    const auto end = MustRun("lookout-replay", arguments);
    replay_s_ = end.wall_s;
    WriteChannels(end.out);
  }

  // Writes channels.csv from lookout-replay's output: a line per channel with name, count and digest.
  void WriteChannels(const std::string& text) {
    std::string csv = "channel,count,sha256\n";
    std::istringstream lines(text);
    std::string channel;
    std::string digest;
    std::int64_t count = 0;
    while (lines >> channel >> count >> digest) {
      counts_[channel] = count;
      csv += fmt::format("{},{},{}\n", channel, count, digest);
    }
    WriteText(folder_ / "out/channels.csv", csv);
  }

  std::int64_t CountOf(const std::string& channel) const {
    const auto entry = counts_.find(channel);
    return entry == counts_.end() ? 0 : entry->second;
  }

  void Export(std::vector<std::string>& remarks) {
    for (const auto& table : unit_.recipe.tables) {
      const auto row = std::ranges::find_if(UnitTables(), [&table](const UnitTable& one) { return table == one.name; });
      if (row == UnitTables().end()) throw Refused("a table that no unit has: " + table);
      if (CountOf(row->channel) == 0) {
        remarks.push_back(table + ": no " + row->channel);
        continue;
      }
      MustRun("lookout-export", {"--in", "replayed", "--table", table, "--out", "out/" + table + ".csv"});
    }
    const std::string drawn = CountOf("TRACKS") > 0 ? "tracks" : "pose";
    const auto end = Run("lookout-export", {"--in", "replayed", "--table", drawn, "--format", "svg", "--out", "out/picture.svg"});
    if (!end.IsFine()) remarks.push_back("picture: " + end.LastLine());
  }

  void Evaluate(std::vector<std::string>& remarks) {
    if (unit_.recipe.truth_digest.empty()) return;
    const auto end = Run("lookout-eval", {"--in", "replayed", "--truth", "truth", "--figures", "out/truth.csv"});
    if (!end.IsFine()) remarks.push_back("truth: " + end.LastLine());
  }

  const ArchiveFolder& archive_;
  const Unit& unit_;
  KnownPrograms& programs_;
  Stamps others_;
  fs::path folder_;
  std::vector<std::string> inputs_;
  std::map<std::string, std::int64_t> counts_;
  std::string last_error_;
  double programs_s_ = 0;
  double replay_s_ = 0;
  double cpu_s_ = 0;
  std::int64_t peak_bytes_ = 0;
};

// Results first, so that a sidecar is never there before them.
void PutInPlace(const ArchiveFolder& archive, const Unit& unit, const Sidecar& sidecar) {
  const auto place = archive.Result(unit.key);
  fs::create_directories(place.parent_path());
  RemoveResult(archive, unit.key);
  io::SyncName(archive.Work(unit.key) / "out/channels.csv");  // brings the names of all outputs to the disk, as they are in one folder
  fs::rename(archive.Work(unit.key) / "out", place);
  io::SyncName(place);
  WriteText(archive.Sidecar(unit.key), SidecarText(sidecar));
}

}  // namespace

UnitOutcome WorkOn(const ArchiveFolder& archive, const Unit& unit, KnownPrograms& programs) {
  const auto begin = std::chrono::steady_clock::now();
  fs::create_directories(archive.Work());
  const io::FileLock lock(archive.WorkLock(unit.key), io::FileLock::AtEnd::kIsRemoved);
  if (Verify(archive, unit.key).is_valid) return {UnitEnd::kAlready, ""};
  fs::remove_all(archive.Work(unit.key));  // remains of a worker that was killed
  try {
    UnitWork work(archive, unit, programs);
    const auto sidecar = work.Do();
    fs::create_directories(archive.Usage(unit.key).parent_path());
    PutInPlace(archive, unit, sidecar);
    const auto wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    WriteText(archive.Usage(unit.key), work.UsageText(sidecar.is_done, wall_s));
    fs::remove_all(archive.Work(unit.key));
    return {sidecar.is_done ? UnitEnd::kDone : UnitEnd::kFailed, sidecar.reason};
  } catch (const NotNow& fault) {
    std::error_code error;
    fs::remove_all(archive.Work(unit.key), error);  // a full disk needs the room
    return {fault.end(), fault.what()};
  } catch (...) {
    std::error_code error;
    fs::remove_all(archive.Work(unit.key), error);
    throw;
  }
}

bool WorkOnBatch(const ArchiveFolder& archive, const fs::path& batch, std::ostream& out) {
  std::ifstream in(batch, std::ios::binary);
  if (!in) throw std::runtime_error(batch.string() + ": cannot be read: " + io::ErrnoText());
  KnownPrograms programs;
  bool is_all = true;
  for (std::string line; std::getline(in, line);) {
    io::ThrowIfStopAsked();
    std::string run = "a unit";  // until the run's name is known
    UnitOutcome outcome;
    try {
      const auto unit = UnitOfLine(line);
      run = unit.run;
      outcome = WorkOn(archive, unit, programs);
    } catch (const io::Stopped&) {
      throw;
    } catch (const std::exception& error) {  // of this unit alone
      outcome = {UnitEnd::kNotFinished, error.what()};
    }
    if (outcome.end == UnitEnd::kNotBegun || outcome.end == UnitEnd::kNotFinished) {
      out << run << ": not done: " << PrintableLines(outcome.reason) << std::endl;
      is_all = false;
    }
  }
  return is_all;
}

}  // namespace lookout::archive
