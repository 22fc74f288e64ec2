#include "tools/archive/index.hpp"

#include <stdexcept>

#include "common/core/printable.hpp"

namespace lookout::archive {

namespace {

constexpr const char* kSchema = R"sql(
CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
-- A file below the scanned folders. `facts`: what joins it to others, JSON; `path` as PathText writes it.
CREATE TABLE IF NOT EXISTS file(
  path TEXT PRIMARY KEY, size_bytes INTEGER NOT NULL, modified_ns INTEGER NOT NULL, changed_ns INTEGER NOT NULL, inode INTEGER NOT NULL,
  kind TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL, digest TEXT NOT NULL, facts TEXT NOT NULL) WITHOUT ROWID;
-- A run: files that belong together, in their order (JSON). `cuts`: times where it may be cut, JSON. `truth`: its folder, empty: none.
CREATE TABLE IF NOT EXISTS run(
  name TEXT PRIMARY KEY, scene TEXT NOT NULL, kind TEXT NOT NULL, start_us INTEGER, end_us INTEGER, size_bytes INTEGER NOT NULL,
  digest TEXT NOT NULL, files TEXT NOT NULL, cuts TEXT NOT NULL, truth TEXT NOT NULL, truth_digest TEXT NOT NULL) WITHOUT ROWID;
-- Config and programs, as planned under a name.
CREATE TABLE IF NOT EXISTS version(
  name TEXT PRIMARY KEY, config TEXT NOT NULL, config_digest TEXT NOT NULL, programs TEXT NOT NULL, programs_digest TEXT NOT NULL,
  program_version TEXT NOT NULL, tables TEXT NOT NULL) WITHOUT ROWID;
-- A run, or a part of it from `from_us` on and before `to_us` (NULL: its start, its end), under a version.
CREATE TABLE IF NOT EXISTS unit(
  version TEXT NOT NULL, run TEXT NOT NULL, part INTEGER NOT NULL, from_us INTEGER, to_us INTEGER, key TEXT NOT NULL,
  PRIMARY KEY(version, run, part)) WITHOUT ROWID;
-- Results that were compared with their sidecars, by what tells that a file has changed: they need not be read again. `outcome`: done or failed.
CREATE TABLE IF NOT EXISTS result(key TEXT PRIMARY KEY, stamp TEXT NOT NULL, outcome TEXT NOT NULL, reason TEXT NOT NULL) WITHOUT ROWID;
)sql";

void CheckFormat(Database& index, const ArchiveFolder& archive) {
  const auto format = index.Value("SELECT value FROM meta WHERE name = 'format'").value_or("none");
  if (format != std::to_string(kFormat)) {
    throw std::runtime_error(archive.Index().string() + ": an index of format " + Printable(format) + ", this version of Lookout reads format " +
                             std::to_string(kFormat) + ". Use the lookout-archive that wrote it, or another --archive folder");
  }
}

}  // namespace

Database OpenIndex(const ArchiveFolder& archive) {
  std::filesystem::create_directories(archive.folder());
  Database index(archive.Index(), Database::Mode::kWrite);
  index.Execute("PRAGMA journal_mode = TRUNCATE; PRAGMA synchronous = FULL; PRAGMA cache_size = -65536;");
  if (!index.Value("SELECT name FROM sqlite_master WHERE type = 'table' AND name = 'meta'")) {
    Transaction transaction(index);
    index.Execute(kSchema);
    index.Execute("INSERT OR IGNORE INTO meta VALUES('format', '" + std::to_string(kFormat) + "')");
    transaction.Commit();
  }
  CheckFormat(index, archive);
  return index;
}

Database ReadIndex(const ArchiveFolder& archive) {
  if (!std::filesystem::exists(archive.Index())) {
    throw std::runtime_error(archive.folder().string() + ": no archive here. lookout-archive scan makes one");
  }
  Database index(archive.Index(), Database::Mode::kRead);
  CheckFormat(index, archive);
  return index;
}

}  // namespace lookout::archive
