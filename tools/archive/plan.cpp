#include "tools/archive/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/lidar.pb.h"
#include "config/schema/segmenter.pb.h"
#include "tools/archive/child.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/results.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::archive {

namespace {

namespace fs = std::filesystem;

struct Version {
  std::string name;
  fs::path config;
  std::string config_digest;
};

void CheckConfig(const fs::path& config, const Programs& programs) {
  const auto end = RunChild({(programs.folder / "lookout-replay").string(), "--config", fs::canonical(config).string(), "--check"}, "/");
  if (end.IsFine()) return;
  throw config::ConfigError({PrintableLines(config.string()) + ": lookout-replay --check refuses it: " + PrintableLines(end.error)});
}

// Faults of a text have been told by lookout-replay --check, maybe of another version: what this one does not know is passed over.
class NoErrors : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int /*line*/, int /*column*/, const std::string& /*message*/) override {}
  void AddWarning(int /*line*/, int /*column*/, const std::string& /*message*/) override {}
};

template <typename Message>
Message Glance(const fs::path& file) {
  Message message;
  if (!fs::exists(file) && !config::OldConfigFile(file)) return message;
  google::protobuf::TextFormat::Parser parser;
  NoErrors errors;
  parser.RecordErrorsTo(&errors);
  parser.AllowUnknownField(true);
  parser.AllowPartialMessage(true);
  parser.ParseFromString(config::ReadConfigFile(file), &message);
  return message;
}

// A file that lies elsewhere is neither in the copy nor in the digest.
void CheckNamedFiles(const fs::path& config) {
  const auto check = [&config](const char* file, const char* field, const fs::path& named) {
    if (!named.is_absolute() && std::ranges::find(named, fs::path("..")) == named.end()) return;
    throw config::ConfigError({PrintableLines((config / file).string()) + ": " + field + ": " + Printable(named.string()) +
                               " is outside of the config's folder: an archive keeps a copy of the folder, so put the file below it"});
  };
  const auto boat = Glance<config::Boat>(config / "boat.txtpb");
  check("boat.txtpb", "evidence", boat.segmenter().evidence());
  check("boat.txtpb", "beam_file", boat.lidar_input().beam_file());
  check("segmenter.txtpb", "evidence", Glance<config::Segmenter>(config / "segmenter.txtpb").evidence());
  for (const auto* file : {"lidar.txtpb", "lidar_2.txtpb"}) check(file, "beam_file", Glance<config::Lidar>(config / file).beam_file());
}

std::vector<Version> VersionsOf(const PlanRequest& request, const Programs& programs) {
  if (!request.names.empty() && request.names.size() != request.configs.size()) {
    throw std::invalid_argument("--name: as many as --config, or none");
  }
  std::vector<Version> versions;
  std::set<std::string> names;
  for (std::size_t i = 0; i < request.configs.size(); ++i) {
    const auto config = fs::canonical(request.configs[i]);
    CheckConfig(config, programs);
    CheckNamedFiles(config);
    const auto name = request.names.empty() ? PathText(config.filename()) : request.names[i];
    if (!names.insert(name).second) throw std::invalid_argument("two versions are called " + Printable(name) + ": give each a --name");
    versions.push_back({name, config, DigestOfConfig(config)});
  }
  return versions;
}

// A copy that workers use: the config may change while they work.
void KeepConfig(const ArchiveFolder& archive, const Version& version, const Programs& programs) {
  const auto place = archive.Config(version.config_digest);
  if (fs::exists(place) && DigestOfConfig(place) == version.config_digest) return;
  const fs::path partial = place.native() + ".partial";
  fs::remove_all(place);
  fs::remove_all(partial);
  fs::create_directories(partial);
  for (const auto& file : FilesOfConfig(version.config)) {
    fs::create_directories((partial / file).parent_path());
    fs::copy_file(version.config / file, partial / file);
  }
  if (DigestOfConfig(partial) != version.config_digest) throw std::runtime_error(version.config.string() + ": was changed meanwhile");
  CheckConfig(partial, programs);  // the copy is whole: the files that it names are in it
  fs::rename(partial, place);
  io::SyncName(place);
}

void WriteVersion(Database& index, const Version& version, const Programs& programs, const std::vector<std::string>& tables) {
  index.Prepare("DELETE FROM unit WHERE version = ?1").Bind(1, version.name).Run();
  auto insert = index.Prepare("INSERT OR REPLACE INTO version VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)");
  insert.Bind(1, version.name).Bind(2, PathText(version.config)).Bind(3, version.config_digest).Bind(4, PathText(programs.folder));
  insert.Bind(5, programs.digest).Bind(6, programs.version).Bind(7, nlohmann::json(tables).dump()).Run();
}

struct PlanCounts {
  std::int64_t num_units = 0;
  std::int64_t num_done = 0;
  std::int64_t num_failed = 0;
  std::int64_t num_invalid = 0;  // a result that does not hold
};

void Bind(Statement& statement, int index, const std::optional<std::int64_t>& time) {
  if (time) {
    statement.Bind(index, *time);
  } else {
    statement.BindNull(index);
  }
}

class UnitWriter {
 public:
  UnitWriter(const ArchiveFolder& archive, Database& index, const PlanRequest& request, const Programs& programs, std::ostream& out)
      : request_(request),
        programs_(programs),
        out_(out),
        results_(archive, index),
        insert_(index.Prepare("INSERT INTO unit VALUES(?1, ?2, ?3, ?4, ?5, ?6)")) {}

  /// A row of "name, kind, start_us, digest, cuts, truth_digest".
  void Write(Statement& run, const Version& version, PlanCounts& counts) {
    const auto cuts = nlohmann::json::parse(run.Text(4)).get<std::vector<std::int64_t>>();
    const auto parts = PartsOf(run.Int(2), cuts, request_.cut_minutes);
    Recipe recipe;
    recipe.run_kind = run.Text(1);
    recipe.run_digest = run.Text(3);
    if (programs_.has_eval) recipe.truth_digest = run.Text(5);
    recipe.config_digest = version.config_digest;
    recipe.programs_digest = programs_.digest;
    recipe.program_version = programs_.version;
    recipe.tables = request_.tables;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      io::ThrowIfStopAsked();
      recipe.from_us = parts[i].from_us;
      recipe.to_us = parts[i].to_us;
      const auto key = KeyOf(recipe);
      insert_.Bind(1, version.name).Bind(2, run.Text(0)).Bind(3, static_cast<std::int64_t>(i));
      Bind(insert_, 4, parts[i].from_us);
      Bind(insert_, 5, parts[i].to_us);
      insert_.Bind(6, key).Run();
      Count(results_.Of(key, request_.verifies), run.Text(0), counts);
    }
  }

 private:
  void Count(const Validity& validity, const std::string& run, PlanCounts& counts) {
    ++counts.num_units;
    if (validity.is_valid) {
      ++(validity.is_done ? counts.num_done : counts.num_failed);
    } else if (!validity.reason.empty()) {
      ++counts.num_invalid;
      out_ << run << ": its result does not hold, and is made again: " << PrintableLines(validity.reason) << '\n';
    }
  }

  const PlanRequest& request_;
  const Programs& programs_;
  std::ostream& out_;
  Results results_;
  Statement insert_;
};

}  // namespace

std::vector<Part> PartsOf(std::int64_t start_us, const std::vector<std::int64_t>& cuts_us, double cut_minutes) {
  constexpr double kUsPerMinute = 60e6;
  std::vector<Part> parts{{}};
  auto begin_us = start_us;
  for (const auto cut_us : cuts_us) {
    if (cut_minutes <= 0 || static_cast<double>(cut_us - begin_us) < cut_minutes * kUsPerMinute) continue;
    parts.back().to_us = cut_us;
    parts.push_back({cut_us, std::nullopt});
    begin_us = cut_us;
  }
  return parts;
}

void MakePlan(const ArchiveFolder& archive, const PlanRequest& request, std::ostream& out) {
  const auto programs = ProgramsIn(request.programs);
  const auto versions = VersionsOf(request, programs);
  ReadIndex(archive);  // throws where there is no index
  const io::FileLock lock(archive.IndexLock(), io::FileLock::AtEnd::kStays, [&out] {
    out << "another program changes the index: waiting\n" << std::flush;
  });
  auto index = OpenIndex(archive);
  for (const auto& version : versions) KeepConfig(archive, version, programs);
  if (!programs.has_eval) out << "no lookout-eval in " << PathText(programs.folder) << ": no run is compared with its truth\n";
  Transaction transaction(index);
  for (const auto& version : versions) {
    WriteVersion(index, version, programs, request.tables);
    UnitWriter writer(archive, index, request, programs, out);
    PlanCounts counts;
    auto runs = index.Prepare("SELECT name, kind, start_us, digest, cuts, truth_digest, scene FROM run ORDER BY name");
    while (runs.Step()) {
      if (request.scenes.empty() || std::ranges::find(request.scenes, runs.Text(6)) != request.scenes.end()) writer.Write(runs, version, counts);
    }
    if (counts.num_units == 0) out << "no run is there" << (request.scenes.empty() ? "" : " of these scenes") << '\n';
    out << fmt::format("{}: {} units, {} done, {} failed, {} to do\n", version.name, counts.num_units, counts.num_done, counts.num_failed,
                       counts.num_units - counts.num_done - counts.num_failed);
  }
  transaction.Commit();
}

}  // namespace lookout::archive
