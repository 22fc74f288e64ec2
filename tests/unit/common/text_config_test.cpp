#include "common/config/text_config.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/boat.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/georeferencer.pb.h"
#include "config/schema/lidar.pb.h"
#include "config/schema/navigator.pb.h"
#include "config/schema/recorder.pb.h"
#include "config/schema/segmenter.pb.h"
#include "config/schema/tracker.pb.h"
#include "tests/support/files.hpp"

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
  Lidar message;
  return FaultsOf(text, message);
}

const std::string kRestOfBoat =
    "gnss_antenna { x_m: 0 y_m: 0 z_m: 0 }\nreference_point_above_water_m: 0\n"
    "own_vessel { min_x_m: -1 max_x_m: 1 min_y_m: -1 max_y_m: 1 min_z_m: -1 max_z_m: 1 }\n";
const std::string kGoodVlp = "source: UDP\nbind_address: \"0.0.0.0\"\ncut_azimuth_deg: 0\n";

TEST(TextConfig, AcceptsWhatTheSchemaAsksFor) { EXPECT_EQ(VlpFaults(kGoodVlp), ""); }

TEST(TextConfig, NamesEveryFactThatIsMissing) {
  GuardZone zone;
  EXPECT_EQ(FaultsOf("from_bearing_deg: 0\n", zone), "f.txtpb:1: range_m: must be set");
  UdpPort port;
  EXPECT_EQ(FaultsOf("", port), "f.txtpb:1: bind_address: must be set\nf.txtpb:1: port: must be set");
}

TEST(TextConfig, RefusesUnknownFieldsWithTheirLine) { EXPECT_NE(VlpFaults(kGoodVlp + "\nno_such_field: 1\n").find("f.txtpb:5:"), std::string::npos); }

// Protobuf itself reads over names that a schema reserves.
TEST(TextConfig, SaysOfFieldsThatAreGoneWhatToDo) {
  Tracker tracker;
  EXPECT_EQ(
      FaultsOf("cpa_limit_m: 4\nmap: \"lake.geojson\"\nwarning_tcpa_s: 20\n", tracker),
      "f.txtpb:2: map: is gone: the tracker reads no map. Delete the line; lookout-export --table map makes the map out of the logs of many days\n"
      "f.txtpb:3: warning_tcpa_s: is gone: a warning means that no more time is left than this boat needs. Delete the line, and set reaction_s, "
      "deceleration_mps2 and turn_rate_degps");
  Georeferencer georeferencer;
  EXPECT_EQ(FaultsOf("guard_zone { range_m: 10 }\n", georeferencer), "f.txtpb:1: guard_zone: is gone from here: move it to tracker.txtpb");
}

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

// One misspelled field used to hide all that stood behind it.
TEST(TextConfig, TellsEveryFaultOfATextAtOnceInTheOrderOfItsLines) {
  Boat boat;
  const std::string text =
      "nam: \"x\"  # misspelled\n"
      "lidar {\n"
      "  x_m: \"half\" y_m: 0\n"
      "\tz_m: 1000  z_m: 1\n"
      "  roll_deg: 0 pitch_deg: 0 yaw_deg 5\n"
      "}\n"
      "antenna { x_m: 0 nonsense: [1, { a: 2 }] }\n"
      "lidar { x_m: 0 }\n"
      "reference_point_above_water_m: nan\n";
  EXPECT_EQ(FaultsOf(text, boat),
            "f.txtpb:1: nam: Message type \"lookout.config.Boat\" has no field named \"nam\".\n"
            "f.txtpb:1: name: must be set\n"
            "f.txtpb:1: gnss_antenna: must be set\n"
            "f.txtpb:1: own_vessel: must be set\n"
            "f.txtpb:3: lidar.x_m: Expected double, got: \"half\"\n"
            "f.txtpb:4: lidar.z_m: stands twice; the first is in line 4\n"
            "f.txtpb:4: lidar.z_m: must be at most 200 (is 1000)\n"
            "f.txtpb:5: lidar.yaw_deg: Expected \":\", found \"5\".\n"
            "f.txtpb:7: antenna: Message type \"lookout.config.Boat\" has no field named \"antenna\".\n"
            "f.txtpb:8: lidar: stands twice; the first is in line 2\n"
            "f.txtpb:9: reference_point_above_water_m: must be a finite number (is nan)");
}

// The separator behind a refused statement goes with it: alone it is a fault of its own, and what stands behind it is not looked at.
TEST(TextConfig, TellsEveryFaultOfATextWithSeparators) {
  const std::string unknown = "Message type \"lookout.config.Lidar\" has no field named ";
  EXPECT_EQ(VlpFaults("source: UDP, bind_addres: \"0.0.0.0\", cut_azimuth_deg: 0, data_port: 70000\n"),
            "f.txtpb:1: bind_addres: " + unknown + "\"bind_addres\".\nf.txtpb:1: data_port: must be at most 65535 (is 70000)");
  EXPECT_EQ(VlpFaults("source: UDP;\nx: 1;\ny { z: 1 };\ncut_azimuth_deg: 0;\ncut_azimuth_deg: 1;\ndata_port: 70000;\n"),
            "f.txtpb:2: x: " + unknown + "\"x\".\nf.txtpb:3: y: " + unknown +
                "\"y\".\nf.txtpb:5: cut_azimuth_deg: stands twice; the first is in line 4\nf.txtpb:6: data_port: must be at most 65535 (is 70000)");
  EXPECT_EQ(
      VlpFaults("source: UDP,, x: 1, cut_azimuth_deg: 0\n; data_port: 70000\n"),
      "f.txtpb:1: text: Expected identifier, got: ,\nf.txtpb:1: x: " + unknown + "\"x\".\nf.txtpb:2: data_port: must be at most 65535 (is 70000)");
  EXPECT_EQ(VlpFaults("source: UDP; cut_azimuth_deg: 0, data_port: 2368;\n"), "");
}

TEST(TextConfig, TellsEveryFaultOfAPartWithSeparators) {
  Boat boat;
  EXPECT_EQ(FaultsOf("name: 'x', lidar { x_m: \"half\", y_m: 0, z_m: 1000; roll_deg: 0 pitch_deg: 0, yaw_deg: 0 };\n" + kRestOfBoat, boat),
            "f.txtpb:1: lidar.x_m: Expected double, got: \"half\"\nf.txtpb:1: lidar.z_m: must be at most 200 (is 1000)");
}

// A bracket that is never closed does not take the closing one of the message around it.
TEST(TextConfig, ABracketThatIsNotClosedIsOneFault) {
  for (const std::string value : {"[1", "<5", "[<1", "<[1", "5>", "5 ]"}) {
    Boat boat;
    const auto faults =
        FaultsOf("name: 'x'\nlidar {\n  x_m: " + value + "\n  y_m: 0 z_m: 0 roll_deg: 0 pitch_deg: 0 yaw_deg: 400\n}\n" + kRestOfBoat, boat);
    EXPECT_EQ(std::ranges::count(faults, '\n'), 1) << value << ":\n" << faults;
    EXPECT_EQ(faults.rfind("f.txtpb:3: lidar.", 0), 0U) << value << ":\n" << faults;
    EXPECT_NE(faults.find("\nf.txtpb:4: lidar.yaw_deg: must be at most 360 (is 400)"), std::string::npos) << value << ":\n" << faults;
  }
}

TEST(TextConfig, AFieldWithoutAValueDoesNotTakeTheNextPartForIt) {
  Boat boat;
  const auto faults = FaultsOf("name:\nlidar { x_m: 0 y_m: 0 z_m: 1000 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 }\n" + kRestOfBoat, boat);
  EXPECT_EQ(std::ranges::count(faults, '\n'), 1) << faults;
  EXPECT_EQ(faults.rfind("f.txtpb:1: name: ", 0), 0U) << faults;
  EXPECT_NE(faults.find("\nf.txtpb:2: lidar.z_m: must be at most 200 (is 1000)"), std::string::npos) << faults;
}

TEST(TextConfig, ChecksWholeNumbersOf64BitsToo) {
  Recorder recorder;
  EXPECT_EQ(FaultsOf("log_folder: \"logs\"\nreserve_bytes: -1\nqueue_bytes: 5000000000\nmax_file_s: 604801\n", recorder),
            "f.txtpb:2: reserve_bytes: must be at least 0 (is -1)\n"
            "f.txtpb:3: queue_bytes: must be at most 4e+09 (is 5e+09)\n"
            "f.txtpb:4: max_file_s: must be at most 604800 (is 604801)");
}

TEST(TextConfig, SaysOnceWhatIsWrongWithAnUnknownWordOfAnEnumeration) {
  EXPECT_EQ(VlpFaults("source: UPD\nbind_address: \"0.0.0.0\"\ncut_azimuth_deg: 0\n"),
            "f.txtpb:1: source: Unknown enumeration value of \"UPD\" for field \"source\".");
}

TEST(TextConfig, SaysWhatIsLeftOpenAndWhatStandsBeforeIt) {
  Boat boat;
  const auto faults = FaultsOf("nam: 'x'\nlidar {\n  xx: 1\n", boat);
  EXPECT_NE(faults.find("f.txtpb:1: nam: "), std::string::npos) << faults;
  EXPECT_NE(faults.find("f.txtpb:3: lidar.xx: "), std::string::npos) << faults;
  EXPECT_NE(faults.find("f.txtpb:4: text: column 1: "), std::string::npos) << faults;
  EXPECT_EQ(faults.find("must be set"), std::string::npos) << faults;
}

TEST(TextConfig, OfNonsenseTellsAHundredFaultsAndHowManyMore) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "{ a: [ < '\n";
  const auto faults = VlpFaults(text);
  EXPECT_EQ(std::ranges::count(faults, '\n'), 100) << faults.substr(0, 500);
  EXPECT_NE(faults.find("faults more"), std::string::npos);
  for (int i = 0; i < 5000; ++i) text += "}]>";
  EXPECT_NE(VlpFaults(text), "");
}

TEST(FaultList, TellsTheFaultsOfTwoFilesEachOnce) {
  FaultList faults;
  const auto load = [](const std::string& name, const std::string& text) {
    Lidar message;
    ParseText(text, name, message);
    return message;
  };
  EXPECT_FALSE(faults.Take([&] { return load("a", "source: UDP\nbind_addres: ''\n"); }));
  EXPECT_FALSE(faults.Take([&] { return load("b", kGoodVlp + "data_port: 0\n"); }));
  EXPECT_FALSE(faults.Take([&] { return load("b", kGoodVlp + "data_port: 0\n"); }));
  EXPECT_TRUE(faults.Take([&] { return load("c", kGoodVlp); }));
  faults.Add("c:1: data_port: must differ");
  try {
    faults.ThrowIfAny();
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    EXPECT_EQ(std::string(error.what()),
              "a:2: bind_addres: Message type \"lookout.config.Lidar\" has no field named \"bind_addres\".\n"
              "b:4: data_port: must be at least 1 (is 0)\n"
              "c:1: data_port: must differ");
  }
}

TEST(FaultLine, NamesTheLineOfTheValueThatIsWrong) {
  const support::TempDir folder;
  const auto file = folder / "file";
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
  Lidar message;
  EXPECT_THROW(LoadText("/nonexistent.txtpb", message), ConfigError);
}

std::string FaultOfFile(const fs::path& file) {
  try {
    Lidar message;
    LoadText(file, message);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "none";
}

// A FIFO held the process for ever, deaf to SIGTERM; /dev/zero filled the memory.
TEST(TextConfig, OfWhatIsNoFileIsRefusedAtOnce) {
  const support::TempDir folder;
  const auto fifo = folder / "lidar.txtpb";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(FaultOfFile(fifo), fifo.string() + ":1: file: is no regular file (a FIFO, a socket or a device)");
  fs::create_symlink(fifo, folder / "link.txtpb");
  EXPECT_NE(FaultOfFile(folder / "link.txtpb").find("is no regular file"), std::string::npos);
  EXPECT_EQ(FaultOfFile("/dev/zero"), "/dev/zero:1: file: is no regular file (a FIFO, a socket or a device)");
  EXPECT_EQ(FaultOfFile(folder), folder.string() + ":1: file: is a folder");
  std::ofstream(folder / "huge").flush();
  fs::resize_file(folder / "huge", std::uintmax_t{8} << 30U);  // no byte of it is on the disk
  EXPECT_EQ(FaultOfFile(folder / "huge"), (folder / "huge").string() + ":1: file: is greater than 4194304 bytes: no config");
}

TEST(TextConfig, WithAByteOrderMarkIsRefusedInWords) {
  EXPECT_EQ(VlpFaults("\xEF\xBB\xBF" + kGoodVlp),
            "f.txtpb:1: text: begins with a byte order mark (EF BB BF): save it as UTF-8 without one (\"UTF-8\", not \"UTF-8 with BOM\")");
  EXPECT_EQ(VlpFaults(std::string("\xFF\xFEs\0o\0", 6)), "f.txtpb:1: text: is UTF-16 (it begins with its byte order mark): save it as UTF-8");
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
  for (const auto& entry : fs::recursive_directory_iterator(support::kSources / "config")) {
    if (entry.path().extension() != ".txtpb") continue;
    EXPECT_NO_THROW(EffectiveTextOfFile(entry.path())) << entry.path();
    ++num_files;
  }
  EXPECT_GE(num_files, 12);
}

TEST(Boat, BoxesAreNotTurnedInsideOut) {
  const auto boat = LoadBoat(support::kDemoConfig);
  EXPECT_LT(boat.own_vessel_box_m.min().x(), boat.own_vessel_box_m.max().x());
  EXPECT_NEAR(boat.T_vessel_lidar.translation().x(), 0.5, 1e-12);
}

TEST(OldNames, OfTheLidarsConfigAreReadWhileTheNewOneIsNotThere) {
  const support::TempDir folder;
  support::WriteFile(folder / "vlp16.txtpb", "source: LOG cut_azimuth_deg: 10\n");
  Lidar message;
  LoadText(folder / "lidar.txtpb", message);
  EXPECT_EQ(message.cut_azimuth_deg(), 10.0);
  EXPECT_EQ(OldConfigFile(folder / "lidar.txtpb"), folder / "vlp16.txtpb");
  EXPECT_NE(EffectiveTextOfFile(folder / "vlp16.txtpb").find("cut_azimuth_deg: 10"), std::string::npos);
  support::WriteFile(folder / "lidar.txtpb", "source: LOG cut_azimuth_deg: 20\n");
  Lidar renamed;
  LoadText(folder / "lidar.txtpb", renamed);
  EXPECT_EQ(renamed.cut_azimuth_deg(), 20.0);
  EXPECT_FALSE(OldConfigFile(folder / "lidar.txtpb"));
  EXPECT_FALSE(OldConfigFile(folder / "segmenter.txtpb"));
}

}  // namespace
}  // namespace lookout::config
