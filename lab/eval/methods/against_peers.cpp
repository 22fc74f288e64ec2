#include "lab/eval/methods/against_peers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lookout::eval {
namespace {

// A difference to 100 % that is not printed is no measure.
constexpr double kLeastError = 0.0005;

using FigureOf = std::function<double(const MethodResult&, Mean Score::*)>;

std::optional<BestPeer> FindBest(const Results& results, bool (*is_wanted)(const MethodResult&), double our_iou, const FigureOf& figure_of) {
  std::optional<BestPeer> best;
  for (const auto& method : results.methods) {
    if (!is_wanted(method)) continue;
    const double iou = figure_of(method, &Score::iou);
    if (!std::isfinite(iou) || (best && iou <= best->iou)) continue;
    best = {method.method, iou, figure_of(method, &Score::false_segments),
            1.0 - iou >= kLeastError ? (1.0 - our_iou) / (1.0 - iou) : std::numeric_limits<double>::quiet_NaN()};
  }
  return best;
}

}  // namespace

std::vector<AgainstPeers> CompareWithPeers(const Results& results, std::string_view name) {
  std::vector<AgainstPeers> rows;
  const auto ours = std::ranges::find_if(results.methods, [name](const MethodResult& method) {
    return method.method == name || method.method == std::string(name) + std::string(kAllSegments);
  });
  if (ours == results.methods.end()) return rows;
  const auto add = [&](const std::string& scene, const FigureOf& figure_of) {
    const double our_iou = figure_of(*ours, &Score::iou);
    const auto of_all = FindBest(results, IsPeer, our_iou, figure_of);
    if (!of_all || !std::isfinite(our_iou)) return;
    rows.push_back({scene, our_iou, figure_of(*ours, &Score::false_segments), FindBest(results, IsTunedPeer, our_iou, figure_of), *of_all});
  };
  for (const auto& scene : results.scenes) {
    add(scene, [&scene](const MethodResult& method, Mean Score::*figure) {
      const auto found = method.by_scene.find(scene);
      return found == method.by_scene.end() ? std::numeric_limits<double>::quiet_NaN() : (found->second.*figure).value();
    });
  }
  if (!rows.empty()) add("mean", [&results](const MethodResult& method, Mean Score::*figure) { return MeanOverScenes(results, method, figure); });
  return rows;
}

}  // namespace lookout::eval
