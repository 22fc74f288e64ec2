// The work of one scan on the tracks.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "services/tracker/core/clutter.hpp"
#include "services/tracker/core/followed.hpp"
#include "services/tracker/core/land.hpp"
#include "services/tracker/core/land_pieces.hpp"
#include "services/tracker/core/sight.hpp"
#include "services/tracker/core/sightings.hpp"
#include "services/tracker/core/standing_ground.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/watched_water.hpp"

namespace lookout::tracker {

// In an outline that is longer or wider, as of a dock with berths, another thing may lie.
inline constexpr double kLongestWholeM = 15.0;
inline constexpr double kWidestBoatM = 6.0;

inline constexpr std::size_t kMostTracks = 8000;  // 20 MB, and 50 kB for each with 12 returns or more; rain has 1500, of a few returns

using Ids = std::pair<std::int64_t, std::int64_t>;  // of two tracks, the lower first

/// The state between scans.
struct Known {
  Sight sight;
  Ledger ledger = {};
  std::int64_t last_frame = 0;
  LandMemory land = {};
  LandPieces land_pieces = {};
  ClutterMap clutter = {};
  WatchedWater watched = {};
  StandingGround ground = {};
  std::deque<Followed> tracks = {};       // by id
  std::map<Ids, double> together_s = {};  // for how long two looked like one
  std::int64_t next_id = 1;
  std::int64_t next_number = 1;
  std::int64_t num_outdated = 0;    // segments placed by an own position that became much better known in the scan
  std::int64_t num_over_limit = 0;  // segments that became no track
  double settled_sd_m = 0.0;        // deviation of the own position before this scan; set only if this scan made it much smaller, else 0
  bool had_sight = false;           // in any scan so far: where LIDAR_SCAN never comes, misses count without it
};

// A cheap test before one of polygons; rounding makes it true rather than false.
inline bool IsWithin(const Eigen::Vector2d& place_m, const Eigen::Vector2d& middle_m, double radius_m) {
  constexpr double kOfRoundingM = 1e-6;
  return (place_m - middle_m).norm() <= radius_m + kOfRoundingM;
}

/// Call Run once, then TakePicture. Its stages are in files of their own: step_settle, step_land, step_associate, step_move, step_exist, step_merge,
/// step_ground.
class Step {
 public:
  Step(const TrackerParams& params, const ScanInput& scan, Known& known, double dt_s) : params_(params), scan_(scan), known_(known), dt_s_(dt_s) {}

  void Run();

  /// The picture without tracks and their consequences.
  Picture TakePicture();

 private:
  struct Near {
    double distance_m;
    std::size_t track;
    std::size_t seen;
  };
  Eigen::Vector2d ToVessel(const Eigen::Vector2d& place_m) const;
  void Predict();
  static void Place(Followed& track);
  void FindLand();
  void FollowLandPieces();
  bool IsLand(const Followed& track) const;
  bool IsPerhapsLand(const Followed& track, std::size_t i) const;
  void Look();
  void LeaveOutdated();
  void Settle();
  double CostOf(const Followed& track, std::size_t i);
  const Sides& SidesOf(std::size_t i);
  bool AreTwo(std::size_t one, std::size_t other) const;
  void AssignBodies();
  template <typename Take>
  void TakeNearest(std::vector<Near>& pairs, const Take& take);
  void AssignRest();
  void HitWhole(Followed& track, std::size_t i);
  void Hit(Followed& track, std::size_t i, const Seen& seen, const Sides& sides);
  void ChooseFrame(Followed& track);
  static void Remember(Followed& track, bool is_seen);
  void Miss(Followed& track);
  std::optional<std::size_t> SightingAround(const Followed& track) const;
  void FindInside();
  bool IsClear(std::size_t i) const;
  bool IsAtOwnHull(const Sighting& sighting) const;
  bool IsAlone(const Followed& track, std::size_t i) const;
  void AskWatched(Followed& track) const;
  void RememberGround();
  void LookAtGround();
  bool IsOnGround(const Followed& track) const;
  void Begin();
  void ConfirmWhereLikely(Followed& track, std::size_t i);
  void Confirm(Followed& track);
  void Move(Followed& track, std::size_t i, const Seen& seen, const Sides& sides);
  void MoveBySurface(Followed& track, const Sighting& sighting, const Sides& sides, bool is_one) const;
  void Believe(Followed& track, std::size_t i, const Seen& seen, const Eigen::Vector2d& expected_m);
  void FeedLand();
  void EndLand();
  void Merge();
  void EndUnseen();
  void Label();
  bool Touch(const Followed& one, const Followed& other) const;
  bool IsLikePart(const Followed& larger, const Followed& lesser, double shared_m2) const;
  bool IsSuspect(const Followed& track) const;
  static bool AreOneBoat(const Followed& one, const Followed& other);
  bool IsFoundAgain(const Followed& lost, const Followed& found) const;
  double OneForS(const Followed& one, const Followed& other) const;
  void Join(Followed& one, Followed& other);

  const TrackerParams& params_;
  const ScanInput& scan_;
  Known& known_;
  double dt_s_;
  bool is_sight_known_ = false;
  bool has_left_out_ = false;  // segments, since they are outdated
  std::vector<Sighting> sightings_;
  std::int32_t num_groups_ = 0;  // of the ledger among them
  std::vector<std::int32_t> sighting_of_piece_;
  std::vector<std::int32_t> sighting_of_segment_;
  std::vector<std::int64_t> track_of_piece_;
  std::vector<std::int32_t> land_ids_;
  std::vector<std::pair<std::int64_t, std::int64_t>> merged_;
};

}  // namespace lookout::tracker
