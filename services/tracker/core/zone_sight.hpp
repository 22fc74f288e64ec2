// The part of the guard zone that nobody looks into: no beam comes there, the segmenter takes nothing there, or the own boat hides it.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/core/guard_sector.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/danger.hpp"
#include "services/tracker/core/scan.hpp"

namespace lookout::tracker {

/// Why nobody looks there. The first five follow from the config alone.
enum class Unseen : std::uint8_t {
  kNo,             // somebody looks
  kHeight,         // no beam passes between the water and kPostM above it
  kNearerThanMin,  // than min_range_m of the segmenter
  kBeyondMax,      // max_range_m of the segmenter
  kFieldOfView,    // outside of that of the segmenter
  kOwnBox,         // inside own_vessel, and farther than 1 m from the hull
  kNoBeams,        // the lidar does not fire there
  kHidden,         // each beam ends on the own boat, or on something nearer than min_range_m
};

struct UnseenPart {
  Unseen why = Unseen::kNo;
  Sector bearing;       // from the bow clockwise
  double from_m = 0.0;  // from the vessel's origin
  double to_m = 0.0;
  bool begins_with_zone = true;  // in most of its bearings no nearer part of the zone is seen
  bool ends_with_zone = true;    // in most of its bearings no farther part of the zone is seen
  bool is_wide = false;          // worth an alert: as wide as kLeastWidthRad and kLeastWidthM, or all of the zone's bearings
};

struct ZoneSightParams {
  GuardZoneParams zone = {};  // range 0: none, and nothing is told
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  double reference_point_above_water_m = 0.0;
  double min_range_m = 0.0;  // of the segmenter, from the lidar; so are max_range_m and field_of_view
  double max_range_m = 120.0;
  Sector field_of_view = {};                       // azimuths of the lidar
  Eigen::AlignedBox3d own_vessel_box_m{};          // vessel frame; empty = none
  Eigen::AlignedBox2d own_hull_m{};                // vessel frame, inside of the box
  std::vector<float> expected_elevation_rad = {};  // of the rings, by the model in the config, from the lowest up: for texts on the config alone
};

/// The zone in cells: a degree of bearing by a twentieth of its range. A beam looks into a cell when it passes through a post that stands in the
/// middle of the cell, from the water up to `top_m`, at a range and azimuth that the segmenter takes. Cells inside of own_vessel within 1 m of the
/// hull are no part of the zone. The boat floats level.
class ZoneGrid {
 public:
  /// @param elevation_rad  of the rings, from the lowest up; at least one
  ZoneGrid(const ZoneSightParams& params, std::span<const float> elevation_rad, double top_m);

  /// A beam that would look into a cell.
  struct Way {
    std::uint16_t ring = 0;
    std::uint16_t azimuth = 0;  // whole degrees, rounded down
    float range_m = 0.0F;       // from the lidar
  };
  struct Cell {
    bool is_zone = false;
    Unseen why = Unseen::kNo;  // why no beam could look into it; kNo: some can
    std::uint32_t first_way = 0;
    std::uint32_t num_ways = 0;
  };

  std::size_t num_bearings() const { return num_bearings_; }
  double bearing_step_rad() const { return bearing_step_rad_; }
  const std::vector<Cell>& cells() const { return cells_; }  // [bearings x kNumRanges]
  std::span<const Way> WaysOf(const Cell& cell) const { return std::span(ways_).subspan(cell.first_way, cell.num_ways); }

  /// The parts that are not looked into, the largest first.
  /// @param why  [cells] kNo where somebody looks
  std::vector<UnseenPart> PartsOf(std::span<const Unseen> why) const;
  /// The parts that the config alone leaves out: for a lidar that fires all round, with nothing before it.
  std::vector<UnseenPart> PartsByConfig() const;

  static constexpr std::size_t kNumRanges = 20;

 private:
  struct Candidate {
    std::size_t ring = 0;
    double azimuth_rad = 0.0;
    double range_m = 0.0;
    Eigen::Vector3d p_vessel_m = Eigen::Vector3d::Zero();
  };
  struct Run;
  struct Beams;
  void AddCell(const ZoneSightParams& params, const Beams& beams, const Eigen::Vector2d& place_m, double top_m);
  Unseen WhyNot(const ZoneSightParams& params, const Candidate& candidate) const;
  std::optional<Run> RunOf(std::size_t bearing, Unseen reason, std::span<const Unseen> why) const;
  void AddParts(Unseen reason, std::span<const Unseen> why, std::vector<UnseenPart>& parts) const;
  UnseenPart ToPart(Unseen reason, std::size_t first, std::size_t count, std::span<const std::optional<Run>> runs) const;

  double range_step_m_;
  Sector bearing_;
  std::size_t num_bearings_;
  double bearing_step_rad_;
  std::vector<Cell> cells_;
  std::vector<Way> ways_;
};

/// Scan by scan. Calm water gives no returns. So the columns of the scan say where the lidar looks, except for beams that end on the own boat before
/// they reach a place. A place is unseen when fewer than a quarter of the last seconds' scans look there, and seen again at more than three fifths,
/// as an alert needs 3 of 5 scans. So lost packets, and a person who walks past the lidar, are told only where they last.
class ZoneSight {
 public:
  /// A person in a kayak or a dinghy.
  static constexpr double kPostM = 1.0;
  /// A gap of 5 deg is 0.9 m wide at the edge of a zone of 10 m: a kayak fits into it with its paddler. A boat that stays on the gap's bearing comes
  /// nearer unseen until the boat is wider than the gap. Narrower gaps (a mast) are counted, and raise no alert: it would stand for ever.
  static constexpr double kLeastWidthRad = DegToRad(5.0);
  static constexpr double kLeastWidthM = 0.8;
  /// Least depth of an unseen part that is nearer or farther than the seen part of its bearing.
  static constexpr double kLeastDepthM = 1.0;
  static constexpr double kTimeConstantS = 2.0;
  static constexpr double kUnseenShare = 0.25;
  static constexpr double kSeenShare = 0.6;

  explicit ZoneSight(const ZoneSightParams& params) : params_(params) {}

  void Update(Utime time, const Sweep& sweep);
  /// Begins anew with another zone; the same zone changes nothing.
  void SetZone(const GuardZoneParams& zone);

  /// Worth an alert, the largest first.
  const std::vector<UnseenPart>& parts() const { return wide_; }
  /// Whether nobody looks into any part of the zone.
  bool is_whole() const { return is_whole_; }
  /// Degrees of bearing of which a part is unseen, narrow gaps included; rounded.
  int unseen_deg() const { return unseen_deg_; }

  /// For Alerts: a danger of cause WATCH. It is another thing each time that parts come up of which 5 deg were not told before.
  std::optional<Danger> danger() const;

 private:
  void Trace(const Sweep& sweep);
  void Advance(double weight);
  void Tell();

  ZoneSightParams params_;
  std::optional<ZoneGrid> grid_;
  std::vector<float> elevation_rad_;  // of the grid
  std::vector<float> reach_m_;        // [degrees x rings] how far the beams see there; below 0: there is no beam
  std::vector<double> share_;         // [cells] share of the last seconds' scans that look there
  std::vector<Unseen> why_;           // [cells]
  std::vector<bool> told_;            // [bearings]
  std::vector<UnseenPart> wide_;
  bool is_whole_ = false;
  int unseen_deg_ = 0;
  std::int64_t num_told_ = 0;
  std::optional<Utime> newest_;
};

}  // namespace lookout::tracker
