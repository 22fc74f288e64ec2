#include "lab/eval/report/truth_match.hpp"

#include <gtest/gtest.h>

#include "common/core/frames.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/eval/truth_fixture.hpp"

namespace lookout::eval {
namespace {

constexpr std::int64_t kScanPeriodUs = 100'000;

// Ten scans a second of 900 columns of two rings, all round of which a wall stands at `wall_m`.
messages::ScanMessages ScanOf(int index, double wall_m, std::int64_t shift_us = 0) {
  messages::ScanMessages messages;
  auto scan = support::OfScan<lidar_scan_t>(kStartUs + index * kScanPeriodUs + shift_us, 0, 0);
  std::vector<float> azimuth_rad;
  std::vector<std::int32_t> time_ns;
  for (int column = 0; column < 900; ++column) {
    azimuth_rad.push_back(static_cast<float>(column) * 0.00698F);
    time_ns.push_back(column * 111'000);
  }
  support::FillColumns(scan, azimuth_rad, time_ns, static_cast<std::int16_t>(wall_m / 0.002));
  messages.utime_us = scan.utime_us;
  messages.scans[0] = scan;
  return messages;
}

// What the lidar sees of a wall at 10 m, for a second.
Truth TruthOfAWall(bool has_places = true) {
  Truth truth(1);
  for (int index = 0; index < 10; ++index) {
    const auto scan = ScanOf(index, 10.0).scans[0];
    std::vector<Truth::Return> returns;
    for (int column = 0; column < scan.num_columns; ++column) {
      for (int ring = 0; ring < 2; ++ring) {
        const auto k = static_cast<std::size_t>(column);
        const Eigen::Vector3d p_m =
            10.0 * BeamDirection(static_cast<double>(scan.azimuth_rad[k]), static_cast<double>(scan.elevation_rad[static_cast<std::size_t>(ring)]));
        const Eigen::Vector3f place = has_places ? Eigen::Vector3f(p_m.cast<float>()) : Eigen::Vector3f::Constant(std::nanf(""));
        returns.push_back({scan.utime_us + column * 111 + (ring == 0 ? 0 : 2), ring, 0, 1, place});
      }
    }
    truth.AddReturns(std::move(returns));
  }
  return truth;
}

struct Compared {
  std::string fault;
  std::string coverage;
};
// Scans `first` to `end` of a log, each wall_m away.
Compared Compare(const Truth& truth, int first, int end, double wall_m, std::int64_t shift_us = 0) {
  TruthMatch match(truth);
  for (int index = first; index < end; ++index) {
    const auto scan = ScanOf(index, wall_m, shift_us);
    match.Count(scan.utime_us);
    if (match.Holds(scan.utime_us)) match.Add(scan);
  }
  return {match.Fault("a.lcmlog", "truth"), match.Coverage()};
}

TEST(TruthMatch, AcceptsTheRunOfTheTruth) {
  const auto truth = TruthOfAWall();
  const auto compared = Compare(truth, 0, 10, 10.0);
  EXPECT_EQ(compared.fault, "");
  EXPECT_EQ(compared.coverage, "");
  EXPECT_EQ(Compare(TruthOfAWall(false), 0, 10, 10.0).fault, "") << "a truth of before returns had places";
}

// The truth of another run once gave tables, exit code 0 and a MOTA of -106 %.
TEST(TruthMatch, RefusesATruthOfAnotherTime) {
  const auto truth = TruthOfAWall();
  const auto fault = Compare(truth, 0, 10, 10.0, 3'600'000'000).fault;
  EXPECT_TRUE(fault.starts_with("a.lcmlog and truth are not of one run: the scans of the log go from 2026-06-15T15:10:00.000000Z to ")) << fault;
  EXPECT_NE(fault.find(", the truth from 2026-06-15T14:10:00.000000Z to "), std::string::npos) << fault;
  EXPECT_TRUE(fault.ends_with("; give the truth that lookout-sim --truth wrote in the run of this log")) << fault;
}

TEST(TruthMatch, RefusesATruthInWhichReturnsLieElsewhere) {
  const auto truth = TruthOfAWall();
  const auto fault = Compare(truth, 0, 10, 14.0).fault;
  EXPECT_NE(fault.find("not of one run: of 18000 returns of the log 100.0 % are in the truth, 0.0 % at their distance"), std::string::npos) << fault;
  // Of another beginning, so that no shot is at the time of one of the truth.
  EXPECT_NE(Compare(truth, 0, 10, 14.0, 500).fault.find("0.0 % at their distance"), std::string::npos);
}

TEST(TruthMatch, AcceptsAClockOfTheLidarThatIsNotThatOfTheTruth) {
  const auto truth = TruthOfAWall();
  EXPECT_EQ(Compare(truth, 0, 10, 10.0, 500).fault, "");
  EXPECT_EQ(Compare(truth, 0, 10, 10.0, -20'300).fault, "");
  EXPECT_EQ(Compare(TruthOfAWall(false), 0, 10, 10.0, 500).fault, "") << "nothing is known of places";
}

TEST(TruthMatch, SaysHowMuchOfTheTruthIsCovered) {
  const auto truth = TruthOfAWall();
  const auto part = Compare(truth, 0, 3, 10.0);
  EXPECT_EQ(part.fault, "");
  EXPECT_EQ(part.coverage, "the log covers 0.3 s of the 1.0 s of the truth (30 %)");
  const auto beyond = Compare(truth, 5, 25, 10.0);
  EXPECT_EQ(beyond.fault, "");
  EXPECT_NE(beyond.coverage.find("of its 20 scans lie outside of the truth and are left out"), std::string::npos) << beyond.coverage;
}

TEST(TruthMatch, RefusesATruthOfAnotherPlace) {
  support::TempDir folder;
  const Truth truth(WriteTruth(folder.path()));
  TruthMatch match(truth);
  match.Count(kStartUs);
  pose_t pose{};
  pose.utime_us = kStartUs;
  pose.status = pose_t::STATUS_OK;
  pose.latitude_deg = 43.63;
  pose.longitude_deg = -72.15;
  match.Add(pose);
  EXPECT_EQ(match.Fault("a.lcmlog", "truth"), "");
  TruthMatch other(truth);
  other.Count(kStartUs);
  pose.latitude_deg = 43.64;
  other.Add(pose);
  EXPECT_NE(other.Fault("a.lcmlog", "truth").find("POSE of the log is 1111 m from the boat of the truth (median of 1 poses)"), std::string::npos)
      << other.Fault("a.lcmlog", "truth");
}

TEST(TruthMatch, RefusesAnEmptyTruth) {
  const Truth truth(1);
  EXPECT_NE(Compare(truth, 0, 3, 10.0).fault.find("truth: holds no pose and no return"), std::string::npos);
}

}  // namespace
}  // namespace lookout::eval
