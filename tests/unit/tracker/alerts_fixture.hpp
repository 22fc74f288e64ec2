// Dangers by hand, and scans of them, for the tests of alerts.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

inline constexpr AlertParams kAlertParams{};

/// A track on its way. It leaves less time than is needed below 15 s, or nearer than 5 m.
inline Danger Cpa(std::int64_t track_id, double probability, double tcpa_s = 25.0, double distance_m = 40.0) {
  return {.cause = AlertCause::kClosestApproach,
          .thing = track_id,
          .nearest_track = track_id,
          .probability = probability,
          .distance_m = distance_m,
          .cpa_m = 2.0,
          .tcpa_s = tcpa_s,
          .is_grave = distance_m < 5.0 || (tcpa_s > 0.0 && tcpa_s < 15.0)};
}

inline Danger Zone(std::int64_t track_id, double distance_m = 8.0) {
  return {.thing = track_id, .nearest_track = track_id, .probability = 1.0, .distance_m = distance_m, .is_grave = true};
}

inline DangerPlace At(double bearing_deg, double range_m) { return {range_m, WrapTo2Pi(DegToRad(bearing_deg))}; }

// The nearest is what is told.
inline Danger Of(std::int64_t track_id, std::vector<DangerPlace> places) {
  const auto nearest = *std::ranges::min_element(places, {}, &DangerPlace::range_m);
  auto danger = Zone(track_id, nearest.range_m);
  danger.bearing_rad = nearest.bearing_rad;
  danger.places = std::move(places);
  return danger;
}

// A straight shore as the guard zone tells it: a place every 5 deg, as far as 10 m.
inline std::vector<DangerPlace> Shore(double bearing_deg, double range_m) {
  std::vector<DangerPlace> places;
  for (double aside_deg = -85.0; aside_deg <= 85.0; aside_deg += 5.0) {
    const double at_m = range_m / std::cos(DegToRad(aside_deg));
    if (at_m <= 10.0) places.push_back(At(bearing_deg + aside_deg, at_m));
  }
  return places;
}

inline std::vector<DangerPlace> Both(std::vector<DangerPlace> one, const std::vector<DangerPlace>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

// Scans at 10 Hz.
class AlertsTest : public ::testing::Test {
 protected:
  const std::vector<Alert>& Scan(const std::vector<Danger>& dangers, bool is_whole = true) {
    time_ += std::chrono::milliseconds(100);
    return alerts_.Update(time_, is_whole, dangers, around_);
  }
  void Scans(int num, const std::vector<Danger>& dangers, bool is_whole = true) {
    for (int i = 0; i < num; ++i) Scan(dangers, is_whole);
  }
  bool Acknowledge(const Alert& alert) {
    return alerts_.Acknowledge({time_, "page", alert.id, alert.raised}, time_ + std::chrono::milliseconds(100));
  }
  const Alert& Only() const {
    EXPECT_EQ(alerts_.alerts().size(), 1U);
    static const Alert kNone{};
    return alerts_.alerts().empty() ? kNone : alerts_.alerts().front();
  }

  Utime time_{std::chrono::seconds(1'700'000'000)};
  Alerts alerts_{kAlertParams};
  Surroundings around_;
};

}  // namespace lookout::tracker
