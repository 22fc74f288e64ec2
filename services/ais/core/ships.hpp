// The table of ships: what AIS has said of each, by MMSI.
#pragma once

#include <Eigen/Core>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/geodesy.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/ais/core/message.hpp"

namespace lookout::ais {

struct Ship {
  std::int32_t mmsi = 0;
  Sender sender = Sender::kUnknown;
  bool is_virtual = false;
  std::string name;       // empty: not known
  std::string call_sign;  // empty: not known
  int ship_type = 0;      // 0: not known
  Dimensions dimensions;
  Utime heard;  // arrival of the ship's last message

  // The last position, with course, speed and heading as they were then. Absent: it has told none for long.
  struct Fix {
    PositionReport report;
    Utime arrival;
    Utime time;                  // of the measurement: by the UTC second of the report, else arrival less kUsualLatency
    bool is_time_known = false;  // by the UTC second
  };
  std::optional<Fix> fix;

  /// Where the position was put in by hand or its system does not work, it says nothing.
  bool has_usable_position() const;
};

/// A ship's place at a time, in a map frame.
struct PredictedShip {
  Eigen::Vector2d antenna_map_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d center_map_m = Eigen::Vector2d::Zero();  // of the hull; the antenna where the offset is not known
  Eigen::Matrix2d covariance_m2 =
      Eigen::Matrix2d::Zero();  // of the centre: error of the fix, of its time, of the way since, and of the antenna's offset
  double offset_m = 0.0;        // from antenna to centre
  Eigen::Vector2d velocity_map_mps = Eigen::Vector2d::Constant(kNan);  // NaN: not known
  double velocity_sd_mps = kNan;
  double bow_rad = kNan;  // direction of the bow from true north, clockwise: heading, else the course of a ship that moves; NaN: not known
  Eigen::Vector2d bow_map = Eigen::Vector2d::Constant(kNan);  // the same, along the axes of the map
  bool is_bow_measured = false;
  double age_s = 0.0;  // since the measurement
};

/// The position after the way since its report, at an unchanged velocity.
///
/// @param map  frame of the result
/// @return nullopt without a usable position
std::optional<PredictedShip> Predict(const Ship& ship, const LocalFrame& map, Utime time);

/// Age, latitude and longitude of the antenna at a time; for those who have no map.
GeodeticPlace PropagatedPlace(const Ship::Fix& fix, Utime time);

/// Depends on the messages and their times alone.
class Ships {
 public:
  /// Beyond, the ship that was heard least lately is forgotten, first of those without a place. A busy strait has some hundreds in reach.
  static constexpr std::size_t kMostShips = 2000;
  /// Delay of a report that does not tell its second.
  static constexpr std::chrono::milliseconds kUsualLatency{2000};

  /// @param own_mmsi  of the own transponder; 0: the one that VDO tells
  explicit Ships(std::int32_t own_mmsi) : configured_own_mmsi_(own_mmsi) {}

  /// @param is_own  from the own transponder (VDO): never a target
  void Add(const Message& message, bool is_own, Utime arrival);

  /// Forgets ships that have been silent for longer than their class may be, and positions that are as old.
  void AdvanceTo(Utime time);

  void Clear();

  const std::map<std::int32_t, Ship>& ships() const { return ships_; }
  /// 0: not known.
  std::int32_t own_mmsi() const { return configured_own_mmsi_ != 0 ? configured_own_mmsi_ : told_own_mmsi_; }
  std::vector<Counter> counters() const {
    std::vector<Counter> counters;
    counts_.AppendTo(counters);
    return counters;
  }

 private:
  // Positions that cannot be, where a ship was believed to be: three that agree with each other are believed.
  struct Doubted {
    Ship::Fix fix;
    int num_agreeing = 0;
  };

  void AddPosition(Ship& ship, const PositionReport& report, Utime arrival);
  bool IsBelieved(const Ship& ship, const Ship::Fix& fix);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"reports_taken", "reports_own", "reports_old", "reports_without_position", "reports_jumped", "ships_moved",
                                       "ships_silent", "positions_silent", "ships_over_limit"});

  std::int32_t configured_own_mmsi_;
  std::int32_t told_own_mmsi_ = 0;
  std::optional<Utime> own_heard_;      // by VDO
  std::map<std::int32_t, Ship> ships_;  // by MMSI: order decides nothing else
  std::map<std::int32_t, Doubted> doubted_;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::ais
