// From the picture after a scan to the alerts: dangers, their urgency, and the alert that sounds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/dangers.hpp"
#include "services/tracker/core/limits.hpp"
#include "services/tracker/core/names.hpp"
#include "services/tracker/core/order.hpp"
#include "services/tracker/core/sound.hpp"
#include "services/tracker/core/things.hpp"

namespace lookout::tracker {

struct LookOutParams {
  AlertParams alerts = {};
  LimitParams limits = {};
  OwnAbility ability = {};
};

class LookOut {
 public:
  explicit LookOut(const LookOutParams& params) : params_(params), alerts_(params.alerts) {
    settings_.mode = params.limits.mode;
    limits_ = LimitsOf(params.limits, settings_, 0.0, params.ability);
  }

  /// An order is in force from the next scan on. Call this before Begin.
  void Take(const Order& order, Utime time);
  /// @return the limits of the next scan: the tracker's closest approach goes by them, too
  const Limits& Begin(const std::optional<Pose>& own);

  /// Call this before Acknowledge and Update: acknowledgements are of the things of this scan.
  void Rename(const Picture& picture, Utime time);
  bool Acknowledge(const Acknowledgement& acknowledgement, Utime time) { return alerts_.Acknowledge(acknowledgement, time); }

  /// @param own     placed, at the end of the scan
  /// @param unseen  parts of the guard zone that nobody looks into, and what a second lidar that is silent would see
  const std::vector<Alert>& Update(Utime time, bool is_whole, const Picture& picture, std::span<const VesselOutline> outlines,
                                   const std::optional<Pose>& own, std::span<const Danger> unseen);

  void ForgetMap() {
    alerts_.ForgetMap();
    shore_m_.clear();
  }
  void ForgetTracks() {
    things_.Clear();
    proof_.Clear();
    names_.Clear();
    shore_m_.clear();
  }

  /// As returned by the last Update.
  const std::vector<Alert>& alerts() const { return told_; }
  const Names& names() const { return names_; }
  /// Number of orders that name an id which is no track.
  std::int64_t num_names_of_no_track() const { return num_names_of_no_track_; }
  const Limits& limits() const { return limits_; }
  /// The guard zone as it is set, not shrunk in harbour: somebody should look into all of it.
  GuardZoneParams WholeZone() const;
  std::int64_t sounding() const { return sounding_; }
  std::optional<Utime> silenced_until() const { return sound_.silenced_until(); }
  std::int64_t num_newcomers_over_limit() const { return newcomers_.num_over_limit(); }

 private:
  void Name(const Picture& picture, Utime time);

  LookOutParams params_;
  Settings settings_;
  Limits limits_;
  Things things_;
  std::vector<Eigen::Vector2d> shore_m_;  // as it was told last
  Proof proof_;
  Newcomers newcomers_;
  StillWatch still_;
  bool is_own_still_ = false;  // after the last scan
  Alerts alerts_;
  Names names_;
  std::vector<Order> namings_;  // with the next scan
  std::int64_t num_names_of_no_track_ = 0;
  std::vector<Alert> told_;
  Sound sound_;
  std::int64_t sounding_ = 0;
};

}  // namespace lookout::tracker
