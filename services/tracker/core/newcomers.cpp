#include "services/tracker/core/newcomers.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace lookout::tracker {

std::vector<double> Newcomers::Update(Utime time, std::span<const DangerPlace> places) {
  std::erase_if(known_, [time](const Known& known) { return std::chrono::abs(time - known.seen) > kKeptFor; });
  struct Pair {
    double distance_m;
    std::size_t known;
    std::size_t place;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance_m = DistanceOf(known_[k].place, places[i]);
      if (distance_m <= kFollowedM) pairs.push_back({distance_m, k, i});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& pair) { return std::tuple(pair.distance_m, pair.known, pair.place); });
  std::vector<bool> is_used(known_.size(), false);
  std::vector<bool> is_taken(places.size(), false);
  std::vector<double> ages_s(places.size(), 0.0);
  for (const auto& pair : pairs) {
    if (is_used[pair.known] || is_taken[pair.place]) continue;
    is_used[pair.known] = is_taken[pair.place] = true;
    auto& known = known_[pair.known];
    known.place = places[pair.place];
    known.seen = time;
    ages_s[pair.place] = ToSeconds(time - known.first);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!is_taken[i]) known_.push_back({places[i], time, time});
  }
  return ages_s;
}

}  // namespace lookout::tracker
