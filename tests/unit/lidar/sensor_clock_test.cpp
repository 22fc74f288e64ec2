// The clock through the whole decoder: a sensor, its receiver and the host's clock as they are at sea, and the expected utime of scans to the
// microsecond.
#include "services/lidar/core/vlp16/sensor_clock.hpp"

#include <cstdio>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "services/lidar/core/vlp16/decoder.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using std::chrono::sys_days;
using std::chrono::year;

// A scan of exactly 75 packets, so that scan k begins with packet 75 k.
constexpr int kPacketsPerRevolution = 75;
constexpr int kPositionEvery = 5;

std::string Rmc(Utime time, char status = 'A', const char* time_of_day = nullptr) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(std::chrono::floor<seconds>(time - day));
  std::array<char, 128> text{};
  std::array<char, 16> hhmmss{};
  std::snprintf(hhmmss.data(), hhmmss.size(), "%02d%02d%02d", static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  std::snprintf(text.data(), text.size(), "$GPRMC,%s,%c,4338.00,N,07209.00,W,0.0,0.0,%02u%02u%02d,,,A",
                time_of_day != nullptr ? time_of_day : hhmmss.data(), status, static_cast<unsigned>(date.day()), static_cast<unsigned>(date.month()),
                static_cast<int>(date.year()) % 100);
  std::uint8_t checksum = 0;
  for (const char* character = text.data() + 1; *character != '\0'; ++character)
    checksum = static_cast<std::uint8_t>(checksum ^ static_cast<std::uint8_t>(*character));
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), "*%02X", checksum);
  return std::string(text.data()) + end.data();
}

// What is expected of the scan that begins `at` after the start (in scans).
struct Expected {
  int scan;
  microseconds utime_error;  // of its utime, against the start plus the time that went by
  TimeSource source;
  ClockState state;
};

// Functions of the time that went by since the start.
struct Scenario {
  std::string name;
  TimeChoice choice = TimeChoice::kAuto;
  Utime start = sys_days(year(2026) / 6 / 15) + hours(14) + minutes(10);
  double duration_s = 6.0;
  std::function<microseconds(double)> host_error = [](double) { return microseconds(0); };
  std::function<microseconds(double)> stamp_error = [](double) { return microseconds(0); };  // of the sensor's microseconds past the hour
  bool does_stamp_wrap = true;
  std::function<int(double)> pps = [](double) { return format::kPpsLocked; };
  // The sentence in a position packet; by default that of the last whole second, from 0.2 s after it.
  std::function<std::string(Utime began, double)> sentence = [](Utime began, double time_s) {
    return Rmc(std::chrono::floor<seconds>(began + microseconds(static_cast<std::int64_t>((time_s - 0.2) * 1e6))));
  };
  std::function<bool(double)> is_on = [](double) { return true; };
  int num_unseen = 0;  // scans of which nothing was sent, from 2 s on
  std::vector<Expected> expected;
};

constexpr auto kHost = TimeSource::kHost;
constexpr auto kSensor = TimeSource::kSensor;

microseconds After(int packet) { return std::chrono::floor<microseconds>(packet * format::kPacketPeriodSingle); }
double TurnSeconds(int scan) { return ToSeconds(After(scan * kPacketsPerRevolution)); }
// The scan that runs at `time_s`, and begins up to 0.1 s before.
int ScanAt(double time_s) { return static_cast<int>(time_s / TurnSeconds(1)); }

std::map<std::int64_t, Scan> Play(const Scenario& scenario) {
  std::map<std::int64_t, Scan> scans;  // by number
  DecoderParams params;
  params.time = scenario.choice;
  Decoder decoder(
      params, [&](const Scan& scan) { scans.emplace(scan.number, scan); }, [](const SentenceOfLidar&) {});
  test::SpinningSensor sensor;
  sensor.rpm = 60e9 / (kPacketsPerRevolution * static_cast<double>(format::kPacketPeriodSingle.count()));
  const int num_packets = static_cast<int>(scenario.duration_s / ToSeconds(format::kPacketPeriodSingle));
  for (int i = 0; i < num_packets; ++i) {
    const microseconds gone_by = After(i);
    const double time_s = ToSeconds(gone_by);
    auto payload = sensor.Next();
    if (!scenario.is_on(time_s)) continue;
    const auto hour = std::chrono::floor<hours>(scenario.start);
    const auto past_hour = scenario.start - hour + gone_by + scenario.stamp_error(time_s);
    const auto stamp_us = (past_hour + hours(1000)).count() % (scenario.does_stamp_wrap ? format::kMicrosecondsPerHour : (std::int64_t{1} << 32));
    WriteU32LittleEndian(payload, format::kStampOffset, static_cast<std::uint32_t>(scenario.does_stamp_wrap ? stamp_us : past_hour.count()));
    // The host takes it when its last shot has gone out.
    const Utime host = scenario.start + After(i + 1) + scenario.host_error(time_s);
    if (i % kPositionEvery == 0) {
      decoder.OnPositionPayload(
          host, test::MakePositionPacket(ReadU32LittleEndian(payload, format::kStampOffset), static_cast<std::uint8_t>(scenario.pps(time_s)),
                                         scenario.sentence(scenario.start, time_s)));
    }
    decoder.OnDataPayload(host, payload);
  }
  decoder.Flush();
  return scans;
}

std::vector<Scenario> Scenarios() {
  std::vector<Scenario> scenarios;
  const auto add = [&](const std::string& name, const std::function<void(Scenario&)>& change) {
    Scenario scenario;
    scenario.name = name;
    change(scenario);
    scenarios.push_back(scenario);
  };
  const auto no_sentence = [](Utime, double) { return std::string(); };
  const auto constant = [](microseconds error) { return [error](double) { return error; }; };

  // --- The states, and what automatic choice makes of them. The host is 40 ms ahead, so that the two clocks can be told apart.
  add("locked", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.expected = {{0, milliseconds(0), kSensor, ClockState::kLocked}, {50, milliseconds(0), kSensor, ClockState::kLocked}};
  });
  add("no PPS", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.stamp_error = constant(minutes(-7));
    s.pps = [](double) { return format::kPpsAbsent; };
    s.sentence = no_sentence;
    s.expected = {{0, milliseconds(40), kHost, ClockState::kNoPps}, {50, milliseconds(40), kHost, ClockState::kNoPps}};
  });
  add("acquiring, then locked", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.pps = [](double time_s) { return time_s < 2.0 ? format::kPpsSynchronising : format::kPpsLocked; };
    s.expected = {{ScanAt(1.5), milliseconds(40), kHost, ClockState::kAcquiring}, {ScanAt(2.5), milliseconds(0), kSensor, ClockState::kLocked}};
  });
  add("locked, but the receiver has no fix", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.sentence = [](Utime start, double time_s) { return Rmc(start + microseconds(static_cast<std::int64_t>(time_s * 1e6)), 'V'); };
    s.expected = {{10, milliseconds(40), kHost, ClockState::kLockedWithoutTime}};
  });
  add("locked, and the sensor repeats an old RMC", [&](Scenario& s) {
    s.duration_s = 9.0;
    s.host_error = constant(milliseconds(40));
    s.sentence = [](Utime start, double time_s) { return Rmc(start + seconds(static_cast<int>(std::min(time_s, 2.5)))); };
    s.expected = {{ScanAt(4.5), milliseconds(0), kSensor, ClockState::kLocked},
                  {ScanAt(5.5), milliseconds(40), kHost, ClockState::kLockedWithoutTime}};
  });
  add("PPS lost after a lock", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.pps = [](double time_s) { return time_s < 2.0 ? format::kPpsLocked : format::kPpsAbsent; };
    s.expected = {{ScanAt(1.5), milliseconds(0), kSensor, ClockState::kLocked}, {ScanAt(2.5), milliseconds(40), kHost, ClockState::kFreeRunning}};
  });
  add("says locked, but free-runs", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.stamp_error = constant(minutes(11));
    s.expected = {{10, milliseconds(40), kHost, ClockState::kFreeRunning}};
  });
  add("PPS error", [&](Scenario& s) {
    s.host_error = constant(milliseconds(40));
    s.pps = [](double) { return format::kPpsError; };
    s.expected = {{10, milliseconds(40), kHost, ClockState::kError}};
  });
  add("host too far off", [&](Scenario& s) {
    s.host_error = constant(milliseconds(260));
    s.expected = {{10, milliseconds(260), kHost, ClockState::kLocked}};
  });
  add("host near enough", [&](Scenario& s) {
    s.host_error = constant(milliseconds(-250));
    s.expected = {{10, milliseconds(0), kSensor, ClockState::kLocked}};
  });
  // A host that is earlier is followed at once: no later arrival can explain it.
  add("host that goes a little over the limit keeps the source, and loses it beyond", [&](Scenario& s) {
    s.host_error = [](double time_s) { return milliseconds(time_s < 2.0 ? -240 : time_s < 4.0 ? -270 : -310); };
    for (int scan = 5; scan < ScanAt(3.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
    s.expected.push_back({ScanAt(4.5), milliseconds(-310), kHost, ClockState::kLocked});
  });
  add("host whose deliveries wander over the limit does not make the source flip", [&](Scenario& s) {
    s.host_error = [](double time_s) { return milliseconds(240 + static_cast<int>(time_s * 10.0) % 2 * 30); };
    for (int scan = 5; scan < 50; ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
  });

  // --- The hour, by the sensor's clock.
  const auto across = [&](const std::string& name, Utime moment) {
    add("across " + name, [&](Scenario& s) {
      s.start = moment - seconds(2);
      s.duration_s = 5.0;
      s.host_error = constant(milliseconds(40));
      for (int scan = 0; scan < ScanAt(4.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
    });
  };
  across("the hour", sys_days(year(2026) / 6 / 15) + hours(15));
  across("midnight", sys_days(year(2026) / 6 / 16));
  across("the month", sys_days(year(2024) / 2 / 29));
  across("the year", sys_days(year(2027) / 1 / 1));
  across("the hour at a whole second of the host", sys_days(year(2026) / 6 / 15) + hours(15) + seconds(1));
  add("across midnight with a host three days off", [&](Scenario& s) {
    s.choice = TimeChoice::kSensor;
    s.start = sys_days(year(2026) / 6 / 16) - seconds(2);
    s.host_error = constant(hours(-75));
    for (int scan = 0; scan < ScanAt(5.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
  });
  add("host's clock counts from 1970", [&](Scenario& s) {
    s.choice = TimeChoice::kSensor;
    s.host_error = constant(-(sys_days(year(2026) / 6 / 15) - sys_days(year(1970) / 1 / 1)));
    s.expected = {{3, milliseconds(0), kSensor, ClockState::kLocked}, {50, milliseconds(0), kSensor, ClockState::kLocked}};
  });
  add("receiver whose week counter ran over", [&](Scenario& s) {
    s.choice = TimeChoice::kSensor;
    s.sentence = [](Utime start, double time_s) {
      return Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>(time_s * 1e6))) - std::chrono::days(7168));
    };
    s.expected = {{3, milliseconds(0), kSensor, ClockState::kLocked}, {50, milliseconds(0), kSensor, ClockState::kLocked}};
  });
  add("GGA, which has no date", [&](Scenario& s) {
    s.start = sys_days(year(2026) / 6 / 16) - seconds(2);
    s.host_error = constant(milliseconds(40));
    s.sentence = [](Utime start, double time_s) {
      const auto rmc = Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>(time_s * 1e6))));
      return "$GPGGA," + rmc.substr(7, 6) + ",4338.00,N,07209.00,W,4,12,0.8,200.0,M,-30.0,M,,";
    };
    for (int scan = 0; scan < ScanAt(5.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
  });
  add("RMC and GGA in turn with a host days off", [&](Scenario& s) {
    s.choice = TimeChoice::kSensor;
    s.host_error = constant(hours(49));
    s.sentence = [](Utime start, double time_s) {
      const auto rmc = Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>(time_s * 1e6))));
      return static_cast<int>(time_s * 10.0) % 2 == 0 ? rmc : "$GPGGA," + rmc.substr(7, 6) + ",4338.00,N,07209.00,W,4,12,0.8,200.0,M,-30.0,M,,";
    };
    for (int scan = 0; scan < ScanAt(5.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
  });
  add("RMC one second late across the hour", [&](Scenario& s) {
    s.start = sys_days(year(2026) / 6 / 15) + hours(15) - seconds(2);
    s.sentence = [](Utime start, double time_s) {
      return Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>((time_s - 1.2) * 1e6))));
    };
    for (int scan = 0; scan < ScanAt(5.9); ++scan) s.expected.push_back({scan, milliseconds(0), kSensor, ClockState::kLocked});
  });
  // The sensor took the late RMC for that of the next PPS: its own clock is a second behind. Only the host can tell.
  for (const auto choice : {TimeChoice::kAuto, TimeChoice::kSensor}) {
    add("sensor set by an RMC one second late", [&](Scenario& s) {
      s.choice = choice;
      s.stamp_error = constant(seconds(-1));
      s.sentence = [](Utime start, double time_s) {
        return Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>((time_s - 1.2) * 1e6))));
      };
      const bool is_auto = choice == TimeChoice::kAuto;
      s.expected = {{20, is_auto ? seconds(0) : seconds(-1), is_auto ? kHost : kSensor, ClockState::kLocked}};
    });
  }
  add("no RMC, sensor half an hour off a host that trembles", [&](Scenario& s) {
    s.choice = TimeChoice::kSensor;
    s.stamp_error = constant(minutes(-30));
    s.host_error = [](double time_s) { return milliseconds(static_cast<int>(time_s * 5.0) % 2 * 20 - 10); };
    s.pps = [](double) { return format::kPpsAbsent; };
    s.sentence = no_sentence;
    for (int scan = 0; scan < ScanAt(5.9); ++scan) s.expected.push_back({scan, minutes(-30), kSensor, ClockState::kNoPps});
  });
  for (const auto choice : {TimeChoice::kHost, TimeChoice::kSensor}) {
    add("values beyond 3600 s of a clock that never was set", [&](Scenario& s) {
      s.choice = choice;
      s.start = sys_days(year(2026) / 6 / 15) + hours(15) - seconds(2);
      s.does_stamp_wrap = false;
      s.pps = [](double) { return format::kPpsAbsent; };
      s.sentence = no_sentence;
      for (int scan = 0; scan < ScanAt(5.9); ++scan)
        s.expected.push_back({scan, milliseconds(0), choice == TimeChoice::kHost ? kHost : kSensor, ClockState::kNoPps});
    });
  }
  // 23:59:60 is 3600 s past the hour, and in POSIX time the same second as 00:00:00, which then comes once more.
  for (const auto choice : {TimeChoice::kHost, TimeChoice::kSensor}) {
    add("leap second", [&](Scenario& s) {
      s.choice = choice;
      s.start = sys_days(year(2017) / 1 / 1) - seconds(2);
      s.does_stamp_wrap = false;
      s.stamp_error = [](double time_s) { return time_s < 3.0 ? seconds(0) : -seconds(3601); };
      // Linux sets its clock back at the start of the leap second.
      s.host_error = [](double time_s) { return time_s < 2.0 ? seconds(0) : seconds(-1); };
      s.sentence = [](Utime start, double time_s) {
        const auto second = static_cast<int>(time_s - 0.2 + 10.0) - 10;
        if (second == 2) return Rmc(start, 'A', "235960");
        return Rmc(start + seconds(second < 2 ? second : second - 1));
      };
      const auto source = choice == TimeChoice::kHost ? kHost : kSensor;
      const auto in_leap_second = choice == TimeChoice::kHost ? seconds(-1) : seconds(0);
      s.expected = {{ScanAt(1.5), seconds(0), source, ClockState::kLocked},
                    {ScanAt(2.5), in_leap_second, source, ClockState::kLocked},
                    {ScanAt(3.3), seconds(-1), source, ClockState::kLocked},
                    {ScanAt(5.5), seconds(-1), source, ClockState::kLocked}};
    });
  }

  // --- The sensor's clock is set.
  for (const auto choice : {TimeChoice::kAuto, TimeChoice::kSensor}) {
    add("receiver off by the leap seconds, then right", [&](Scenario& s) {
      s.choice = choice;
      s.host_error = constant(milliseconds(40));
      s.stamp_error = [](double time_s) { return time_s < 4.0 ? seconds(18) : seconds(0); };
      s.sentence = [](Utime start, double time_s) {
        const auto error = time_s < 3.2 ? seconds(18) : seconds(0);
        return Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>((time_s - 0.2) * 1e6))) + error);
      };
      const bool is_auto = choice == TimeChoice::kAuto;
      const auto source = is_auto ? kHost : kSensor;
      s.expected = {{ScanAt(2.0), is_auto ? microseconds(milliseconds(40)) : seconds(18), source, ClockState::kLocked},
                    {ScanAt(3.6), is_auto ? microseconds(milliseconds(40)) : seconds(18), source, ClockState::kFreeRunning},
                    {ScanAt(5.5), milliseconds(0), kSensor, ClockState::kLocked}};
    });
  }
  add("sensor restarts and locks again", [&](Scenario& s) {
    s.duration_s = 12.0;
    s.host_error = constant(milliseconds(40));
    s.is_on = [](double time_s) { return time_s < 2.0 || time_s > 5.0; };
    s.stamp_error = [](double time_s) { return time_s > 5.0 && time_s < 8.0 ? microseconds(-(minutes(10) + seconds(5))) : microseconds(0); };
    s.pps = [](double time_s) {
      return time_s > 5.0 && time_s < 7.0 ? format::kPpsAbsent : time_s > 5.0 && time_s < 8.0 ? format::kPpsSynchronising : format::kPpsLocked;
    };
    s.sentence = [](Utime start, double time_s) {
      if (time_s > 5.0 && time_s < 7.0) return std::string();
      return Rmc(std::chrono::floor<seconds>(start + microseconds(static_cast<std::int64_t>((time_s - 0.2) * 1e6))));
    };
    // Two scans in parts, before and after the pause, and 30 that nobody saw: numbers are those of scans that were sent.
    const int num_unseen = ScanAt(5.0) - ScanAt(2.0) - 1;
    s.expected = {{ScanAt(1.5), milliseconds(0), kSensor, ClockState::kLocked},
                  {ScanAt(6.0), milliseconds(40), kHost, ClockState::kNoPps},
                  {ScanAt(7.5), milliseconds(40), kHost, ClockState::kAcquiring},
                  {ScanAt(10.0), milliseconds(0), kSensor, ClockState::kLocked}};
    s.num_unseen = num_unseen;
  });
  add("host's clock is set by ten seconds", [&](Scenario& s) {
    s.choice = TimeChoice::kHost;
    s.host_error = [](double time_s) { return time_s < 2.0 ? seconds(10) : seconds(0); };
    s.expected = {{ScanAt(1.5), seconds(10), kHost, ClockState::kLocked}, {ScanAt(2.5), seconds(0), kHost, ClockState::kLocked}};
  });
  return scenarios;
}

TEST(SensorClock, StampsScansToTheMicrosecond) {
  for (const auto& scenario : Scenarios()) {
    SCOPED_TRACE(scenario.name + (scenario.choice == TimeChoice::kAuto ? ", auto" : scenario.choice == TimeChoice::kHost ? ", host" : ", sensor"));
    const auto scans = Play(scenario);
    ASSERT_FALSE(scenario.expected.empty());
    for (const auto& expected : scenario.expected) {
      const auto found = scans.find(expected.scan - (expected.scan > ScanAt(2.0) ? scenario.num_unseen : 0));
      ASSERT_NE(found, scans.end()) << "scan " << expected.scan;
      const Scan& scan = found->second;
      const Utime true_time = scenario.start + After(expected.scan * kPacketsPerRevolution);
      EXPECT_EQ((scan.time - true_time).count(), expected.utime_error.count()) << "scan " << expected.scan;
      EXPECT_EQ(scan.clock.source, expected.source) << "scan " << expected.scan;
      EXPECT_EQ(scan.clock.state, expected.state) << "scan " << expected.scan;
    }
  }
}

TEST(SensorClock, IsUnknownWithoutPositionPacketsAndWhenTheyStop) {
  SensorClock clock(TimeChoice::kAuto);
  const Utime noon = sys_days(year(2026) / 6 / 15) + hours(12);
  StampedPacket packet;
  packet.host_time = noon;
  clock.OnDataPacket(packet);
  EXPECT_EQ(clock.Read(noon).state, ClockState::kUnknown);
  EXPECT_FALSE(clock.Read(noon).pps);
  EXPECT_FALSE(clock.Read(noon).rmc_age);
  PositionPacket position;
  position.pps = format::kPpsLocked;
  position.time = SentenceTime{hours(12), sys_days(year(2026) / 6 / 15)};
  clock.OnPositionPacket(noon, position, microseconds(0));
  const auto read_after = [&](microseconds time, microseconds host_error) {
    packet.is_restart = false;
    packet.time = time;
    packet.host_time = noon + time + host_error;
    clock.OnDataPacket(packet);
    return clock.Read(packet.host_time);
  };
  EXPECT_EQ(read_after(seconds(2), seconds(0)).rmc_age, seconds(2));
  EXPECT_EQ(read_after(seconds(3), seconds(0)).state, ClockState::kLocked);
  EXPECT_EQ(read_after(seconds(3), seconds(-4)).state, ClockState::kLocked) << "the host's clock was set back: that says nothing of the sensor's";
  EXPECT_EQ(read_after(seconds(3), seconds(12)).state, ClockState::kLocked) << "late";
  EXPECT_EQ(read_after(microseconds(3'000'001), seconds(0)).state, ClockState::kUnknown);
}

TEST(SensorClock, MeasuresTheAgeOfAnRmcFromWhenItWasNew) {
  SensorClock clock(TimeChoice::kAuto);
  const Utime noon = sys_days(year(2026) / 6 / 15) + hours(12);
  StampedPacket packet;
  packet.host_time = noon;
  clock.OnDataPacket(packet);
  PositionPacket position;
  position.pps = format::kPpsLocked;
  position.time = SentenceTime{hours(12), sys_days(year(2026) / 6 / 15)};
  for (int i = 0; i < 20; ++i) clock.OnPositionPacket(noon + i * milliseconds(100), position, i * milliseconds(100));
  packet.is_restart = false;
  packet.time = seconds(2);
  packet.host_time = noon + seconds(2);
  clock.OnDataPacket(packet);
  EXPECT_EQ(clock.Read(noon + seconds(2)).rmc_age, seconds(2));
}

TEST(SensorClock, StampsAPositionPacketThatComesBeforeAnyData) {
  const Utime noon = sys_days(year(2026) / 6 / 15) + hours(12);
  SensorClock host(TimeChoice::kHost);
  EXPECT_EQ(host.TimeOfStampAlone(noon, 77), noon);
  SensorClock sensor(TimeChoice::kSensor);
  EXPECT_EQ(sensor.TimeOfStampAlone(noon - seconds(1), 77), noon + microseconds(77));
}

}  // namespace
}  // namespace lookout::vlp16
