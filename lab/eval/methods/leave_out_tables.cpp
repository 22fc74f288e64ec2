#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "lab/eval/methods/against_peers.hpp"
#include "lab/eval/methods/leave_out.hpp"
#include "lab/eval/methods/result_tables.hpp"

namespace lookout::eval {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// NaN where it is not known.
double IouIn(const MethodResult& method, const std::string& scene) {
  const auto found = method.by_scene.find(scene);
  return found == method.by_scene.end() ? kUnknown : found->second.iou.value();
}

double LeastIou(const Results& results, const MethodResult& method) {
  double least = kUnknown;
  for (const auto& scene : results.scenes) least = std::fmin(least, IouIn(method, scene));
  return least;
}

bool IsLeftOut(const MethodResult& method) { return method.method.starts_with(kLeftOut); }

Table ByMethod(const Results& results) {
  Table::Row header{"method", "mean", "least"};
  header.insert(header.end(), results.scenes.begin(), results.scenes.end());
  Table table(header);
  for (const auto& method : results.methods) {
    Table::Row row{method.method, Percent(MeanOverScenes(results, method, &Score::iou)), Percent(LeastIou(results, method))};
    for (const auto& scene : results.scenes) row.push_back(Percent(IouIn(method, scene)));
    table.Add(std::move(row));
  }
  return table;
}

// Each scene, the mean, and the worst: the least mIoU, the greatest share of a peer's error.
Table AgainstBest(const Results& results) {
  Table table({"scene", "left_out_%", "left_out_false", "compiled_in_%", "best_tuned_peer", "peer_%", "our_error_of_its_error_%", "best_peer_of_all",
               "best_%", "our_error_of_best_error_%"});
  const auto rows = CompareWithPeers(results, kLeftOut);
  const auto compiled_in = CompareWithPeers(results);
  double least = kUnknown;
  double least_compiled_in = kUnknown;
  double greatest_of_tuned = kUnknown;
  double greatest_of_all = kUnknown;
  for (const auto& row : rows) {
    const auto same = std::ranges::find(compiled_in, row.scene, &AgainstPeers::scene);
    const double compiled_in_iou = same == compiled_in.end() ? kUnknown : same->our_iou;
    const auto tuned = row.tuned.value_or(BestPeer{"-", kUnknown, kUnknown, kUnknown});
    table.Add({row.scene, Percent(row.our_iou), Number(row.our_false, 2), Percent(compiled_in_iou), tuned.name, Percent(tuned.iou),
               Percent(tuned.error_share), row.of_all.name, Percent(row.of_all.iou), Percent(row.of_all.error_share)});
    if (row.scene == rows.back().scene) break;  // the mean is none of the scenes
    least = std::fmin(least, row.our_iou);
    least_compiled_in = std::fmin(least_compiled_in, compiled_in_iou);
    greatest_of_tuned = std::fmax(greatest_of_tuned, tuned.error_share);
    greatest_of_all = std::fmax(greatest_of_all, row.of_all.error_share);
  }
  if (!rows.empty()) {
    table.Add({"worst", Percent(least), "-", Percent(least_compiled_in), "-", "-", Percent(greatest_of_tuned), "-", "-", Percent(greatest_of_all)});
  }
  return table;
}

}  // namespace

std::vector<NamedTable> LeaveOutTablesOf(const Results& results) {
  if (std::ranges::none_of(results.methods, IsLeftOut)) return {};
  return {{"leave_out",
           "ours where its evidence was fitted without the scene, beside the best peer of each scene: mIoU and error (100 - mIoU) as a share, %",
           AgainstBest(results)},
          {"leave_out_by_method", "mIoU with the least of the scenes, %", ByMethod(results)}};
}

}  // namespace lookout::eval
