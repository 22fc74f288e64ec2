#include "common/config/text_config.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/boat.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/segmenter.pb.h"
#include "config/schema/vlp16.pb.h"

namespace lookout::config {
namespace {

namespace fs = std::filesystem;

std::string FaultsOf(const std::string& text, google::protobuf::Message& message) {
  try {
    ParseText(text, "f.txtpb", message);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string VlpFaults(const std::string& text) {
  Vlp16 message;
  return FaultsOf(text, message);
}

const std::string kGoodVlp = "source: UDP\nbind_address: \"0.0.0.0\"\ncut_azimuth_deg: 0\n";

TEST(TextConfig, AcceptsWhatTheSchemaAsksFor) { EXPECT_EQ(VlpFaults(kGoodVlp), ""); }

TEST(TextConfig, NamesEveryFactThatIsMissing) {
  EXPECT_EQ(VlpFaults("data_port: 2368\n"), "f.txtpb:1: source: must be set\nf.txtpb:1: cut_azimuth_deg: must be set");
}

TEST(TextConfig, RefusesUnknownFieldsWithTheirLine) { EXPECT_NE(VlpFaults(kGoodVlp + "\nno_such_field: 1\n").find("f.txtpb:5:"), std::string::npos); }

TEST(TextConfig, RefusesNumbersThatAreNotFinite) {
  EXPECT_EQ(VlpFaults("source: UDP\nbind_address: \"\"\ncut_azimuth_deg: nan\n"), "f.txtpb:3: cut_azimuth_deg: must be a finite number (is nan)");
  EXPECT_NE(VlpFaults("source: UDP\nbind_address: \"\"\ncut_azimuth_deg: inf\n"), "");
}

TEST(TextConfig, RefusesNumbersOutOfRangeWithTheirLine) {
  EXPECT_EQ(VlpFaults(kGoodVlp + "data_port: 70000\n"), "f.txtpb:4: data_port: must be at most 65535 (is 70000)");
  EXPECT_EQ(VlpFaults(kGoodVlp + "data_port: 0\n"), "f.txtpb:4: data_port: must be at least 1 (is 0)");
}

TEST(TextConfig, RefusesASecondValueOfOneField) { EXPECT_NE(VlpFaults(kGoodVlp + "cut_azimuth_deg: 1\n").find("f.txtpb:4:"), std::string::npos); }

TEST(TextConfig, RefusesAWrongType) { EXPECT_NE(VlpFaults(kGoodVlp + "data_port: \"x\"\n").find("f.txtpb:4:"), std::string::npos); }

TEST(TextConfig, NamesFieldsOfPartsByTheirPath) {
  Boat boat;
  const std::string faults = FaultsOf("name: \"x\"\nlidar {\n x_m: 0 y_m: 0 z_m: 1000\n}\n", boat);
  EXPECT_NE(faults.find("f.txtpb:2: lidar.yaw_deg: must be set"), std::string::npos) << faults;
  EXPECT_NE(faults.find("f.txtpb:3: lidar.z_m: must be at most 200 (is 1000)"), std::string::npos) << faults;
  EXPECT_NE(faults.find("f.txtpb:1: gnss_antenna: must be set"), std::string::npos) << faults;
  EXPECT_EQ(faults.find("datum"), std::string::npos) << faults;
}

TEST(FaultLine, NamesTheLineOfTheValueThatIsWrong) {
  const auto file = std::filesystem::temp_directory_path() / ("lookout_fault_line_" + std::to_string(getpid()));
  std::ofstream(file) << "# capture_file: 'x'\nsource: CAPTURE\ncapture_file: 'a' capture_file: 'b'\n\ncapture_file: 'c'\n";
  const auto line_of = [&](std::size_t index) { return FaultLine(file, "capture_file", "reason", index); };
  EXPECT_EQ(line_of(0), file.string() + ":3: capture_file: reason");
  EXPECT_EQ(line_of(1), line_of(0));
  EXPECT_EQ(line_of(2), file.string() + ":5: capture_file: reason");
  EXPECT_EQ(line_of(9), line_of(2));
  EXPECT_EQ(FaultLine(file, "bind_address", "reason"), file.string() + ":1: bind_address: reason");
  std::filesystem::remove(file);
}

TEST(TextConfig, OfAFileThatIsNotThereIsRefused) {
  Vlp16 message;
  EXPECT_THROW(LoadText("/nonexistent.txtpb", message), ConfigError);
}

TEST(EffectiveText, ShowsDefaultsAndReadsBackTheSame) {
  Segmenter message;
  ParseText("e1_cosine: 0.6\n", "f", message);
  const std::string text = EffectiveText(message);
  EXPECT_NE(text.find("e1_cosine: 0.6\n"), std::string::npos) << text;
  EXPECT_NE(text.find("e3_distance_m: 3.5  # default\n"), std::string::npos) << text;
  Segmenter again;
  ParseText(text, "f", again);
  EXPECT_EQ(again.e3_distance_m(), 3.5);
}

TEST(Config, EveryFileOfEveryBoatLoads) {
  int num_files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(LOOKOUT_SOURCE_DIR) / "config")) {
    if (entry.path().extension() != ".txtpb") continue;
    EXPECT_NO_THROW(EffectiveTextOfFile(entry.path())) << entry.path();
    ++num_files;
  }
  EXPECT_GE(num_files, 12);
}

TEST(Boat, BoxesAreNotTurnedInsideOut) {
  const auto boat = LoadBoat(fs::path(LOOKOUT_SOURCE_DIR) / "config/demo");
  EXPECT_LT(boat.own_vessel_box_m.min().x(), boat.own_vessel_box_m.max().x());
  EXPECT_NEAR(boat.T_vessel_lidar.translation().x(), 0.5, 1e-12);
}

}  // namespace
}  // namespace lookout::config
