#include "tools/eval/against_peers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace lookout::eval {
namespace {

// What is not printed of 100 % is no measure.
constexpr double kLeastError = 0.0005;

std::optional<AgainstPeer> Compare(const Results& results, const MethodResult& ours, bool is_tuned_only, const std::string& scene,
                                   const std::function<double(const MethodResult&, Mean Score::*)>& figure_of) {
  AgainstPeer row{scene, figure_of(ours, &Score::iou), figure_of(ours, &Score::false_segments), "", -1.0, 0.0, 0.0};
  for (const auto& method : results.methods) {
    if (is_tuned_only ? !IsTunedPeer(method) : !IsPeer(method)) continue;
    const double iou = figure_of(method, &Score::iou);
    if (!(iou > row.peer_iou)) continue;
    row.peer = method.method;
    row.peer_iou = iou;
    row.peer_false = figure_of(method, &Score::false_segments);
  }
  if (row.peer.empty() || !std::isfinite(row.our_iou)) return std::nullopt;
  row.error_share = 1.0 - row.peer_iou >= kLeastError ? (1.0 - row.our_iou) / (1.0 - row.peer_iou) : std::numeric_limits<double>::quiet_NaN();
  return row;
}

}  // namespace

std::vector<AgainstPeer> CompareWithPeers(const Results& results, bool is_tuned_only) {
  std::vector<AgainstPeer> rows;
  const auto ours = std::ranges::find_if(
      results.methods, [](const MethodResult& method) { return method.method == "ours" || method.method == "ours" + std::string(kAllSegments); });
  if (ours == results.methods.end()) return rows;
  const auto add = [&](const std::string& scene, const std::function<double(const MethodResult&, Mean Score::*)>& figure_of) {
    if (auto row = Compare(results, *ours, is_tuned_only, scene, figure_of)) rows.push_back(std::move(*row));
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
