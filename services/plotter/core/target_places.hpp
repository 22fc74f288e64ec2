// Places of targets at a Signal K server, which keeps each context that it was ever told of for an hour: few contexts, used again.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// A target keeps its place as long as it lives. Time is host time passed.
class TargetPlaces {
 public:
  /// A place that was freed is given to no other target for so long: displays draw no way from the one to the other.
  static constexpr std::chrono::seconds kQuarantine{60};

  /// The target's place, or the first that is free: 1, 2 and on.
  int Of(std::int64_t target_id, std::chrono::microseconds now);

  /// Frees the places of all others.
  void Keep(std::span<const Target> targets, std::chrono::microseconds now);

  /// Places that were ever given.
  std::size_t num_places() const { return places_.size(); }

 private:
  struct Place {
    bool is_used = false;
    std::chrono::microseconds freed{0};
  };
  std::vector<Place> places_;
  std::map<std::int64_t, int> place_of_;
};

}  // namespace lookout::plotter
