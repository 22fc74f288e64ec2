// Metadata of Ouster sensors: what recordings of each firmware say, and every field that is wrong.
#include "services/lidar/core/models/ouster_metadata.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/ouster.hpp"
#include "tests/support/files.hpp"

namespace lookout::lidar::ouster_metadata_test {
namespace {

using Json = nlohmann::json;

const std::filesystem::path kMeta = support::kRecordings / "lidars/meta";

OusterMetadata ReadMetadata(const std::string& name) { return ParseOusterMetadata(support::ReadFile(kMeta / name)); }

std::string FaultOf(const std::string& json) {
  try {
    ParseOusterMetadata(json);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// Two channels, firmware 3.
Json Nested() {
  return Json::parse(R"({
    "beam_intrinsics": {"beam_altitude_angles": [10.0, -5.0], "beam_azimuth_angles": [1.5, -1.5],
                        "beam_to_lidar_transform": [1,0,0,3, 0,1,0,0, 0,0,1,4, 0,0,0,1], "lidar_origin_to_beam_origin_mm": 3},
    "config_params": {"lidar_mode": "1024x10", "timestamp_mode": "TIME_FROM_PTP_1588", "udp_port_lidar": 7502, "udp_port_imu": 7503,
                      "return_order": "FARTHEST_TO_NEAREST"},
    "lidar_data_format": {"columns_per_frame": 1024, "columns_per_packet": 8, "pixels_per_column": 2, "column_window": [370, 85],
                          "udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16_DUAL"},
    "lidar_intrinsics": {"lidar_to_sensor_transform": [-1,0,0,0, 0,-1,0,0, 0,0,1,36.18, 0,0,0,1]},
    "imu_intrinsics": {"imu_to_sensor_transform": [1,0,0,6.253, 0,1,0,-11.775, 0,0,1,7.645, 0,0,0,1]},
    "sensor_info": {"prod_line": "OS-1-128", "prod_sn": "122246000293", "build_rev": "v3.0.1", "initialization_id": 1629346}})");
}

TEST(OusterMetadata, OfFirmware3IsReadByField) {
  const auto metadata = ParseOusterMetadata(Nested().dump());
  EXPECT_EQ(metadata.product, "OS-1-128");
  EXPECT_EQ(metadata.ModelName(), "Ouster OS1-128");
  EXPECT_EQ(metadata.serial_number, 122246000293U);
  EXPECT_EQ(metadata.firmware, "v3.0.1");
  EXPECT_EQ(metadata.init_id, 1629346U);
  EXPECT_EQ(metadata.columns_per_frame, 1024);
  EXPECT_EQ(metadata.frames_per_s, 10);
  EXPECT_EQ(metadata.profile, OusterProfile::kDual);
  EXPECT_EQ(metadata.pixels_per_column, 2);
  EXPECT_EQ(metadata.columns_per_packet, 8);
  EXPECT_EQ(metadata.first_column, 370);
  EXPECT_EQ(metadata.last_column, 85);
  EXPECT_EQ(metadata.clock, OusterClock::kPtp);
  EXPECT_EQ(metadata.return_order, OusterReturnOrder::kFarthestToNearest);
  EXPECT_EQ(metadata.lidar_port, 7502);
  EXPECT_EQ(metadata.imu_port, 7503);
  ASSERT_EQ(metadata.elevation_rad.size(), 2U);
  EXPECT_DOUBLE_EQ(metadata.elevation_rad[0], DegToRad(10.0));
  EXPECT_DOUBLE_EQ(metadata.azimuth_offset_rad[1], DegToRad(-1.5));
  EXPECT_DOUBLE_EQ(metadata.beam_origin_m, 0.005) << "3 mm along, 4 mm up";
  EXPECT_DOUBLE_EQ(metadata.beam_origin_height_m, 0.004);
  ASSERT_TRUE(metadata.T_sensor_lidar && metadata.T_sensor_imu);
  EXPECT_TRUE((*metadata.T_sensor_lidar * Eigen::Vector3d(1.0, 2.0, 3.0)).isApprox(Eigen::Vector3d(-1.0, -2.0, 3.03618)));
  EXPECT_TRUE(metadata.T_sensor_imu->translation().isApprox(Eigen::Vector3d(0.006253, -0.011775, 0.007645)));
}

TEST(OusterMetadata, OfAnyLayoutSaysTheSame) {
  const auto nested = Nested();
  Json flat;
  for (const auto& [name, part] : nested.items()) {
    if (name == "lidar_data_format") {
      flat["data_format"] = part;
    } else {
      flat.update(part);
    }
  }
  const auto one = ParseOusterMetadata(flat.dump());
  const auto other = ParseOusterMetadata(nested.dump());
  EXPECT_EQ(one.serial_number, other.serial_number);
  EXPECT_EQ(one.product, other.product);
  EXPECT_EQ(one.clock, other.clock);
  EXPECT_EQ(one.columns_per_packet, other.columns_per_packet);
  EXPECT_EQ(one.elevation_rad, other.elevation_rad);
  EXPECT_EQ(one.frames_per_s, other.frames_per_s);
  EXPECT_EQ(one.imu_port, other.imu_port);
  EXPECT_TRUE(one.T_sensor_imu->isApprox(*other.T_sensor_imu));
}

TEST(OusterMetadata, OfFirmware1HasNoDataFormat) {
  for (const bool has_text : {false, true}) {
    auto json = Nested();
    json.erase("lidar_data_format");
    if (has_text) json["lidar_data_format"] = "error: Command not recognized.";
    json["beam_intrinsics"].erase("beam_to_lidar_transform");
    json["beam_intrinsics"].erase("lidar_origin_to_beam_origin_mm");
    const auto metadata = ParseOusterMetadata(json.dump());
    EXPECT_EQ(metadata.profile, OusterProfile::kLegacy);
    EXPECT_EQ(metadata.columns_per_packet, 16);
    EXPECT_EQ(metadata.first_column, 0);
    EXPECT_EQ(metadata.last_column, 1023);
    EXPECT_DOUBLE_EQ(metadata.beam_origin_m, 0.012163);
  }
}

TEST(OusterMetadata, OfARecordingIsRead) {
  if (!std::filesystem::exists(kMeta)) GTEST_SKIP() << "no recordings at " << kMeta;
  const auto first = ReadMetadata("ouster_1_12_os1-991913000010-64.json");
  EXPECT_EQ(first.ModelName(), "Ouster OS1-64");
  EXPECT_EQ(first.profile, OusterProfile::kLegacy);
  EXPECT_EQ(first.clock, OusterClock::kInternalOscillator);
  EXPECT_EQ(first.lidar_port, 60823);

  const auto window = ReadMetadata("ouster_2_0_0_os1-992008000494-128_col_win_legacy.json");
  EXPECT_EQ(window.first_column, 2014);
  EXPECT_EQ(window.last_column, 2036);
  EXPECT_EQ(window.profile, OusterProfile::kLegacy);

  const auto flat = ReadMetadata("ouster_os0_32.json");
  EXPECT_EQ(flat.ModelName(), "Ouster OS0-32-U1");
  EXPECT_EQ(flat.profile, OusterProfile::kDual);
  EXPECT_DOUBLE_EQ(flat.beam_origin_m, 0.02767);

  EXPECT_EQ(ReadMetadata("ouster_os1_128.json").ModelName(), "Ouster OS1-128");
  EXPECT_EQ(ReadMetadata("ouster_os1_64_fw20_reduced.json").ModelName(), "Ouster with 64 rings");

  const auto nested = ReadMetadata("ouster_3_0_1_os-122246000293-128.json");
  EXPECT_EQ(nested.profile, OusterProfile::kDual);
  EXPECT_DOUBLE_EQ(nested.beam_origin_m, 0.016721);
  EXPECT_DOUBLE_EQ(nested.T_sensor_lidar->translation().z(), 0.038195);
}

// Every second or fourth channel has a beam.
TEST(OusterMetadata, OfFirmware1_13HasChannelsWithoutABeam) {
  const auto sixteen = [](int every) {
    std::string elevations;
    std::string offsets;
    for (int i = 0; i < 64; ++i) {
      const bool has_beam = i % every == every - 1;
      elevations += (i == 0 ? "" : ",") + std::to_string(has_beam ? 15.0 - 0.5 * i : 0.0);
      offsets += (i == 0 ? "" : ",") + std::to_string(has_beam ? -3.1 : 0.0);
    }
    return R"({"prod_line":"OS-1-16-A0","lidar_mode":"1024x10","beam_altitude_angles":[)" + elevations + R"(],"beam_azimuth_angles":[)" + offsets +
           "]}";
  };
  for (const int every : {2, 4}) {
    const auto metadata = ParseOusterMetadata(sixteen(every));
    EXPECT_EQ(metadata.pixels_per_column, 64);
    const auto beams = OusterReader(metadata).head().beams;
    ASSERT_EQ(beams.size(), static_cast<std::size_t>(64 / every));
    for (const auto& beam : beams) EXPECT_EQ(beam.channel % every, every - 1);
  }
  EXPECT_NE(FaultOf(sixteen(8)).find("two channels have one direction"), std::string::npos);
}

TEST(OusterMetadata, ThatIsMalformedIsRefused) {
  if (!std::filesystem::exists(kMeta)) GTEST_SKIP() << "no recordings at " << kMeta;
  const auto zeros = FaultOf(support::ReadFile(kMeta / "ouster_malformed_all_zeros_legacy.json"));
  EXPECT_NE(zeros.find("beam_altitude_angles: two channels have one direction"), std::string::npos) << zeros;
  EXPECT_EQ(FaultOf(support::ReadFile(kMeta / "ouster_malformed_incomplete_data_format_legacy.json")), "data_format.columns_per_frame: missing");
}

TEST(OusterMetadata, IsRefusedByFieldAndReason) {
  const auto fault = [](const char* pointer, const Json& value) {
    auto json = Nested();
    json[Json::json_pointer(pointer)] = value;
    return FaultOf(json.dump());
  };
  const auto missing = [](const char* section, const char* field) {
    auto json = Nested();
    json[section].erase(field);
    return FaultOf(json.dump());
  };
  EXPECT_EQ(fault("/config_params/lidar_mode", "2048x10"), "lidar_data_format.columns_per_frame: 1024, but config_params.lidar_mode says 2048");
  EXPECT_EQ(fault("/config_params/lidar_mode", "1024"), "config_params.lidar_mode: \"1024\" is none such as 1024x10");
  EXPECT_EQ(fault("/config_params/lidar_mode", "1024x"), "config_params.lidar_mode: \"1024x\" is none such as 1024x10");
  EXPECT_EQ(fault("/config_params/lidar_mode", "1024x0"), "config_params.lidar_mode: \"1024x0\" is beyond what a sensor does");
  EXPECT_EQ(fault("/config_params/lidar_mode", "99999999999x10"), "config_params.lidar_mode: \"99999999999x10\" is none such as 1024x10");
  EXPECT_EQ(missing("config_params", "lidar_mode"), "lidar_data_format.fps: missing");
  EXPECT_EQ(fault("/config_params/udp_port_imu", 70000), "config_params.udp_port_imu: beyond 0 to 65535");
  EXPECT_EQ(fault("/config_params/return_order", "RANDOM").rfind("config_params.return_order: \"RANDOM\" is not known:", 0), 0U);
  EXPECT_EQ(fault("/lidar_data_format/udp_profile_lidar", "FIVE_WORD_PIXEL"),
            "lidar_data_format.udp_profile_lidar: \"FIVE_WORD_PIXEL\" is not known: LEGACY RNG19_RFL8_SIG16_NIR16 RNG19_RFL8_SIG16_NIR16_DUAL "
            "RNG15_RFL8_NIR8 FUSA_RNG15_RFL8_NIR8_DUAL");
  EXPECT_EQ(fault("/lidar_data_format/pixels_per_column", 64), "pixels_per_column: 64, but there are angles for 2");
  EXPECT_EQ(fault("/lidar_data_format/pixels_per_column", 129), "lidar_data_format.pixels_per_column: beyond 1 to 128");
  EXPECT_EQ(fault("/lidar_data_format/pixels_per_column", 2.5), "lidar_data_format.pixels_per_column: must be a whole number");
  EXPECT_EQ(fault("/lidar_data_format/columns_per_packet", 0), "lidar_data_format.columns_per_packet: beyond 1 to 64");
  EXPECT_EQ(fault("/lidar_data_format/columns_per_frame", 18446744073709551615U),
            "lidar_data_format.columns_per_frame: beyond -1000000000000000.000000 to 1000000000000000.000000");
  EXPECT_EQ(fault("/lidar_data_format/column_window", Json::array({0, 1024})), "lidar_data_format.column_window: beyond 0 to 1023");
  EXPECT_EQ(fault("/lidar_data_format/column_window", Json::array({0})), "lidar_data_format.column_window: must hold two columns");
  EXPECT_EQ(fault("/lidar_data_format", Json::array()), "lidar_data_format: must be an object");
  EXPECT_EQ(missing("lidar_data_format", "columns_per_packet"), "lidar_data_format.columns_per_packet: missing");
  EXPECT_EQ(missing("lidar_data_format", "pixels_per_column"), "lidar_data_format.pixels_per_column: missing");
  EXPECT_EQ(missing("beam_intrinsics", "beam_altitude_angles"), "beam_altitude_angles: missing");
  EXPECT_EQ(missing("beam_intrinsics", "beam_azimuth_angles"), "beam_azimuth_angles: missing");
  EXPECT_EQ(fault("/beam_intrinsics/beam_altitude_angles", Json::array()),
            "beam_intrinsics.beam_altitude_angles: holds 0 angles; there must be 1 to 128");
  EXPECT_EQ(fault("/beam_intrinsics/beam_altitude_angles", Json::array({1.0, "2"})), "beam_intrinsics.beam_altitude_angles: must hold numbers alone");
  EXPECT_EQ(fault("/beam_intrinsics/beam_altitude_angles", Json::array({1.0, 91.0})),
            "beam_intrinsics.beam_altitude_angles: beyond -90.000000 to 90.000000");
  EXPECT_EQ(fault("/beam_intrinsics/beam_azimuth_angles", Json::array({1.0})),
            "beam_intrinsics.beam_azimuth_angles: 1 angles, but beam_intrinsics.beam_altitude_angles has 2");
  EXPECT_EQ(fault("/beam_intrinsics/lidar_origin_to_beam_origin_mm", -1),
            "beam_intrinsics.lidar_origin_to_beam_origin_mm: beyond 0.000000 to 200.000000");
  EXPECT_EQ(fault("/beam_intrinsics/beam_to_lidar_transform/3", 500), "beam_intrinsics.beam_to_lidar_transform: is no offset along x and z");
  EXPECT_EQ(fault("/lidar_intrinsics/lidar_to_sensor_transform", Json::array({1, 2})),
            "lidar_intrinsics.lidar_to_sensor_transform: must hold 16 numbers");
  EXPECT_EQ(fault("/lidar_intrinsics/lidar_to_sensor_transform/0", 1), "lidar_intrinsics.lidar_to_sensor_transform: is no rotation with an offset")
      << "a mirror";
  EXPECT_EQ(fault("/imu_intrinsics/imu_to_sensor_transform/0", 0), "imu_intrinsics.imu_to_sensor_transform: is no rotation with an offset");
  EXPECT_EQ(fault("/sensor_info/prod_sn", "12x"), "sensor_info.prod_sn: \"12x\" is no number");
  EXPECT_EQ(fault("/sensor_info/prod_sn", "1099511627776"), "sensor_info.prod_sn: beyond 40 bits");
  EXPECT_EQ(fault("/sensor_info/prod_line", std::string(1000, 'x')), "sensor_info.prod_line: too long");
  EXPECT_EQ(fault("/sensor_info/prod_line", 5), "sensor_info.prod_line: must be a text");
}

TEST(OusterMetadata, WithoutASensorsNameIsRead) {
  auto json = Nested();
  json["sensor_info"]["prod_sn"] = "";
  json["sensor_info"]["prod_line"] = nullptr;
  EXPECT_FALSE(ParseOusterMetadata(json.dump()).serial_number);
  EXPECT_EQ(ParseOusterMetadata(json.dump()).ModelName(), "Ouster with 2 rings");
  json.erase("sensor_info");
  EXPECT_FALSE(ParseOusterMetadata(json.dump()).init_id);
}

TEST(OusterMetadata, FromOutsideIsMadePrintable) {
  auto json = Nested();
  json["sensor_info"]["prod_line"] = "OS-1\x1b[2J";
  EXPECT_EQ(ParseOusterMetadata(json.dump()).product, "OS-1?[2J");
}

TEST(OusterMetadata, ThatIsNoJsonOrHugeOrDeepIsRefused) {
  for (const std::string text : {"", "hello", "[]", "5", "null", "{", "\"x", "{\"a\": 1e999}", "\xff\xfe"}) {
    EXPECT_EQ(FaultOf(text), "metadata: no JSON object") << text;
  }
  EXPECT_EQ(FaultOf("{}"), "beam_altitude_angles: missing");
  EXPECT_EQ(FaultOf(std::string(1'000'000, '[')), "metadata: nested too deep");
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_EQ(FaultOf(objects), "metadata: nested too deep");
  EXPECT_EQ(FaultOf(std::string(2'000'000, ' ')), "metadata: more than 1 MiB");
  auto json = Nested();
  json["comment"] = std::string(100, '[') + "\\\"" + std::string(100, '{');
  EXPECT_EQ(FaultOf(json.dump()), "") << "brackets of a text are none";
}

TEST(OusterMetadata, CutAnywhereIsRefused) {
  const auto whole = Nested().dump();
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_NE(FaultOf(whole.substr(0, size)), "") << size;
}

}  // namespace
}  // namespace lookout::lidar::ouster_metadata_test
