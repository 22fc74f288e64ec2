// The sections of the report page. Each gives markup, or nothing where the results hold nothing for it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/eval/results.hpp"

namespace lookout::eval::page {

/// 0 to 100; NaN for a scene without such objects.
double IouPercent(const Score& score);
double WaterIouPercent(const Score& score);

/// A method's time per turn over all scenes, milliseconds.
struct Times {
  std::size_t num_scans = 0;
  double median_ms = 0.0;  // this and the others: NaN without turns
  double p99_ms = 0.0;     // nearest rank
  double mean_ms = 0.0;
  double sd_ms = 0.0;
};
Times TimesOf(const std::vector<double>& time_ms);
Times TimesOf(const MethodResult& method);

/// Stands in the names of methods that lack a step: "ours without component clustering".
inline constexpr std::string_view kWithout = " without ";

bool IsOurs(const MethodResult& method);  // its name begins with "ours", and no step is left out

std::string Summary(const Results& results);        // in words, and the winner of each scene
std::string Bars(const Results& results);           // mIoU of all methods, and of the best by scene
std::string AgainstPeers(const Results& results);   // our error as a share of the best peer's
std::string NearRecall(const Results& results);     // by scene and kind
std::string TableOne(const Results& results);       // mIoU and time, all methods and scenes
std::string WaterAndKinds(const Results& results);  // objects in the water alone, each kind, sure segments
std::string SegmentCounts(const Results& results);  // false segments, over- and under-segmentation
std::string TableTwo(const Results& results);       // projections
std::string TableThree(const Results& results);     // time per stage
std::string Ablation(const Results& results);       // methods named "X without Y" beside X
std::string Curves(const Results& results);         // tests of the paper, sweeps
std::string ByRange(const Results& results);        // IoU and recall by range
std::string WorstTurns(const Results& results);

}  // namespace lookout::eval::page
