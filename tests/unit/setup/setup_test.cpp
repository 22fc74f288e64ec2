// The answers of a person, and the boat that is made of them.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "tests/support/files.hpp"
#include "tools/setup/boat_file.hpp"
#include "tools/setup/folder.hpp"
#include "tools/setup/picture.hpp"
#include "tools/setup/questions.hpp"

namespace lookout::setup {
namespace {

namespace fs = std::filesystem;

lidar::Speaker Vlp16At(const std::string& address) {
  lidar::Speaker speaker;
  speaker.source_address = address;
  speaker.data_port = 2368;
  speaker.second_port = 8308;
  speaker.name = "Velodyne VLP-16";
  speaker.is_of_vlp16_family = true;
  speaker.num_packets = 755;
  speaker.last = Utime(std::chrono::seconds(1));
  return speaker;
}

NmeaHeard OnUdp(int port) {
  return {.kind = NmeaHeard::Kind::kUdp, .port = port, .num_by_type = {{"HDT", 10}, {"RMC", 1}}, .has_position = true, .has_heading = true};
}

NmeaHeard OnSerial(const std::string& device) {
  return {.kind = NmeaHeard::Kind::kSerial, .device = device, .baud = 4800, .num_by_type = {{"GGA", 5}}, .has_position = true, .seconds = 4.0};
}

// What is asked and said, and the answers.
struct Talk {
  bool is_whole = false;
  std::string text;
  config::Answers answers;
};
Talk TalkOf(const std::string& input, const Heard& heard) {
  Talk talk;
  std::istringstream in(input);
  std::ostringstream out;
  talk.is_whole = Ask(heard, in, out, talk.answers);
  talk.text = out.str();
  return talk;
}

const std::string kUsual = "Ida\n5.2 x 2.1\n1.2 0 1.5\n\n\n\n\n\n";
Heard OneLidar() { return {.lidars = {Vlp16At("192.168.1.201")}}; }

std::string FaultsIn(const std::string& text, const Heard& heard) {
  const support::TempDir folder;
  support::WriteFile(folder / "answers.txtpb", text);
  try {
    LoadAnswers(folder / "answers.txtpb", heard);
  } catch (const config::ConfigError& error) {
    std::string faults;
    for (const auto& fault : error.faults()) faults += fault.substr(fault.find("answers.txtpb")) + "\n";
    return faults;
  }
  return "";
}

TEST(Questions, AreTenAtMost) {
  EXPECT_EQ(QuestionsFor(OneLidar()).size(), 8U);
  EXPECT_EQ(QuestionsFor({}).size(), 9U);
  const Heard most{.lidars = {Vlp16At("192.168.1.201"), Vlp16At("192.168.1.202")}, .nmea = {OnUdp(10110)}};
  EXPECT_EQ(QuestionsFor(most).size(), kMostQuestions);
}

TEST(Questions, TakeUsualAnswersForEmptyLines) {
  const auto talk = TalkOf(kUsual, OneLidar());
  ASSERT_TRUE(talk.is_whole) << talk.text;
  EXPECT_EQ(talk.answers.name(), "Ida");
  EXPECT_EQ(talk.answers.hull_length_m(), 5.2);
  EXPECT_EQ(talk.answers.hull_beam_m(), 2.1);
  EXPECT_EQ(talk.answers.lidar().behind_bow_m(), 1.2);
  EXPECT_EQ(talk.answers.lidar_faces_deg(), 0.0);
  EXPECT_FALSE(talk.answers.has_gnss_antenna());
  EXPECT_EQ(GuardZoneM(talk.answers), 11.0) << "8 m beyond the bow";
  EXPECT_EQ(talk.answers.viewers(), config::Answers::THIS_COMPUTER);
}

TEST(Questions, AreAskedAgainWithTheReason) {
  const auto talk = TalkOf(
      "Ida\n"
      "\nfive x two\n5,2\n5.2\n2.1 5.2\n5.2 x 900\nnan 2\n5.2 m x 2.1m\n"
      "1.2 0\n1.2 0 -1\n40 0 1\n1.2 9 1\n1.2 0 1.5\n"
      "up\nport\n"
      "upside down\n"
      "here\n4 -0.5 1.8\n"
      "2\n0\n"
      "nobody\neverybody\n",
      OneLidar());
  ASSERT_TRUE(talk.is_whole) << talk.text;
  for (const auto* reason :
       {"an answer is needed here", "'five x two' holds what is no number: 2 numbers, with a point as in 1.5", "'5,2' holds what is no number",
        "1 number came: 2 numbers", "hull_beam_m: must not be greater than the length (5.2 against 2.1 m)",
        "hull_beam_m: must be at most 40 (is 900)", "hull_length_m: must be a finite number", "2 numbers came: 3 numbers",
        "lidar.above_water_m: must be above the water, greater than 0 (is -1)",
        "lidar.behind_bow_m: is more than 2 m outside of a hull of 5.2 m (is 40)",
        "lidar.to_port_m: is more than 2 m outside of a hull 2.1 m wide (is 9)", "'up' holds what is no number", "'here' holds what is no number",
        "guard_zone_m: must reach beyond the bow, which is 2.8 m ahead of the middle (is 2)", "'nobody' is neither: this computer, everybody"}) {
    EXPECT_NE(talk.text.find(reason), std::string::npos) << reason << " is missing in\n" << talk.text;
  }
  EXPECT_EQ(talk.answers.lidar_faces_deg(), 90.0);
  EXPECT_EQ(talk.answers.lidar_roll_deg(), 180.0);
  EXPECT_EQ(talk.answers.gnss_antenna().to_port_m(), -0.5);
  EXPECT_EQ(GuardZoneM(talk.answers), 0.0);
}

TEST(Questions, EndWithTheInput) {
  EXPECT_FALSE(TalkOf("Ida\n5.2 x 2.1\n", OneLidar()).is_whole);
  EXPECT_FALSE(TalkOf("", OneLidar()).is_whole);
}

TEST(Questions, AskWhichOfSeveralLidarsAndForOneThatIsSilent) {
  const Heard two{.lidars = {Vlp16At("192.168.1.201"), Vlp16At("192.168.1.202")}};
  const auto talk = TalkOf("Ida\n5.2 x 2.1\n3\n1.5\n2\n1.2 0 1.5\n\n\n\n\n\n", two);
  ASSERT_TRUE(talk.is_whole) << talk.text;
  EXPECT_EQ(talk.answers.lidar_address(), "192.168.1.202");
  EXPECT_NE(talk.text.find("a number of 1 to 2"), std::string::npos) << talk.text;
  EXPECT_NE(BoatFile(talk.answers, two).find("allowed_source_address: \"192.168.1.202\""), std::string::npos);

  const auto silent = TalkOf("Ida\n5.2 x 2.1\nOS9\nXT32\n1.2 0 1.5\n\n\n\n\n\n", {});
  ASSERT_TRUE(silent.is_whole) << silent.text;
  EXPECT_NE(silent.text.find("'OS9' is none of AUTO, VLP16"), std::string::npos) << silent.text;
  EXPECT_NE(BoatFile(silent.answers, {}).find("model: MODEL_XT32\n"), std::string::npos);
}

TEST(Answers, OfAFileAreRefusedWithTheirLines) {
  const std::string good = "hull_length_m: 5.2\nhull_beam_m: 2.1\nlidar { behind_bow_m: 1.2 to_port_m: 0 above_water_m: 1.5 }\n";
  EXPECT_EQ(FaultsIn(good, OneLidar()), "");
  EXPECT_EQ(FaultsIn("hull_length_m: 5.2\nlidar { behind_bow_m: 1 }\n", OneLidar()),
            "answers.txtpb:1: hull_beam_m: must be set\nanswers.txtpb:2: lidar.to_port_m: must be set\nanswers.txtpb:2: lidar.above_water_m: must be "
            "set\n");
  EXPECT_EQ(FaultsIn(good + "hull: 3\n", OneLidar()),
            "answers.txtpb:4: hull: Message type \"lookout.config.Answers\" has no field named \"hull\".\n");
  EXPECT_EQ(FaultsIn(good + "\ngnss_antenna { behind_bow_m: 30 to_port_m: 0 above_water_m: 0 }\n", OneLidar()),
            "answers.txtpb:5: gnss_antenna: behind_bow_m is more than 2 m outside of a hull of 5.2 m (is 30)\n"
            "answers.txtpb:5: gnss_antenna: above_water_m must be above the water, greater than 0 (is 0)\n");
  EXPECT_EQ(FaultsIn(good + "lidar_address: \"192.168.1.9\"\n", OneLidar()),
            "answers.txtpb:4: lidar_address: no lidar speaks from '192.168.1.9'; those that do: 192.168.1.201 (Velodyne VLP-16)\n");
  const Heard two{.lidars = {Vlp16At("192.168.1.201"), Vlp16At("192.168.1.202")}};
  EXPECT_EQ(FaultsIn(good, two),
            "answers.txtpb:1: lidar_address: must be set: several lidars speak: 192.168.1.201 (Velodyne VLP-16), 192.168.1.202 (Velodyne VLP-16)\n");
}

// In the vessel frame from the middle of the hull, at the height of the water.
TEST(BoatFile, HoldsTheFactsOfTheAnswers) {
  const support::TempDir folder;
  auto talk = TalkOf("Ida \"2\"\n6 x 2\n-0.5 0.1 1.25\nstarboard\n1 -2\n5.75 -0.4 2\n30\n\n", OneLidar());
  ASSERT_TRUE(talk.is_whole) << talk.text;
  support::WriteFile(folder / "boat.txtpb", BoatFile(talk.answers, OneLidar()));
  const auto boat = config::LoadBoat(folder);
  EXPECT_EQ(boat.name, "Ida \"2\"");
  EXPECT_EQ(boat.lidar.p_vessel_m, Eigen::Vector3d(3.5, 0.1, 1.25));
  EXPECT_NEAR(boat.lidar.yaw_rad, -1.5708, 1e-4);
  EXPECT_NEAR(boat.lidar.pitch_rad, -0.0349, 1e-4);
  EXPECT_EQ(boat.p_vessel_antenna_m, Eigen::Vector3d(-2.75, -0.4, 2.0));
  EXPECT_EQ(boat.reference_point_above_water_m, 0.0);
  EXPECT_EQ(boat.own_vessel_box_m.min(), Eigen::Vector3d(-3.2, -1.2, -1.0));
  EXPECT_EQ(boat.own_vessel_box_m.max(), Eigen::Vector3d(3.7, 1.2, 2.15)) << "the lidar hangs before the bow";
  for (const auto& remark : config::RemarksOnBoat(boat)) EXPECT_EQ(remark.cure, "") << remark.words;
  const auto whole = config::Load<config::Boat>(folder, "boat.txtpb");
  EXPECT_EQ(whole.tracker().guard_zone().range_m(), 30.0);
  EXPECT_EQ(whole.lidar_input().data_port(), 2368);
  EXPECT_FALSE(whole.has_page());
}

TEST(BoatFile, HasAnInputForEachSourceOfSentences) {
  const Heard heard{.lidars = {Vlp16At("192.168.1.201")}, .nmea = {OnUdp(2000), OnUdp(10110), OnSerial("/dev/serial/by-id/usb-gnss")}};
  const auto talk = TalkOf("Ida\n5.2 x 2.1\n1.2 0 1.5\n\n\n\n-90\n\neverybody\n", heard);
  ASSERT_TRUE(talk.is_whole) << talk.text;
  const support::TempDir folder;
  support::WriteFile(folder / "boat.txtpb", BoatFile(talk.answers, heard));
  const auto boat = config::Load<config::Boat>(folder, "boat.txtpb");
  EXPECT_EQ(boat.navigator().bind_address(), "0.0.0.0");
  EXPECT_EQ(boat.navigator().heading_offset_deg(), -90.0);
  ASSERT_EQ(boat.navigator().input_size(), 2);
  EXPECT_EQ(boat.navigator().input(0).udp().port(), 2000);
  EXPECT_EQ(boat.navigator().input(1).serial().device(), "/dev/serial/by-id/usb-gnss");
  EXPECT_EQ(boat.navigator().input(1).serial().baud(), 4800);
  EXPECT_EQ(boat.page().bind_address(), "0.0.0.0");
  EXPECT_EQ(WriteBoat(folder / "new", BoatFile(talk.answers, heard), false), std::vector<fs::path>()) << "it is right for every process";
}

TEST(BoatFile, IsTheSameHoweverLongItWasListened) {
  auto heard = OneLidar();
  heard.nmea = {OnUdp(10110)};
  const auto answers = TalkOf("Ida\n5.2 x 2.1\n1.2 0 1.5\n\n\n\n\n\n\n", heard).answers;
  const auto text = BoatFile(answers, heard);
  heard.lidars.front().num_packets = 99;
  heard.nmea.front().num_by_type["RMC"] = 55;
  heard.nmea.front().seconds = 30.0;
  EXPECT_EQ(BoatFile(answers, heard), text);
}

// lookout-setup asks an Ouster itself for its beams, where it knows its address.
TEST(BoatFile, AsksAnOusterForItsBeams) {
  auto speaker = Vlp16At("192.168.1.150");
  speaker.is_of_vlp16_family = false;
  speaker.other = lidar::OtherModel::kOuster;
  speaker.data_port = 7502;
  speaker.second_port = 7503;
  const Heard heard{.lidars = {speaker}};
  const auto text = BoatFile(TalkOf(kUsual, heard).answers, heard);
  EXPECT_NE(text.find("sensor_address: \"192.168.1.150\""), std::string::npos) << text;
  EXPECT_EQ(text.find("beam_file"), std::string::npos) << text;
  const support::TempDir folder;
  EXPECT_NO_THROW(WriteBoat(folder / "new", text, false));
}

TEST(Folder, KeepsWhatItReplacesAndNeedsForce) {
  const support::TempDir folder;
  const auto text = BoatFile(TalkOf(kUsual, OneLidar()).answers, OneLidar());
  support::WriteFile(folder / "boat.txtpb", "old 1");
  support::WriteFile(folder / "tracker.txtpb", "old 2");
  support::WriteFile(folder / "segmenter.txtpb", "land_probability: 0.6\n");
  EXPECT_THROW(WriteBoat(folder, text, false), std::runtime_error);
  EXPECT_EQ(support::ReadFile(folder / "boat.txtpb"), "old 1");
  EXPECT_EQ(WriteBoat(folder, text, true), (std::vector<fs::path>{folder / "boat.txtpb.old", folder / "tracker.txtpb.old"}));
  EXPECT_EQ(support::ReadFile(folder / "boat.txtpb.old"), "old 1");
  EXPECT_EQ(support::ReadFile(folder / "tracker.txtpb.old"), "old 2");
  EXPECT_EQ(support::ReadFile(folder / "boat.txtpb"), text);
  EXPECT_FALSE(fs::exists(folder / "tracker.txtpb"));
  EXPECT_EQ(WriteBoat(folder, text, true), std::vector<fs::path>{folder / "boat.txtpb.old.2"}) << "nothing is lost";
}

TEST(Folder, IsNotChangedByABoatThatIsWrong) {
  const support::TempDir folder;
  support::WriteFile(folder / "boat.txtpb", "old");
  support::WriteFile(folder / "segmenter.txtpb", "max_range_m: -1\n");
  const auto text = BoatFile(TalkOf(kUsual, OneLidar()).answers, OneLidar());
  try {
    WriteBoat(folder, text, true);
    FAIL() << "a segmenter.txtpb that stays is wrong";
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find((folder / "segmenter.txtpb").string() + ":1: max_range_m"), std::string::npos) << error.what();
  }
  EXPECT_EQ(support::ReadFile(folder / "boat.txtpb"), "old");
  EXPECT_FALSE(fs::exists(folder / "boat.txtpb.old"));
}

TEST(Picture, ShowsBoatAndSensorsFromAboveAndFromTheSide) {
  config::Answers answers;
  EXPECT_EQ(Picture(answers), "");
  answers.set_hull_length_m(6);
  answers.set_hull_beam_m(2);
  auto& lidar = *answers.mutable_lidar();
  lidar.set_behind_bow_m(1.5);
  lidar.set_to_port_m(0);
  lidar.set_above_water_m(1.6);
  answers.set_lidar_faces_deg(90);
  auto& antenna = *answers.mutable_gnss_antenna();
  antenna.set_behind_bow_m(5.5);
  antenna.set_to_port_m(-0.5);
  antenna.set_above_water_m(1.1);
  EXPECT_EQ("\n" + Picture(answers), R"(
seen from above: ahead is right, port is up; 6 x 2 m

          ---------------------------------
          |                                \----
          |                                     \---
          |                                ^        \-
          |                     +          L          >
          |                                         /-
          |   G                                 /---
          |                                /----
          ---------------------------------

seen from starboard: ahead is right; ~ the water
                                           L
                                           |
              G                            |
              |                            |
              |                            |
          _____________________________________________
~~~~~~~~~~\                                           /~~~~~~~~~
           -------------------------------------------
)");
}

TEST(Hearing, SaysWhatIsThereAndWhatLacks) {
  Heard heard = OneLidar();
  heard.nmea = {OnSerial("/dev/ttyUSB0")};
  heard.unread = {"Livox"};
  const auto lines = InWords(heard);
  const std::vector<std::string> wanted{"lidar: Velodyne VLP-16 at 192.168.1.201, port 2368, 754 packets/s",
                                        "lidar: Livox, whose packets are not read", "NMEA 0183, serial port /dev/ttyUSB0, 4800 baud: GGA 1.2/s",
                                        "lacking: no heading. The course over ground stands in for it above 1 m/s",
                                        "lacking: no roll and pitch. In waves places far away are less sure"};
  EXPECT_EQ(lines, wanted);
  EXPECT_EQ(InWords({}).size(), 4U);
}

}  // namespace
}  // namespace lookout::setup
