// Whether something covers the lidar, or its lasers are off: its packets come whole, and it sees nothing.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/own_vessel.hpp"
#include "common/core/utime.hpp"

namespace lookout {

/// How it is known that a sector is covered.
enum class Cover : std::uint8_t {
  kNo,
  kNear,     // half of its beams or more end on the own boat or below the least range, and nearer than CoverWatch::kNearM
  kOwnGone,  // the lidar saw the own boat in it for long, and sees neither that nor anything else
  kDark,     // the lidar saw much in the scans before, and there is no return in all of this one
};

/// Whether a lidar has become dark: it saw much in each of the last scans, and nothing in this one. Things that get out of reach do so one by one.
class Darkness {
 public:
  /// Returns of a scan.
  static constexpr std::int64_t kMuch = 100;

  /// The next scan.
  ///
  /// @param most_strays  so many returns and fewer are none
  /// @return whether it is dark. It is so until three scans in a row have returns
  bool Add(std::int64_t num_returns, std::int64_t most_strays);

 private:
  static constexpr std::size_t kNumScans = 3;
  std::array<std::int64_t, kNumScans> last_{};  // returns of the last scans, the newest first
  bool is_dark_ = false;
};

struct CoverParams {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  double min_range_m = 0.0;                   // of the segmenter
  Sector field_of_view = {};                  // of the segmenter, azimuths of the lidar
  Eigen::AlignedBox3d own_vessel_box_m = {};  // vessel frame; empty = none
};

struct CoveredPart {
  Cover why = Cover::kNo;
  Sector bearing;  // from the bow clockwise
};

/// Scan by scan, in sectors of 5 deg of azimuth. Calm water gives no returns, so an empty sector says nothing by itself; the own boat does not go
/// away. A cover is 30 deg wide at least: what is narrower may be a mast, a person or a fender that was taken in. It is used with the scan that shows
/// it, and told when it has lasted (three quarters of the last seconds, until less than two fifths).
class CoverWatch {
 public:
  static constexpr std::size_t kNumSectors = 72;
  static constexpr std::size_t kLeastSectors = 6;
  static constexpr double kNearM = 1.0;
  static constexpr float kAtLidarM = 0.01F;  // no lidar measures so near
  /// Without a return, where nothing else tells, until it is said; and of scans with returns, until that is taken back.
  static constexpr double kNothingS = 30.0;
  static constexpr double kSomethingS = 5.0;

  explicit CoverWatch(const CoverParams& params);

  void Begin() { now_ = {}; }
  /// @param azimuth_offset_rad  [rings] to be added to the azimuth of the column, less than a circle
  /// @param elevation_rad       [rings]
  /// @param range_m             [rings] of the nearest return; 0 = none
  void AddColumn(double azimuth_rad, std::span<const float> azimuth_offset_rad, std::span<const float> elevation_rad, std::span<const float> range_m);
  void End(Utime time);
  /// In place of a scan of which the returns did not come: nothing is covered in it, and after some seconds nothing is told any more.
  void Skip(Utime time);

  /// Whether the beam's sector is covered in the scan that ended last.
  /// @param azimuth_rad  of a beam, offset included; from minus a circle on
  bool Covers(double azimuth_rad) const { return sectors_[IndexOf(azimuth_rad)].cover != Cover::kNo; }
  /// Where a beam of that scan ends: one that shows nothing in a covered sector ends at the lidar, and nobody knows what is behind.
  /// @param range_m  0 = no return
  float EndOf(double azimuth_rad, float range_m) const { return range_m <= 0.0F && Covers(azimuth_rad) ? kAtLidarM : range_m; }
  bool covers_any() const { return covers_any_; }
  /// Whether a sector is covered that looked before in this run: things that were seen there may still be there.
  bool covers_anew() const { return covers_anew_; }

  /// Covers that have lasted, clockwise from the lidar's x axis.
  std::vector<CoveredPart> parts() const;
  std::int64_t num_lasting() const { return num_lasting_; }  // sectors
  bool is_all_round() const { return is_all_round_; }
  /// Grows by 1 each time that 30 deg are covered which were not told in the last 10 s. 0: nothing was told yet.
  std::int64_t num_told() const { return num_told_; }
  /// No return for kNothingS, and nothing tells why: the lasers may be off, the window covered, or the water flat and empty.
  bool sees_nothing() const { return sees_nothing_; }

 private:
  struct Counts {
    int num_shots = 0;
    int num_returns = 0;
    int num_own = 0;   // returns of the own boat, or below the least range
    int num_near = 0;  // of these, returns nearer than kNearM
  };
  struct State {
    Cover cover = Cover::kNo;
    Cover lasting = Cover::kNo;
    double own_share = 0.0;     // of scans in which the own boat was seen there
    double cover_share = 0.0;   // of the last seconds
    bool is_looked_at = false;  // the lidar fires there, and the segmenter takes it
    bool has_looked = false;    // it looked earlier in this run: things that were seen there may still be there
    bool was_told = false;
    double unfired_s = 0.0;  // since the lidar fired there last
    double covered_s = 0.0;  // since it was not covered last
    double free_s = 0.0;     // since a cover lasted there
  };

  static std::size_t IndexOf(double azimuth_rad) {
    return static_cast<std::size_t>(azimuth_rad * (static_cast<double>(kNumSectors) / kTwoPi) + static_cast<double>(kNumSectors)) % kNumSectors;
  }
  bool IsOwn(double azimuth_rad, double elevation_rad, double range_m) const;
  void FindCovers(bool is_dark, double step_s);
  void KeepWide();
  void Learn(double step_s);
  void Tell(double step_s);
  void WatchForNothing(bool is_nothing, double step_s);

  CoverParams params_;
  OwnVessel own_vessel_;
  std::array<Counts, kNumSectors> now_{};
  std::array<State, kNumSectors> sectors_{};
  bool covers_any_ = false;
  bool covers_anew_ = false;
  std::int64_t num_lasting_ = 0;
  bool is_all_round_ = false;
  std::int64_t num_told_ = 0;
  Darkness darkness_;
  double nothing_s_ = 0.0;
  bool sees_nothing_ = false;
  std::optional<Utime> newest_;
};

}  // namespace lookout
