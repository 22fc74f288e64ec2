// The truth after a scan, in the map frame of the boat, by which alerts are judged.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "lab/eval/tracks/alert_scan.hpp"
#include "lab/eval/tracks/track_truth.hpp"

namespace lookout::eval {

class AlertTruth {
 public:
  /// @param truth       its outlines are read here, its returns are not
  /// @param own_hull_m  in the vessel frame, corners in the order of the own boat's outline in the truth (OwnHullOf)
  AlertTruth(const Truth& truth, const MapOrigin& origin, Polygon own_hull_m);

  /// Objects with an outline, by id, and the own boat; without alerts. Velocities and turn rates are means over the second around the time, so that a
  /// boat's roll is none. nullopt: the truth does not know the own boat then.
  /// @param num_returns  by object, of the scan
  std::optional<AlertScan> At(std::int64_t utime_us, const std::map<int, int>& num_returns) const;

 private:
  struct Known {
    AlertThing thing;  // of a standing thing complete, of all others without outline and motion
    bool is_moving = false;
  };
  MovingHull MotionOf(int id, std::int64_t utime_us) const;
  AlertOwnBoat OwnOf(const Polygon& outline_m, std::int64_t utime_us) const;
  void GroupLand();

  Polygon own_hull_m_;
  Outlines outlines_;
  std::map<int, Known> known_;
};

}  // namespace lookout::eval
