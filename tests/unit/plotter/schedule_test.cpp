#include <gtest/gtest.h>

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
  for (const auto& target : targets) schedule.NoteSent(target, 0, 100ms);
  EXPECT_TRUE(schedule.Due(targets, 2599ms).empty());
  EXPECT_EQ(schedule.Due(targets, 2600ms).size(), 2U);
}

TEST(PlotterTargetSchedule, SendsDangerousOnesFirstAndThenWhatHasWaitedLongest) {
  TargetSchedule schedule(2500ms);
  std::vector<Target> targets{MakeTarget(5), MakeTarget(1), MakeTarget(2), MakeTarget(3)};
  targets[0].level = Level::kWarning;
  schedule.NoteSent(targets[0], 0, 0ms);
  schedule.NoteSent(targets[1], 1, 300ms);
  schedule.NoteSent(targets[2], 2, 100ms);
  EXPECT_EQ(Ids(schedule.Due(targets, 5000ms)), (std::vector<std::int64_t>{5, 3, 2, 1}));
}

TEST(PlotterTargetSchedule, TellsOnceWhatHasEnded) {
  TargetSchedule schedule(2500ms);
  schedule.NoteSent(MakeTarget(1), 8, 0ms);
  schedule.NoteSent(MakeTarget(2), 9, 0ms);
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
  schedule.NoteSent(targets[0], 0, 0ms);
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

TEST(PlotterNoticeSchedule, LeavesWhatIsOldAsItWasTold) {
  NoticeSchedule schedule;
  std::vector<Notice> notices{MakeNotice()};
  schedule.Take(notices, 0s);
  notices[0].is_old = true;
  EXPECT_TRUE(schedule.Take(notices, 30s).empty());
  notices[0].is_old = false;
  EXPECT_EQ(schedule.Take(notices, 31s).size(), 1U);
}

}  // namespace
}  // namespace lookout::plotter
