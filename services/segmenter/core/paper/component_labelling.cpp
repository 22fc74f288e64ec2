#include "services/segmenter/core/paper/component_labelling.hpp"

#include <limits>
#include <numeric>
#include <utility>

namespace lookout::segmenter {

namespace {

// Components of one more look, over returns that had none, are numbered on.
Groups Unite(Groups components, const Groups& more) {
  for (std::size_t i = 0; i < components.of_return.size(); ++i) {
    if (more.of_return[i] != Groups::kNone) components.of_return[i] = components.count + more.of_return[i];
  }
  components.count += more.count;
  return components;
}

}  // namespace

ShadowedReturns JoinShadowed(const RangeImage& image, std::span<const Return> returns, std::span<const std::int32_t> indices, Groups components,
                             const SearchParams& params) {
  const JoinRule rule(params);
  ShadowedReturns result{std::move(components), {}};
  for (const std::int32_t index : indices) {
    if (image.IsInImage(index)) continue;
    const Return& one = returns[static_cast<std::size_t>(index)];
    const int column = image.place_of[static_cast<std::size_t>(index)].column;
    std::int32_t nearest = RangeImage::kNone;
    double least_m2 = std::numeric_limits<double>::infinity();
    const auto consider = [&](int other_column, int other_ring) {
      const std::int32_t other = image.return_at[image.Pixel(other_column, other_ring)];
      if (other == RangeImage::kNone) return;
      const double distance_m2 = SquaredDistance(one.point, returns[static_cast<std::size_t>(other)].point);
      if (!rule.IsClose(distance_m2) || distance_m2 >= least_m2) return;
      least_m2 = distance_m2;
      nearest = other;
    };
    consider(column, one.ring);
    consider(image.PreviousColumn(column), one.ring);
    consider(image.NextColumn(column), one.ring);
    if (one.ring > 0) consider(column, one.ring - 1);
    if (one.ring + 1 < image.num_rings) consider(column, one.ring + 1);
    if (nearest == RangeImage::kNone) {
      result.remaining.push_back(index);
    } else {
      result.components.of_return[static_cast<std::size_t>(index)] = result.components.of_return[static_cast<std::size_t>(nearest)];
    }
  }
  return result;
}

Groups LabelComponents(const Scan& scan, std::span<const Return> returns, const LabellingParams& params) {
  if (params.image_columns == 0) return SearchComponents(ProjectToOwnColumns(scan, returns), returns, params.search);

  std::vector<std::int32_t> waiting(returns.size());
  std::iota(waiting.begin(), waiting.end(), 0);
  Groups components{std::vector<std::int32_t>(returns.size(), Groups::kNone), 0};
  for (int look = 0; look < kMaxLooks && !waiting.empty(); ++look) {
    const auto image = ProjectToAzimuths(scan, returns, waiting, params.image_columns);
    auto seen = SearchComponents(image, returns, params.search);
    if (!params.label_shadowed_returns) return seen;
    auto shadowed = JoinShadowed(image, returns, waiting, std::move(seen), params.search);
    components = Unite(std::move(components), shadowed.components);
    waiting = std::move(shadowed.remaining);
  }
  for (const std::int32_t index : waiting) components.of_return[static_cast<std::size_t>(index)] = components.count++;
  return components;
}

}  // namespace lookout::segmenter
