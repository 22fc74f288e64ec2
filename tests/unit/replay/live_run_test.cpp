// The tracker, live and replayed: acknowledgements that a person gave, and a process that was restarted in mid-run.
#include "tools/replay/live_run.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/replay/live_run_fixture.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout::replay {
namespace {

TEST_F(LiveRun, TakesAcknowledgementsWithTheScansWithWhichTheyWereTaken) {
  Start();
  std::optional<alert_ack_t> waiting;  // to be recorded
  int num_sent = 0;
  for (int i = 0; i < 150; ++i) {
    SendScan(i);
    if (waiting && i % 3 == 0) {
      Record("ALERT_ACK", bus::Encode(*waiting));  // the recorder heard it later than the tracker
      waiting.reset();
    } else if (active_ && !waiting) {
      waiting.emplace();
      waiting->source = "page";
      waiting->seq = num_sent++;
      waiting->alert_id = active_->id;
      waiting->alert_raised_utime_us = active_->raised_utime_us;
      Deliver(bus::kAlertAck, *waiting);
    }
  }
  ASSERT_GE(num_sent, 1) << "no alert came up";
  int num_taken = 0;
  for (const auto& bytes : live_.at("ALERTS")) num_taken += bus::Decode<alerts_t>(bytes).value().num_acknowledged;
  EXPECT_GE(num_taken, 1);
  ExpectReplayEqualsLive();
}

// Silence and another mode: which scan they came with no input tells.
TEST_F(LiveRun, TakesOrdersWithTheScansWithWhichTheyWereTaken) {
  Start();
  for (int i = 0; i < 150; ++i) {
    SendScan(i);
    if (i % 40 != 20) continue;
    order_t order{};
    order.utime_us = i;
    order.seq = i;
    order.source = "page";
    order.kind = order_t::KIND_SILENCE;
    if (i % 80 == 20) order.kind = order_t::KIND_SETTINGS;
    order.mode = order_t::MODE_HARBOUR;
    order.guard_zone_range_m = 30.0F;
    order.guard_zone_from_rad = order.guard_zone_to_rad = order.cpa_limit_m = std::numeric_limits<float>::quiet_NaN();
    Deliver(bus::kOrders, order);
    Record("ORDERS", bus::Encode(order));
  }
  int num_taken = 0;
  for (const auto& bytes : live_.at("ALERTS")) num_taken += bus::Decode<alerts_t>(bytes).value().num_orders;
  EXPECT_EQ(num_taken, 4);
  EXPECT_EQ(bus::Decode<alerts_t>(live_.at("ALERTS").back()).value().mode, std::int32_t{order_t::MODE_HARBOUR});
  ExpectReplayEqualsLive();
}

// The buoy ahead has a name, also where its track has another number: after the lidar began anew, and after the process was killed.
TEST_F(LiveRun, KeepsNamesOverARestartAndInAReplay) {
  const auto names = [this] { return LastAlerts().given_name; };
  Start();
  for (int i = 0; i < 20; ++i) SendScan(i);
  order_t order{};
  order.source = "page";
  order.kind = order_t::KIND_NAME;
  order.name = "Anna's mooring buoy";
  order.track_id = 77;
  Deliver(bus::kOrders, order);
  order.track_id = bus::Decode<tracks_t>(live_.at("TRACKS").back()).value().tracks.back().id;
  Deliver(bus::kOrders, order);
  for (int i = 20; i < 30; ++i) SendScan(i);
  EXPECT_EQ(LastAlerts().named_track_id, std::vector{order.track_id});
  EXPECT_EQ(names(), std::vector{order.name});
  for (int i = 30; i < 60; ++i) SendScan(i, i - 30);
  EXPECT_EQ(names(), std::vector{order.name});
  EXPECT_NE(LastAlerts().named_track_id, std::vector{order.track_id});
  process_.reset();  // killed
  for (int i = 60; i < 70; ++i) SendScan(i, i - 30);
  Start();
  for (int i = 70; i < 170; ++i) SendScan(i, i - 30);
  EXPECT_EQ(names(), std::vector{order.name});
  ASSERT_EQ(LastAlerts().num_alerts, 1);
  EXPECT_EQ(LastAlerts().alerts[0].name, order.name);
  EXPECT_EQ(LastAlerts().alerts[0].text.find(order.name), 0U);
  ExpectReplayEqualsLive();
}

// The navigator finds that it was wrong by 40 m; then its map gets another datum.
TEST_F(LiveRun, KeepsNamesWhereThePositionJumpsOrTheDatumChanges) {
  Start();
  for (int i = 0; i < 20; ++i) SendScan(i);
  order_t order{};
  order.source = "page";
  order.kind = order_t::KIND_NAME;
  order.name = "Anna's mooring buoy";
  order.track_id = bus::Decode<tracks_t>(live_.at("TRACKS").back()).value().tracks.back().id;
  Deliver(bus::kOrders, order);
  for (int i = 20; i < 30; ++i) SendScan(i);
  ASSERT_EQ(LastAlerts().named_track_id, std::vector{order.track_id});
  moved_m_ = 40.0;
  for (int i = 30; i < 60; ++i) SendScan(i);
  ASSERT_EQ(LastAlerts().given_name, std::vector{order.name});
  const auto after_jump = LastAlerts().named_track_id;
  EXPECT_NE(after_jump, std::vector{order.track_id});
  moved_m_ = -100.0;
  moved_deg_ = 0.001;
  for (int i = 60; i < 90; ++i) SendScan(i);
  EXPECT_EQ(LastAlerts().given_name, std::vector{order.name});
  EXPECT_NE(LastAlerts().named_track_id, after_jump);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, BeginsAnewWhereTheProcessWasRestarted) {
  Start();
  for (int i = 0; i < 40; ++i) SendScan(i);
  process_.reset();  // killed
  for (int i = 40; i < 50; ++i) SendScan(i);
  Start();
  for (int i = 50; i < 120; ++i) SendScan(i);
  EXPECT_LE(live_.at("TRACKS").size(), 110U);
  EXPECT_GE(live_.at("TRACKS").size(), 108U);
  const auto begin = bus::Decode<alerts_t>(live_.at("ALERTS").back()).value().begin_seq;
  EXPECT_GE(begin, 50);
  EXPECT_LE(begin, 51);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, BeginsWhereTheFirstProcessBegan) {
  for (int i = 0; i < 10; ++i) SendScan(i);
  Start();
  for (int i = 10; i < 60; ++i) SendScan(i);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, WithoutAlertsInTheLogTakesAcknowledgementsAsTheyCome) {
  for (int i = 0; i < 60; ++i) SendScan(i);
  EXPECT_FALSE(ReadScript({}));
  const auto messages = Replay();
  EXPECT_EQ(messages.at("TRACKS").size(), 60U);
  EXPECT_EQ(messages.at("ALERTS").size(), 60U);
}

// What people took note of they need not take note of again.
TEST_F(LiveRun, TakesAcknowledgementsOverFromTheProcessThatWasKilled) {
  Start();
  int number = AcknowledgeTheWarning();
  ASSERT_GT(number, 0) << "no warning came up";
  process_.reset();  // killed
  const int gone = number + 10;
  for (; number < gone; ++number) SendScan(number);
  Start();
  const int begin = number;
  for (; number < begin + 10; ++number) SendScan(number);
  ASSERT_GE(LastAlerts().begin_seq, begin);
  ASSERT_EQ(LastAlerts().num_alerts, 1) << "what still holds is raised again within 1 s";
  EXPECT_EQ(LastAlerts().alerts[0].state, alert_t::STATE_ACKNOWLEDGED);
  EXPECT_LE(NumActive(LastAlerts().begin_seq), 1);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, TakesNoAcknowledgementOverFromLongAgo) {
  Start();
  int number = AcknowledgeTheWarning();
  ASSERT_GT(number, 0);
  process_.reset();
  // It lies still, for longer than they are kept: then people want to be told.
  const auto gone_for = std::chrono::duration_cast<std::chrono::milliseconds>(tracker::KeptAcknowledgements::kKeptFor).count() / 100 + 5;
  auto before = handover_.Read();
  ASSERT_TRUE(before);
  before->time -= std::chrono::milliseconds(100 * gone_for);
  tracker::KeptAcknowledgements kept;
  kept.Keep(before->time, before->datum, before->alerts, before->tracks);
  auto alert = before->alerts.at(0);
  alert.state = tracker::AlertState::kActive;
  alert.raised = before->time + std::chrono::milliseconds(100 * gone_for);
  EXPECT_TRUE(kept.Take(alert.raised, before->datum, std::vector{alert}, before->tracks).empty());
  kept.Keep(before->time, before->datum, before->alerts, before->tracks);
  EXPECT_EQ(kept.Take(alert.raised - std::chrono::seconds(2), before->datum, std::vector{alert}, before->tracks).size(), 1U);
}

TEST_F(LiveRun, LeavesNothingBehindWithoutAnAcknowledgedAlert) {
  support::WriteFile(folder_ / "alerts.lcmlog", "what is no log");
  Start();
  for (int i = 0; i < 5; ++i) SendScan(i);
  EXPECT_FALSE(fs::exists(folder_ / "alerts.lcmlog"));
  EXPECT_EQ(live_.at("ALERTS").size(), 4U);
}

// The lidar, too, may begin anew; the tracker raises again what holds, and its replay does so with the same scans.
TEST_F(LiveRun, TakesAcknowledgementsOverWhereTheLidarBeganAnew) {
  Start();
  int number = AcknowledgeTheWarning();
  ASSERT_GT(number, 0);
  for (int seq = 0; seq < 20; ++seq, ++number) SendScan(number, seq);
  bool is_told = false;
  for (const auto& bytes : live_.at("ALERTS")) {
    const auto message = bus::Decode<alerts_t>(bytes).value();
    is_told |= std::ranges::any_of(message.acknowledged, [](const alert_ack_t& one) { return one.source == "tracker"; });
  }
  EXPECT_TRUE(is_told);
  ExpectReplayEqualsLive();
}

// At SIGTERM a scan waits for its POSE, which comes later and is recorded. What the tracker would make of it without, no replay could know.
TEST_F(LiveRun, StoppedWhileAScanWaitsLeavesItToNobody) {
  Start();
  for (int i = 0; i < 20; ++i) SendScan(i);
  SendSight(20, 20);
  SendObstacles(20, 20);
  ASSERT_GE(process_->service.num_waiting(), 1);
  process_.reset();
  SendPoses(20);
  SendPoses(21);
  for (int i = 22; i < 25; ++i) SendScan(i);
  Start();
  for (int i = 25; i < 40; ++i) SendScan(i);
  ExpectReplayEqualsLive();
}

// The ALERTS of a second tracker lie between those of the first, which goes on. From the first of them on, replay left out all scans.
TEST_F(LiveRun, IsNotTornByASecondTracker) {
  Start();
  bool is_heard = true;
  bus::Subscribe<alerts_t>(process_->bus, bus::kAlerts, [&](const alerts_t& message) {
    if (is_heard && message.seq >= 20 && message.seq % 3 == 0) RecordOfSecondTracker(message);
  });
  int number = AcknowledgeTheWarning();
  ASSERT_GT(number, 0) << "no warning came up";
  is_heard = false;
  for (const int end = number + 10; number < end; ++number) SendScan(number);
  EXPECT_EQ(LastAlerts().alerts.at(0).state, alert_t::STATE_ACKNOWLEDGED);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, BeginsAnewWhereTheFirstProcessWasRestartedBesideASecondTracker) {
  const auto hear_second = [this](int number) {
    if (number % 20 == 10) RecordOfSecondTracker(LastAlerts());
  };
  Start();
  for (int i = 0; i < 40; ++i) SendScan(i), hear_second(i);
  process_.reset();  // killed
  for (int i = 40; i < 55; ++i) SendScan(i), hear_second(i);
  Start();
  for (int i = 55; i < 120; ++i) SendScan(i), hear_second(i);
  EXPECT_GE(LastAlerts().begin_seq, 55);
  ExpectReplayEqualsLive();
}

// Neither lies within the other: the last of the log is the one that goes on, from its first ALERTS on.
TEST_F(LiveRun, OfTwoTrackersThatOverlapFollowsTheOneThatGoesOn) {
  const auto record = [this](std::int64_t begin_seq, std::int64_t seq) {
    alerts_t message{};
    message.begin_seq = begin_seq;
    message.begin_utime_us = test::kStartUs + test::kScanUs * begin_seq;
    message.seq = seq;
    message.utime_us = test::kStartUs + test::kScanUs * seq;
    alert_ack_t acknowledgement{};
    acknowledgement.alert_id = begin_seq + 1;
    message.acknowledged = {acknowledgement};
    message.num_acknowledged = 1;
    Record(bus::kAlerts.name, bus::Encode(message));
  };
  for (const int seq : {0, 1, 2, 3}) record(0, seq);
  record(2, 3);  // a third, for a moment
  record(0, 4);
  for (const int seq : {5, 6, 7}) record(5, seq), record(0, seq);
  for (const int seq : {8, 9}) record(5, seq);
  writer_.Flush();
  support::WriteFile(log_, std::string(bytes_.begin(), bytes_.end()));
  const auto script = ReadScript({log_}).value();
  const auto key = [](std::int64_t seq) { return tracker::ScanKey{Utime(std::chrono::microseconds(test::kStartUs + test::kScanUs * seq)), seq}; };
  ASSERT_EQ(script.stretches.size(), 2U);
  EXPECT_TRUE(script.stretches[0].begin == key(0));
  EXPECT_TRUE(script.stretches[0].last == key(4));
  EXPECT_TRUE(script.stretches[1].begin == key(5));
  EXPECT_TRUE(script.stretches[1].last == key(9));
  ASSERT_EQ(script.acknowledged.size(), 10U);
  for (const auto& [scan, acknowledgements] : script.acknowledged) {
    ASSERT_EQ(acknowledgements.size(), 1U) << scan.seq;
    EXPECT_EQ(acknowledgements[0].alert_id, scan.seq < 5 ? 1 : 6) << scan.seq;
  }
}

// The last scan of the run waits for a POSE that never comes.
TEST_F(LiveRun, AtTheEndLeavesOutWhatTheLiveRunLeftOut) {
  Start();
  for (int i = 0; i < 20; ++i) SendScan(i);
  SendSight(20, 20);
  SendObstacles(20, 20);
  ExpectReplayEqualsLive();
}

// A computer without a clock of its own: time goes back when the first fix comes, then the tracker is killed.
TEST_F(LiveRun, FollowsARunInWhichTimeWentBack) {
  Start();
  for (int i = 3000; i < 3040; ++i) SendScan(i);
  for (int i = 0; i < 30; ++i) SendScan(i);
  process_.reset();
  for (int i = 30; i < 40; ++i) SendScan(i);
  Start();
  for (int i = 40; i < 60; ++i) SendScan(i);
  EXPECT_GT(live_.at("TRACKS").size(), 80U);
  ExpectReplayEqualsLive();
}

// OBSTACLES and POSE from elsewhere, and no more.
TEST_F(LiveRun, OfObstaclesAndPosesAloneKnowsNoSight) {
  for (int i = 0; i < 60; ++i) SendScan(i);
  writer_.Flush();
  support::WriteFile(log_, std::string(bytes_.begin(), bytes_.end()));
  bytes_.clear();
  {
    bus::LogReader reader(log_);
    bus::LogWriter some([this](Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); });
    while (const auto event = reader.Next()) {
      if (event->channel == "OBSTACLES" || event->channel == "POSE") some.Write(event->time, event->channel, event->bytes);
    }
    some.Flush();
  }
  const auto messages = Replay();
  ASSERT_EQ(messages.at("TRACKS").size(), 60U);
  for (const auto& bytes : messages.at("TRACKS")) EXPECT_EQ(bus::Decode<tracks_t>(bytes).value().sight, tracks_t::SIGHT_UNKNOWN);
}

}  // namespace
}  // namespace lookout::replay
