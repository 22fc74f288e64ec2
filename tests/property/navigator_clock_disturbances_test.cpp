// navigator while its sentences come late, the computer's clock is set, and through leap seconds: a boat that goes straight on, whose place is known
// at every instant. Driven by message time.
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/geodesy.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/common/late_arrivals.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

constexpr microseconds kDelay = 50ms;
constexpr double kSpeedMps = 5.0;
constexpr double kSpeedKnots = kSpeedMps * 3600.0 / 1852.0;
constexpr char kTcp[] = "gnss";

double Seconds(microseconds duration) { return ToSeconds(duration); }

struct Health {
  microseconds time{0};  // true time
  std::string reason;
};
struct Given {
  microseconds time{0};  // true time at which it was given
  Utime utime;
  double east_m = 0.0;
  double sd_m = 0.0;
  bool has_position = false;
  double heading_deg = kNan;
  double heading_sd_deg = kNan;
};
struct Run {
  std::vector<Health> health;
  std::vector<Given> poses;
};

// What the receiver says of the instant, and what the computer's clock shows.
struct World {
  std::function<std::string(microseconds)> time_of_day;  // hhmmss.ss
  std::function<std::string(microseconds)> date;         // ddmmyy
  std::function<Utime(microseconds)> host;
  std::function<microseconds(microseconds)> delivery;
  double turn_degps = 0.0;  // of the bow, while the boat goes straight on
};

Run Play(const World& world, microseconds period, microseconds duration) {
  const LocalFrame map({50.0, 8.0, 0.0});
  auto params = LoadParams(support::kDemoConfig.string());
  params.reads_nav_raw = false;
  SourceParams source;
  source.name = kTcp;
  source.latency = kDelay;
  params.navigator.sources.push_back(source);
  params.navigator.filter.p_vessel_antenna_m.setZero();
  bus::MemoryBus bus;
  Service service(bus, params);
  Run run;
  microseconds now(0);
  bus.SubscribeAll([&](std::string_view channel, Bytes bytes) {
    if (channel != "POSE") return;
    const auto pose = bus::Decode<pose_t>(bytes).value();
    Given given{now, Utime(microseconds(pose.utime_us)), kNan, kNan, !std::isnan(pose.latitude_deg)};
    given.heading_deg = RadToDeg(pose.heading_rad);
    given.heading_sd_deg = RadToDeg(std::sqrt(pose.covariance[8][8]));
    if (given.has_position) {
      given.east_m = map.Forward({pose.latitude_deg, pose.longitude_deg, 0.0}).x();
      given.sd_m = std::sqrt(pose.covariance[0][0]);
    }
    run.poses.push_back(given);
  });
  microseconds next_sent(0);
  microseconds next_health = 1s;
  for (; now < duration; now += 10ms) {
    for (; world.delivery(next_sent) <= now; next_sent += period) {
      const auto place = map.Reverse({kSpeedMps * Seconds(next_sent), 0.0, 0.0});
      const auto where = Angle(place.latitude_deg, 2, 'N', 'S') + "," + Angle(place.longitude_deg, 3, 'E', 'W');
      const auto time_of_day = world.time_of_day(next_sent);
      const std::string text = Line("GPRMC," + time_of_day + ",A," + where + Print(",%.6f,90.0,", kSpeedKnots) + world.date(next_sent) + ",,,R") +
                               "\r\n" + Line("GPGGA," + time_of_day + "," + where + ",4,12,0.8,0.0,M,0.0,M,,") + "\r\n" +
                               HdtLine(std::fmod(90.0 + world.turn_degps * Seconds(next_sent), 360.0)) + "\r\n";
      service.OnStream(world.host(now), ToBytes(text), kTcp);
    }
    service.AdvanceTo(world.host(now));
    support::HandleAll(bus);
    if (now >= next_health) {
      run.health.push_back({now, service.Report().reason});
      next_health += 500ms;
    }
  }
  return run;
}

std::string Ddmmyy(Utime time) {
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(time));
  return Print("%02u%02u%02d", static_cast<unsigned>(date.day()), static_cast<unsigned>(date.month()), static_cast<int>(date.year()) % 100);
}

World WorldOf(const late::Disturbance& disturbance) {
  const auto utc = [](microseconds time) { return NoonPlus(0) + time; };
  return {[=](microseconds time) { return TimeOfDay(utc(time)); }, [=](microseconds time) { return Ddmmyy(utc(time)); },
          [=](microseconds time) { return utc(time) + disturbance.HostError(time); },
          [=](microseconds sent) { return disturbance.Delivery(sent) + kDelay; }};
}

// Positions that are farther off than what is stated allows; of a boat whose clock is right the truth is that of the label.
struct Errors {
  int num_wrong = 0;
  double worst_m = 0.0;
  std::string first;
};
Errors ErrorsOf(const Run& run, const std::function<microseconds(const Given&)>& true_time, microseconds from) {
  Errors errors;
  for (const auto& pose : run.poses) {
    if (!pose.has_position || pose.time < from) continue;
    const double error_m = std::abs(pose.east_m - kSpeedMps * Seconds(true_time(pose)));
    errors.worst_m = std::max(errors.worst_m, error_m);
    if (error_m <= 3.0 * pose.sd_m + 0.01) continue;
    if (errors.num_wrong++ == 0) errors.first = Print("%.2f s: %.3f m off, stated %.3f m", Seconds(pose.time), error_m, pose.sd_m);
  }
  return errors;
}

bool Claims(const Health& health) { return health.reason.find("off UTC") != std::string::npos; }

TEST(NavigatorClockDisturbances, LateDeliveriesLeaveNoWrongPoseAndNoComplaint) {
  for (const auto period : {100ms, 1000ms}) {
    for (const auto& disturbance : late::LateDeliveries()) {
      SCOPED_TRACE(disturbance.name + ", every " + std::to_string(period.count()) + " ms");
      const auto run = Play(WorldOf(disturbance), period, disturbance.end + 12s);
      int num_claims = 0;
      for (const auto& health : run.health) {
        num_claims += Claims(health) ? 1 : 0;
        EXPECT_TRUE(health.time < disturbance.end + 5s || health.reason.empty())
            << health.reason << ", " << Seconds(health.time) - Seconds(disturbance.end);
      }
      EXPECT_EQ(num_claims, 0);
      const auto errors = ErrorsOf(
          run, [](const Given& pose) { return pose.utime - NoonPlus(0); }, 3s);
      EXPECT_EQ(errors.num_wrong, 0) << errors.first;
      EXPECT_TRUE(run.poses.back().has_position);
    }
  }
}

// Headings have no time of their own. Those of twelve seconds, taken at their arrival, were one heading of 12 s ago for a second.
TEST(NavigatorClockDisturbances, LateHeadingsAreOfWhenTheyWereMeasured) {
  for (const auto period : {100ms, 200ms, 1000ms}) {
    for (const auto& disturbance : {late::StoppedFor12SecondsAndDrained(), late::StoppedFor300MsAHundredTimes(), late::RandomStalls(3)}) {
      SCOPED_TRACE(disturbance.name + ", every " + std::to_string(period.count()) + " ms");
      auto world = WorldOf(disturbance);
      world.turn_degps = 10.0;
      int num_wrong = 0;
      double worst_deg = 0.0;
      for (const auto& pose : Play(world, period, disturbance.end + 12s).poses) {
        if (pose.time < 3s || std::isnan(pose.heading_deg)) continue;
        const double true_deg = 90.0 + world.turn_degps * Seconds(pose.utime - NoonPlus(0));
        const double error_deg = std::abs(RadToDeg(WrapToPi(DegToRad(pose.heading_deg - true_deg))));
        if (error_deg <= 3.0 * pose.heading_sd_deg + 1.0) continue;
        ++num_wrong;
        worst_deg = std::max(worst_deg, error_deg);
      }
      EXPECT_EQ(num_wrong, 0) << worst_deg << " deg off";
    }
  }
}

// Every second there is a fix in time.
TEST(NavigatorClockDisturbances, NamesNoMissingFixWhileFixesCome) {
  const auto disturbance = late::StoppedFor300MsAHundredTimes();
  for (const auto& health : Play(WorldOf(disturbance), 100ms, disturbance.end + 5s).health) EXPECT_EQ(health.reason, "") << Seconds(health.time);
}

TEST(NavigatorClockDisturbances, AStepOfTheClockIsKnownWithinFiveSeconds) {
  for (const auto period : {100ms, 1000ms}) {
    for (const auto& disturbance : late::ClockSteps()) {
      SCOPED_TRACE(disturbance.name + ", every " + std::to_string(period.count()) + " ms");
      const auto run = Play(WorldOf(disturbance), period, disturbance.end + 20s);
      const auto step = disturbance.steps[0].step;
      const bool is_claimed = std::chrono::abs(step) > 500ms;
      int num_changes = 0;
      bool was_claimed = false;
      for (const auto& health : run.health) {
        num_changes += Claims(health) != was_claimed ? 1 : 0;
        was_claimed = Claims(health);
        if (health.time < disturbance.end || health.time >= disturbance.end + 5s) {
          const bool is_now = is_claimed && health.time >= disturbance.end;
          const auto expected = is_now ? Print("clock of this computer is off UTC by %.1f s", Seconds(step)) : std::string();
          EXPECT_TRUE(health.time <= 2s || health.reason == expected) << health.reason << ", " << Seconds(health.time) - Seconds(disturbance.end);
        }
      }
      EXPECT_EQ(num_changes, is_claimed ? 1 : 0);
      // A clock that is not off by more than the delay that a receiver may have is taken for UTC: POSE is labelled so.
      const auto off = is_claimed ? step : microseconds(0);
      const auto errors = ErrorsOf(
          run, [=](const Given& pose) { return pose.utime - NoonPlus(0) - off; }, disturbance.end + 5s);
      EXPECT_EQ(errors.num_wrong, 0) << errors.first;
      EXPECT_TRUE(run.poses.back().has_position);
    }
  }
}

// --- Leap seconds.

constexpr Utime kNewYear = std::chrono::sys_days(std::chrono::year(2017) / 1 / 1);
constexpr microseconds kLeap = 30s;  // true time of its begin

enum class Receiver { kSays60, kRepeats59, kRepeats00 };

// The label of the instant as the receiver has it; of 23:59:60 that of the second before it.
Utime LabelOf(Receiver receiver, microseconds time) {
  if (time < kLeap) return kNewYear + (time - kLeap);
  if (time >= kLeap + 1s) return kNewYear + (time - kLeap - 1s);
  return kNewYear + (time - kLeap) - (receiver == Receiver::kRepeats00 ? 0s : 1s);
}

World LeapWorld(Receiver receiver, bool is_host_told) {
  const auto is_60 = [=](microseconds time) { return receiver == Receiver::kSays60 && time >= kLeap && time < kLeap + 1s; };
  return {[=](microseconds time) {
            const auto text = TimeOfDay(LabelOf(receiver, time));
            return is_60(time) ? "235960" + text.substr(6) : text;
          },
          [=](microseconds time) { return Ddmmyy(LabelOf(receiver, time)); },
          // Linux sets its clock back when the leap second begins.
          [=](microseconds time) { return kNewYear + (time - kLeap) - (is_host_told && time >= kLeap ? 1s : 0s); },
          [](microseconds sent) { return sent + kDelay; }};
}

TEST(NavigatorClockDisturbances, ALeapSecondMovesPoseByNoMoreThanItStates) {
  for (const auto receiver : {Receiver::kSays60, Receiver::kRepeats59, Receiver::kRepeats00}) {
    for (const bool is_host_told : {false, true}) {
      for (const auto period : {100ms, 500ms, 1000ms}) {
        SCOPED_TRACE(Print("receiver %d, host %s, every %d ms", static_cast<int>(receiver), is_host_told ? "told" : "not told",
                           static_cast<int>(period.count())));
        const auto run = Play(LeapWorld(receiver, is_host_told), period, kLeap + 20s);
        // While the host's clock is not told it goes on evenly; else it starts anew, and POSE with it.
        const auto true_time = [=](const Given& pose) { return pose.utime - kNewYear + kLeap + (is_host_told && pose.time >= kLeap ? 1s : 0s); };
        const auto errors = ErrorsOf(run, true_time, 3s);
        EXPECT_EQ(errors.num_wrong, 0) << errors.first;
        EXPECT_TRUE(run.poses.back().has_position);
        for (const auto& health : run.health) {
          if (health.time < 2s || (health.time >= kLeap && health.time < kLeap + 5s)) continue;
          const bool is_off = !is_host_told && health.time > kLeap;
          EXPECT_EQ(health.reason, is_off ? "clock of this computer is off UTC by 1.0 s" : "") << Seconds(health.time - kLeap);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lookout::navigator
