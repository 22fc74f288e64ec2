#include "tools/calibrate/hand_eye.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/calibrate/made_track.hpp"

namespace lookout::calibrate {
namespace {

const Eigen::Vector3d kLidarM(0.5, -0.1, 1.1);

TEST(HandEye, FindsRotationAndLatencyWithoutNoise) {
  const MadeWay way;
  const Eigen::Vector3d rotation_rad(DegToRad(4.0), DegToRad(-7.0), DegToRad(9.0));
  const auto motions = MakeMotions(way, 60.0, TurnAbout(kLidarM, rotation_rad), 0.0, 0.0, 1);
  const auto fit = SolveHandEye(motions, MakeTrack(way, 60.0, 0.037), kLidarM, {}, {});
  ASSERT_TRUE(fit);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(RadToDeg(fit->correction.rotation_rad[i]), RadToDeg(rotation_rad[i]), 0.01) << i;
  EXPECT_NEAR(fit->correction.latency.heading_s, 0.037, 0.0005);
  EXPECT_NEAR(fit->correction.latency.tilt_s, 0.037, 0.0005);
  EXPECT_LT(fit->rotation_rms_rad, DegToRad(0.01));
}

TEST(HandEye, TellsItsDeviations) {
  const MadeWay way;
  const auto track = MakeTrack(way, 60.0, 0.0);
  constexpr int kNumTrials = 40;
  int num_within = 0;
  int num_numbers = 0;
  for (int trial = 0; trial < kNumTrials; ++trial) {
    const Eigen::Vector3d rotation_rad(0.05, -0.03, 0.08);
    const auto motions = MakeMotions(way, 60.0, TurnAbout(kLidarM, rotation_rad), 0.05, 0.005, 100U + static_cast<unsigned>(trial));
    const auto fit = SolveHandEye(motions, track, kLidarM, {}, {});
    ASSERT_TRUE(fit);
    Correction truth;
    truth.rotation_rad = rotation_rad;
    const auto error = (fit->correction.ToNumbers() - truth.ToNumbers()).eval();
    for (int i = 0; i < 5; ++i) {
      ++num_numbers;
      num_within += std::abs(error[i]) <= 2.0 * fit->sd[i] ? 1 : 0;
    }
    EXPECT_LT(fit->sd[2], DegToRad(0.5)) << "deviations that say nothing hold every error";
  }
  EXPECT_GE(num_within, num_numbers * 93 / 100) << "seeds 100 to 139";
}

TEST(HandEye, SaysThatAStraightRunOnFlatWaterShowsNoRollAndPitch) {
  MadeWay way;
  way.turn_radps = 0.0;
  way.swing_rad = 0.0;
  way.roll_rad = 0.0;
  const auto motions = MakeMotions(way, 60.0, TurnAbout(kLidarM, {0.05, -0.03, 0.08}), 0.05, 0.005, 7);
  const auto fit = SolveHandEye(motions, MakeTrack(way, 60.0, 0.0), kLidarM, {}, {});
  ASSERT_TRUE(fit);
  // Rolling about the way stays unseen; pitch would lift the boat, which is seen.
  EXPECT_GT(fit->sd[1 - 1], DegToRad(1.0));
  EXPECT_NEAR(fit->correction.rotation_rad.z(), 0.08, 3.0 * fit->sd[2]);
}

TEST(HandEye, LeewayDoesNotBendTheYaw) {
  // The boat goes sideways by 10 deg: the course is not the heading.
  MadeWay way;
  class Crabbing {
   public:
    static PoseTrack Track(const MadeWay& way) {
      PoseTrack track;
      for (int i = -50; i * 0.02 < 61.0; ++i) {
        TrackPose pose;
        pose.time = MadeTime(i * 0.02);
        pose.T_map_vessel = At(way, i * 0.02);
        pose.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-7, 1e-7, 1e-7;
        track.Add(pose);
      }
      return track;
    }
    static Eigen::Isometry3d At(const MadeWay& way, double time_s) {
      auto T = way.At(time_s);
      T.linear() = RotationAboutZ(DegToRad(10.0)) * T.linear();
      return T;
    }
  };
  const auto D = TurnAbout(kLidarM, {0.0, 0.0, 0.05});
  std::vector<RelativeMotion> motions;
  for (auto motion : MakeMotions(way, 60.0, D, 0.02, 0.002, 3)) {
    const double begin_s = ToSeconds(motion.begin - MadeTime(0.0));
    const double end_s = ToSeconds(motion.end - MadeTime(0.0));
    motion.T_begin_end = D.inverse() * Crabbing::At(way, begin_s).inverse() * Crabbing::At(way, end_s) * D;
    motions.push_back(motion);
  }
  const auto fit = SolveHandEye(motions, Crabbing::Track(way), kLidarM, {}, {});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(RadToDeg(fit->correction.rotation_rad.z()), RadToDeg(0.05), 0.02);
}

TEST(HandEye, APairThatWasRegisteredWronglyCountsForLittle) {
  const MadeWay way;
  auto motions = MakeMotions(way, 60.0, TurnAbout(kLidarM, {0.0, 0.0, 0.05}), 0.02, 0.002, 5);
  for (std::size_t i = 0; i < motions.size(); i += 10) motions[i].T_begin_end.translation() += Eigen::Vector3d(1.5, -1.0, 0.0);
  const auto fit = SolveHandEye(motions, MakeTrack(way, 60.0, 0.0), kLidarM, {}, {});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(RadToDeg(fit->correction.rotation_rad.z()), RadToDeg(0.05), 0.1);
}

TEST(HandEye, NeedsTenMotions) {
  const MadeWay way;
  const auto motions = MakeMotions(way, 3.0, Eigen::Isometry3d::Identity(), 0.02, 0.002, 5);
  ASSERT_LT(motions.size(), 10U);
  EXPECT_FALSE(SolveHandEye(motions, MakeTrack(way, 3.0, 0.0), kLidarM, {}, {}));
}

}  // namespace
}  // namespace lookout::calibrate
