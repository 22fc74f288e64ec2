#include "services/tracker/core/names.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "services/tracker/core/look_out.hpp"

namespace lookout::tracker::named {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Utime kBegin{seconds(1'700'000'000)};
const Datum kHere{60.0, 20.0, 0.0};

Track TrackAt(std::int64_t id, double east_m, TrackKind kind = TrackKind::kBoat) {
  Track track;
  track.id = id;
  track.status = TrackStatus::kConfirmed;
  track.kind = kind;
  track.first = kBegin - seconds(10);
  track.position_m = track.rectangle.center_m = {east_m, 20.0};
  track.rectangle.length_m = track.rectangle.width_m = 1.0;
  track.outline_m = {{east_m - 0.5, 19.5}, {east_m + 0.5, 19.5}, {east_m + 0.5, 20.5}, {east_m - 0.5, 20.5}};
  track.existence_probability = 0.99;
  track.approach.distance_m = 20.0;
  track.approach.cpa_m = 1.0;
  track.approach.tcpa_s = 20.0;
  track.approach.probability = 0.99;
  return track;
}

class NamesOfThings : public ::testing::Test {
 protected:
  NamesOfThings() { own_.is_placed = true, own_.velocity_map_mps = {0.0, 1.0}; }
  void Order(std::int64_t track_id, const std::string& name) {
    tracker::Order order;
    order.kind = OrderKind::kName;
    order.track_id = track_id;
    order.name = name;
    look_out_.Take(order, time_);
  }
  void Scans(int number, const std::vector<Track>& tracks) {
    for (int i = 0; i < number; ++i) {
      time_ += milliseconds(100);
      picture_.tracks = tracks;
      for (auto& track : picture_.tracks) track.seen = time_;
      look_out_.Begin(own_);
      look_out_.Rename(picture_, time_);
      look_out_.Update(time_, true, picture_, {}, own_, {});
      picture_.merged.clear();
    }
  }
  std::string AlertName() const { return look_out_.alerts().empty() ? "no alert" : look_out_.alerts().front().name; }

  Pose own_;
  Utime time_ = kBegin;
  Picture picture_;
  LookOut look_out_{[] {
    LookOutParams params;
    params.limits.cpa_limit_m = 5.0;
    return params;
  }()};
};

TEST_F(NamesOfThings, StandInTheirAlertsAsLongAsTheyLive) {
  Scans(10, {TrackAt(7, 0.0)});
  EXPECT_EQ(AlertName(), "");
  Order(7, "Anna's boat");
  Order(8, "nobody");
  Scans(1, {TrackAt(7, 0.0)});
  EXPECT_EQ(AlertName(), "Anna's boat");
  EXPECT_EQ(look_out_.num_names_of_no_track(), 1);
  // It becomes part of another track; it is not seen any more; it is found again.
  picture_.merged = {{7, 9}};
  Scans(5, {TrackAt(9, 0.0)});
  EXPECT_EQ(AlertName(), "Anna's boat");
  Scans(30, {});
  EXPECT_EQ(AlertName(), "Anna's boat");
  auto again = TrackAt(11, 0.5);
  again.first = time_;
  Scans(15, {again});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(AlertName(), "Anna's boat");
  EXPECT_EQ(look_out_.names().All().size(), 1U);
  Order(11, "");
  Scans(1, {again});
  EXPECT_EQ(AlertName(), "");
  Order(11, "Anna's boat");
  Scans(1, {again});
  Scans(300, {});
  EXPECT_TRUE(look_out_.names().All().empty()) << "it is gone";
}

TEST_F(NamesOfThings, OfAStructureAreToldOfAllItsPieces) {
  std::vector<Track> pieces{TrackAt(3, 0.0, TrackKind::kStructure), TrackAt(5, 3.0, TrackKind::kStructure), TrackAt(6, 5.0)};
  pieces[0].approach.cpa_m = 0.5;  // the nearest
  pieces[0].approach.tcpa_s = 15.0;
  Scans(10, pieces);
  Order(5, "Kiosk pier");
  Order(6, "Anna's boat");
  Scans(1, pieces);
  EXPECT_EQ(look_out_.names().Of(3), "");
  EXPECT_EQ(look_out_.names().Of(5), "Kiosk pier") << "the track that was named";
  EXPECT_EQ(look_out_.names().Of(6), "Anna's boat");
  EXPECT_EQ(look_out_.alerts().front().nearest_track, 3);
  EXPECT_EQ(AlertName(), "Kiosk pier");
}

// The structure is called by its boat, which has the lowest id, and the boat leaves.
TEST_F(NamesOfThings, OfAPierStayWhereABoatCastsOff) {
  std::vector<Track> pieces{TrackAt(2, 0.0), TrackAt(5, 3.0, TrackKind::kStructure), TrackAt(6, 6.0, TrackKind::kStructure)};
  Scans(10, pieces);
  Order(5, "Kiosk pier");
  Scans(5, pieces);
  for (int i = 0; i < 50; ++i) {
    pieces[0] = TrackAt(2, -0.1 * i);
    pieces[0].velocity_mps = {-1.0, 0.0};
    Scans(1, pieces);
  }
  EXPECT_EQ(look_out_.names().Of(2), "");
  EXPECT_EQ(look_out_.names().Of(5), "Kiosk pier");
  for (const auto& alert : look_out_.alerts()) EXPECT_EQ(alert.name, alert.thing == 2 ? "" : "Kiosk pier") << alert.thing;
}

TEST_F(NamesOfThings, OfOneStructureTheLastThatWasGivenIsTold) {
  const std::vector<Track> pieces{TrackAt(3, 0.0, TrackKind::kStructure), TrackAt(5, 3.0, TrackKind::kStructure),
                                  TrackAt(6, 6.0, TrackKind::kStructure)};
  Scans(10, pieces);
  Order(6, "North pier");
  Order(5, "Kiosk pier");
  Scans(1, pieces);
  EXPECT_EQ(AlertName(), "Kiosk pier");
  EXPECT_EQ(look_out_.names().num_beside(), 1);
  Order(3, "");  // which has none of its own
  Scans(1, pieces);
  EXPECT_EQ(AlertName(), "North pier");
  EXPECT_EQ(look_out_.names().num_beside(), 0);
  // The named piece is gone; another of the pier goes on with the name.
  Scans(1, {pieces[0], pieces[1]});
  EXPECT_EQ(look_out_.names().Of(3), "North pier");
  EXPECT_EQ(AlertName(), "North pier");
}

TEST_F(NamesOfThings, OfTwoThatBecomeOneTheLaterStays) {
  Scans(10, {TrackAt(7, 0.0), TrackAt(8, 10.0)});
  Order(7, "Anna's boat");
  Order(8, "Berta");
  Scans(1, {TrackAt(7, 0.0), TrackAt(8, 10.0)});
  picture_.merged = {{8, 7}};
  Scans(1, {TrackAt(7, 0.0)});
  EXPECT_EQ(look_out_.names().Of(7), "Berta");
  EXPECT_EQ(look_out_.names().num_merged(), 1);
}

TEST(Names, AreBounded) {
  Names names;
  for (int id = 1; id <= 105; ++id) names.Give(id, "buoy", kBegin);
  names.Give(1, "other", kBegin);
  EXPECT_EQ(names.All().size(), Names::kMost);
  EXPECT_EQ(names.num_over_limit(), 5);
  EXPECT_EQ(names.Of(1), "other");
}

TEST(KeptNames, PassToTheTrackThatStandsWhereItWouldBe) {
  KeptNames kept;
  const Names none;
  auto moving = TrackAt(1, 20.0);
  moving.velocity_mps = {-2.0, 0.0};
  const std::vector<std::pair<std::int64_t, std::string>> names{{1, "Anna's boat"}, {2, "gone"}};
  kept.Keep(kBegin + seconds(1), kHere, names, std::vector{moving});
  auto far = TrackAt(4, 20.0), near = TrackAt(5, 14.5), old = TrackAt(3, 14.0);
  far.first = near.first = kBegin + seconds(2);
  EXPECT_TRUE(kept.Take(kBegin + seconds(4), {60.0, 20.5, 0.0}, std::vector{old, far, near}, none).empty()) << "another map";
  const auto orders = kept.Take(kBegin + seconds(4), kHere, std::vector{old, far, near}, none);
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].track_id, 5) << "not what was seen before";
  EXPECT_EQ(orders[0].name, "Anna's boat");
  EXPECT_TRUE(kept.Take(kBegin + seconds(5), kHere, std::vector{near}, none).empty()) << "once";
  kept.Keep(kBegin + seconds(5), kHere, names, std::vector{moving});
  EXPECT_TRUE(kept.Take(kBegin + seconds(16), kHere, std::vector{near}, none).empty());
}

// Two boats moored side by side: after a restart the one is confirmed a scan before the other.
TEST(KeptNames, OfNeighboursAreNotMixedUpByWhichIsConfirmedFirst) {
  for (const bool is_annas_first : {true, false}) {
    SCOPED_TRACE(is_annas_first);
    KeptNames kept;
    Names names;
    kept.Keep(kBegin, kHere, std::vector<std::pair<std::int64_t, std::string>>{{2, "Berta"}, {1, "Anna"}},
              std::vector{TrackAt(1, 20.0), TrackAt(2, 24.0)});
    auto annas = TrackAt(5, 20.2), bertas = TrackAt(6, 23.8);
    annas.first = bertas.first = kBegin + seconds(1);
    std::vector<Track> seen{is_annas_first ? annas : bertas};
    for (int scan = 0; scan < 2; ++scan) {
      for (const auto& order : kept.Take(kBegin + seconds(2 + scan), kHere, seen, names)) names.Give(order.track_id, order.name, order.time);
      if (scan == 0) seen = {annas, bertas};
    }
    EXPECT_EQ(names.Of(5), "Anna");
    EXPECT_EQ(names.Of(6), "Berta");
  }
}

}  // namespace
}  // namespace lookout::tracker::named
