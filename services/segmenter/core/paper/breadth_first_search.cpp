#include "services/segmenter/core/paper/breadth_first_search.hpp"

namespace lookout::segmenter {

Groups SearchComponents(const RangeImage& image, std::span<const Return> returns, const SearchParams& params) {
  const JoinRule rule(params);
  const BeamStep same_beam;
  Groups components;
  components.of_return.assign(returns.size(), Groups::kNone);
  std::vector<std::int32_t> queue;
  queue.reserve(returns.size());
  for (std::size_t seed = 0; seed < returns.size(); ++seed) {
    if (components.of_return[seed] != Groups::kNone || !image.IsInImage(static_cast<std::int32_t>(seed))) continue;
    const std::int32_t component = components.count++;
    components.of_return[seed] = component;
    queue.clear();
    queue.push_back(static_cast<std::int32_t>(seed));
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const auto index = static_cast<std::size_t>(queue[head]);
      const Return& one = returns[index];
      const int column = image.place_of[index].column;
      const auto visit = [&](int other_column, int other_ring, const BeamStep& step) {
        const std::size_t pixel = image.Pixel(other_column, other_ring);
        for (std::size_t layer = 0; layer < static_cast<std::size_t>(image.num_layers); ++layer) {
          const std::int32_t other = image.return_at[pixel + layer];
          if (other == RangeImage::kNone || components.of_return[static_cast<std::size_t>(other)] != Groups::kNone) continue;
          if (!rule.Joins(one, returns[static_cast<std::size_t>(other)], step)) continue;
          components.of_return[static_cast<std::size_t>(other)] = component;
          queue.push_back(other);
        }
      };
      const int previous_column = image.PreviousColumn(column);
      const BeamStep& to_next = image.to_next_column[static_cast<std::size_t>(column)];
      const BeamStep& from_previous = image.to_next_column[static_cast<std::size_t>(previous_column)];
      if (to_next.is_neighbour) visit(image.NextColumn(column), one.ring, to_next);
      if (from_previous.is_neighbour) visit(previous_column, one.ring, from_previous);
      if (one.ring + 1 < image.num_rings) visit(column, one.ring + 1, image.to_higher_ring[static_cast<std::size_t>(one.ring)]);
      if (one.ring > 0) visit(column, one.ring - 1, image.to_higher_ring[static_cast<std::size_t>(one.ring) - 1]);
      if (image.num_layers > 1) visit(column, one.ring, same_beam);
    }
  }
  return components;
}

}  // namespace lookout::segmenter
