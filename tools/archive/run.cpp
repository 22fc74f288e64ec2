#include "tools/archive/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "tools/archive/engines.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/processes.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/results.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostTold = 20;
constexpr std::int64_t kMostBatches = 1000;  // Slurm's greatest array, unless its administrator says otherwise

// A unit that has no result yet.
struct Wanted {
  std::string key;
  std::string run;
  std::int64_t size_bytes = 0;  // of its recordings
};

// Units without a result, their lines already in batches.
struct Todo {
  std::vector<Wanted> units;
  std::int64_t size_bytes = 0;
  fs::path batches;  // folder of N.jsonl
  std::int64_t num_batches = 0;
  std::int64_t num_failed_before = 0;
  std::int64_t num_not_ready = 0;  // their recordings are gone, or were changed
};

std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text) quoted += letter == '\'' ? std::string("''") : std::string(1, letter);
  return quoted + "'";
}

std::string SelectText(const RunRequest& request) {
  std::string names;
  for (const auto& name : request.versions) names += (names.empty() ? "" : ", ") + Quoted(name);
  return "SELECT unit.key, unit.run, unit.from_us, unit.to_us, run.files, run.truth, run.kind, run.digest, run.truth_digest, run.size_bytes, "
         "version.config_digest, version.programs, version.programs_digest, version.program_version, version.tables "
         "FROM unit JOIN run ON run.name = unit.run JOIN version ON version.name = unit.version WHERE " +
         (names.empty() ? "1" : "unit.version IN (" + names + ")") + (request.only.empty() ? "" : " AND (" + request.only + "\n)") +
         " ORDER BY unit.version, unit.run, unit.part";
}

std::optional<std::int64_t> TimeOf(const Statement& row, int column) {
  if (row.IsNull(column)) return std::nullopt;
  return row.Int(column);
}

fs::path PathIn(const std::string& text) {
  const auto path = PathOfText(text);
  if (!path) throw std::runtime_error("index: a path that is none: " + Printable(text));
  return *path;
}

// A row of SelectText. nullopt: the recordings were scanned anew since, so that the key is of others.
std::optional<Unit> UnitOfRow(const Statement& row) {
  Unit unit;
  unit.key = row.Text(0);
  unit.run = row.Text(1);
  auto& recipe = unit.recipe;
  recipe.from_us = TimeOf(row, 2);
  recipe.to_us = TimeOf(row, 3);
  for (const auto& file : nlohmann::json::parse(row.Text(4))) {
    unit.inputs.push_back({PathIn(file.at(0).get<std::string>()), file.at(1).get<std::int64_t>(), file.at(2).get<std::int64_t>()});
  }
  unit.truth = PathIn(row.Text(5));
  recipe.run_kind = row.Text(6);
  recipe.run_digest = row.Text(7);
  recipe.truth_digest = row.Text(8);
  recipe.config_digest = row.Text(10);
  unit.programs = PathIn(row.Text(11));
  recipe.programs_digest = row.Text(12);
  recipe.program_version = row.Text(13);
  recipe.tables = nlohmann::json::parse(row.Text(14)).get<std::vector<std::string>>();
  if (!fs::exists(unit.programs / "lookout-eval")) recipe.truth_digest.clear();
  if (recipe.truth_digest.empty()) unit.truth.clear();
  if (KeyOf(recipe) != unit.key) return std::nullopt;
  return unit;
}

void CheckVersions(Database& index, const RunRequest& request) {
  auto find = index.Prepare("SELECT 1 FROM version WHERE name = ?1");
  for (const auto& name : request.versions) {
    find.Bind(1, name);
    if (!find.Step()) throw std::invalid_argument("no version " + Printable(name) + " is planned: lookout-archive plan --name " + Printable(name));
    find.Reset();
  }
}

// --only is SQL of the user. It can change nothing, as it stands within one SELECT; it is tried where nothing can be written.
void CheckCondition(const ArchiveFolder& archive, const RunRequest& request) {
  auto index = ReadIndex(archive);
  try {
    index.Prepare(SelectText(request)).Step();
  } catch (const std::runtime_error& error) {
    if (request.only.empty()) throw;
    throw std::invalid_argument("--only: " + Printable(error.what()));
  }
}

class TodoMaker {
 public:
  /// @param among  keys that a later round may take; nullptr: all
  TodoMaker(const ArchiveFolder& archive, const RunRequest& request, const std::set<std::string>* among, std::ostream& out)
      : archive_(archive), request_(request), among_(among), out_(out) {}

  Todo Make() {
    const io::FileLock lock(archive_.IndexLock(), io::FileLock::AtEnd::kStays, [this] {
      out_ << "another program changes the index: waiting\n" << std::flush;
    });
    auto index = OpenIndex(archive_);
    Todo todo;
    Transaction transaction(index);
    {
      auto rows = index.Prepare(SelectText(request_));
      std::set<std::string> keys;  // a recording that is there twice is one
      Results results(archive_, index);
      while (rows.Step()) {
        io::ThrowIfStopAsked();
        if (request_.limit > 0 && static_cast<std::int64_t>(todo.units.size()) >= request_.limit) break;
        Add(rows, results, keys, todo);
      }
    }
    transaction.Commit();
    if (todo.num_not_ready > kMostTold) out_ << todo.num_not_ready - kMostTold << " more units are not done for such a reason\n";
    WriteBatches(todo);
    return todo;
  }

 private:
  void Add(const Statement& row, Results& results, std::set<std::string>& keys, Todo& todo) {
    const auto key = row.Text(0);
    if (!keys.insert(key).second || (among_ != nullptr && !among_->contains(key))) return;
    const auto validity = results.Of(key);
    if (validity.is_valid && !validity.is_done) ++todo.num_failed_before;
    if (validity.is_valid && (validity.is_done || !request_.again_failed)) return;
    if (!validity.is_valid && !validity.reason.empty()) {
      out_ << row.Text(1) << ": its result does not hold, and is made again: " << PrintableLines(validity.reason) << '\n';
    }
    const auto unit = UnitOfRow(row);
    const auto fault = unit ? FaultOfInputs(*unit) : "was scanned anew since it was planned: plan again";
    if (!fault.empty()) {
      if (++todo.num_not_ready > kMostTold) return;  // a mount that is gone would fill the screen
      out_ << row.Text(1) << ": not done: " << PrintableLines(fault) << '\n';
      return;
    }
    if (validity.is_valid) RemoveResult(archive_, key);
    todo.units.push_back({key, unit->run, row.Int(9)});
    todo.size_bytes += row.Int(9);
    lines_.push_back(UnitLine(*unit));
  }

  static std::string FaultOfInputs(const Unit& unit) {
    for (const auto& input : unit.inputs) {
      const auto stamp = StampOf(input.path);
      if (!stamp) return "its recording cannot be found: " + input.path.string();
      if (stamp->size_bytes != input.size_bytes || stamp->modified_ns != input.modified_ns) return "its recording was changed: scan and plan again";
    }
    return "";
  }

  // In a folder that is called by what it holds: an engine that still works on an older list has that one.
  void WriteBatches(Todo& todo) {
    const auto num_units = static_cast<std::int64_t>(lines_.size());
    if (num_units == 0) return;
    const auto batch_units = request_.batch_units > 0 ? request_.batch_units : (num_units + kMostBatches - 1) / kMostBatches;
    std::string keys = std::to_string(batch_units) + "\n";
    for (const auto& unit : todo.units) keys += unit.key + "\n";
    constexpr std::size_t kNameLetters = 16;
    todo.batches = archive_.Work() / ("batches-" + DigestOfText(keys).substr(0, kNameLetters));
    fs::remove_all(todo.batches);
    fs::create_directories(todo.batches);
    for (std::int64_t begin = 0; begin < num_units; begin += batch_units) {
      io::OutputFile file(todo.batches / (std::to_string(todo.num_batches++) + ".jsonl"), {.force = true});
      for (auto i = begin; i < std::min(begin + batch_units, num_units); ++i) file.Write(lines_[static_cast<std::size_t>(i)] + "\n");
      file.Commit();
    }
  }

  const ArchiveFolder& archive_;
  const RunRequest& request_;
  const std::set<std::string>* among_;
  std::ostream& out_;
  std::vector<std::string> lines_;
};

// How far the units are, by their sidecars: whatever the engine believes.
class Watcher {
 public:
  Watcher(const ArchiveFolder& archive, const Todo& todo, std::FILE* progress)
      : archive_(archive),
        open_(todo.units),
        all_bytes_(std::max<std::int64_t>(1, todo.size_bytes)),
        num_units_(todo.units.size()),
        progress_("lookout-archive", progress) {}

  // Looks no more often than that a twentieth of the time goes to looking: a mount may be slow.
  void Look() {
    const auto now = Clock::now();
    if (now < next_) return;
    std::erase_if(open_, [this](const Wanted& unit) {
      if (!StampOf(archive_.Sidecar(unit.key))) return false;
      done_bytes_ += unit.size_bytes;
      return true;
    });
    constexpr int kTimesAsLong = 20;
    next_ = Clock::now() + std::max<Clock::duration>(std::chrono::seconds(1), kTimesAsLong * (Clock::now() - now));
    progress_.Update(static_cast<double>(done_bytes_) / static_cast<double>(all_bytes_), [this] {
      constexpr double kBytesPerMb = 1e6;
      const auto elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
      return fmt::format("{} of {} units, {:.1f} MB/s", num_units_ - open_.size(), num_units_,
                         static_cast<double>(done_bytes_) / kBytesPerMb / elapsed_s);
    });
  }
  void Clear() { progress_.Clear(); }

 private:
  using Clock = std::chrono::steady_clock;
  const ArchiveFolder& archive_;
  std::vector<Wanted> open_;
  std::int64_t done_bytes_ = 0;
  std::int64_t all_bytes_;
  std::size_t num_units_;
  runtime::Progress progress_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point next_ = begin_;
};

void RunLocally(const ArchiveFolder& archive, const RunRequest& request, const Todo& todo, Watcher& watcher) {
  Processes workers;
  std::int64_t next = 0;
  while (next < todo.num_batches || workers.num_running() > 0) {
    while (next < todo.num_batches && workers.num_running() < static_cast<std::size_t>(request.num_jobs)) {
      workers.Start({request.own_program.string(), "work", "--archive", archive.folder().string(), "--batch",
                     (todo.batches / (std::to_string(next++) + ".jsonl")).string()},
                    {});
    }
    io::ThrowIfStopAsked();
    workers.WaitForOne(std::chrono::milliseconds(500));
    watcher.Look();
  }
}

void RunByScript(const ArchiveFolder& archive, const RunRequest& request, const Todo& todo, Watcher& watcher) {
  Processes engine;
  engine.Start({"/bin/bash", "-c", EngineText(request.engine)}, {{"LOOKOUT_ARCHIVE", request.own_program.string()},
                                                                 {"LOOKOUT_FOLDER", archive.folder().string()},
                                                                 {"LOOKOUT_BATCHES", todo.batches.string()},
                                                                 {"LOOKOUT_LAST", std::to_string(todo.num_batches - 1)},
                                                                 {"LOOKOUT_JOBS", std::to_string(request.num_jobs)}});
  while (engine.num_running() > 0) {
    io::ThrowIfStopAsked();
    engine.WaitForOne(std::chrono::milliseconds(500));
    watcher.Look();
  }
}

// Units that still have no result; failed ones are told.
RunSummary Settle(const ArchiveFolder& archive, const Todo& todo, std::ostream& out) {
  const io::FileLock lock(archive.IndexLock());
  auto index = OpenIndex(archive);
  Results results(archive, index);
  Transaction transaction(index);
  RunSummary summary;
  for (const auto& unit : todo.units) {
    const auto validity = results.Of(unit.key);
    if (!validity.is_valid) {
      ++summary.num_not_done;
    } else if (validity.is_done) {
      ++summary.num_done;
    } else {
      ++summary.num_failed;
      out << unit.run << ": failed: " << PrintableLines(validity.reason) << '\n';
    }
  }
  transaction.Commit();
  return summary;
}

}  // namespace

std::string EngineText(const std::string& engine) {
  for (const auto& known : kEngineScripts) {
    if (known.name == engine) return std::string(known.script);
  }
  std::ifstream in(engine, std::ios::binary);
  if (!in || !fs::is_regular_file(engine)) throw std::invalid_argument("--engine: " + Printable(engine) + " is no engine, and no file with commands");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

RunSummary RunUnits(const ArchiveFolder& archive, const RunRequest& request, std::ostream& out) {
  if (request.engine != "local") EngineText(request.engine);
  CheckCondition(archive, request);
  {
    auto index = ReadIndex(archive);
    CheckVersions(index, request);
  }
  const io::FileLock lock(archive.RunLock(), io::FileLock::AtEnd::kStays, [&out] {
    out << "another run works on this archive: waiting\n" << std::flush;
  });
  RunSummary sum;
  std::set<std::string> keys;  // of the first round
  std::int64_t num_not_ready = 0;
  for (int round = 0; round <= request.num_retries; ++round) {
    auto again = request;
    again.again_failed = request.again_failed && round == 0;
    const auto todo = TodoMaker(archive, again, round == 0 ? nullptr : &keys, out).Make();
    num_not_ready += todo.num_not_ready;
    if (round == 0) {
      for (const auto& unit : todo.units) keys.insert(unit.key);
      sum.num_units = static_cast<std::int64_t>(todo.units.size());
      out << fmt::format("{} units to do, {} failed before\n", sum.num_units, todo.num_failed_before) << std::flush;
    } else if (!todo.units.empty()) {
      out << fmt::format("{} units were not finished: again\n", todo.units.size()) << std::flush;
    }
    sum.num_not_done = num_not_ready;
    if (todo.units.empty()) break;
    Watcher watcher(archive, todo, request.progress);
    if (request.engine == "local") {
      RunLocally(archive, request, todo, watcher);
    } else {
      RunByScript(archive, request, todo, watcher);
    }
    watcher.Clear();
    fs::remove_all(todo.batches);
    const auto settled = Settle(archive, todo, out);
    sum.num_done += settled.num_done;
    sum.num_failed += settled.num_failed;
    sum.num_not_done += settled.num_not_done;
    if (settled.num_not_done == 0) break;
  }
  out << fmt::format("{} done, {} failed, {} not done\n", sum.num_done, sum.num_failed, sum.num_not_done);
  return sum;
}

}  // namespace lookout::archive
