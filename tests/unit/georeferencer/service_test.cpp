#include "services/georeferencer/service.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::At;
using test::MakePoseMessage;
using test::MakeSegmentMessage;
using test::MakeSegmentsMessage;

class GeoreferencerService : public support::BusTest {
 protected:
  Params params_{PlacementParams{}, std::chrono::milliseconds(500)};
  Service service_{bus_, params_};
  support::Kept<obstacles_t> obstacles_{bus_, bus::kObstacles};

  void SendTurn(std::int64_t offset_us) { Send(bus::kSegments, MakeSegmentsMessage(offset_us, 0, {MakeSegmentMessage(1, offset_us)})); }
  void SendPoses(std::int64_t first_us, std::int64_t last_us, std::int32_t status = pose_t::STATUS_OK) {
    for (auto offset_us = first_us; offset_us <= last_us; offset_us += 20'000) {
      auto message = MakePoseMessage(offset_us, offset_us / 20'000);
      message.status = status;
      bus::Publish(bus_, bus::kPose, message);
    }
    HandleAll();
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(service_, name); }
};

// 200 km off, and on the other side of the earth, as when latitude and longitude are swapped: such poses were refused, or taken without a word.
TEST(GeoreferencerDatum, ThatIsFarFromTheBoatIsNamedAndUsed) {
  for (const double wrong_latitude_deg : {41.9, -72.3}) {
    SCOPED_TRACE(wrong_latitude_deg);
    const GeodeticPlace datum{wrong_latitude_deg, wrong_latitude_deg < 0.0 ? 43.7 : -72.3, 0.0};
    bus::MemoryBus bus;
    Params params{PlacementParams{}, std::chrono::milliseconds(500)};
    params.datum = datum;
    Service service(bus, params);
    const support::Kept<obstacles_t> obstacles(bus, bus::kObstacles);
    bus::Publish(bus, bus::kSegments, MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)}));
    const Eigen::Vector3d p_map_m = LocalFrame(datum).Forward({43.7, -72.3, 100.0});
    for (std::int64_t offset_us = 0; offset_us <= 100'000; offset_us += 20'000) {
      auto message = MakePoseMessage(offset_us, offset_us / 20'000);
      message.datum_latitude_deg = datum.latitude_deg;
      message.datum_longitude_deg = datum.longitude_deg;
      message.datum_ellipsoid_height_m = datum.ellipsoid_height_m;
      for (int axis = 0; axis < 3; ++axis) message.position_map_m[axis] = p_map_m[axis];
      bus::Publish(bus, bus::kPose, message);
    }
    support::HandleAll(bus);
    ASSERT_EQ(obstacles.size(), 1U);
    const auto& obstacle = obstacles[0].obstacles.at(0);
    ASSERT_EQ(obstacle.status, obstacle_t::STATUS_OK);
    EXPECT_NEAR(obstacle.latitude_deg, 43.7 + 10.0 / 111'110.0, 1e-7) << "10 m to the north";
    EXPECT_NEAR(obstacle.longitude_deg, -72.3, 1e-7);
    const auto report = service.Report();
    EXPECT_EQ(report.state, HealthState::kDegraded);
    const auto expected = wrong_latitude_deg < 0.0 ? "km from the first POSE at 43.70000 N 72.30000 W: swapped latitude and longitude?"
                                                   : "is 200 km from the first POSE at 43.70000 N 72.30000 W: positions are right all the same";
    EXPECT_NE(report.reason.find(expected), std::string::npos) << report.reason;
  }
}

TEST(GeoreferencerSecond, WhoseClockIsBehindIsNamed) {
  for (const std::int64_t behind_us : {0, 1'000'000}) {
    SCOPED_TRACE(behind_us);
    bus::MemoryBus bus;
    Params params{PlacementParams{}, std::chrono::milliseconds(500)};
    params.T_vessel_lidar_2 = Eigen::Isometry3d::Identity();
    Service service(bus, params);
    for (std::int64_t now_us = 0; now_us < 5'000'000; now_us += 20'000) {
      if (now_us % 100'000 == 0) {
        bus::Publish(bus, bus::kSegments, MakeSegmentsMessage(now_us, 0, {MakeSegmentMessage(1, now_us)}));
        const auto seen_us = now_us - behind_us;
        bus::Publish(bus, bus::kSegments2, MakeSegmentsMessage(seen_us, 0, {MakeSegmentMessage(1, seen_us)}));
      }
      bus::Publish(bus, bus::kPose, MakePoseMessage(now_us, now_us / 20'000));
      support::HandleAll(bus);
      service.AdvanceTo(At(now_us));
    }
    const auto reason = service.Report().reason;
    const bool is_named = reason.find("SEGMENTS_2 do not fit the time of SEGMENTS") != std::string::npos;
    EXPECT_EQ(is_named, behind_us > 0) << reason;
  }
}

TEST_F(GeoreferencerService, PlacesATurn) {
  SendTurn(0);
  EXPECT_TRUE(obstacles_.empty());
  SendPoses(0, 100'000);
  ASSERT_EQ(obstacles_.size(), 1U);
  EXPECT_EQ(obstacles_[0].obstacles.at(0).status, obstacle_t::STATUS_OK);
  EXPECT_NEAR(obstacles_[0].obstacles[0].position_map_m[1], 10.0, 1e-6);
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
}

TEST_F(GeoreferencerService, FinishSendsWhatWaits) {
  SendTurn(0);
  service_.Finish();
  HandleAll();
  ASSERT_EQ(obstacles_.size(), 1U);
  EXPECT_EQ(obstacles_[0].obstacles.at(0).status, obstacle_t::STATUS_VESSEL_FRAME_ONLY);
  EXPECT_TRUE(std::isnan(obstacles_[0].datum_latitude_deg));
}

TEST_F(GeoreferencerService, CountsRefusedMessagesUnderTheirReason) {
  auto segments = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)});
  segments.segments[0].hull_x_m[0] = 1e38F;
  bus::Publish(bus_, bus::kSegments, segments);
  auto pose = MakePoseMessage(0);
  pose.status = 99;
  bus::Publish(bus_, bus::kPose, pose);
  bus_.Publish(bus::kPose, std::vector<std::uint8_t>{1, 2, 3});
  HandleAll();
  EXPECT_EQ(Count("segments_refused_number"), 1);
  EXPECT_EQ(Count("pose_refused_status"), 1);
  EXPECT_EQ(Count("pose_refused_time"), 0);
  EXPECT_EQ(bus_.input_traffic().at("POSE").num_undecodable, 1);
}

TEST_F(GeoreferencerService, TellsThatPoseDoesNotCome) {
  service_.AdvanceTo(At(0));
  for (int i = 1; i <= 30; ++i) {
    SendTurn(100'000 * i);
    service_.AdvanceTo(At(100'000 * i));
    HandleAll();
  }
  const auto report = service_.Report();
  EXPECT_EQ(report.state, HealthState::kDegraded);
  EXPECT_EQ(report.reason, "no POSE for 3 s");
  ASSERT_GE(obstacles_.size(), 20U);
  EXPECT_EQ(obstacles_[0].obstacles.at(0).status, obstacle_t::STATUS_POSE_TIMEOUT);
}

TEST_F(GeoreferencerService, TellsThatSegmentsDoNotComeAndIsFineWhenTheyDo) {
  service_.AdvanceTo(At(0));
  SendPoses(0, 1'980'000);
  service_.AdvanceTo(At(2'000'000));
  EXPECT_EQ(service_.Report().reason, "no SEGMENTS for 2 s; no POSE for 2 s");
  SendPoses(2'000'000, 2'100'000);
  SendTurn(2'000'000);
  EXPECT_EQ(service_.Report().state, HealthState::kOk) << service_.Report().reason;
}

TEST_F(GeoreferencerService, TellsThatPoseIsNotPlaced) {
  SendPoses(0, 100'000, pose_t::STATUS_NO_HEADING);
  EXPECT_EQ(service_.Report().reason, "no heading: obstacles in the vessel frame only");
  SendPoses(120'000, 120'000);
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
}

// Obstacles are placed then, and look as good as ever.
TEST_F(GeoreferencerService, TellsThatPoseIsOnlyCarriedOn) {
  SendPoses(0, 100'000, pose_t::STATUS_COASTING);
  SendTurn(0);
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service_.Report().reason, "position or heading is only propagated: obstacles drift as their covariance says, see HEALTH of navigator");
  SendPoses(120'000, 120'000);
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
}

TEST_F(GeoreferencerService, TellsThatTheClocksDiffer) {
  for (int i = 0; i <= 10; ++i) {
    service_.AdvanceTo(At(100'000 * i));
    SendPoses(100'000 * i, 100'000 * i + 80'000);
    SendTurn(3'600'000'000 + 100'000 * i);
  }
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_NE(service_.Report().reason.find("clocks"), std::string::npos) << service_.Report().reason;
}

TEST(GeoreferencerParams, OfTheBoatsInConfigAreThoseOfTheirFiles) {
  const auto params = LoadParams(support::kDemoConfig.string());
  EXPECT_EQ(params.pose_timeout, std::chrono::milliseconds(500));
  EXPECT_EQ(params.placement.mounting_sd_rad, 0.0) << "the simulated boat is as boat.txtpb says";
  EXPECT_NEAR(params.placement.azimuth_sd_rad, 0.05 * 3.14159265 / 180.0, 1e-9);
  EXPECT_EQ(params.placement.range_sd_m, 0.03);
  EXPECT_EQ(params.placement.reference_point_above_water_m, 0.4);
  EXPECT_EQ(params.placement.T_vessel_lidar.translation().z(), 1.1);
  const auto catabot = LoadParams(support::kCatabotConfig.string());
  EXPECT_NEAR(catabot.placement.mounting_sd_rad, 0.5 * 3.14159265 / 180.0, 1e-9);
}

// A boat whose config is older must not lose its guard zone silently.
TEST(GeoreferencerParams, RefuseTheGuardZoneThatIsTheTrackersNow) {
  const support::TempDir folder;
  std::filesystem::copy_file(support::kDemoConfig / "boat.txtpb", folder / "boat.txtpb");
  std::ofstream(folder / "georeferencer.txtpb") << "guard_zone { range_m: 10 }\n";
  try {
    LoadParams(folder);
    FAIL();
  } catch (const config::ConfigError& error) {
    EXPECT_NE(error.faults().at(0).find("guard_zone"), std::string::npos) << error.faults().at(0);
  }
}

}  // namespace
}  // namespace lookout::georeferencer
