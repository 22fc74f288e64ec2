// navigator in a turning boat whose sensors stand still and then deliver all that waited: what has no time of its own (HDT, VNIMU) comes in a queue.
// Driven by message time; the true pose is known at every instant.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <iostream>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/geodesy.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator::turning {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

constexpr double kSpeedMps = 3.0;
constexpr microseconds kStall = 20s;
constexpr microseconds kRecovery = 5s;
constexpr double kGravityMps2 = 9.81;

enum Device : unsigned { kGnss = 1, kCompass = 2, kImu = 4, kAttitude = 8, kAll = 15 };

struct Case {
  double turn_degps = 0.0;
  microseconds stall{0};
  double drain = 0.0;  // messages per message of the usual rate; 0 = all at once
  unsigned stalled = kAll;
  unsigned present = kAll;
  bool is_lost = false;  // what waited is thrown away
};

// The boat begins to turn a second before the stall, and goes in circles from there.
struct Truth {
  double east_m = 0.0;
  double north_m = 0.0;
  double heading_deg = 0.0;
};
constexpr double kTurnStartS = 19.0;
Truth TruthAt(double time_s, double turn_degps) {
  if (time_s <= kTurnStartS) return {kSpeedMps * (time_s - kTurnStartS), 0.0, 90.0};
  const double rate_radps = DegToRad(turn_degps);
  const double angle_rad = rate_radps * (time_s - kTurnStartS);
  const double radius_m = kSpeedMps / rate_radps;
  return {radius_m * std::sin(angle_rad), radius_m * (std::cos(angle_rad) - 1.0), 90.0 + RadToDeg(angle_rad)};
}

double WrappedDeg(double angle_deg) { return RadToDeg(WrapTo2Pi(DegToRad(angle_deg))); }

struct Sent {
  microseconds delivery{0};
  std::string source;
  std::string text;
};

microseconds Delivery(const Case& scene, microseconds sent) {
  const auto end = kStall + scene.stall;
  if (sent < kStall) return sent;
  if (scene.drain <= 0.0) return std::max(sent, end);
  const auto drained = end + microseconds(std::llround(static_cast<double>((sent - kStall).count()) / scene.drain));
  return std::max(sent, drained);
}

// When the queue is empty.
microseconds DrainedAt(const Case& scene) {
  const auto end = kStall + scene.stall;
  return scene.drain <= 0.0 ? end : end + microseconds(std::llround(static_cast<double>(scene.stall.count()) / (scene.drain - 1.0)));
}

std::vector<Sent> Sentences(const Case& scene, microseconds duration) {
  const LocalFrame map({50.0, 8.0, 0.0});
  std::vector<Sent> all;
  const auto send = [&](Device device, const char* source, microseconds sent, std::string text) {
    if ((scene.present & device) == 0) return;
    const bool is_stalled = (scene.stalled & device) != 0;
    if (is_stalled && scene.is_lost && sent >= kStall && sent < kStall + scene.stall) return;
    all.push_back({is_stalled ? Delivery(scene, sent) : sent, scene.stalled == kAll ? "udp" : source, std::move(text)});
  };
  for (microseconds time(0); time < duration; time += 10ms) {
    const auto truth = TruthAt(ToSeconds(time), scene.turn_degps);
    const Utime utc = NoonPlus(0) + time;
    const double heading_deg = WrappedDeg(truth.heading_deg);
    const bool is_turning = ToSeconds(time) > kTurnStartS;
    const double rate_radps = is_turning ? DegToRad(scene.turn_degps) : 0.0;
    send(kImu, "imu", time + 2ms,
         Line(Print("VNIMU,+00.0000,+00.0000,+00.0000,%+07.3f,%+07.3f,%+07.3f,%+010.6f,%+010.6f,%+010.6f,+20.0,+101.300", 0.0, rate_radps * kSpeedMps,
                    -kGravityMps2, 0.0, 0.0, rate_radps)));
    if (time % 20ms == 0us) send(kAttitude, "attitude", time + 15ms, PashrLine(utc, heading_deg, 0.0, 0.0, 0.0));
    if (time % 50ms == 0us) send(kCompass, "compass", time + 20ms, HdtLine(heading_deg));
    if (time % 200ms == 0us) {
      const auto place = map.Reverse({truth.east_m, truth.north_m, 0.0});
      send(kGnss, "gnss", time + 100ms, RmcLine(utc, place.latitude_deg, place.longitude_deg, kSpeedMps, heading_deg));
      send(kGnss, "gnss", time + 102ms, GgaLine(utc, place.latitude_deg, place.longitude_deg, 4, 0.8, 0.0, 0.0));
    }
  }
  std::ranges::stable_sort(all, {}, &Sent::delivery);
  return all;
}

struct Wrong {
  int num_during = 0;
  int num_after = 0;
  double worst_m = 0.0;
  double worst_deg = 0.0;
  std::string first;
  std::string last_reason;
};

Wrong Play(const Case& scene) {
  auto params = LoadParams(support::kDemoConfig.string());
  params.reads_nav_raw = false;
  params.navigator.filter.p_vessel_antenna_m.setZero();
  params.navigator.filter.p_vessel_imu_m.setZero();
  params.navigator.use_lidar_odometry = false;  // places on the earth are judged, not those in a frame of its own
  bus::MemoryBus bus;
  Service service(bus, params);
  const LocalFrame map({50.0, 8.0, 0.0});
  const auto recovered = DrainedAt(scene) + kRecovery;
  const auto duration = recovered + 10s;
  Wrong wrong;
  bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
    if (channel != "POSE") return;
    const auto pose = bus::Decode<pose_t>(bytes).value();
    const auto time = Utime(microseconds(pose.utime_us)) - NoonPlus(0);
    if (time < 10s) return;
    const bool is_after = time > recovered;
    const auto truth = TruthAt(ToSeconds(time), scene.turn_degps);
    double error_m = 0.0;
    double error_deg = 0.0;
    double sd_m = 0.0;
    double sd_deg = 0.0;
    const bool has_position = !std::isnan(pose.latitude_deg) && pose.status != pose_t::STATUS_NO_POSITION && pose.status != pose_t::STATUS_UNKNOWN;
    const bool has_heading = pose.heading_source != pose_t::HEADING_NONE;
    if (has_position) {
      const auto place = map.Forward({pose.latitude_deg, pose.longitude_deg, 0.0});
      error_m = std::hypot(place.x() - truth.east_m, place.y() - truth.north_m);
      sd_m = std::sqrt(pose.covariance[0][0] + pose.covariance[1][1]);
    }
    if (has_heading) {
      error_deg = std::abs(RadToDeg(WrapToPi(pose.heading_rad - DegToRad(truth.heading_deg))));
      sd_deg = RadToDeg(std::sqrt(pose.covariance[8][8]));
    }
    const bool is_bad = error_m > 4.0 * sd_m + 0.2 || error_deg > 4.0 * sd_deg + 2.0 || (is_after && pose.status != pose_t::STATUS_OK);
    if (!is_bad) return;
    ++(is_after ? wrong.num_after : wrong.num_during);
    wrong.worst_m = std::max(wrong.worst_m, error_m);
    wrong.worst_deg = std::max(wrong.worst_deg, error_deg);
    if (wrong.first.empty()) {
      wrong.first = Print("%.2f s after the begin of the stall: %.2f m off, stated %.2f m, %.1f deg off, stated %.1f deg, status %d",
                          ToSeconds(time - kStall), error_m, sd_m, error_deg, sd_deg, static_cast<int>(pose.status));
    }
  });
  const auto sentences = Sentences(scene, duration);
  auto next = sentences.begin();
  for (microseconds now(0); now < duration; now += 10ms) {
    // Each has the stamp of its arrival.
    for (; next != sentences.end() && next->delivery <= now; ++next) {
      service.OnDatagram(NoonPlus(0) + next->delivery, ToBytes(next->text + "\r\n"), next->source);
    }
    service.AdvanceTo(NoonPlus(0) + now);
    support::HandleAll(bus);
  }
  const auto report = service.Report();
  wrong.last_reason = report.reason;
  if (std::getenv("LOOKOUT_NAVIGATOR_COUNTERS") != nullptr) {
    for (const auto& counter : report.counters) {
      if (counter.count != 0) std::cout << "  " << counter.name << " " << counter.count << "\n";
    }
  }
  return wrong;
}

std::string NameOf(const Case& scene) {
  std::string name = Print("%.0f deg/s, stopped %.1f s, %s", scene.turn_degps, ToSeconds(scene.stall),
                           scene.is_lost        ? "lost"
                           : scene.drain <= 0.0 ? "drained at once"
                                                : Print("drained at %.0f times", scene.drain).c_str());
  name += Print(", stalled %u of %u", scene.stalled, scene.present);
  return name;
}

void ExpectRight(const std::vector<Case>& scenes) {
  int num_wrong = 0;
  double worst_m = 0.0;
  double worst_deg = 0.0;
  for (const auto& scene : scenes) {
    const auto wrong = Play(scene);
    num_wrong += wrong.num_during + wrong.num_after > 0 ? 1 : 0;
    worst_m = std::max(worst_m, wrong.worst_m);
    worst_deg = std::max(worst_deg, wrong.worst_deg);
    EXPECT_EQ(wrong.num_during, 0) << NameOf(scene) << ": " << wrong.first;
    EXPECT_EQ(wrong.num_after, 0) << NameOf(scene) << ": " << wrong.first;
    EXPECT_EQ(wrong.last_reason, "") << NameOf(scene);
  }
  std::cout << num_wrong << " of " << scenes.size() << " wrong, at most " << worst_m << " m and " << worst_deg << " deg\n";
}

std::vector<Case> Scenes(unsigned stalled, unsigned present) {
  std::vector<Case> scenes;
  for (const double turn_degps : {10.0, 20.0}) {
    for (const auto stall : {300ms, 1800ms, 3000ms, 12000ms}) {
      for (const double drain : {0.0, 2.0, 20.0}) scenes.push_back({turn_degps, stall, drain, stalled, present});
    }
    scenes.push_back({turn_degps, 1800ms, 0.0, stalled, present, true});
  }
  return scenes;
}

TEST(NavigatorTurningStalls, AllSensorsComeLateAndPoseIsRightAgain) { ExpectRight(Scenes(kAll, kAll)); }

TEST(NavigatorTurningStalls, AllSensorsWithoutOneOfAttitudeComeLate) {
  auto scenes = Scenes(kAll, kGnss | kCompass | kImu);
  const auto without_imu = Scenes(kAll, kGnss | kCompass);
  scenes.insert(scenes.end(), without_imu.begin(), without_imu.end());
  ExpectRight(scenes);
}

TEST(NavigatorTurningStalls, OneSensorComesLate) {
  for (const unsigned stalled : {kGnss, kCompass, kImu, kAttitude}) ExpectRight(Scenes(stalled, kAll));
  for (const unsigned stalled : {kGnss, kCompass, kImu}) ExpectRight(Scenes(stalled, kGnss | kCompass | kImu));
}

}  // namespace
}  // namespace lookout::navigator::turning
