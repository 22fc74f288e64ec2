// Which lidar sends a datagram, told without a config.
#include "services/lidar/survey.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/lidar/packet_maker.hpp"
#include "tests/unit/lidar_models/hesai_packet.hpp"
#include "tests/unit/lidar_models/ouster_packet_maker.hpp"
#include "tests/unit/lidar_models/velodyne_packet.hpp"

namespace lookout::lidar {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Utime kStart{std::chrono::seconds(1'795'780'801)};  // 2026-11-27 12:00:01

std::vector<Speaker> SpeakersOf(const std::vector<std::uint8_t>& payload, int port, int num = 8, milliseconds period = milliseconds(1)) {
  Survey survey;
  for (int i = 0; i < num; ++i) survey.Add(kStart + i * period, "192.168.1.201", "255.255.255.255", port, payload);
  return survey.Speakers();
}

TEST(Survey, TellsEachHesai) {
  const std::vector<std::pair<HesaiModel, std::string>> models{{HesaiModel::kXt16, "MODEL_XT16"},        {HesaiModel::kXt32, "MODEL_XT32"},
                                                               {HesaiModel::kXt32m, "MODEL_XT32M"},      {HesaiModel::kQt64, "MODEL_QT64"},
                                                               {HesaiModel::kQt128, "MODEL_QT128"},      {HesaiModel::kPandar40p, "MODEL_PANDAR40P"},
                                                               {HesaiModel::kPandar64, "MODEL_PANDAR64"}};
  for (const auto& [model, word] : models) {
    const auto speakers = SpeakersOf(MadeHesaiPacket(model, 0x37).bytes, 2368);
    ASSERT_EQ(speakers.size(), 1U) << word;
    EXPECT_EQ(speakers[0].name, NameOf(model));
    EXPECT_EQ(speakers[0].num_packets, 8);
    EXPECT_EQ(ConfigLines(speakers[0]), "model: " + word + "\ndata_port: 2368\nposition_port: 10110\n");
    // The packets say 12:00:01 and 250 us.
    ASSERT_TRUE(speakers[0].host_minus_stamp) << word;
    EXPECT_EQ(*speakers[0].host_minus_stamp, microseconds(-250)) << word;
  }
}

TEST(Survey, TellsTheVelodynes) {
  const auto hdl32 = SpeakersOf(MakeVelodynePacket(VelodyneModel::kHdl32e, 0x37), 2368, 8, milliseconds(1));
  const auto vlp32 = SpeakersOf(MakeVelodynePacket(VelodyneModel::kVlp32c, 0x37), 2369);
  const auto vls128 = SpeakersOf(MakeVelodynePacket(VelodyneModel::kVls128, 0x37), 2368);
  ASSERT_EQ(vlp32.size() + vls128.size() + hdl32.size(), 3U);
  EXPECT_EQ(ConfigLines(vlp32[0]), "model: MODEL_VLP32C\ndata_port: 2369\nposition_port: 8308\n");
  EXPECT_EQ(ConfigLines(vls128[0]), "model: MODEL_VLS128\ndata_port: 2368\nposition_port: 8308\n");
  EXPECT_FALSE(vls128[0].host_minus_stamp) << "its stamp is within an hour";
  const auto vlp16 = SpeakersOf(vlp16::test::MakeDataPacket(vlp16::test::Azimuths(1000, 20), 0, 0x37, 0x22, {}), 2368);
  ASSERT_EQ(vlp16.size(), 1U);
  EXPECT_EQ(vlp16[0].name, "Velodyne VLP-16");
  EXPECT_EQ(ConfigLines(vlp16[0]), "model: MODEL_AUTO\ndata_port: 2368\nposition_port: 8308\n");
}

TEST(Survey, TellsEachProfileOfAnOusterAndNamesBothWhereSizesAreEqual) {
  using namespace ouster_maker;
  for (const auto profile :
       {OusterProfile::kLegacy, OusterProfile::kSingle, OusterProfile::kDual, OusterProfile::kLowBandwidth, OusterProfile::kFusaDual}) {
    for (const int rings : {16, 32, 64, 128}) {
      PacketText text;
      text.stamp_ns = 1'795'780'838'000'000'000;  // 37 s ahead
      const auto speakers = SpeakersOf(MakePacket(MakeMetadata(profile, rings), text), 7502);
      ASSERT_EQ(speakers.size(), 1U) << NameOf(profile) << " " << rings;
      const OusterLayout made{profile, rings, 16};
      EXPECT_NE(std::ranges::find(speakers[0].layouts, made), speakers[0].layouts.end()) << NameOf(profile) << " " << rings;
      EXPECT_EQ(ConfigLines(speakers[0]), "model: MODEL_OUSTER\ndata_port: 7502\nposition_port: 7503\nbeam_file: \"metadata.json\"\n");
      EXPECT_EQ(*speakers[0].host_minus_stamp, std::chrono::seconds(-37));
    }
  }
  PacketText text;
  const auto both = OusterLayoutsOf(MakePacket(MakeMetadata(OusterProfile::kDual, 64), text));
  EXPECT_EQ(both.size(), 2U) << "64 rings dual are as large as 128 of FUSA";
}

TEST(Survey, HearsTheSecondPort) {
  Survey survey;
  survey.Add(kStart, "10.0.0.1", "", 7502, ouster_maker::MakePacket(ouster_maker::MakeMetadata(OusterProfile::kSingle, 32), {}));
  survey.Add(kStart, "10.0.0.1", "", 7777, std::vector<std::uint8_t>(48));
  const auto speakers = survey.Speakers();
  ASSERT_EQ(speakers.size(), 1U);
  EXPECT_NE(ConfigLines(speakers[0]).find("position_port: 7777\n"), std::string::npos);
}

TEST(Survey, NamesWhatIsNotReadAndNothingElse) {
  std::vector<std::uint8_t> robosense(1248);
  robosense[0] = 0x55;
  robosense[1] = 0xAA;
  robosense[2] = 0x05;
  robosense[3] = 0x5A;
  const auto speakers = SpeakersOf(robosense, 6699);
  ASSERT_EQ(speakers.size(), 1U);
  EXPECT_EQ(speakers[0].name, "RoboSense");
  EXPECT_EQ(ConfigLines(speakers[0]), "");
  EXPECT_TRUE(SpeakersOf(std::vector<std::uint8_t>(1206), 2368).empty());
  EXPECT_TRUE(SpeakersOf({'$', 'G', 'P'}, 10110).empty());
  EXPECT_TRUE(SpeakersOf({}, 10110).empty());
}

// It had no lines for the config after one such datagram.
TEST(Survey, KeepsWhatItKnowsOfASenderThatSendsSomethingElseToo) {
  const auto ouster = ouster_maker::MakePacket(ouster_maker::MakeMetadata(OusterProfile::kSingle, 32), {});
  for (const auto& payload : {MadeHesaiPacket(HesaiModel::kXt32, 0x37).bytes, ouster}) {
    Survey survey;
    survey.Add(kStart, "10.0.0.1", "", 7502, payload);
    const auto lines = ConfigLines(survey.Speakers().at(0));
    EXPECT_NE(lines, "");
    survey.Add(kStart, "10.0.0.1", "", 7502, std::vector<std::uint8_t>{'$', 'G', 'P'});
    ASSERT_EQ(survey.Speakers().size(), 1U);
    const auto speaker = survey.Speakers()[0];
    EXPECT_EQ(ConfigLines(speaker), lines);
    EXPECT_EQ(speaker.num_packets, 1);
    EXPECT_EQ(speaker.size_bytes, payload.size());
    EXPECT_EQ(speaker.layouts.empty(), speaker.other != OtherModel::kOuster);
  }
}

TEST(Survey, KeepsABoundedNumberOfSenders) {
  Survey survey;
  const auto payload = MadeHesaiPacket(HesaiModel::kXt32, 0x37).bytes;
  for (int i = 0; i < 1000; ++i) survey.Add(kStart, std::to_string(i), "", 2368, payload);
  EXPECT_EQ(survey.Speakers().size(), 64U);
}

TEST(ClockDifference, IsToldInWords) {
  const auto of = [](double host_minus_stamp_s, Utime stamp) {
    return ClockDifferenceText(microseconds(static_cast<std::int64_t>(host_minus_stamp_s * 1e6)), stamp, "this computer's");
  };
  EXPECT_EQ(of(0.2, kStart), "");
  EXPECT_EQ(of(-37.0, kStart), "it is 37.000 s ahead of this computer's, as TAI is ahead of UTC by 37 s: its PTP master sends TAI");
  EXPECT_EQ(of(-17.9, kStart), "it is 17.900 s ahead of this computer's, as GPS time is ahead of UTC by 18 s");
  EXPECT_EQ(of(37.0, kStart), "it is 37.000 s behind this computer's");
  EXPECT_EQ(of(1.7e9, Utime(std::chrono::seconds(4711))), "it counts from its own start: it was never set");
  EXPECT_NE(of(2e8, Utime(std::chrono::seconds(1'580'000'000))).find("it was never set"), std::string::npos);
}

}  // namespace
}  // namespace lookout::lidar
