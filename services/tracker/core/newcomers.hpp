// Things in the guard zone without a track: for how long each has been at its place.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

/// From one scan to the next, the places nearest to each other are the same thing. Drops and strays change their places; a thing stays.
class Newcomers {
 public:
  /// Between two scans a thing moves by at most 1 m (10 m/s), and its outline changes by less than a metre.
  static constexpr double kFollowedM = 1.5;
  /// A boat in waves loses a low thing for some scans.
  static constexpr std::chrono::milliseconds kKeptFor{400};

  /// In a downpour the nearest places of a scan are followed; of known places those stay that were seen last, then the nearest.
  static constexpr std::size_t kMostPlaces = 200;
  static constexpr std::size_t kMostKnown = 400;

  /// One scan. Cost: at most kMostPlaces x kMostKnown distances, sorted.
  /// @return [places] seconds since the thing at that place was seen first; 0 of a place that is not followed
  std::vector<double> Update(Utime time, std::span<const DangerPlace> places);

  /// Places of scans, and known ones, that were dropped because there were too many.
  std::int64_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Known {
    DangerPlace place;
    Utime first;
    Utime seen;
  };
  void ForgetBeyondLimit();

  std::vector<Known> known_;
  std::int64_t num_over_limit_ = 0;
};

}  // namespace lookout::tracker
