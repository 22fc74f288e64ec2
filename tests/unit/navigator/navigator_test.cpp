#include "services/navigator/core/navigator.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/support/counters.hpp"
#include "tests/unit/navigator/filter_params.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

NavigatorParams NavigatorTestParams() {
  NavigatorParams params;
  params.max_sentence_latency = 2s;
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  return params;
}

class NavigatorTest : public ::testing::Test {
 protected:
  NavigatorOutput Mark(ItemKind kind, double time_s) { return navigator_.Consume({NoonPlus(time_s), seq_++, kind, {}, {}}); }
  NavigatorOutput Sentence(double time_s, const std::string& line, const char* source = kUdpSource) {
    return navigator_.Consume({NoonPlus(time_s), seq_++, ItemKind::kSentence, source, line});
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(navigator_, name); }
  static std::vector<double> TimesMs(const NavigatorOutput& output) {
    std::vector<double> times_ms;
    for (const auto& pose : output.poses) times_ms.push_back(std::chrono::duration<double, std::milli>(pose.time - NoonPlus(0)).count());
    return times_ms;
  }

  Navigator navigator_{NavigatorTestParams()};
  std::int64_t seq_ = 0;
};

// POSE after 2 s of motions by the lidar alone, as a log of a live run holds them.
PoseStatus StatusAfterMotions(bool uses_them) {
  auto params = NavigatorTestParams();
  params.use_lidar_odometry = uses_them;
  Navigator navigator(params);
  auto status = PoseStatus::kOk;
  for (int i = 0; i < 20; ++i) {
    OdometryMotion motion{NoonPlus(0.1 * i), NoonPlus(0.1 * i + 0.1), true, {0.1, 0.0}, 0.0, {}};
    motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal();
    const auto output = navigator.Consume({motion.end, i, ItemKind::kSentence, kOdometerSource, ToSentence(motion)});
    if (!output.poses.empty()) status = output.poses.back().status;
  }
  return status;
}

TEST(NavigatorOdometry, OfALogCountsNothingWhereTheConfigLeavesItOut) {
  EXPECT_EQ(StatusAfterMotions(true), PoseStatus::kRelative);
  EXPECT_EQ(StatusAfterMotions(false), PoseStatus::kUnknown);
}

// A lidar whose clock is ahead must not lead the frame of its own either.
TEST(NavigatorOdometry, AheadOfTheComputersClockIsNotUsed) {
  Navigator navigator(NavigatorTestParams());
  Pose pose;
  for (int i = 0; i < 20; ++i) {
    OdometryMotion motion{NoonPlus(0.1 * i + 30.0), NoonPlus(0.1 * i + 30.1), true, {0.1, 0.0}, 0.0, {}};
    motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal();
    const auto output = navigator.Consume({NoonPlus(0.1 * i), i, ItemKind::kSentence, kOdometerSource, ToSentence(motion)});
    if (!output.poses.empty()) pose = output.poses.back();
  }
  EXPECT_EQ(pose.status, PoseStatus::kRelativeToBoat);
  EXPECT_EQ(support::CountOf(navigator, "odometry_ahead"), 20);
  EXPECT_TRUE(navigator.HasOdometry());
}

// The tool that looks for the lidar's mounting must not read what that mounting has turned.
TEST(NavigatorLidarImu, CanBeLeftOut) {
  const auto num_read = [](bool uses, const char* source) {
    auto params = NavigatorTestParams();
    params.use_lidar_imu = uses;
    Navigator navigator(params);
    navigator.Consume({NoonPlus(0.0), 0, ItemKind::kStart, {}, {}});
    navigator.Consume({NoonPlus(0.1), 1, ItemKind::kSentence, source, Line("VNIMU,this,is,none")});
    return support::CountOf(navigator, "bad_field");  // what is read is refused
  };
  EXPECT_EQ(num_read(true, kLidarSource), 1);
  EXPECT_EQ(num_read(false, kLidarSource), 0);
  EXPECT_EQ(num_read(false, kUdpSource), 1);
}

TEST_F(NavigatorTest, MakesAPoseForEveryWhole20Ms) {
  EXPECT_EQ(TimesMs(Mark(ItemKind::kStart, 0.005)), std::vector<double>{});
  EXPECT_EQ(TimesMs(Mark(ItemKind::kTick, 0.0199)), std::vector<double>{});
  EXPECT_EQ(TimesMs(Mark(ItemKind::kTick, 0.02)), std::vector<double>{20});
  EXPECT_EQ(TimesMs(Mark(ItemKind::kTick, 0.02)), std::vector<double>{});
  EXPECT_EQ(TimesMs(Mark(ItemKind::kImu, 0.085)), (std::vector<double>{40, 60, 80}));
}

TEST_F(NavigatorTest, MakesAPoseAtAStartOnTheGrid) { EXPECT_EQ(TimesMs(Mark(ItemKind::kStart, 0.04)), std::vector<double>{40}); }

TEST_F(NavigatorTest, MakesOneMorePoseAtTheEnd) {
  Mark(ItemKind::kStart, 0.005);
  EXPECT_EQ(TimesMs(Mark(ItemKind::kEnd, 0.05)), (std::vector<double>{20, 40, 60}));
  EXPECT_EQ(TimesMs(navigator_.Flush()), std::vector<double>{});
}

TEST_F(NavigatorTest, MakesNoneBeyondAnEndOnTheGrid) {
  Mark(ItemKind::kStart, 0.005);
  EXPECT_EQ(TimesMs(Mark(ItemKind::kEnd, 0.04)), (std::vector<double>{20, 40}));
}

TEST_F(NavigatorTest, FlushesWhatHasNoEndMark) {
  EXPECT_EQ(TimesMs(navigator_.Flush()), std::vector<double>{});
  Mark(ItemKind::kStart, 0.005);
  Mark(ItemKind::kTick, 0.03);
  EXPECT_EQ(TimesMs(navigator_.Flush()), std::vector<double>{40});
  EXPECT_EQ(TimesMs(navigator_.Flush()), std::vector<double>{});
}

TEST_F(NavigatorTest, SkipsAJumpOfTime) {
  Mark(ItemKind::kStart, 0.0);
  EXPECT_EQ(Mark(ItemKind::kTick, 10.0).poses.size(), 500U);
  EXPECT_EQ(TimesMs(Mark(ItemKind::kTick, 20.01)), std::vector<double>{});
  EXPECT_EQ(TimesMs(Mark(ItemKind::kTick, 20.02)), std::vector<double>{20020});
  EXPECT_EQ(Count("time_jump"), 1);
}

TEST_F(NavigatorTest, IsVoidAfterAStartMark) {
  Mark(ItemKind::kStart, 0.0);
  Sentence(0.1, RmcLine(NoonPlus(0.05), 50.0, 8.0, 2.0, 30.0));
  Sentence(0.1, HdtLine(45.0));
  ASSERT_EQ(navigator_.last_pose()->status, PoseStatus::kOk);
  const auto output = Mark(ItemKind::kStart, -100.0);
  ASSERT_EQ(output.poses.size(), 1U);
  EXPECT_EQ(output.poses[0].status, PoseStatus::kUnknown);
  EXPECT_TRUE(std::isnan(output.poses[0].datum.latitude_deg)) << "the datum came from the first fix";
}

TEST_F(NavigatorTest, MovesTheStateBeforeItMakesPoses) {
  Mark(ItemKind::kStart, 0.0);
  const auto output = Sentence(0.1, RmcLine(NoonPlus(0.05), 50.0, 8.0, 0.0, 0.0));
  ASSERT_EQ(output.poses.size(), 5U);
  // A fix says nothing of the time before it.
  for (const auto& pose : output.poses) {
    EXPECT_EQ(pose.status, pose.time < NoonPlus(0.05) ? PoseStatus::kUnknown : PoseStatus::kNoHeading);
  }
}

TEST_F(NavigatorTest, NeverMakesATimeTwiceWhenAFixIsLate) {
  Mark(ItemKind::kStart, 0.0);
  Sentence(1.0, RmcLine(NoonPlus(0.9), 50.0, 8.0, 0.0, 0.0));
  const auto before = Mark(ItemKind::kTick, 1.0);
  const auto output = Sentence(1.01, RmcLine(NoonPlus(0.2), 50.00001, 8.0, 0.0, 0.0), "other");
  EXPECT_TRUE(output.fix) << "it is still a fix";
  EXPECT_TRUE(output.poses.empty());
  const auto pose = Mark(ItemKind::kTick, 1.02).poses.at(0);
  EXPECT_GT(pose.latitude_deg, 50.000001) << "and counts for what comes";
  EXPECT_LT(pose.latitude_deg, 50.000009);
  EXPECT_EQ(Count("late_fix"), 0);
}

TEST_F(NavigatorTest, MakesAFixPerRmcAndGga) {
  Mark(ItemKind::kStart, 0.0);
  const auto rmc = Sentence(0.1, RmcLine(NoonPlus(0.05), 50.0, -8.0, 2.0, 30.0)).fix;
  ASSERT_TRUE(rmc);
  EXPECT_EQ(rmc->sentence_type, "RMC");
  EXPECT_EQ(rmc->when.time, NoonPlus(0.05));
  EXPECT_EQ(rmc->when.arrival, NoonPlus(0.1));
  EXPECT_TRUE(rmc->when.is_from_sentence);
  EXPECT_NEAR(rmc->position->longitude_deg, -8.0, 1e-9);
  EXPECT_NEAR(rmc->speed_mps, 2.0, 1e-5);
  EXPECT_EQ(rmc->horizontal_sd_m, 2.5);
  const auto gga = Sentence(0.11, GgaLine(NoonPlus(0.05), 50.0, -8.0, 4, 0.8, 100.0, 47.0)).fix;
  ASSERT_TRUE(gga);
  EXPECT_EQ(gga->sentence_type, "GGA");
  EXPECT_EQ(gga->when.time, NoonPlus(0.05));
  EXPECT_EQ(gga->num_satellites, 12);
  EXPECT_LT(gga->horizontal_sd_m, 0.1);
  EXPECT_FALSE(Sentence(0.12, Line("GPVTG,30.0,T,,M,4.0,N,,K")).fix);
  EXPECT_EQ(Count("understood_sentence"), 3);
}

TEST_F(NavigatorTest, MakesAFixWithoutPositionWhereThereIsNone) {
  Mark(ItemKind::kStart, 0.0);
  const auto fix = Sentence(0.1, "$GPGGA,,,,,,0,,,,M,,M,,*66").fix;
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->quality, FixQuality::kNone);
  EXPECT_FALSE(fix->position);
  EXPECT_TRUE(std::isnan(fix->horizontal_sd_m));
  EXPECT_EQ(Count("unusable_fix"), 1);
  Mark(ItemKind::kStart, 0.0);
  EXPECT_EQ(Count("unusable_fix"), 1) << "a start mark voids the state, not the counts";
}

TEST_F(NavigatorTest, AddsTheOffsetsOfConfigToAttitude) {
  auto params = NavigatorTestParams();
  params.heading_offset_rad = DegToRad(30.0);
  params.pitch_offset_rad = DegToRad(-2.0);
  params.roll_offset_rad = DegToRad(3.0);
  navigator_ = Navigator(params);
  const auto pashr = Sentence(0.1, PashrLine(NoonPlus(0.05), 350.0, 1.0, 2.0, 0.5)).attitude;
  ASSERT_TRUE(pashr);
  EXPECT_EQ(pashr->sentence_type, "PASHR");
  EXPECT_EQ(pashr->when.time, NoonPlus(0.05));
  EXPECT_NEAR(pashr->heading_rad, DegToRad(20.0), 1e-9);
  EXPECT_NEAR(pashr->roll_rad, DegToRad(4.0), 1e-9);
  EXPECT_NEAR(pashr->pitch_rad, 0.0, 1e-9);
  EXPECT_NEAR(pashr->roll_sd_rad, DegToRad(0.05), 1e-9);
  EXPECT_NEAR(pashr->pitch_sd_rad, DegToRad(0.06), 1e-9);
  const auto hdt = Sentence(0.2, HdtLine(350.0)).attitude;
  ASSERT_TRUE(hdt);
  EXPECT_FALSE(hdt->when.is_from_sentence);
  EXPECT_EQ(hdt->when.time, NoonPlus(0.2));
  EXPECT_NEAR(hdt->heading_rad, DegToRad(20.0), 1e-9);
  EXPECT_TRUE(std::isnan(hdt->roll_rad));
  EXPECT_FALSE(Sentence(0.3, "$GPHDT,,T*1B").attitude) << "unknown, not the offset";
}

TEST_F(NavigatorTest, CountsWhatItDoesNotTake) {
  Sentence(0.0, "$GPHDT,1.0,T");
  Sentence(0.0, "$GPHDT,1.0,T*00");
  Sentence(0.0, Line("GPHDT,x,T"));
  Sentence(0.0, Line("GPHDT,361.0,T"));
  Sentence(0.0, Line("IIXDR,C,19.52,C,TempAir"));
  EXPECT_EQ(Count("no_checksum"), 1);
  EXPECT_EQ(Count("bad_checksum"), 1);
  EXPECT_EQ(Count("bad_field"), 1);
  EXPECT_EQ(Count("implausible_value"), 1);
  EXPECT_EQ(Count("other_sentence"), 1);
  EXPECT_EQ(Count("understood_sentence"), 0);
}

TEST_F(NavigatorTest, UsesASentenceThatTheLidarRepeatsOnce) {
  const auto line = RmcLine(NoonPlus(0.0), 50.0, 8.0, 2.0, 30.0);
  EXPECT_TRUE(Sentence(0.1, line, kLidarSource).fix);
  EXPECT_FALSE(Sentence(0.107, line, kLidarSource).fix);
  EXPECT_TRUE(Sentence(0.11, line, kUdpSource).fix) << "another source";
  EXPECT_FALSE(Sentence(0.114, line, kLidarSource).fix);
  EXPECT_TRUE(Sentence(1.1, RmcLine(NoonPlus(1.0), 50.0, 8.0, 2.0, 30.0), kLidarSource).fix);
  EXPECT_EQ(Count("repeated_sentence"), 2);
  Mark(ItemKind::kStart, 2.0);
  EXPECT_TRUE(Sentence(2.0, RmcLine(NoonPlus(1.0), 50.0, 8.0, 2.0, 30.0), kLidarSource).fix) << "after a start mark it is the first";
}

TEST_F(NavigatorTest, UsesTheArrivalWhereTheReceiversTimeIsOff) {
  const auto fix = Sentence(0.1, RmcLine(NoonPlus(-60.0), 50.0, 8.0, 2.0, 30.0)).fix;
  ASSERT_TRUE(fix);
  EXPECT_FALSE(fix->when.is_from_sentence);
  EXPECT_EQ(fix->when.time, NoonPlus(0.1));
  EXPECT_EQ(Count("sentence_time_unusable"), 1);
  EXPECT_NEAR(Mark(ItemKind::kTick, 0.12).poses.at(0).latitude_deg, 50.0, 1e-6);
}

// MRPT's recording: a receiver at rest, no heading, host stamps 0.4 s off.
TEST_F(NavigatorTest, StandsAtTheFixOfAReceiverAtRest) {
  const Utime fix_time = std::chrono::sys_days(std::chrono::year(2016) / 1 / 21) + 8h + 18min + 2s;
  const std::string line = "$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2E";
  navigator_.Consume({fix_time + 400ms, 0, ItemKind::kStart, {}, {}});
  std::vector<Pose> poses;
  for (int i = 0; i < 57; ++i) {
    const auto output = navigator_.Consume({fix_time + 400ms + i * 7ms, i + 1, ItemKind::kSentence, kLidarSource, line});
    poses.insert(poses.end(), output.poses.begin(), output.poses.end());
  }
  ASSERT_GE(poses.size(), 19U);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].status, PoseStatus::kNoHeading);
    EXPECT_NEAR(poses[i].latitude_deg, 36.82913093, 1e-6);
    EXPECT_NEAR(poses[i].longitude_deg, -2.40757155, 1e-6);
  }
}

TEST_F(NavigatorTest, DoesNotTakeAnOldSentenceThatTheLidarRepeatsForAFix) {
  // The receiver went five minutes ago; the lidar still repeats its last sentence. Once it changes, it is alive.
  EXPECT_FALSE(Sentence(0.1, RmcLine(NoonPlus(-300.0), 50.0, 8.0, 2.0, 30.0), kLidarSource).fix);
  EXPECT_TRUE(Sentence(1.1, RmcLine(NoonPlus(-299.0), 50.0, 8.0, 2.0, 30.0), kLidarSource).fix);
}

TEST_F(NavigatorTest, IsNotAtAPlaceForASentenceThatIsRepeatedForEver) {
  for (int i = 0; i < 600; ++i) Sentence(0.1 + 0.1 * i, RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0));
  EXPECT_EQ(navigator_.last_pose()->status, PoseStatus::kRelativeToBoat);
  EXPECT_TRUE(std::isnan(navigator_.last_pose()->latitude_deg));
  EXPECT_EQ(navigator_.filter().stopped(), "no position fix for 60 s");
}

TEST_F(NavigatorTest, KeepsTheTimeOfDayOfAReceiverWhoseDateIsWrong) {
  // GPS weeks roll over after 1024: such a receiver is 7168 days behind.
  const auto fix = Sentence(0.1, RmcLine(NoonPlus(0.05) - std::chrono::days(7168), 50.0, 8.0, 2.0, 30.0)).fix;
  ASSERT_TRUE(fix);
  EXPECT_TRUE(fix->when.is_from_sentence);
  EXPECT_EQ(fix->when.time, NoonPlus(0.05));
  EXPECT_EQ(Count("date_unusable"), 1);
}

}  // namespace
}  // namespace lookout::navigator
