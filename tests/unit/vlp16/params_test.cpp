#include "services/vlp16/params.hpp"

#include <unistd.h>

#include <fstream>
#include <gtest/gtest.h>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"

namespace lookout::vlp16 {
namespace {

class Vlp16Params : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Params Load(const std::string& text) const {
    std::ofstream(folder_ / "vlp16.txtpb") << text;
    return LoadParams(folder_);
  }
  std::string FaultOf(const std::string& text) const {
    try {
      Load(text);
    } catch (const config::ConfigError& error) {
      return error.what();
    }
    return "";
  }
  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("lookout_vlp16_params_" + std::to_string(getpid()));
};

TEST_F(Vlp16Params, HaveTheDefaultsOfTheSchema) {
  const auto params = Load("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 90");
  EXPECT_EQ(params.input, Input::kOutside);
  EXPECT_EQ(params.data_port, 2368);
  EXPECT_EQ(params.position_port, 8308);
  EXPECT_EQ(params.decoder.model, ModelChoice::kAuto);
  EXPECT_EQ(params.decoder.time, TimeChoice::kAuto);
  EXPECT_DOUBLE_EQ(params.decoder.cut_azimuth_rad, kPi / 2);
  EXPECT_FALSE(params.use_vertical_origin_offsets);
  EXPECT_FALSE(params.capture_file);
}

TEST_F(Vlp16Params, FindTheCaptureBesideTheConfig) {
  const auto params =
      Load("source: CAPTURE capture_file: 'lake.pcap' bind_address: '' cut_azimuth_deg: 0 model: MODEL_PUCK_HI_RES time_source: TIME_HOST");
  EXPECT_EQ(params.capture_file, folder_ / "lake.pcap");
  EXPECT_EQ(params.decoder.model, ModelChoice::kPuckHiRes);
  EXPECT_EQ(params.decoder.time, TimeChoice::kHost);
  EXPECT_EQ(Load("source: LOG bind_address: '' cut_azimuth_deg: 0").input, Input::kLog);
}

TEST_F(Vlp16Params, StopTheStartWhenTheyAreWrong) {
  EXPECT_NE(FaultOf("source: CAPTURE bind_address: '' cut_azimuth_deg: 0").find("capture_file"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: '' cut_azimuth_deg: 0 data_port: 8308").find("position_port"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: '' cut_azimuth_deg: 360").find("cut_azimuth_deg"), std::string::npos);
  EXPECT_NE(FaultOf("source: UDP bind_address: ''").find("cut_azimuth_deg"), std::string::npos);
}

}  // namespace
}  // namespace lookout::vlp16
