#include "services/tracker/core/newcomers.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace lookout::tracker {

namespace {

// Indices, in their order.
std::vector<std::size_t> NearestPlaces(std::span<const DangerPlace> places, std::size_t most) {
  std::vector<std::size_t> indices(places.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  if (indices.size() <= most) return indices;
  std::ranges::stable_sort(indices, {}, [&places](std::size_t index) { return places[index].range_m; });
  indices.resize(most);
  std::ranges::sort(indices);
  return indices;
}

}  // namespace

std::vector<double> Newcomers::Update(Utime time, std::span<const DangerPlace> places) {
  std::erase_if(known_, [time](const Known& known) { return std::chrono::abs(time - known.seen) > kKeptFor; });
  const auto followed = NearestPlaces(places, kMostPlaces);
  num_over_limit_ += static_cast<std::int64_t>(places.size() - followed.size());
  struct Pair {
    double distance_m;
    std::size_t known;
    std::size_t place;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    for (const auto i : followed) {
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
  for (const auto i : followed) {
    if (!is_taken[i]) known_.push_back({places[i], time, time});
  }
  ForgetBeyondLimit();
  return ages_s;
}

void Newcomers::ForgetBeyondLimit() {
  if (known_.size() <= kMostKnown) return;
  num_over_limit_ += static_cast<std::int64_t>(known_.size() - kMostKnown);
  std::ranges::stable_sort(known_, [](const Known& one, const Known& other) {
    return one.seen != other.seen ? one.seen > other.seen : one.place.range_m < other.place.range_m;
  });
  known_.resize(kMostKnown);
}

}  // namespace lookout::tracker
