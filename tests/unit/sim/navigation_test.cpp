// What the receiver, the compass, the attitude sensor and the IMU send, read by the navigator's own parser.
#include "lab/sim/navigation.hpp"

#include <gtest/gtest.h>
#include <map>

#include "services/lidar/core/vlp16/position_packet.hpp"
#include "services/navigator/core/nmea.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

const Utime kNavigationStart = Utime(1'781'532'600s);

Scene MovingScene() {
  Scene scene;
  scene.own_motion.semi_axes_m = {30.0, 20.0};
  scene.own_motion.period_s = 60.0;
  scene.own_motion.roll_rad = {{DegToRad(5.0), 3.0, 0.0}};
  scene.own_motion.pitch_rad = {{DegToRad(3.0), 2.5, 1.0}};
  return scene;
}

struct Line {
  Utime arrival;
  std::string type;  // RMC ... VNIMU
  std::string text;  // without CR LF
};

struct Run {
  std::vector<Line> lines;
  std::vector<std::pair<Utime, vlp16::PositionPacket>> position_packets;

  std::vector<Line> Of(std::string_view type) const {
    std::vector<Line> found;
    for (const auto& line : lines) {
      if (line.type == type) found.push_back(line);
    }
    return found;
  }
};

Run RunAll(const NavigationParams& params, std::chrono::microseconds duration, const std::vector<std::string>& faults = {}, std::uint64_t seed = 1) {
  std::vector<TimedFault> parsed;
  for (const auto& fault : faults) parsed.push_back(ParseTimedFault(fault));
  const FaultPlan plan(parsed, kNavigationStart);
  Navigation navigation(MovingScene(), SmallBoat(), params, plan, kNavigationStart, seed);
  Run run;
  while (navigation.next_time() < kNavigationStart + duration) {
    for (const auto& datagram : navigation.Next()) {
      if (datagram.port == params.position_port) {
        const auto result = vlp16::ParsePositionPacket(datagram.payload);
        EXPECT_EQ(result.fault, vlp16::PositionFault::kNone);
        run.position_packets.emplace_back(datagram.time, result.packet);
        continue;
      }
      const std::string text(datagram.payload.begin(), datagram.payload.end() - 2);
      const auto address = text.substr(1, text.find(',') - 1);
      run.lines.push_back({datagram.time, address.starts_with("GP") ? address.substr(2) : address, text});
    }
  }
  return run;
}

navigator::Sentence Parsed(navigator::SentenceType type, const Line& line) {
  const auto result = navigator::ParseSentence(line.text);
  EXPECT_EQ(result.fault, SentenceFault::kNone) << line.text;
  EXPECT_EQ(result.sentence.type, type) << line.text;
  return result.sentence;
}

double SdOf(const std::vector<double>& errors) {
  double square = 0.0;
  for (const double error : errors) square += error * error;
  return std::sqrt(square / static_cast<double>(errors.size()));
}

// Horizontal error of a fix, metres east and north, against the true place of the antenna.
Eigen::Vector2d FixErrorM(const navigator::Sentence& gga, double time_s) {
  const auto state = StateAt(MovingScene().own_motion, SmallBoat().reference_point_above_water_m, time_s);
  const Eigen::Vector3d antenna_m = state.T_map_vessel() * SmallBoat().p_vessel_antenna_m;
  Eigen::Vector3d fix_m;
  MapFrame(SmallBoat())
      .Forward(gga.position->latitude_deg, gga.position->longitude_deg, gga.msl_height_m + gga.geoid_separation_m, fix_m.x(), fix_m.y(), fix_m.z());
  return (fix_m - antenna_m).head<2>();
}

TEST(Navigation, SendsEachSentenceAtItsRate) {
  const auto run = RunAll({}, 10s);
  const std::map<std::string, std::size_t> expected{{"RMC", 50},  {"GGA", 50},  {"VTG", 50},    {"GST", 50},   {"ZDA", 10},
                                                    {"HDT", 200}, {"ROT", 200}, {"PASHR", 500}, {"VNIMU", 998}};
  std::map<std::string, std::size_t> counts;
  for (const auto& line : run.lines) ++counts[line.type];
  EXPECT_EQ(counts, expected);
}

TEST(Navigation, EverySentenceIsUnderstoodByTheNavigator) {
  for (const auto& params : {NavigationParams{}, StandaloneNavigation()}) {
    for (const auto& line : RunAll(params, 3s, {"gnss_gap:1:2"}).lines) {
      const auto result = navigator::ParseSentence(line.text);
      EXPECT_EQ(result.fault, SentenceFault::kNone) << line.text;
      EXPECT_NE(result.sentence.type, navigator::SentenceType::kOther) << line.text;
    }
  }
}

TEST(Navigation, DefaultsAreTwoCentimetresAHundredMillisecondsLateAndTheAnglesOfGoodSensors) {
  const auto run = RunAll({}, 100s);
  std::vector<double> position_m;
  for (const auto& line : run.Of("GGA")) {
    const auto gga = Parsed(navigator::SentenceType::kGga, line);
    EXPECT_EQ(gga.quality, navigator::FixQuality::kRtkFixed);
    const Utime measured = std::chrono::floor<std::chrono::days>(kNavigationStart) + *gga.time_of_day;
    EXPECT_GE(line.arrival - measured, 100ms);
    EXPECT_LE(line.arrival - measured, 110ms);
    const auto error_m = FixErrorM(gga, ToSeconds(measured - kNavigationStart));
    position_m.insert(position_m.end(), {error_m.x(), error_m.y()});
  }
  EXPECT_NEAR(SdOf(position_m), 0.02, 0.002);

  std::vector<double> heading_deg;
  const auto scene = MovingScene();
  for (const auto& line : run.Of("HDT")) {
    const double time_s = std::floor(ToSeconds(line.arrival - kNavigationStart) * 20.0) / 20.0;  // measured up to 22 ms before, at multiples of 50 ms
    heading_deg.push_back(
        RadToDeg(WrapToPi(Parsed(navigator::SentenceType::kHdt, line).heading_rad - StateAt(scene.own_motion, 0.5, time_s).heading_rad)));
  }
  EXPECT_NEAR(SdOf(heading_deg), 0.2, 0.02);

  std::vector<double> tilt_deg;
  for (const auto& line : run.Of("PASHR")) {
    const auto pashr = Parsed(navigator::SentenceType::kPashr, line);
    const double time_s = ToSeconds(std::chrono::floor<std::chrono::days>(kNavigationStart) + *pashr.time_of_day - kNavigationStart);
    const auto state = StateAt(scene.own_motion, 0.5, time_s);
    tilt_deg.insert(tilt_deg.end(), {RadToDeg(pashr.roll_rad - state.roll_rad), RadToDeg(pashr.pitch_rad - state.pitch_rad)});
    EXPECT_NEAR(pashr.roll_sd_rad, DegToRad(0.1), 1e-9);
    EXPECT_NEAR(pashr.heading_sd_rad, DegToRad(0.2), 1e-9);
  }
  EXPECT_NEAR(SdOf(tilt_deg), 0.1, 0.01);
}

TEST(Navigation, StandaloneIsMetresOffAndWandersSlowly) {
  const auto run = RunAll(StandaloneNavigation(), 1000s);
  std::vector<double> east_m;
  std::vector<double> step_m;
  for (const auto& line : run.Of("GGA")) {
    const auto gga = Parsed(navigator::SentenceType::kGga, line);
    EXPECT_EQ(gga.quality, navigator::FixQuality::kGnss);
    const auto error_m = FixErrorM(gga, ToSeconds(std::chrono::floor<std::chrono::days>(kNavigationStart) + *gga.time_of_day - kNavigationStart));
    if (!east_m.empty()) step_m.push_back(error_m.x() - east_m.back());
    east_m.push_back(error_m.x());
  }
  EXPECT_NEAR(SdOf(east_m), 1.5, 0.75) << "17 time constants: the deviation itself is known to a quarter";
  EXPECT_NEAR(SdOf(step_m), 1.5 * std::sqrt(2.0 * 0.2 / 60.0), 0.01);
}

TEST(Navigation, ReceiverAloneSendsNoAnglesAndNoImu) {
  NavigationParams params;
  params.has_heading = false;
  std::map<std::string, int> counts;
  for (const auto& line : RunAll(params, 2s).lines) ++counts[line.type];
  EXPECT_EQ(counts, (std::map<std::string, int>{{"RMC", 10}, {"GGA", 10}, {"VTG", 10}, {"GST", 10}, {"ZDA", 2}}));
}

TEST(Navigation, TheLidarGetsTheSameRmcAsTheNavigator) {
  const auto run = RunAll(StandaloneNavigation(), 5s);
  std::map<std::string, int> sent;
  for (const auto& line : run.Of("RMC")) ++sent[line.text];
  int num_same = 0;
  for (const auto& [time, packet] : run.position_packets) num_same += static_cast<int>(sent.count(packet.sentence));
  // All but those of the second before the start: 150 ms of 5 s.
  EXPECT_NEAR(static_cast<double>(num_same) / static_cast<double>(run.position_packets.size()), 0.97, 0.005);
}

TEST(Navigation, AFaultOfOneSensorLeavesTheBytesOfAllOthersAlone) {
  const auto without = RunAll({}, 6s);
  const std::map<std::string, std::vector<std::string>> touched{{"gnss_gap:2:4", {"RMC", "GGA", "VTG", "GST"}},
                                                                {"gnss_jump:2:4:10", {"RMC", "GGA"}},
                                                                {"frozen_heading:2:4", {"HDT", "ROT", "PASHR"}},
                                                                {"imu_stop:2:4", {"VNIMU"}},
                                                                {"wrong_hour:2:4", {}},
                                                                {"sensor_restart:2:4", {}}};
  for (const auto& [fault, types] : touched) {
    const auto with = RunAll({}, 6s, {fault});
    for (const auto* type : {"RMC", "GGA", "VTG", "GST", "ZDA", "HDT", "ROT", "PASHR", "VNIMU"}) {
      const auto before = without.Of(type);
      const auto after = with.Of(type);
      const bool is_equal =
          before.size() == after.size() && std::equal(before.begin(), before.end(), after.begin(),
                                                      [](const Line& a, const Line& b) { return a.arrival == b.arrival && a.text == b.text; });
      EXPECT_EQ(is_equal, std::ranges::find(types, type) == types.end()) << fault << " and " << type;
    }
  }
}

TEST(Navigation, InAGapOfTheReceiverItSaysThatItHasNoFix) {
  const auto run = RunAll({}, 6s, {"gnss_gap:2:4"});
  for (const auto& line : run.Of("RMC")) {
    const auto rmc = Parsed(navigator::SentenceType::kRmc, line);
    const auto since_start = std::chrono::floor<std::chrono::days>(kNavigationStart) + *rmc.time_of_day - kNavigationStart;
    EXPECT_EQ(rmc.position.has_value(), since_start < 2s || since_start >= 4s) << line.text;
  }
  // The lidar's RMC of second 2 is there from 2.15 s, that of second 4 from 4.15 s.
  for (const auto& [arrival, packet] : run.position_packets) {
    const auto since_start = arrival - kNavigationStart - 60us;
    EXPECT_EQ(packet.time.has_value(), since_start < 2150ms || since_start >= 4150ms);
    EXPECT_EQ(packet.pps, 2) << "pulses go on";
  }
}

TEST(Navigation, AJumpIsToTheEast) {
  std::vector<double> north_m;
  for (const auto& line : RunAll({}, 6s, {"gnss_jump:2:4:10"}).Of("GGA")) {
    const auto gga = Parsed(navigator::SentenceType::kGga, line);
    const double time_s = ToSeconds(std::chrono::floor<std::chrono::days>(kNavigationStart) + *gga.time_of_day - kNavigationStart);
    const auto error_m = FixErrorM(gga, time_s);
    EXPECT_NEAR(error_m.x(), time_s >= 2.0 && time_s < 4.0 ? 10.0 : 0.0, 0.1);
    EXPECT_NEAR(error_m.y(), 0.0, 0.1);
  }
}

TEST(Navigation, AFrozenHeadingStaysAndItsBoatRollsOn) {
  const auto run = RunAll({}, 6s, {"frozen_heading:2:4"});
  const auto hdt = run.Of("HDT");
  for (std::size_t i = 41; i < 80; ++i) EXPECT_EQ(hdt[i].text, hdt[39].text);
  EXPECT_NE(hdt[38].text, hdt[39].text);
  EXPECT_NE(hdt[80].text, hdt[39].text);
  const auto pashr = run.Of("PASHR");
  const auto at = [&](std::size_t i) { return Parsed(navigator::SentenceType::kPashr, pashr[i]); };
  EXPECT_EQ(at(110).heading_rad, at(190).heading_rad);
  EXPECT_NEAR(at(150).heading_rad, Parsed(navigator::SentenceType::kHdt, hdt[39]).heading_rad, 1e-9);
  EXPECT_GT(std::abs(at(110).roll_rad - at(140).roll_rad), DegToRad(1.0));
}

TEST(Navigation, AStoppedImuIsSilent) {
  int num_inside = 0;
  for (const auto& line : RunAll({}, 6s, {"imu_stop:2:4"}).Of("VNIMU"))
    num_inside += line.arrival > kNavigationStart + 2010ms && line.arrival < kNavigationStart + 4s ? 1 : 0;
  EXPECT_EQ(num_inside, 0);
}

TEST(Navigation, SameSeedSameLinesAndAnotherSeedOthers) {
  const auto texts = [](std::uint64_t seed) {
    std::string all;
    for (const auto& line : RunAll({}, 2s, {}, seed).lines) all += line.text + std::to_string(ToUtimeUs(line.arrival));
    return all;
  };
  EXPECT_EQ(texts(4), texts(4));
  EXPECT_NE(texts(4), texts(5));
}

}  // namespace
}  // namespace lookout::sim
