#include <gtest/gtest.h>
#include <map>
#include <vector>

#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;
using test::MakeNotice;
using test::MakeTarget;

std::vector<std::int64_t> Ids(const std::vector<const Target*>& targets) {
  std::vector<std::int64_t> ids;
  for (const auto* target : targets) ids.push_back(target->id);
  return ids;
}

TEST(PlotterTargetSchedule, SendsEachTargetOnceAPeriod) {
  TargetSchedule schedule(2500ms);
  const std::vector<Target> targets{MakeTarget(1), MakeTarget(2)};
  EXPECT_EQ(Ids(schedule.Due(targets, 0ms)), (std::vector<std::int64_t>{1, 2}));
  for (const auto& target : targets) schedule.NoteSent(target, test::kTime, 0, 100ms);
  EXPECT_TRUE(schedule.Due(targets, 2599ms).empty());
  EXPECT_EQ(schedule.Due(targets, 2600ms).size(), 2U);
}

TEST(PlotterTargetSchedule, SendsDangerousOnesFirstAndThenWhatHasWaitedLongest) {
  TargetSchedule schedule(2500ms);
  std::vector<Target> targets{MakeTarget(5), MakeTarget(1), MakeTarget(2), MakeTarget(3)};
  targets[0].level = Level::kWarning;
  schedule.NoteSent(targets[0], test::kTime, 0, 0ms);
  schedule.NoteSent(targets[1], test::kTime, 1, 300ms);
  schedule.NoteSent(targets[2], test::kTime, 2, 100ms);
  EXPECT_EQ(Ids(schedule.Due(targets, 5000ms)), (std::vector<std::int64_t>{5, 3, 2, 1}));
}

TEST(PlotterTargetSchedule, LetsManyDangerousOnesTakeTurnsAndTheOthersToo) {
  TargetSchedule schedule(2500ms);
  std::vector<Target> targets;
  for (int id = 1; id <= 40; ++id) targets.push_back(MakeTarget(id));
  for (int i = 0; i < 30; ++i) targets[static_cast<std::size_t>(i)].level = Level::kWarning;
  std::map<std::int64_t, int> counts;
  for (auto now = 0ms; now < 60s; now += 250ms) {  // four a second
    const auto due = schedule.Due(targets, now);
    if (due.empty()) continue;
    ++counts[due.front()->id];
    schedule.NoteSent(*due.front(), test::kTime, 0, now);
  }
  EXPECT_EQ(counts.size(), 40U);
  EXPECT_GE(counts[30], 2 * counts[40]);
}

TEST(PlotterTargetSchedule, SaysWhereWhatHasEndedIsNow) {
  TargetSchedule schedule(2500ms);
  const auto target = MakeTarget(1);  // 1 m/s to the south
  schedule.NoteSent(target, test::kTime, 0, 0ms);
  const auto ended = EndedAt(schedule.TakeEnded({}).at(0), test::kTime + 2s);
  EXPECT_NEAR(RangeAndBearingOf(target.position, ended.position).range_m, 2.0, 1e-3);
  EXPECT_LT(ended.position.latitude_deg, target.position.latitude_deg);
}

TEST(PlotterTargetSchedule, TellsOnceWhatHasEnded) {
  TargetSchedule schedule(2500ms);
  schedule.NoteSent(MakeTarget(1), test::kTime, 8, 0ms);
  schedule.NoteSent(MakeTarget(2), test::kTime, 9, 0ms);
  const std::vector<Target> targets{MakeTarget(2)};
  const auto ended = schedule.TakeEnded(targets);
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].target.id, 1);
  EXPECT_EQ(ended[0].target.state, TargetState::kLost);
  EXPECT_EQ(ended[0].number, 8);
  EXPECT_TRUE(schedule.TakeEnded(targets).empty());
}

TEST(PlotterTargetSchedule, SendsAllToANewReceiver) {
  TargetSchedule schedule(2500ms);
  const std::vector<Target> targets{MakeTarget(1)};
  schedule.NoteSent(targets[0], test::kTime, 0, 0ms);
  schedule.SendAnew();
  EXPECT_EQ(schedule.Due(targets, 1ms).size(), 1U);
  EXPECT_EQ(schedule.TakeEnded({}).size(), 1U);
}

TEST(PlotterNoticeSchedule, SendsWhatIsNewOrChangedAndRepeatsTheRest) {
  NoticeSchedule schedule;
  std::vector<Notice> notices{MakeNotice()};
  ASSERT_EQ(schedule.Take(notices, 0s).size(), 1U);
  EXPECT_TRUE(schedule.Take(notices, 9s).empty());
  notices[0].text = "boat 17: closest approach 2 m in 20 s";  // changes with each scan
  EXPECT_TRUE(schedule.Take(notices, 9s).empty());
  ASSERT_EQ(schedule.Take(notices, 10s).size(), 1U);
  notices[0].state = NoticeState::kAcknowledged;
  const auto changed = schedule.Take(notices, 11s);
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].revision, 2);
  schedule.SendAnew();
  EXPECT_EQ(schedule.Take(notices, 12s).size(), 1U);
}

TEST(PlotterNoticeSchedule, SendsWhichOneSoundsAtOnce) {
  NoticeSchedule schedule;
  std::vector<Notice> notices{MakeNotice(1), MakeNotice(2)};
  notices[0].sound = Sound::kSounds;
  EXPECT_EQ(schedule.Take(notices, 0s).size(), 2U);
  std::swap(notices[0].sound, notices[1].sound);
  EXPECT_EQ(schedule.Take(notices, 1s).size(), 2U);
  EXPECT_TRUE(schedule.Take(notices, 2s).empty());
}

TEST(PlotterNoticeSchedule, TellsTheEndOnce) {
  NoticeSchedule schedule;
  std::vector<Notice> notices{MakeNotice(1), MakeNotice(2)};
  schedule.Take(notices, 0s);
  notices[0].state = NoticeState::kCleared;
  notices.pop_back();  // vanished: the message that cleared it was lost
  const auto ended = schedule.Take(notices, 1s);
  ASSERT_EQ(ended.size(), 2U);
  for (const auto& due : ended) EXPECT_EQ(due.notice.state, NoticeState::kCleared);
  EXPECT_TRUE(schedule.Take(notices, 2s).empty());
}

// One lost message must leave no alarm standing.
TEST(PlotterNoticeSchedule, RepeatsTheEndTwiceAndToNewReceivers) {
  NoticeSchedule schedule;
  schedule.Take(std::vector<Notice>{MakeNotice()}, 0s);
  int num_told = 0;
  for (auto now = 1s; now < 60s; now += 1s) {
    for (const auto& due : schedule.Take({}, now)) {
      EXPECT_EQ(due.notice.state, NoticeState::kCleared);
      ++num_told;
    }
  }
  EXPECT_EQ(num_told, 3);
  schedule.SendAnew();
  EXPECT_EQ(schedule.Take({}, 61s).size(), 1U);
  EXPECT_TRUE(schedule.Take({}, 70s).empty());
  schedule.SendAnew();
  EXPECT_TRUE(schedule.Take({}, 11min).empty());
}

// A tracker that began anew gives the same ids to other alerts.
TEST(PlotterNoticeSchedule, EndsTheAlertOfARestartedTracker) {
  NoticeSchedule schedule;
  schedule.Take(std::vector<Notice>{MakeNotice(1)}, 0s);
  auto other = MakeNotice(1);
  other.cause = Cause::kGuardZone;
  other.raised += 1s;
  const auto due = schedule.Take(std::vector<Notice>{other}, 1s);
  ASSERT_EQ(due.size(), 2U);
  EXPECT_EQ(due[0].notice.cause, Cause::kGuardZone);
  EXPECT_EQ(due[0].notice.state, NoticeState::kActive);
  EXPECT_EQ(due[1].notice.cause, Cause::kClosestApproach);
  EXPECT_EQ(due[1].notice.state, NoticeState::kCleared);
}

TEST(PlotterNoticeSchedule, LeavesWhatIsOldAsItWasTold) {
  NoticeSchedule schedule;
  std::vector<Notice> notices{MakeNotice()};
  schedule.Take(notices, 0s);
  notices[0].is_old = true;
  EXPECT_TRUE(schedule.Take(notices, 30s).empty());
  notices[0].is_old = false;
  EXPECT_EQ(schedule.Take(notices, 31s).size(), 1U);
}

// Dangerous again within 10 s it is the same alert: a receiver that heard "over" of it afterwards took it off.
TEST(PlotterNoticeSchedule, TellsNoEndOfWhatIsThereAgain) {
  NoticeSchedule schedule;
  const std::vector<Notice> notices{MakeNotice(3)};
  EXPECT_EQ(schedule.Take(notices, 0s).at(0).revision, 1);
  EXPECT_EQ(schedule.Take({}, 1s).at(0).revision, 2);
  const auto again = schedule.Take(notices, 2s);
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].notice.state, NoticeState::kActive);
  EXPECT_EQ(again[0].revision, 3);
  for (auto now = 2100ms; now < 11s; now += 100ms) EXPECT_TRUE(schedule.Take(notices, now).empty());
}

TEST(PlotterNoticeSchedule, GoesOnWithTheRevisionsOfTheProcessBefore) {
  NoticeSchedule before;
  std::vector<Notice> notices{MakeNotice(3), MakeNotice(4), MakeNotice(5)};
  before.Take(notices, 0s);
  notices[0].state = notices[1].state = NoticeState::kAcknowledged;
  before.Take(notices, 1s);
  NoticeSchedule schedule;
  schedule.Recall(before.Standing());
  notices[1].state = NoticeState::kRectified;
  notices.push_back(MakeNotice(6));
  const auto due = schedule.Take(notices, 0s);
  ASSERT_EQ(due.size(), 4U);
  EXPECT_EQ(due[0].revision, 2) << "unchanged";
  EXPECT_EQ(due[1].revision, 3) << "changed meanwhile";
  EXPECT_EQ(due[2].revision, 1);
  EXPECT_EQ(due[3].revision, 1);
}

// Ended, and there again after a restart: revision 1 was told a second time, which the receiver knew.
TEST(PlotterNoticeSchedule, GoesOnWithTheRevisionOfWhatEndedBeforeTheRestart) {
  const std::vector<Notice> notices{MakeNotice(3)};
  NoticeSchedule before;
  before.Take(notices, 0s);
  EXPECT_EQ(before.Take({}, 1s).at(0).revision, 2);
  // Two restarts within ten minutes, the first of a process that told nothing.
  NoticeSchedule between;
  between.Recall(before.Kept());
  EXPECT_TRUE(between.Take({}, 0s).empty());
  EXPECT_TRUE(between.Standing().empty());
  NoticeSchedule schedule;
  schedule.Recall(between.Kept());
  ASSERT_EQ(schedule.Take(notices, 3s).size(), 1U);
  EXPECT_EQ(schedule.Standing().at(0).revision, 3);
  EXPECT_EQ(schedule.Kept().size(), 1U);
  // After ten minutes nobody waits for it any more.
  between.Take({}, 10min);
  EXPECT_TRUE(between.Kept().empty());
}

}  // namespace
}  // namespace lookout::plotter
