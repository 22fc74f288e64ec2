// Where a thing can come from: what beams say of the water in which it comes up, and what becomes of it.
#include "services/tracker/core/watched_water.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker::watched {
namespace {

constexpr double kLidarM = 1.0;  // over the water
constexpr double kMaxRangeM = 60.0;
constexpr int kColumns = 1800;

// What stands in the water, round and upright.
struct Post {
  Eigen::Vector2d place_m;
  double top_m = 0.4;
  double radius_m = 0.4;
  double thing_probability = 0.92;
  double share = 1.0;  // of the beams that come back
};

// What a lidar at the origin sees of posts. It rolls by two degrees in four seconds, so that its rings sweep over the water.
ScanInput Look(int scan, const std::vector<Post>& posts) {
  std::mt19937_64 random(static_cast<std::uint64_t>(scan));
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  ScanInput input = test::MakeScan(scan, Eigen::Vector2d::Zero());
  const double roll_rad = DegToRad(2.0) * std::sin(kTwoPi * scan / 40.0);
  input.own->roll_rad = input.own_at_start->roll_rad = roll_rad;
  Sweep sweep;
  for (int ring = 0; ring < 16; ++ring) {
    sweep.elevation_rad.push_back(static_cast<float>(DegToRad(-15.0 + 2.0 * ring)));
    sweep.azimuth_offset_rad.push_back(0.0F);
  }
  std::vector<std::vector<Eigen::Vector2d>> places_m(posts.size());
  std::vector<double> tops_m(posts.size(), 0.0);
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth_rad = kTwoPi * column / kColumns;
    sweep.azimuth_rad.push_back(static_cast<float>(azimuth_rad));
    sweep.time.push_back(input.time);
    const Eigen::Vector2d ahead(std::sin(azimuth_rad), std::cos(azimuth_rad));
    for (const float elevation_rad : sweep.elevation_rad) {
      // To starboard is down where the roll is positive.
      const double rise = std::tan(elevation_rad) - std::tan(roll_rad) * std::sin(azimuth_rad);
      double met_m = std::numeric_limits<double>::infinity();
      std::size_t met = 0;
      for (std::size_t i = 0; i < posts.size(); ++i) {
        const double along_m = posts[i].place_m.dot(ahead);
        const double beside_m = posts[i].place_m.x() * ahead.y() - posts[i].place_m.y() * ahead.x();
        if (along_m < 0.0 || std::abs(beside_m) > posts[i].radius_m) continue;
        const double distance_m = along_m - std::sqrt(posts[i].radius_m * posts[i].radius_m - beside_m * beside_m);
        const double z_m = kLidarM + distance_m * rise;
        if (z_m < 0.0 || z_m > posts[i].top_m || distance_m >= met_m || distance_m > kMaxRangeM || chance(random) >= posts[i].share) continue;
        met_m = distance_m;
        met = i;
      }
      const bool is_met = std::isfinite(met_m);
      sweep.range_m.push_back(is_met ? static_cast<float>(met_m / std::cos(elevation_rad)) : 0.0F);
      sweep.label.push_back(is_met ? static_cast<std::int16_t>(met + 1) : std::int16_t{0});
      if (!is_met) continue;
      places_m[met].push_back(met_m * ahead);
      tops_m[met] = std::max(tops_m[met], kLidarM + met_m * rise);
    }
  }
  for (std::size_t i = 0; i < posts.size(); ++i) {
    if (places_m[i].empty()) continue;
    Seen seen;
    seen.segment_id = static_cast<std::int32_t>(i + 1);
    seen.time = input.end_time;
    seen.thing_probability = posts[i].thing_probability;
    seen.is_sure = seen.thing_probability >= 0.5;
    seen.num_returns = static_cast<int>(places_m[i].size());
    seen.outline_m = Polygon(SupportOf(places_m[i]));
    for (const auto& corner : seen.outline_m) seen.position_m += corner / static_cast<double>(seen.outline_m.size());
    seen.covariance_relative_m2 = seen.covariance_m2 = 0.0025 * Eigen::Matrix2d::Identity();
    seen.top_above_water_m = tops_m[i];
    input.seen.push_back(seen);
  }
  input.sweep = std::move(sweep);
  return input;
}

TrackerParams Params() {
  TrackerParams params;
  params.reference_point_above_water_m = kLidarM;
  params.max_range_m = kMaxRangeM;
  return params;
}

// The memory of a lidar that looked for some scans, and the time of the next one's end.
class Memory {
 public:
  void Scans(int number, const std::vector<Post>& posts) {
    for (int i = 0; i < number; ++i) {
      const auto input = Look(number_++, posts);
      sight_.Begin(input);
      water.Add(sight_, input.end_time);
    }
  }
  Utime now() const { return test::MakeScan(number_, Eigen::Vector2d::Zero()).end_time; }
  Watched At(const Eigen::Vector2d& place_m, double top_m) const { return water.At(place_m, top_m, now()); }

  WatchedWater water;

 private:
  Sight sight_{Eigen::Isometry3d::Identity(), kLidarM, kMaxRangeM};
  int number_ = 0;
};

TEST(WatchedWater, WasEmptyWhereEachBeamMetNothing) {
  Memory memory;
  memory.Scans(30, {});
  EXPECT_EQ(memory.At({3.0, 9.0}, 0.5), (Watched{20, 20})) << "the two seconds before count";
  EXPECT_EQ(memory.At({-6.0, -4.0}, 0.5), (Watched{20, 20}));
  EXPECT_EQ(memory.At({0.0, 100.0}, 0.5), Watched{}) << "beyond the range";
}

TEST(WatchedWater, IsLookedAtOnlyWhereABeamPassesBelowTheTop) {
  Memory memory;
  memory.Scans(30, {});
  const auto low = memory.At({15.0, 0.0}, 0.3);
  EXPECT_GT(low.num_looks, 0);
  EXPECT_LT(low.num_looks, 20) << "rings are half a metre apart there";
  EXPECT_EQ(low.num_empty, low.num_looks);
  EXPECT_EQ(memory.At({15.0, 0.0}, 1.0), (Watched{20, 20}));
  EXPECT_EQ(memory.At({2.0, 0.0}, 0.3), Watched{}) << "below the lowest beam";
}

TEST(WatchedWater, IsNotLookedAtBehindSomething) {
  Memory memory;
  memory.Scans(30, {{.place_m = {0.0, 8.0}, .top_m = 4.0, .radius_m = 2.0}});
  EXPECT_EQ(memory.At({0.0, 20.0}, 0.6), Watched{});
  EXPECT_EQ(memory.At({20.0, 0.0}, 0.6).num_empty, memory.At({20.0, 0.0}, 0.6).num_looks);
}

TEST(WatchedWater, WasNotEmptyBesideSomething) {
  Memory memory;
  memory.Scans(30, {{.place_m = {0.0, 10.0}}});
  EXPECT_EQ(memory.At({0.0, 10.0}, 0.4).num_empty, 0);
  EXPECT_EQ(memory.At({1.0, 10.0}, 0.4).num_empty, 0);
  EXPECT_EQ(memory.At({5.0, 10.0}, 0.4).num_empty, memory.At({5.0, 10.0}, 0.4).num_looks);
  // It went a second ago.
  memory.Scans(10, {});
  EXPECT_EQ(memory.At({0.0, 10.0}, 0.5).num_empty, 10);
}

TEST(WatchedWater, IsForgotten) {
  Memory memory;
  memory.Scans(30, {});
  EXPECT_EQ(memory.water.At({3.0, 9.0}, 0.5, memory.now() + std::chrono::seconds(5)), Watched{});
  memory.water.Clear();
  EXPECT_EQ(memory.At({3.0, 9.0}, 0.5), Watched{});
}

TEST(WatchedWater, IsNotLookedAtByAScanThatSaysNothing) {
  WatchedWater water;
  Sight sight(Eigen::Isometry3d::Identity(), kLidarM, kMaxRangeM);
  auto input = Look(0, {});
  input.sweep.reset();
  sight.Begin(input);
  water.Add(sight, input.end_time);
  EXPECT_EQ(water.At({3.0, 9.0}, 0.5, input.end_time + std::chrono::milliseconds(100)), Watched{});
}

TEST(WatchedWater, SaysMoreThatAThingCameUpTheSurerItWouldHaveBeenSeen) {
  EXPECT_EQ(CameUpLogOdds({}, 0.9), 0.0);
  EXPECT_EQ(CameUpLogOdds({10, 0}, 0.9), 0.0);
  EXPECT_LT(CameUpLogOdds({10, 4}, 0.2), CameUpLogOdds({10, 4}, 0.5));
  EXPECT_LT(CameUpLogOdds({10, 2}, 0.5), CameUpLogOdds({10, 4}, 0.5));
  EXPECT_EQ(CameUpLogOdds({20, 20}, 0.9), CameUpLogOdds({20, 10}, 0.9)) << "never for sure";
}

// When a thing is confirmed near a place, and how it looks then.
class Situation {
 public:
  /// @return s from when there was something within 1.5 m of `place_m` to a confirmed track there; nullopt: none within the scans
  std::optional<double> ConfirmedAfter(int num_scans, const std::function<std::vector<Post>(double time_s)>& posts_at,
                                       const std::function<Eigen::Vector2d(double time_s)>& place_at) {
    Tracker tracker(Params());
    std::optional<double> seen_s;
    for (int scan = 0; scan < num_scans; ++scan) {
      const double time_s = test::kScanS * scan;
      const auto input = Look(scan, posts_at(time_s));
      const auto is_here = [&](const Eigen::Vector2d& other_m) { return (other_m - place_at(time_s)).norm() < 1.5; };
      if (!seen_s && std::ranges::any_of(input.seen, [&](const Seen& seen) { return is_here(seen.position_m); })) seen_s = time_s;
      for (const auto& track : tracker.Update(input).tracks) {
        if (track.status == TrackStatus::kConfirmed && is_here(track.position_m)) return time_s - *seen_s;
      }
    }
    return std::nullopt;
  }
};

TEST(WhatComesUp, InWatchedWaterAndRunsForAShortTimeIsACrest) {
  for (const double life_s : {0.6, 1.0, 1.5, 2.0, 2.7}) {
    for (const double speed_mps : {0.8, 2.0, 3.0}) {
      const auto place_at = [&](double time_s) { return Eigen::Vector2d(4.0 + speed_mps * (time_s - 3.0), 8.0); };
      const auto confirmed_s = Situation().ConfirmedAfter(
          80, [&](double time_s) { return time_s < 3.0 || time_s > 3.0 + life_s ? std::vector<Post>{} : std::vector<Post>{{place_at(time_s)}}; },
          place_at);
      EXPECT_FALSE(confirmed_s) << life_s << " s, " << speed_mps << " m/s: after " << confirmed_s.value_or(0.0) << " s";
    }
  }
}

TEST(WhatComesUp, InWatchedWaterAndStaysIsAThing) {
  const Eigen::Vector2d place_m(5.0, 7.0);
  const Post swimmer{.place_m = place_m, .top_m = 0.3, .radius_m = 0.15};
  const auto confirmed_s = Situation().ConfirmedAfter(
      120, [&](double time_s) { return time_s < 3.0 ? std::vector<Post>{} : std::vector<Post>{swimmer}; }, [&](double) { return place_m; });
  ASSERT_TRUE(confirmed_s);
  EXPECT_GE(*confirmed_s, 1.0);
  EXPECT_LE(*confirmed_s, 4.0);
}

TEST(WhatComesUp, AndSwimsIsAThingInTheEnd) {
  const auto place_at = [](double time_s) { return Eigen::Vector2d(5.0 + 0.8 * (time_s - 3.0), 7.0); };
  const auto confirmed_s = Situation().ConfirmedAfter(
      150,
      [&](double time_s) {
        return time_s < 3.0 ? std::vector<Post>{} : std::vector<Post>{{place_at(time_s), 0.3, 0.15}};
      },
      place_at);
  ASSERT_TRUE(confirmed_s);
  EXPECT_LE(*confirmed_s, 8.0);
}

TEST(WhatComesUp, AndIsTallIsAThing) {
  const Eigen::Vector2d place_m(5.0, 7.0);
  const auto confirmed_s = Situation().ConfirmedAfter(
      120,
      [&](double time_s) {
        return time_s < 3.0 ? std::vector<Post>{} : std::vector<Post>{{place_m, 1.8}};
      },
      [&](double) { return place_m; });
  ASSERT_TRUE(confirmed_s);
  EXPECT_LE(*confirmed_s, 0.5);
}

TEST(WhatComes, IntoRangeIsConfirmedAtOnce) {
  for (const double speed_mps : {1.5, 6.0}) {
    const auto place_at = [&](double time_s) { return Eigen::Vector2d(61.0 - speed_mps * time_s, 10.0); };
    const auto confirmed_s = Situation().ConfirmedAfter(
        100,
        [&](double time_s) {
          return std::vector<Post>{{place_at(time_s), 1.2, 1.0, 0.97}};
        },
        place_at);
    ASSERT_TRUE(confirmed_s) << speed_mps << " m/s";
    EXPECT_LE(*confirmed_s, 0.5) << speed_mps << " m/s";
  }
}

TEST(WhatComes, FromBehindAShipIsConfirmedAtOnce) {
  const Eigen::Vector2d buoy_m(0.0, 18.0);
  const auto confirmed_s = Situation().ConfirmedAfter(
      120,
      [&](double time_s) {
        return std::vector<Post>{{buoy_m, 0.7, 0.3}, {{-2.0 + 2.0 * time_s, 10.0}, 4.0, 2.5, 0.99}};
      },
      [&](double) { return buoy_m; });
  ASSERT_TRUE(confirmed_s);
  EXPECT_LE(*confirmed_s, 0.5);
}

TEST(WhatIsThere, FromTheBeginningIsConfirmedAtOnce) {
  const Eigen::Vector2d buoy_m(-4.0, 9.0);
  const auto confirmed_s = Situation().ConfirmedAfter(
      50,
      [&](double) {
        return std::vector<Post>{{buoy_m, 0.6, 0.3}};
      },
      [&](double) { return buoy_m; });
  ASSERT_TRUE(confirmed_s);
  EXPECT_LE(*confirmed_s, 0.5);
}

// Black paint: few beams come back, a return in one scan of five.
TEST(WhatIsThere, AndIsSeenByOneScanInFiveIsConfirmed) {
  const Post buoy{.place_m = {-4.0, 9.0}, .top_m = 0.6, .radius_m = 0.2, .thing_probability = 0.6, .share = 0.01};
  int num_seen = 0;
  for (int scan = 0; scan < 200; ++scan) num_seen += static_cast<int>(Look(scan, {buoy}).seen.size());
  EXPECT_NEAR(num_seen, 40, 15);
  const auto confirmed_s = Situation().ConfirmedAfter(
      200, [&](double) { return std::vector<Post>{buoy}; }, [&](double) { return buoy.place_m; });
  ASSERT_TRUE(confirmed_s);
  EXPECT_LE(*confirmed_s, 6.0);
}

}  // namespace
}  // namespace lookout::tracker::watched
