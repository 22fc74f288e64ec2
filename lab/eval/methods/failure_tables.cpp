#include <string>
#include <utility>

#include "lab/eval/methods/result_tables.hpp"

namespace lookout::eval {
namespace {

constexpr int kDecimalsOfProbability = 3;

// Shares of boats that are wanted at 0.2 % and less.
std::string FinePercent(double share) { return Percent(share, 2); }

Outcomes AllKinds(const Score& score) {
  Outcomes all;
  for (const auto& [kind, outcomes] : score.outcomes_by_kind) all.Add(outcomes);
  return all;
}

constexpr std::array kLosses{Outcome::kIntoLand, Outcome::kIntoThing, Outcome::kCut, Outcome::kWithClutter, Outcome::kMissed};

void AddOutcomeHeadings(Table::Row& header) {
  header.insert(header.end(), {"things", "lost_%"});
  for (const auto loss : kLosses) header.push_back(std::string(NameOf(loss)) + "_%");
}

void AddOutcomeCells(Table::Row& row, const Outcomes& outcomes) {
  row.insert(row.end(), {Number(outcomes.num_things()), FinePercent(outcomes.ShareLost())});
  for (const auto loss : kLosses) row.push_back(FinePercent(outcomes.Share(loss)));
}

void AddLandHeadings(Table::Row& header) {
  header.insert(header.end(), {"near_land", "near_land_found_%", "land_segments", "segments_of_land_object"});
}

void AddLandCells(Table::Row& row, const Score& score) {
  row.insert(row.end(), {Number(score.near_land_found.count), FinePercent(score.near_land_found.value()), Number(score.land_segments.value(), 2),
                         Number(score.segments_of_land_object.value(), 2)});
}

Table ThingsLost(const Results& results) {
  Table::Row header{"method"};
  AddOutcomeHeadings(header);
  AddLandHeadings(header);
  Table table(header);
  for (const auto& method : results.methods) {
    const auto total = Total(method);
    if (AllKinds(total).num_things() == 0 && total.land_segments.count == 0) continue;
    Table::Row row{method.method};
    AddOutcomeCells(row, AllKinds(total));
    AddLandCells(row, total);
    table.Add(std::move(row));
  }
  return table;
}

// A row for each method and scene.
Table OperatingPoints(const Results& results) {
  Table::Row header{"method", "scene", "false", "with_segment_%"};
  AddOutcomeHeadings(header);
  AddLandHeadings(header);
  Table table(header);
  ForEachScore(results, [&](const std::string& method, const std::string& scene, const Score& score) {
    Table::Row row{method, scene, Number(score.false_segments.value(), 3), FinePercent(score.with_segment.value())};
    AddOutcomeCells(row, AllKinds(score));
    AddLandCells(row, score);
    table.Add(std::move(row));
  });
  return table;
}

Table LossesByKind(const Results& results) {
  Table::Row header{"method", "scene", "kind"};
  AddOutcomeHeadings(header);
  Table table(header);
  ForEachScore(results, [&](const std::string& method, const std::string& scene, const Score& score) {
    for (const auto& [kind, outcomes] : score.outcomes_by_kind) {
      Table::Row row{method, scene, kind};
      AddOutcomeCells(row, outcomes);
      table.Add(std::move(row));
    }
  });
  return table;
}

void AddCurve(Table& table, const std::string& method, const std::string& scene, const Confidence& confidence) {
  for (const auto& point : OperatingPointsOf(confidence)) {
    table.Add({method, scene, Number(point.threshold, kDecimalsOfProbability), FinePercent(point.recall), Number(point.false_segments, 3)});
  }
}

Table ConfidenceCurve(const Results& results, bool is_by_scene) {
  Table table({"method", "scene", "threshold", "with_segment_%", "false"});
  if (is_by_scene) {
    ForEachScore(results,
                 [&](const std::string& method, const std::string& scene, const Score& score) { AddCurve(table, method, scene, score.confidence); });
  } else {
    for (const auto& method : results.methods) AddCurve(table, method.method, "all", Total(method).confidence);
  }
  return table;
}

Table Reliability(const Results& results) {
  Table table({"method", "scene", "bin", "segments", "stated", "observed"});
  for (const auto& method : results.methods) {
    double from = 0.0;
    const auto bins = ReliabilityOf(Total(method).confidence);
    for (const auto& bin : bins) {
      const double to = from + 1.0 / static_cast<double>(bins.size());
      table.Add({method.method, "all", Number(from, 1) + " to " + Number(to, 1), Number(bin.count), Number(bin.stated, kDecimalsOfProbability),
                 Number(bin.observed, kDecimalsOfProbability)});
      from = to;
    }
  }
  return table;
}

}  // namespace

std::vector<NamedTable> FailureTablesOf(const Results& results) {
  return {
      {"things_lost",
       "things of 5 returns or more with an IoU below 0.5, by what became of them, % of object-scans; of those in the water and within 3 m of land, "
       "share found, %; segments of land a scan, and for each object of land",
       ThingsLost(results)},
      {"operating_points", "", OperatingPoints(results), false},
      {"losses_by_kind", "", LossesByKind(results), false},
      {"confidence_curve", "segments below a stated probability left out: things with a segment, %, and false segments a scan",
       ConfidenceCurve(results, false)},
      {"confidence_by_scene", "", ConfidenceCurve(results, true), false},
      {"reliability", "stated probability of a segment to be of an object, and how many were", Reliability(results)}};
}

}  // namespace lookout::eval
