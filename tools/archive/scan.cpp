#include "tools/archive/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/joining.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/recording.hpp"
#include "tools/archive/walk.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

struct KnownFile {
  FileStamp stamp;
  Recording recording;
};

// The files of the index, by the text of their path.
std::map<std::string, KnownFile> KnownFiles(Database& index) {
  std::map<std::string, KnownFile> known;
  auto rows = index.Prepare("SELECT path, size_bytes, modified_ns, changed_ns, inode, kind, state, reason, digest, facts FROM file");
  while (rows.Step()) {
    KnownFile file;
    file.stamp = {rows.Int(1), rows.Int(2), rows.Int(3), rows.Int(4)};
    file.recording.kind = rows.Text(5);
    file.recording.state = StateOfWord(rows.Text(6));
    file.recording.reason = rows.Text(7);
    file.recording.digest = rows.Text(8);
    TakeFacts(rows.Text(9), file.recording);
    known.emplace(rows.Text(0), std::move(file));
  }
  return known;
}

void Write(Statement& insert, const std::string& path, const KnownFile& file) {
  const auto& [stamp, recording] = file;
  insert.Bind(1, path).Bind(2, stamp.size_bytes).Bind(3, stamp.modified_ns).Bind(4, stamp.changed_ns).Bind(5, stamp.inode);
  insert.Bind(6, recording.kind).Bind(7, Word(recording.state)).Bind(8, recording.reason).Bind(9, recording.digest).Bind(10, FactsText(recording));
  insert.Run();
}

bool IsBelow(const std::string& path, const std::vector<fs::path>& folders) {
  return std::ranges::any_of(folders, [&path](const fs::path& folder) {
    auto prefix = PathText(fs::weakly_canonical(folder));
    if (!prefix.ends_with('/')) prefix += '/';
    return path.starts_with(prefix);
  });
}

// Nothing is known about paths that could not be read: the index keeps its rows for these paths and all below.
bool IsAtOrBelow(const std::string& path, const std::vector<fs::path>& unreadable) {
  return std::ranges::any_of(unreadable, [&path](const fs::path& one) {
    const auto text = PathText(one);
    return path == text || path.starts_with(text + '/');
  });
}

struct ScanCounts {
  std::int64_t num_read = 0;
  std::int64_t num_known = 0;
  std::int64_t num_gone = 0;
};

// Reads what is new or changed. Each transaction holds the files of a few seconds, so that a scan that is ended loses no more.
class Reader {
 public:
  Reader(Database& index, const Walk& walk, std::FILE* progress)
      : insert_(index.Prepare("INSERT OR REPLACE INTO file VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)")),
        index_(index),
        walk_(walk),
        progress_("lookout-archive", progress) {}

  ScanCounts Read(std::map<std::string, KnownFile>& known) {
    const auto all_bytes =
        std::max<std::int64_t>(1, std::accumulate(walk_.files.begin(), walk_.files.end(), std::int64_t{0},
                                                  [](std::int64_t sum, const FoundFile& file) { return sum + file.stamp.size_bytes; }));
    std::optional<Transaction> transaction;
    std::int64_t done_bytes = 0;
    std::int64_t unsaved_bytes = 0;
    ScanCounts counts;
    for (const auto& file : walk_.files) {
      io::ThrowIfStopAsked();
      const auto path = PathText(file.path);
      const auto place = known.find(path);
      done_bytes += file.stamp.size_bytes;
      if (place != known.end() && place->second.stamp == file.stamp) {
        ++counts.num_known;
        continue;
      }
      if (!transaction) transaction.emplace(index_);
      KnownFile read{file.stamp, LookAt(file.path)};
      Write(insert_, path, read);
      known.insert_or_assign(path, std::move(read));
      ++counts.num_read;
      unsaved_bytes += file.stamp.size_bytes + kBytesPerFile;
      if (unsaved_bytes > kMostUnsavedBytes) {
        transaction->Commit();
        transaction.reset();
        unsaved_bytes = 0;
      }
      progress_.Update(static_cast<double>(done_bytes) / static_cast<double>(all_bytes));
    }
    if (transaction) transaction->Commit();
    return counts;
  }

 private:
  static constexpr std::int64_t kMostUnsavedBytes = 1'000'000'000;  // of recordings: some seconds of reading
  static constexpr std::int64_t kBytesPerFile = 100'000;            // what a small file costs, as so many bytes

  Statement insert_;
  Database& index_;
  const Walk& walk_;
  runtime::Progress progress_;
};

// A folder that cannot be read now may be there again tomorrow: its files stay.
std::int64_t ForgetGone(Database& index, const Walk& walk, const std::vector<fs::path>& folders, std::map<std::string, KnownFile>& known) {
  std::set<std::string> there;
  for (const auto& file : walk.files) there.insert(PathText(file.path));
  std::vector<fs::path> unreadable;
  for (const auto& fault : walk.faults) unreadable.push_back(fault.first);
  auto remove = index.Prepare("DELETE FROM file WHERE path = ?1");
  return static_cast<std::int64_t>(std::erase_if(known, [&](const auto& entry) {
    const auto& [path, file] = entry;
    const bool is_there = file.recording.kind == "truth" ? StampOf(PathOfText(path).value_or("")).has_value() : there.contains(path);
    if (is_there || !IsBelow(path, folders) || IsAtOrBelow(path, unreadable)) return false;
    remove.Bind(1, path).Run();
    return true;
  }));
}

std::string DigestOfKnownTruth(const fs::path& folder, Database& index, std::map<std::string, KnownFile>& known) {
  return DigestOfTruth(folder, [&](const fs::path& file) {
    const auto stamp = StampOf(file).value_or(FileStamp());
    const auto path = PathText(file);
    auto place = known.find(path);
    if (place == known.end() || place->second.stamp != stamp) {
      KnownFile read{stamp, {}};
      read.recording.kind = "truth";
      read.recording.reason = "of a truth";
      read.recording.digest = DigestOfFile(file);
      auto insert = index.Prepare("INSERT OR REPLACE INTO file VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
      Write(insert, path, read);
      place = known.insert_or_assign(path, std::move(read)).first;
    }
    return place->second.recording.digest;
  });
}

class RunWriter {
 public:
  RunWriter(Database& index, std::map<std::string, KnownFile>& known)
      : insert_(index.Prepare("INSERT INTO run VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)")), index_(index), known_(known) {}

  void Write(const std::vector<ScannedFile>& files, const RunFiles& run, bool is_only_one) {
    const auto& first = files[run.front()];
    const auto truth = TruthOf(first.path, is_only_one);
    nlohmann::json paths = nlohmann::json::array();
    std::vector<std::int64_t> cuts;
    std::string digests;
    std::int64_t size_bytes = 0;
    std::optional<std::int64_t> end_us;
    for (const auto i : run) {
      const auto& [path, stamp, recording] = files[i];
      paths.push_back({PathText(path), stamp.size_bytes, stamp.modified_ns});
      cuts.insert(cuts.end(), recording.cuts_us.begin(), recording.cuts_us.end());
      digests += recording.digest + "\n";
      size_bytes += stamp.size_bytes;
      end_us = std::max(end_us, recording.end_us);
    }
    const bool can_be_cut = std::ranges::all_of(run, [&](std::size_t i) { return files[i].recording.can_be_cut; });
    if (!can_be_cut || !std::ranges::is_sorted(cuts)) cuts.clear();
    insert_.Bind(1, PathText(first.path)).Bind(2, SceneOf(first.path)).Bind(3, first.recording.kind);
    if (first.recording.start_us) insert_.Bind(4, *first.recording.start_us);
    if (end_us) insert_.Bind(5, *end_us);
    insert_.Bind(6, size_bytes).Bind(7, DigestOfText(digests)).Bind(8, paths.dump()).Bind(9, nlohmann::json(cuts).dump());
    insert_.Bind(10, PathText(truth)).Bind(11, truth.empty() ? "" : DigestOfKnownTruth(truth, index_, known_));
    insert_.Run();
  }

 private:
  Statement insert_;
  Database& index_;
  std::map<std::string, KnownFile>& known_;
};

void WriteRuns(Database& index, std::map<std::string, KnownFile>& known) {
  std::vector<ScannedFile> files;
  files.reserve(known.size());
  for (const auto& [path, file] : known) files.push_back({PathOfText(path).value_or(path), file.stamp, file.recording});
  const auto runs = JoinRuns(files);
  std::map<fs::path, int> runs_of_folder;
  for (const auto& run : runs) ++runs_of_folder[files[run.front()].path.parent_path()];
  index.Execute("DELETE FROM run");
  RunWriter writer(index, known);
  for (const auto& run : runs) writer.Write(files, run, runs_of_folder[files[run.front()].path.parent_path()] == 1);
}

// Files of one folder that have the same state and reason.
struct Unused {
  std::string state;
  std::string folder;
  std::string reason;
  std::vector<std::string> names;
};

// A folder may hold thousands of files that are no recordings: a line for each reason, which names the first ones. The index has them all. Recordings
// that are damaged, older or unreadable are each told.
void TellUnused(Database& index, std::ostream& out) {
  std::vector<Unused> groups;
  auto rows = index.Prepare("SELECT path, state, reason FROM file WHERE state != 'sound' AND kind != 'truth' ORDER BY path");
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> places;
  while (rows.Step()) {
    const auto path = rows.Text(0);
    const auto name_begin = path.rfind('/') + 1;
    const auto folder = path.substr(0, name_begin);
    const auto [place, is_new] = places.try_emplace({folder, rows.Text(1), rows.Text(2)}, groups.size());
    if (is_new) groups.push_back({rows.Text(1), folder, rows.Text(2), {}});
    groups[place->second].names.push_back(path.substr(name_begin));
  }
  constexpr std::size_t kMostLines = 3;
  for (const auto& group : groups) {
    if (group.state != Word(Recording::State::kForeign) || group.names.size() <= kMostLines) {
      for (const auto& name : group.names) out << fmt::format("{:<10} {}{}: {}\n", group.state, group.folder, name, group.reason);
    } else {
      out << fmt::format("{:<10} {} files of {} ({}, {}, ...): {}\n", group.state, group.names.size(), group.folder, group.names[0], group.names[1],
                         group.reason);
    }
  }
}

void Tell(Database& index, const Walk& walk, const ScanCounts& counts, std::ostream& out) {
  TellUnused(index, out);
  for (const auto& [folder, why] : walk.faults) out << fmt::format("{:<10} {}: {}\n", "unreadable", PathText(folder), PrintableLines(why));
  out << fmt::format("{} files: {} read, {} as before, {} gone\n", counts.num_read + counts.num_known, counts.num_read, counts.num_known,
                     counts.num_gone);
  constexpr double kBytesPerGb = 1e9;
  constexpr double kUsPerHour = 3.6e9;
  auto sum = index.Prepare("SELECT count(*), total(size_bytes), sum(kind = 'lcm-log'), total(end_us - start_us), sum(truth != '') FROM run");
  if (!sum.Step()) return;
  out << fmt::format("{} runs, {:.3f} GB, {} with truth; {} of them lcm-logs, of {:.2f} h\n", sum.Int(0), sum.Double(1) / kBytesPerGb, sum.Int(4),
                     sum.Int(2), sum.Double(3) / kUsPerHour);
}

}  // namespace

void Scan(const ArchiveFolder& archive, const ScanRequest& request, std::ostream& out) {
  fs::create_directories(archive.folder());
  const io::FileLock lock(archive.IndexLock(), io::FileLock::AtEnd::kStays, [&out] {
    out << "another program changes the index: waiting\n" << std::flush;
  });
  auto index = OpenIndex(archive);
  const auto walk = FilesBelow(request.folders, archive.folder());
  auto known = KnownFiles(index);
  auto counts = Reader(index, walk, request.progress).Read(known);
  Transaction transaction(index);
  std::vector<fs::path> folders;
  for (const auto& folder : request.folders) folders.push_back(fs::canonical(folder));
  counts.num_gone = ForgetGone(index, walk, folders, known);
  WriteRuns(index, known);
  transaction.Commit();
  Tell(index, walk, counts, out);
}

}  // namespace lookout::archive
