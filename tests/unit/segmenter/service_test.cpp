#include "services/segmenter/service.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "common/config/text_config.hpp"
#include "lookout/segments_t.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/segmenter/message_maker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

class SegmenterService : public support::BusTest {
 protected:
  SegmenterService() : service_(bus_, Params{}) {
    bus_.SubscribeRaw(bus::kSegments, [this](std::string_view, Bytes bytes) { answers_.emplace_back(bytes.begin(), bytes.end()); });
  }

  void Send(const lidar_scan_t& message) { BusTest::Send(bus::kLidarScan, message); }

  std::int64_t Count(const std::string& name) const { return support::CountOf(service_, name); }

  Service service_;
  std::vector<std::vector<std::uint8_t>> answers_;
};

Scan LakeInRain() {
  auto scan = test::EmptyScan({});
  test::Look(scan, test::Lake(1), 0.03);
  test::AddRain(scan, 3000, 1);
  return scan;
}

TEST_F(SegmenterService, AnswersATurnInOneMessage) {
  auto scan = test::EmptyScan({});
  test::Look(scan, test::Lake(1), 0.03);
  Send(test::ScanMessages(scan, 7, 1)[0]);
  ASSERT_EQ(answers_.size(), 1U);
  const auto answer = bus::Decode<segments_t>(answers_[0]);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->seq, 7);
  EXPECT_EQ(answer->num_cells, 28928);
  EXPECT_GT(answer->num_segments, 3);
  EXPECT_EQ(answer->num_turn_segments, answer->num_segments);
  EXPECT_EQ(Count("scans"), 1);
  EXPECT_EQ(Count("segments"), answer->num_segments);
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
}

TEST_F(SegmenterService, AnswersAScanInPartsWithTheSameLabels) {
  const auto scan = LakeInRain();
  Send(test::ScanMessages(scan, 7, 1)[0]);
  const auto whole = bus::Decode<segments_t>(answers_.at(0));
  answers_.clear();
  for (const auto& message : test::ScanMessages(scan, 7, 3)) {
    EXPECT_TRUE(answers_.empty());
    Send(message);
  }
  ASSERT_GE(answers_.size(), 3U);
  std::vector<std::int16_t> label;
  for (const auto& bytes : answers_) {
    const auto part = bus::Decode<segments_t>(bytes);
    ASSERT_TRUE(part);
    label.insert(label.end(), part->label.begin(), part->label.end());
  }
  EXPECT_EQ(label, whole->label);
}

TEST_F(SegmenterService, GivesTheSameBytesForTheSameScanWhateverCameBefore) {
  const auto messages = test::ScanMessages(LakeInRain(), 7, 2);
  Send(messages[0]);
  Send(messages[1]);
  const auto first = std::exchange(answers_, {});
  Send(test::ScanMessages(test::EmptyScan({}), 8, 1)[0]);
  Send(test::ScanMessages(LakeInRain(), 9, 2)[0]);  // stays incomplete
  answers_.clear();
  Send(messages[0]);
  Send(messages[1]);
  EXPECT_EQ(answers_, first);
  EXPECT_EQ(Count("scans_incomplete"), 1);
}

TEST_F(SegmenterService, TellsOfARefusalForAMinuteWhereNothingFollows) {
  auto message = test::ScanMessages(LakeInRain(), 7, 1)[0];
  message.azimuth_rad[5] = 7.0F;
  Utime now{std::chrono::seconds(1'800'000'000)};
  service_.AdvanceTo(now);
  Send(message);
  for (int second = 0; second < 59; ++second) service_.AdvanceTo(now += std::chrono::seconds(1));
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service_.Report().reason, "no LIDAR_SCAN for 59 s; the latest LIDAR_SCAN was refused: refused_azimuth");
  service_.AdvanceTo(now += std::chrono::seconds(1));
  EXPECT_EQ(service_.Report().reason, "no LIDAR_SCAN for 60 s");
  EXPECT_EQ(Count("refused_azimuth"), 1);
}

// HEALTH stayed ok while no scan came.
TEST_F(SegmenterService, SaysThatNoScansCome) {
  Utime now{std::chrono::seconds(1'800'000'000)};
  service_.AdvanceTo(now);
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
  service_.AdvanceTo(now += std::chrono::seconds(2));
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service_.Report().reason, "no LIDAR_SCAN for 2 s");
  Send(test::ScanMessages(LakeInRain(), 7, 1)[0]);
  service_.AdvanceTo(now += std::chrono::seconds(1));
  EXPECT_EQ(service_.Report().state, HealthState::kOk) << service_.Report().reason;
}

TEST_F(SegmenterService, RefusesAndCountsWrongMessagesAndGoesOn) {
  auto message = test::ScanMessages(LakeInRain(), 7, 1)[0];
  message.azimuth_rad[5] = 7.0F;
  Send(message);
  EXPECT_TRUE(answers_.empty());
  EXPECT_EQ(Count("refused_azimuth"), 1);
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service_.Report().reason, "the latest LIDAR_SCAN was refused: refused_azimuth");
  Send(test::ScanMessages(LakeInRain(), 8, 1)[0]);
  EXPECT_FALSE(answers_.empty());
  EXPECT_EQ(service_.Report().state, HealthState::kOk);
}

TEST_F(SegmenterService, DropsATurnWithAMissingPart) {
  const auto lost = test::ScanMessages(LakeInRain(), 7, 3);
  Send(lost[0]);
  Send(lost[2]);
  Send(lost[2]);
  EXPECT_EQ(Count("parts_duplicate"), 1);
  Send(test::ScanMessages(test::EmptyScan({}), 8, 1)[0]);
  EXPECT_EQ(Count("scans_incomplete"), 1);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(bus::Decode<segments_t>(answers_[0])->seq, 8);
}

TEST_F(SegmenterService, SurvivesBytesThatAreNoMessage) {
  const std::vector<std::uint8_t> bytes(100, 0xFF);
  bus_.Publish(bus::kLidarScan, bytes);
  EXPECT_TRUE(bus_.HandleOnce());
  EXPECT_EQ(bus_.input_traffic()["LIDAR_SCAN"].num_undecodable, 1);
}

TEST(SegmenterParams, AreTheDefaultsOfTheSchemaWhereNothingIsSet) {
  const auto folder = support::kSources / "config" / "catabot";
  const auto params = LoadParams(folder);
  const Params defaults;
  EXPECT_EQ(params.filter.min_range_m, defaults.filter.min_range_m);
  EXPECT_EQ(params.filter.max_range_m, defaults.filter.max_range_m);
  EXPECT_EQ(params.filter.max_repeat_gap_m, defaults.filter.max_repeat_gap_m);
  EXPECT_EQ(params.filter.field_of_view.start_rad, defaults.filter.field_of_view.start_rad);
  EXPECT_EQ(params.filter.field_of_view.width_rad, defaults.filter.field_of_view.width_rad);
  EXPECT_FALSE(params.filter.own_vessel_box_m.isEmpty());
  EXPECT_NEAR(params.filter.T_vessel_lidar.translation().z(), 0.6, 1e-12);
  EXPECT_EQ(params.labelling.image_columns, defaults.labelling.image_columns);
  EXPECT_EQ(params.labelling.label_shadowed_returns, defaults.labelling.label_shadowed_returns);
  EXPECT_EQ(params.labelling.search.angle_rad, defaults.labelling.search.angle_rad);
  EXPECT_EQ(params.labelling.search.distance_m, defaults.labelling.search.distance_m);
  EXPECT_EQ(params.component_clustering, defaults.component_clustering);
  EXPECT_EQ(params.clustering.e1_cosine, defaults.clustering.e1_cosine);
  EXPECT_EQ(params.clustering.e2_angle_rad, defaults.clustering.e2_angle_rad);
  EXPECT_EQ(params.clustering.e3_distance_m, defaults.clustering.e3_distance_m);
  EXPECT_EQ(params.clustering.e2_max_distance_m, defaults.clustering.e2_max_distance_m);
  EXPECT_EQ(params.min_segment_points, defaults.min_segment_points);
  EXPECT_EQ(params.lookout.link.at_lidar_m, defaults.lookout.link.at_lidar_m);
  EXPECT_EQ(params.lookout.link.per_range, defaults.lookout.link.per_range);
  EXPECT_EQ(params.lookout.merges.back().log_odds, defaults.lookout.merges.back().log_odds);
  EXPECT_EQ(params.lookout.land_probability, defaults.lookout.land_probability);
  EXPECT_EQ(params.lookout.sure_probability, defaults.lookout.sure_probability);
}

TEST(SegmenterParams, OfTheLookoutMethodAreTaken) {
  const support::TempDir folder;
  std::filesystem::copy_file(support::kSources / "config" / "catabot" / "boat.txtpb", folder / "boat.txtpb",
                             std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "segmenter.txtpb") << "link_m: 0.2 link_per_range: 0.02 merge_log_odds: 1.5 land_probability: 0.7 sure_probability: 0.6\n";
  const auto params = LoadParams(folder).lookout;
  EXPECT_EQ(params.link.at_lidar_m, 0.2);
  EXPECT_EQ(params.link.per_range, 0.02);
  EXPECT_EQ(params.merges.back().log_odds, 1.5);
  EXPECT_EQ(params.merges.front().log_odds, LookoutParams().merges.front().log_odds);
  EXPECT_EQ(params.land_probability, 0.7);
  EXPECT_EQ(params.sure_probability, 0.6);
}

// The first lidar of config/catabot is 0.6 m above the reference point.
TEST(SegmenterParams, OfASecondLidarAreThoseOfItsPlace) {
  const support::TempDir folder;
  std::filesystem::copy(support::kCatabotConfig, folder.path(),
                        std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  EXPECT_FALSE(LoadLanes(folder).second);
  const auto first_m = LoadLanes(folder).first.lookout.lidar_above_water_m;
  std::ofstream(folder / "boat.txtpb", std::ios::app) << "lidar_2 { x_m: 0 y_m: 0 z_m: 2.5 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 }\n";
  const auto lanes = LoadLanes(folder);
  ASSERT_TRUE(lanes.second);
  EXPECT_EQ(lanes.first.lookout.lidar_above_water_m, first_m);
  EXPECT_NEAR(lanes.second->lookout.lidar_above_water_m, first_m - 0.6 + 2.5, 1e-12);
  EXPECT_NEAR(lanes.second->filter.T_vessel_lidar.translation().z(), 2.5, 1e-12);
}

TEST(SegmenterLanes, TellOfTheirOwnRefusals) {
  bus::MemoryBus bus;
  Service service(bus, Lanes{Params{}, Params{}});
  auto wrong = test::ScanMessages(LakeInRain(), 7, 1)[0];
  wrong.azimuth_rad[5] = 7.0F;
  bus::Publish(bus, bus::kLidarScan2, wrong);
  // A scan of the first that is right takes nothing back.
  bus::Publish(bus, bus::kLidarScan, test::ScanMessages(LakeInRain(), 8, 1)[0]);
  support::HandleAll(bus);
  EXPECT_EQ(service.Report().reason, "the latest LIDAR_SCAN_2 was refused: refused_azimuth");
}

TEST(SegmenterParams, RefuseRelationsThatMakeNoSense) {
  const support::TempDir folder;
  std::filesystem::copy_file(support::kSources / "config" / "catabot" / "boat.txtpb", folder / "boat.txtpb",
                             std::filesystem::copy_options::overwrite_existing);
  const std::map<std::string, std::string> reasons{
      {"land_length_m: 15", "has no field named \"land_length_m\""},  // of the rules that were before
      {"join_m: 0.3", "has no field named \"join_m\""},
      {"land_probability: 1", "land_probability: must be at most 0.999"},
      {"sure_probability: 0", "sure_probability: must be at least 0.001"},
      {"merge_log_odds: nan", "merge_log_odds: must be a finite number"},
      {"min_range_m: 20 max_range_m: 20", "max_range_m: must be greater than min_range_m"},
      {"image_columns: 15", "image_columns: must be 0 or at least 16, so that neighbouring pixels look much the same way"}};
  for (const auto& [text, reason] : reasons) {
    std::ofstream(folder / "segmenter.txtpb") << text << "\n";
    try {
      LoadParams(folder);
      ADD_FAILURE() << text << " was taken";
    } catch (const config::ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
  std::ofstream(folder / "segmenter.txtpb") << "image_columns: 16\n";
  EXPECT_EQ(LoadParams(folder).labelling.image_columns, 16);
}

}  // namespace
}  // namespace lookout::segmenter
