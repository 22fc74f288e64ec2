// lookout-archive compare: two versions over all runs.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/archive/archive_folder.hpp"
#include "tools/archive/comparison.hpp"
#include "tools/archive/fail_if.hpp"

namespace lookout::archive {

struct CompareRequest {
  std::string a;  // versions
  std::string b;
  std::filesystem::path csv;   // empty: none
  std::filesystem::path html;  // empty: none
  std::vector<std::string> fail_if;
  int num_worst = 20;  // with pictures on the page
  bool force = false;
};

/// How a unit stands under a version.
struct Standing {
  enum class State { kDone, kFailed, kNotDone };
  State state = State::kNotDone;
  std::string key;
  std::string reason;  // why the unit failed
  std::optional<double> replay_s;
  std::optional<double> cpu_s;
  std::optional<double> peak_bytes;
};

/// A run, or a part of one.
struct ComparedUnit {
  std::string run;
  std::string scene;
  std::string kind;  // of the recording
  std::int64_t part = 0;
  std::optional<std::int64_t> from_us;
  std::optional<std::int64_t> to_us;
  std::vector<std::string> files;  // of the recording, as PathText
  Standing a;
  Standing b;
  UnitComparison comparison;  // where the unit is done under both versions

  bool AreBothDone() const { return a.state == Standing::State::kDone && b.state == Standing::State::kDone; }
  /// Whether a figure against the truth is known under the other version alone.
  bool IsTruthMissingUnderA() const;
  bool IsTruthMissingUnderB() const;
  /// Greater is worse. 1000 for a unit that is not done any more, and for figures against the truth that B lacks and A has; 10 for each point of mIoU
  /// lost, 2 for an alert lost or gained, 1 for a track lost or gained.
  double Badness() const;
};

struct VersionFacts {
  std::string name;
  std::string config;  // folder
  std::string config_digest;
  std::string program_version;
  std::string programs_digest;
  std::string programs;  // folder, as PathText
};

struct Comparison {
  VersionFacts a;
  VersionFacts b;
  std::vector<ComparedUnit> units;  // worst first
  std::vector<std::string> only_a;  // runs of units that the other version does not have
  std::vector<std::string> only_b;
  Figures figures;
};

/// Sums and means over all units, by name; figures that exist under two versions as NAME_a and NAME_b, with NAME_drop (a - b) and NAME_rise (b - a).
Figures FiguresOf(const std::vector<ComparedUnit>& units);

/// A row per unit. @throws as io::OutputFile
void WriteCsv(const Comparison& comparison, const std::filesystem::path& file, bool force);

/// One page that needs no other file. Pictures come from the results.
/// @throws as io::OutputFile
void WritePage(const ArchiveFolder& archive, const Comparison& comparison, const CompareRequest& request);

/// @param out  figures, channels that differ, and the worst units
/// @return whether no condition of --fail-if holds
/// @throws std::invalid_argument for a version or condition that is none; std::runtime_error
bool Compare(const ArchiveFolder& archive, const CompareRequest& request, std::ostream& out);

}  // namespace lookout::archive
