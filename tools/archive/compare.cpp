#include "tools/archive/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "common/core/printable.hpp"
#include "common/io/file_lock.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/results.hpp"

namespace lookout::archive {

namespace {

VersionFacts FactsOf(Database& index, const std::string& name) {
  auto find = index.Prepare("SELECT name, config, config_digest, program_version, programs_digest, programs FROM version WHERE name = ?1");
  find.Bind(1, name);
  if (!find.Step()) throw std::invalid_argument("no version " + Printable(name) + " is planned: lookout-archive plan --name " + Printable(name));
  return {find.Text(0), find.Text(1), find.Text(2), find.Text(3), find.Text(4), find.Text(5)};
}

// Reads a file of usage/, which no digest protects: wrong values count as not known.
void TakeUsage(const std::filesystem::path& file, Standing& standing) {
  std::ifstream in(file, std::ios::binary);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  if (!json.is_object()) return;
  const auto take = [&json](const char* name, std::optional<double>& value) {
    const auto place = json.find(name);
    if (place != json.end() && place->is_number()) value = place->get<double>();
  };
  take("replay_s", standing.replay_s);
  take("cpu_s", standing.cpu_s);
  take("peak_bytes", standing.peak_bytes);
}

Standing StandingOf(const ArchiveFolder& archive, Results& results, const std::string& key) {
  Standing standing;
  standing.key = key;
  const auto validity = results.Of(key);
  if (!validity.is_valid) return standing;
  standing.state = validity.is_done ? Standing::State::kDone : Standing::State::kFailed;
  standing.reason = validity.reason;
  TakeUsage(archive.Usage(key), standing);
  return standing;
}

std::vector<std::string> OnlyIn(Database& index, const std::string& name, const std::string& other) {
  auto rows = index.Prepare(
      "SELECT DISTINCT run FROM unit AS one WHERE version = ?1 AND NOT EXISTS (SELECT 1 FROM unit WHERE version = ?2 AND run = one.run AND part = "
      "one.part AND from_us IS one.from_us AND to_us IS one.to_us) ORDER BY run");
  rows.Bind(1, name).Bind(2, other);
  std::vector<std::string> runs;
  while (rows.Step()) runs.push_back(rows.Text(0));
  return runs;
}

std::vector<ComparedUnit> UnitsOf(const ArchiveFolder& archive, Database& index, const CompareRequest& request) {
  auto rows = index.Prepare(
      "SELECT a.run, run.scene, a.part, a.from_us, a.to_us, run.files, a.key, b.key, run.kind FROM unit AS a JOIN unit AS b ON b.run = a.run AND "
      "b.part = "
      "a.part "
      "AND b.from_us IS a.from_us AND b.to_us IS a.to_us LEFT JOIN run ON run.name = a.run WHERE a.version = ?1 AND b.version = ?2 "
      "ORDER BY a.run, a.part");
  rows.Bind(1, request.a).Bind(2, request.b);
  Results results(archive, index);
  std::vector<ComparedUnit> units;
  while (rows.Step()) {
    io::ThrowIfStopAsked();
    ComparedUnit unit;
    unit.run = rows.Text(0);
    unit.scene = rows.Text(1);
    unit.part = rows.Int(2);
    if (!rows.IsNull(3)) unit.from_us = rows.Int(3);
    if (!rows.IsNull(4)) unit.to_us = rows.Int(4);
    if (!rows.IsNull(5)) {
      for (const auto& file : nlohmann::json::parse(rows.Text(5))) unit.files.push_back(file.at(0).get<std::string>());
    }
    unit.kind = rows.Text(8);
    unit.a = StandingOf(archive, results, rows.Text(6));
    unit.b = StandingOf(archive, results, rows.Text(7));
    if (unit.AreBothDone()) unit.comparison = CompareUnit(archive.Result(unit.a.key), archive.Result(unit.b.key));
    units.push_back(std::move(unit));
  }
  return units;
}

double Truth(const std::map<std::string, double>& figures, const char* name) {
  const auto place = figures.find(name);
  return place == figures.end() ? std::numeric_limits<double>::quiet_NaN() : place->second;
}

// Figures against the truth that are compared, and what lookout-eval calls them.
constexpr std::array<std::pair<const char*, const char*>, 8> kTruthFigures{{{"miou", "miou"},
                                                                            {"recall", "recall"},
                                                                            {"false_segments_per_scan", "false_segments_per_scan"},
                                                                            {"sure_false_segments_per_scan", "sure_false_segments_per_scan"},
                                                                            {"position_outside_95_m", "position_outside_95_m"},
                                                                            {"mota", "tracks_identities.MOTA_%"},
                                                                            {"idf1", "tracks_identities.IDF1_%"},
                                                                            {"false_tracks_h", "tracks_identities.false_tracks_h"}}};

// Whether one of them is known under one version and not under the other.
bool IsTruthMissing(const std::map<std::string, double>& here, const std::map<std::string, double>& there) {
  return std::ranges::any_of(kTruthFigures, [&](const auto& row) { return there.contains(row.second) && !here.contains(row.second); });
}

void AddPair(Figures& figures, const std::string& name, std::optional<double> a, std::optional<double> b) {
  figures[name + "_a"] = a;
  figures[name + "_b"] = b;
  figures[name + "_drop"] = a && b ? std::optional(*a - *b) : std::nullopt;
  figures[name + "_rise"] = a && b ? std::optional(*b - *a) : std::nullopt;
}

// A figure of lookout-eval: mean over the scans of units that have it under both versions.
void AddTruth(Figures& figures, const std::string& name, const char* of_eval, const std::vector<ComparedUnit>& units) {
  double sum_a = 0;
  double sum_b = 0;
  double weight = 0;
  for (const auto& unit : units) {
    const auto& [a, b] = std::pair(unit.comparison.truth_a, unit.comparison.truth_b);
    const auto value_a = a.find(of_eval);
    const auto value_b = b.find(of_eval);
    const auto scans = a.find("scans");
    if (value_a == a.end() || value_b == b.end() || scans == a.end()) continue;
    sum_a += scans->second * value_a->second;
    sum_b += scans->second * value_b->second;
    weight += scans->second;
  }
  AddPair(figures, name, weight > 0 ? std::optional(sum_a / weight) : std::nullopt, weight > 0 ? std::optional(sum_b / weight) : std::nullopt);
}

using BalanceOf = std::optional<Balance> UnitComparison::*;

void AddBalance(Figures& figures, const std::string& name, BalanceOf member, const std::vector<ComparedUnit>& units) {
  std::optional<Balance> sum;
  for (const auto& unit : units) {
    const auto& one = unit.comparison.*member;
    if (!one) continue;
    if (!sum) sum.emplace();
    sum->num_a += one->num_a;
    sum->num_b += one->num_b;
    sum->num_lost += one->num_lost;
    sum->num_gained += one->num_gained;
  }
  const auto number = [&sum](std::int64_t Balance::*which) -> std::optional<double> {
    if (!sum) return std::nullopt;
    return static_cast<double>((*sum).*which);
  };
  AddPair(figures, name, number(&Balance::num_a), number(&Balance::num_b));
  figures[name + "_lost"] = number(&Balance::num_lost);
  figures[name + "_gained"] = number(&Balance::num_gained);
}

void AddUsage(Figures& figures, const std::string& name, std::optional<double> Standing::*member, bool is_sum, double unit_of,
              const std::vector<ComparedUnit>& units) {
  std::optional<double> of_a;
  std::optional<double> of_b;
  for (const auto& unit : units) {
    const auto& a = unit.a.*member;
    const auto& b = unit.b.*member;
    if (!unit.AreBothDone() || !a || !b) continue;
    of_a = is_sum ? of_a.value_or(0) + *a / unit_of : std::max(of_a.value_or(0), *a / unit_of);
    of_b = is_sum ? of_b.value_or(0) + *b / unit_of : std::max(of_b.value_or(0), *b / unit_of);
  }
  AddPair(figures, name, of_a, of_b);
}

void PrintWorst(const Comparison& comparison, std::ostream& out) {
  constexpr std::size_t kMost = 20;
  std::size_t num_shown = 0;
  for (const auto& unit : comparison.units) {
    if (unit.Badness() <= 0 || num_shown == kMost) break;
    if (num_shown++ == 0) out << "\nworst first\n";
    out << fmt::format("{:8.1f}  {}{}", unit.Badness(), unit.run, unit.part > 0 ? fmt::format(" part {}", unit.part) : "");
    if (unit.comparison.tracks) out << fmt::format(", tracks -{} +{}", unit.comparison.tracks->num_lost, unit.comparison.tracks->num_gained);
    if (unit.comparison.alerts) out << fmt::format(", alerts -{} +{}", unit.comparison.alerts->num_lost, unit.comparison.alerts->num_gained);
    if (unit.IsTruthMissingUnderB()) out << ", figures against the truth are missing under B";
    if (unit.b.state == Standing::State::kFailed) out << ", failed: " << PrintableLines(unit.b.reason);
    if (!unit.comparison.differences.empty()) out << ", first on " << unit.comparison.differences.front().channel;
    out << '\n';
  }
}

}  // namespace

bool ComparedUnit::IsTruthMissingUnderA() const { return IsTruthMissing(comparison.truth_a, comparison.truth_b); }
bool ComparedUnit::IsTruthMissingUnderB() const { return IsTruthMissing(comparison.truth_b, comparison.truth_a); }

double ComparedUnit::Badness() const {
  constexpr double kNotDone = 1000;
  constexpr double kPerPoint = 10;
  constexpr double kPerAlert = 2;
  constexpr double kPerObstacle = 0.1;  // per scan with a lost or gained obstacle: a second of scans adds 1
  double badness = a.state == Standing::State::kDone && b.state != Standing::State::kDone ? kNotDone : 0;
  if (IsTruthMissingUnderB()) badness += kNotDone;
  const double drop = Truth(comparison.truth_a, "miou") - Truth(comparison.truth_b, "miou");
  if (drop > 0) badness += kPerPoint * drop;  // false where one of the two is not known
  if (const auto& tracks = comparison.tracks) badness += static_cast<double>(tracks->num_lost + tracks->num_gained);
  if (const auto& alerts = comparison.alerts) badness += kPerAlert * static_cast<double>(alerts->num_lost + alerts->num_gained);
  if (const auto& obstacles = comparison.obstacles) badness += kPerObstacle * static_cast<double>(obstacles->num_lost + obstacles->num_gained);
  return badness;
}

Figures FiguresOf(const std::vector<ComparedUnit>& units) {
  const auto count = [&units](const std::function<bool(const ComparedUnit&)>& is_meant) {
    return static_cast<double>(std::ranges::count_if(units, is_meant));
  };
  using State = Standing::State;
  Figures figures;
  figures["units"] = static_cast<double>(units.size());
  figures["units_equal"] = count([](const ComparedUnit& unit) { return unit.AreBothDone() && unit.comparison.differences.empty(); });
  figures["units_different"] = count([](const ComparedUnit& unit) { return unit.AreBothDone() && !unit.comparison.differences.empty(); });
  figures["newly_failed"] = count([](const ComparedUnit& unit) { return unit.a.state == State::kDone && unit.b.state == State::kFailed; });
  AddPair(figures, "failed", count([](const ComparedUnit& unit) { return unit.a.state == State::kFailed; }),
          count([](const ComparedUnit& unit) { return unit.b.state == State::kFailed; }));
  AddPair(figures, "not_done", count([](const ComparedUnit& unit) { return unit.a.state == State::kNotDone; }),
          count([](const ComparedUnit& unit) { return unit.b.state == State::kNotDone; }));
  AddBalance(figures, "tracks", &UnitComparison::tracks, units);
  AddBalance(figures, "obstacles", &UnitComparison::obstacles, units);
  AddBalance(figures, "alerts", &UnitComparison::alerts, units);
  AddPair(figures, "truth_missing", count([](const ComparedUnit& unit) { return unit.IsTruthMissingUnderA(); }),
          count([](const ComparedUnit& unit) { return unit.IsTruthMissingUnderB(); }));
  for (const auto& [name, of_eval] : kTruthFigures) AddTruth(figures, name, of_eval, units);
  constexpr double kBytesPerMb = 1e6;
  AddUsage(figures, "replay_s", &Standing::replay_s, true, 1, units);
  AddUsage(figures, "cpu_s", &Standing::cpu_s, true, 1, units);
  AddUsage(figures, "peak_mb", &Standing::peak_bytes, false, kBytesPerMb, units);
  return figures;
}

bool Compare(const ArchiveFolder& archive, const CompareRequest& request, std::ostream& out) {
  std::vector<Condition> conditions;
  conditions.reserve(request.fail_if.size());
  for (const auto& text : request.fail_if) conditions.push_back(ParseCondition(text));
  ReadIndex(archive);  // throws where there is no index
  Comparison comparison;
  {
    const io::FileLock lock(archive.IndexLock(), io::FileLock::AtEnd::kStays, [&out] {
      out << "another program changes the index: waiting\n" << std::flush;
    });
    auto index = OpenIndex(archive);
    Transaction transaction(index);
    comparison.a = FactsOf(index, request.a);
    comparison.b = FactsOf(index, request.b);
    comparison.units = UnitsOf(archive, index, request);
    comparison.only_a = OnlyIn(index, request.a, request.b);
    comparison.only_b = OnlyIn(index, request.b, request.a);
    transaction.Commit();
  }
  std::ranges::stable_sort(comparison.units, std::greater(), [](const ComparedUnit& unit) { return unit.Badness(); });
  comparison.figures = FiguresOf(comparison.units);
  for (const auto& condition : conditions) Holds(condition, comparison.figures);  // throws for wrong conditions before files are written
  if (!request.csv.empty()) WriteCsv(comparison, request.csv, request.force);
  if (!request.html.empty()) WritePage(archive, comparison, request);
  for (const auto& [name, value] : comparison.figures) out << fmt::format("{:<34} {}\n", name, value ? fmt::format("{:.4g}", *value) : "-");
  if (!comparison.only_a.empty()) out << comparison.only_a.size() << " runs are planned for " << request.a << " alone\n";
  if (!comparison.only_b.empty()) out << comparison.only_b.size() << " runs are planned for " << request.b << " alone\n";
  PrintWorst(comparison, out);
  bool is_fine = true;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (!Holds(conditions[i], comparison.figures)) continue;
    out << fmt::format("fails: {} ({:.6g})\n", request.fail_if[i], *comparison.figures.at(conditions[i].figure));
    is_fine = false;
  }
  return is_fine;
}

}  // namespace lookout::archive
