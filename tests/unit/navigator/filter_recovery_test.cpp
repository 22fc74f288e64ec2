// The filter after its IMU has led it astray: fixes and attitudes that agree with each other win.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <string>

#include "services/navigator/core/filter/pose_filter.hpp"
#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator::recovery {
namespace {

constexpr double kBeginS = 20.0;
constexpr double kRecoveryS = 5.0;

struct Fault {
  std::function<Eigen::Vector3d(double)> force_mps2;  // what the accelerometers err by, so many seconds after its begin
  std::function<Eigen::Vector3d(double)> rate_radps;  // the gyroscopes
  double duration_s = 0.0;
  double north_offset_m = 0.0;  // of the fixes, meanwhile
};

struct Outcome {
  int num_wrong = 0;  // later than kRecoveryS after the begin
  double worst_m = 0.0;
  double worst_deg = 0.0;
  double worst_during_m = 0.0;
  std::string first;
  FilterCounts counts;
  bool is_named = false;
};

// A boat at rest that heads north; exact RTK fixes and attitudes all the while.
Outcome Play(const Fault& fault, double end_s) {
  auto params = TestFilterParams();
  PoseFilter filter(params);
  Outcome outcome;
  for (int tick = 0; tick < static_cast<int>(end_s * 100.0); ++tick) {
    const double time_s = 0.01 * tick;
    const double since_s = time_s - kBeginS;
    const bool is_faulty = since_s >= 0.0 && since_s < fault.duration_s;
    auto sample = RestSample(time_s);
    if (is_faulty && fault.force_mps2) sample.specific_force_mps2 += fault.force_mps2(since_s);
    if (is_faulty && fault.rate_radps) sample.angular_velocity_radps += fault.rate_radps(since_s);
    filter.Add(sample);
    if (tick % 2 == 0) {
      // A sensor that lives has noise.
      const double noise_deg = tick % 4 == 0 ? 0.02 : -0.02;
      auto attitude = AttitudeSample(time_s, noise_deg, noise_deg, noise_deg);
      attitude.heading_sd_rad = attitude.roll_sd_rad = attitude.pitch_sd_rad = DegToRad(0.1);
      filter.Add(attitude);
    }
    if (tick % 20 == 0) {
      auto fix = MovingFix(time_s, 0.0, 0.0);
      fix.horizontal_sd_m = 0.02;
      fix.position->longitude_deg += (tick % 40 == 0 ? 0.005 : -0.005) / 80'000.0;
      if (is_faulty) fix.position->latitude_deg += fault.north_offset_m / 111'111.0;
      filter.Add(fix);
    }
    if (tick % 10 == 0) filter.AdvanceTo(NoonPlus(time_s));
    if (tick % 2 != 0) continue;
    const auto pose = filter.At(NoonPlus(time_s));
    const double error_deg = std::abs(RadToDeg(WrapToPi(pose.heading_rad)));
    if (since_s >= 0.0 && since_s < kRecoveryS) outcome.worst_during_m = std::max(outcome.worst_during_m, DistanceM(pose));
    outcome.is_named = outcome.is_named || filter.stopped().find("IMU not used") != std::string::npos;
    if (since_s < kRecoveryS) continue;
    outcome.worst_m = std::max(outcome.worst_m, DistanceM(pose));
    outcome.worst_deg = std::max(outcome.worst_deg, error_deg);
    const double sd_m = std::sqrt(pose.covariance(0, 0) + pose.covariance(1, 1));
    const double sd_deg = RadToDeg(std::sqrt(pose.covariance(8, 8)));
    const bool is_right = DistanceM(pose) <= 4.0 * sd_m + 0.2 && error_deg <= 4.0 * sd_deg + 2.0 && pose.status == PoseStatus::kOk;
    if (is_right) continue;
    if (outcome.num_wrong++ == 0) {
      outcome.first = Print("%.2f s after: %.2f m off, stated %.2f m, %.1f deg off, stated %.1f deg, status %d, ", since_s, DistanceM(pose), sd_m,
                            error_deg, sd_deg, static_cast<int>(pose.status)) +
                      filter.stopped();
    }
  }
  outcome.counts = filter.counts();
  return outcome;
}

TEST(PoseFilterRecovery, FixesWinWhereAccelerometersLeadAway) {
  for (const double duration_s : {2.0, 12.0}) {
    for (const double jerk_mps3 : {0.0, 1.0}) {
      Fault fault;
      fault.duration_s = duration_s;
      fault.force_mps2 = [=](double since_s) { return Eigen::Vector3d(3.0 + jerk_mps3 * since_s, 0.0, 0.0); };
      const auto outcome = Play(fault, kBeginS + 14.0);
      EXPECT_EQ(outcome.num_wrong, 0) << duration_s << " s, " << jerk_mps3 << ": " << outcome.first << ", at most " << outcome.worst_m;
      EXPECT_TRUE(outcome.is_named);
    }
  }
}

TEST(PoseFilterRecovery, AttitudesWinWhereGyroscopesLeadAway) {
  for (const double duration_s : {2.0, 12.0}) {
    Fault fault;
    fault.duration_s = duration_s;
    fault.rate_radps = [](double since_s) { return Eigen::Vector3d(0.0, 0.0, DegToRad(10.0 + 5.0 * since_s)); };
    const auto outcome = Play(fault, kBeginS + 14.0);
    EXPECT_EQ(outcome.num_wrong, 0) << duration_s << " s: " << outcome.first << ", at most " << outcome.worst_deg;
  }
}

// It is tried again after 10 s, 20 s, 40 s ...
TEST(PoseFilterRecovery, AnImuThatIsWrongForGoodIsTriedMoreAndMoreSeldom) {
  Fault fault;
  fault.duration_s = 1e9;
  fault.force_mps2 = [](double since_s) { return Eigen::Vector3d(3.0 + std::fmod(since_s, 5.0), 0.0, 0.0); };
  const auto outcome = Play(fault, kBeginS + 160.0);
  EXPECT_LE(outcome.counts["renewed_position"], 4);
  EXPECT_LT(outcome.num_wrong, 9 * 50) << outcome.first;
}

TEST(PoseFilterRecovery, AJumpOfTheReceiverIsNotTheImusFault) {
  Fault fault;
  fault.duration_s = 8.0;
  fault.north_offset_m = 5.0;
  const auto outcome = Play(fault, kBeginS + 14.0);
  EXPECT_EQ(outcome.counts["renewed_position"], 0);
  EXPECT_LT(outcome.worst_during_m, 0.5);
  EXPECT_FALSE(outcome.is_named);
}

}  // namespace
}  // namespace lookout::navigator::recovery
