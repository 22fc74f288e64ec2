// Inputs of the judge of alerts: the truth after one scan, and its ALERTS. Map frame: east, north at one datum.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lab/eval/tracks/alert_geometry.hpp"

namespace lookout::eval {

/// The track of an alert.
struct AlertTrackPlace {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Polygon outline_m;                                       // empty: the position alone is known
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();  // as TRACKS have it: 0 of a standing track
  double existence_probability = 0.0;
};

/// One alert of one message, as much of it as is judged: ToJudgedAlert makes it.
struct JudgedAlert {
  std::int64_t id = 0;
  bool is_of_zone = false;  // at least one of these two
  bool is_of_approach = false;
  bool is_warning = false;               // else a caution
  bool holds = false;                    // active or acknowledged: not over
  bool is_open = false;                  // holds, and nobody has acknowledged it
  bool sounds = false;                   // the alert is the one that ALERTS let sound
  std::int64_t track_id = 0;             // 0 = of none: land, or a thing without a track
  std::optional<AlertTrackPlace> track;  // where TRACKS had it last; nullopt: they never did
  double distance_m = 0.0;               // told: from the own hull, of a zone from the reference point
  double bearing_rad = 0.0;              // told: from the bow clockwise
  std::string text;
};

/// A true object after a scan.
struct AlertThing {
  int id = 0;     // 1, 2, ...
  int group = 0;  // equal for pieces of land and structures that belong together; else the id
  std::string name;
  std::string kind;
  bool is_in_water = false;  // a boat, swimmer, buoy, marker; all else is land, or a structure
  std::shared_ptr<const HullOutline> outline_m;
  MovingHull motion;
  int num_returns = 0;  // in this scan
};

/// The own boat after a scan.
struct AlertOwnBoat {
  Polygon hull_m;
  Eigen::Vector2d reference_m = Eigen::Vector2d::Zero();  // reference point of the own boat
  double heading_rad = 0.0;                               // from north clockwise
  MovingHull motion;
};

struct AlertScan {
  std::int64_t utime_us = 0;  // end of the scan
  AlertOwnBoat own;
  std::vector<AlertThing> things;
  std::vector<JudgedAlert> alerts;
};

}  // namespace lookout::eval
