// What is seen in the guard zone and has no track: for how long it has been at its place.
#pragma once

#include <chrono>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

/// From scan to scan the nearest places are the same thing. Drops and strays are here now and there now; what stays is something.
class Newcomers {
 public:
  /// It goes by at most 10 m/s, and its outline changes by less than a metre.
  static constexpr double kFollowedM = 1.5;
  /// A boat in waves loses a low thing for some scans.
  static constexpr std::chrono::milliseconds kKeptFor{400};

  /// One scan.
  /// @return [places] seconds since something was seen there first
  std::vector<double> Update(Utime time, std::span<const DangerPlace> places);

 private:
  struct Known {
    DangerPlace place;
    Utime first;
    Utime seen;
  };
  std::vector<Known> known_;
};

}  // namespace lookout::tracker
