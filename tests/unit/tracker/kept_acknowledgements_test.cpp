#include "services/tracker/core/kept_acknowledgements.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

#include "common/core/angles.hpp"

namespace lookout::tracker::kept {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Datum kHere{60.0, 20.0, 0.0};
const Datum kThere{60.0, 20.5, 0.0};

Track TrackAt(std::int64_t id, double east_m, double east_mps = 0.0) {
  Track track;
  track.id = id;
  track.position_m = {east_m, 0.0};
  track.velocity_mps = {east_mps, 0.0};
  return track;
}

class KeptAcknowledgementsTest : public ::testing::Test {
 protected:
  // Of the guard zone, raised now.
  Alert Of(std::int64_t track_id, AlertState state, AlertLevel level = AlertLevel::kWarning) const {
    return {.id = 100 + track_id, .level = level, .state = state, .thing = track_id, .nearest_track = track_id, .raised = time_, .changed = time_};
  }
  Alert OfLand(AlertState state, double distance_m = 8.0, double bearing_deg = 0.0) const {
    auto alert = Of(kLandTrack, state);
    alert.distance_m = distance_m;
    alert.bearing_rad = WrapTo2Pi(DegToRad(bearing_deg));
    return alert;
  }
  // Before tracks are forgotten, all of which had an alert that was acknowledged.
  void Keep(const std::vector<Track>& tracks, const Datum& datum = kHere, AlertLevel level = AlertLevel::kWarning) {
    std::vector<Alert> alerts;
    for (const auto& track : tracks) alerts.push_back(Of(track.id, AlertState::kAcknowledged, level));
    kept_.Keep(time_, datum, alerts, tracks);
  }
  // How many of the alerts that come up now, of these tracks, are acknowledged.
  std::size_t Take(const std::vector<Track>& tracks, const Datum& datum = kHere, AlertLevel level = AlertLevel::kWarning) {
    std::vector<Alert> alerts;
    for (const auto& track : tracks) alerts.push_back(Of(track.id, AlertState::kActive, level));
    return kept_.Take(time_, datum, alerts, tracks).size();
  }

  Utime time_{seconds(1'700'000'000)};
  KeptAcknowledgements kept_;
};

TEST_F(KeptAcknowledgementsTest, CountOnceForWhatIsRaisedAgainWhereItWouldBe) {
  Keep({TrackAt(1, 20.0, -2.0)});
  time_ += seconds(3);
  EXPECT_EQ(Take({TrackAt(8, 20.0)}), 0U) << "it would be 6 m nearer by now";
  EXPECT_EQ(Take({TrackAt(9, 14.0), TrackAt(10, 15.0)}), 1U);
  EXPECT_EQ(Take({TrackAt(9, 14.0)}), 0U);
}

// The lidar begins anew twice within seconds: the second time nothing had been raised again, and nothing was known of the first any more.
TEST_F(KeptAcknowledgementsTest, OutliveAnotherBeginWithNoneOrOthers) {
  Keep({TrackAt(1, 20.0)});
  time_ += seconds(1);
  Keep({});
  time_ += seconds(1);
  Keep({TrackAt(5, 50.0)});
  time_ += seconds(2);
  EXPECT_EQ(Take({TrackAt(8, 20.0), TrackAt(9, 50.0)}), 2U);
}

TEST_F(KeptAcknowledgementsTest, AreKeptForTenSecondsFromWhenTheyWereKeptThemselves) {
  Keep({TrackAt(1, 20.0)});
  time_ += seconds(9);
  Keep({TrackAt(5, 50.0)});
  time_ += milliseconds(1100);
  EXPECT_EQ(Take({TrackAt(8, 20.0), TrackAt(9, 50.0)}), 1U);
}

TEST_F(KeptAcknowledgementsTest, OfAnotherMapAcknowledgeNothingThere) {
  Keep({TrackAt(1, 20.0)}, kHere);
  time_ += seconds(1);
  Keep({TrackAt(2, 50.0)}, kThere);
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(8, 20.0), TrackAt(9, 50.0)}, kThere), 1U) << "at 20 m stood something of the other map";
  EXPECT_EQ(Take({TrackAt(8, 20.0), TrackAt(9, 50.0)}, kHere), 1U) << "and the map is the first again";
}

TEST_F(KeptAcknowledgementsTest, OfLandCountForLandAlone) {
  kept_.Keep(time_, kHere, std::vector{OfLand(AlertState::kAcknowledged), Of(kUnnamed, AlertState::kAcknowledged)}, {});
  time_ += seconds(1);
  kept_.Keep(time_, kHere, std::vector{OfLand(AlertState::kAcknowledged)}, {});
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(8, 0.0)}), 0U);
  const std::vector land{OfLand(AlertState::kActive)};
  EXPECT_TRUE(kept_.Take(time_, kThere, land, {}).empty());
  EXPECT_EQ(kept_.Take(time_, kHere, land, {}).size(), 1U);
  EXPECT_TRUE(kept_.Take(time_, kHere, land, {}).empty()) << "the second replaced the first";
}

// The quay to port was acknowledged, the process began anew before a wall ahead: that nobody had been told of.
TEST_F(KeptAcknowledgementsTest, OfLandAreOfItsSideAndDistance) {
  kept_.Keep(time_, kHere, std::vector{OfLand(AlertState::kAcknowledged, 6.0, -90.0)}, {});
  time_ += seconds(1);
  const auto is_taken = [this](double distance_m, double bearing_deg) {
    return !kept_.Take(time_, kHere, std::vector{OfLand(AlertState::kActive, distance_m, bearing_deg)}, {}).empty();
  };
  EXPECT_FALSE(is_taken(6.0, 0.0));
  EXPECT_FALSE(is_taken(2.9, -90.0));
  EXPECT_FALSE(is_taken(kNan, -90.0));
  EXPECT_TRUE(is_taken(5.0, -70.0));
}

TEST_F(KeptAcknowledgementsTest, OfTheSameThingReplaceTheOlder) {
  Keep({TrackAt(1, 20.0, -2.0)});
  time_ += seconds(2);
  Keep({TrackAt(6, 16.5)}, kHere, AlertLevel::kCaution);
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(8, 16.0)}), 0U) << "it is graver than what people last took note of";
  EXPECT_EQ(Take({TrackAt(8, 16.0)}, kHere, AlertLevel::kCaution), 1U);
  EXPECT_EQ(Take({TrackAt(9, 16.0)}, kHere, AlertLevel::kCaution), 0U);
}

// A warning of one buoy was acknowledged; all cautions within 5 m of it were for 10 s, and one of them was a kayak.
TEST_F(KeptAcknowledgementsTest, AreOfOneThingTheNearest) {
  Keep({TrackAt(1, 20.0)});
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(9, 16.0), TrackAt(8, 20.5)}, kHere, AlertLevel::kCaution), 1U);
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(9, 16.0)}, kHere, AlertLevel::kCaution), 0U);
  EXPECT_EQ(Take({TrackAt(9, 16.0)}), 0U) << "a warning neither";
  EXPECT_EQ(Take({TrackAt(8, 20.5)}), 1U) << "it was just seen, and is a warning again";
  EXPECT_EQ(Take({TrackAt(8, 20.5)}), 0U);
}

// Two buoys 3 m apart, of which the second time only one was acknowledged again so far.
TEST_F(KeptAcknowledgementsTest, OfNeighboursReplaceOneEachTheNearest) {
  Keep({TrackAt(1, 20.0), TrackAt(2, 23.0)});
  time_ += seconds(1);
  Keep({TrackAt(6, 23.2)});
  time_ += seconds(1);
  EXPECT_EQ(Take({TrackAt(8, 16.0)}), 1U) << "of the buoy at 20 m";
  EXPECT_EQ(Take({TrackAt(9, 27.0)}), 1U) << "of that at 23 m";
  EXPECT_EQ(Take({TrackAt(10, 21.0)}), 0U);
}

TEST_F(KeptAcknowledgementsTest, AreForgottenWhereTimeGoesBack) {
  Keep({TrackAt(1, 20.0)});
  time_ -= seconds(100);
  EXPECT_EQ(Take({TrackAt(8, 20.0)}), 0U);
  time_ += seconds(101);
  EXPECT_EQ(Take({TrackAt(8, 20.0)}), 0U);
}

}  // namespace
}  // namespace lookout::tracker::kept
