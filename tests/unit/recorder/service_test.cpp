#include "services/recorder/service.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/log_file.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/files.hpp"

namespace lookout::recorder {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;
using std::chrono::seconds;

class Recorder : public support::BusTest {
 protected:
  support::TempDir folder_;
  Utime now_{seconds(1'800'000'000)};

  // The disk that the tests run on may be nearly full.
  Params params_{.log_folder = folder_, .reserve_bytes = 0};

  Service Make(const Disk& disk = RealDisk()) {
    return Service(
        bus_, params_, run_info_t{}, [this] { return now_; }, disk);
  }
  static std::vector<bus::LogEvent> Events(const fs::path& file) {
    std::vector<bus::LogEvent> events;
    bus::LogReader reader(file);
    while (auto event = reader.Next()) events.push_back(*event);
    return events;
  }
};

TEST_F(Recorder, BeginsWithRunInfoAndLogsEveryChannelWithItsTimeOfReceipt) {
  fs::path file;
  {
    Service service = Make();
    file = service.log_file();
    now_ += microseconds(5);
    bus::Publish(bus_, bus::kLidarNmea, lidar_nmea_t{});
    bus_.Publish(bus::Channel{"SOMEBODY_ELSES", "", "", 1, 1, false, false}, std::vector<std::uint8_t>{1, 2, 3});
    HandleAll();
    EXPECT_EQ(service.Report().state, HealthState::kOk);
  }
  EXPECT_EQ(file.filename(), "20270115T080000Z.lcmlog");
  const auto events = Events(file);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].channel, "RUN_INFO");
  EXPECT_EQ(events[1].channel, "LIDAR_NMEA");
  EXPECT_EQ(events[1].time, now_);
  EXPECT_EQ(events[2].channel, "SOMEBODY_ELSES");
  EXPECT_EQ(events[2].bytes, (std::vector<std::uint8_t>{1, 2, 3}));
}

// A bus that hands nothing on for long must not grow what is remembered: of RUN_INFO that comes back the last eight are known again.
TEST_F(Recorder, KnowsItsLastEightRunInfosWhenTheyComeBack) {
  for (const auto& [num_waiting, num_forgotten] : {std::pair{8, 0}, {9, 1}, {12, 4}}) {
    bus::MemoryBus bus;
    Service service(
        bus, params_, run_info_t{}, [this] { return now_; }, RealDisk());
    for (int i = 1; i < num_waiting; ++i) {
      now_ += seconds(10);
      service.AdvanceTo(now_);
    }
    support::HandleAll(bus);
    service.Flush();
    EXPECT_EQ(Events(service.log_file()).size(), static_cast<std::size_t>(num_waiting + num_forgotten)) << num_waiting;
    now_ += seconds(10);
  }
}

TEST_F(Recorder, RepeatsRunInfoEveryTenSecondsAndLogsItOnce) {
  Service service = Make();
  for (int i = 0; i < 21; ++i) {
    now_ += seconds(1);
    service.AdvanceTo(now_);
    HandleAll();
  }
  service.Flush();
  const auto events = Events(service.log_file());
  ASSERT_EQ(events.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto message = bus::Decode<run_info_t>(events[static_cast<std::size_t>(i)].bytes);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->seq, i);
  }
}

TEST_F(Recorder, NeverOverwritesALog) {
  const Service first = Make();
  const Service second = Make();
  EXPECT_NE(first.log_file(), second.log_file());
  EXPECT_EQ(second.log_file().filename(), "20270115T080000Z001.lcmlog");
}

TEST_F(Recorder, SaysWhyALogCannotBeMade) {
  EXPECT_THROW(Service(bus_, Params{.log_folder = "/proc/nowhere"}, run_info_t{}, [this] { return now_; }), std::runtime_error);
  std::ofstream(folder_ / "file") << "in the way";
  EXPECT_THROW(Service(bus_, Params{.log_folder = folder_ / "file"}, run_info_t{}, [this] { return now_; }), std::runtime_error);
}

TEST_F(Recorder, SendsRunInfoOnTheBusToo) {
  std::vector<run_info_t> received;
  bus::Subscribe<run_info_t>(bus_, bus::kRunInfo, [&](const run_info_t& message) { received.push_back(message); });
  Service service = Make();
  now_ += seconds(10);
  service.AdvanceTo(now_);
  HandleAll();
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(received[1].utime_us, ToUtimeUs(now_));
  EXPECT_EQ(received[1].seq, 1);
}

// A log that is played on the bus, say.
TEST_F(Recorder, LogsACopyOfItsRunInfoThatComesAgain) {
  Service service = Make();
  HandleAll();
  service.Flush();
  ASSERT_EQ(Events(service.log_file()).size(), 1U);
  bus_.Publish(bus::kRunInfo, Events(service.log_file())[0].bytes);
  HandleAll();
  service.Flush();
  EXPECT_EQ(Events(service.log_file()).size(), 2U);
}

TEST_F(Recorder, LogsTheRunInfoOfSomebodyElse) {
  Service service = Make();
  run_info_t other{};
  other.program = "replay";
  Send(bus::kRunInfo, other);
  service.Flush();
  const auto events = Events(service.log_file());
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(bus::Decode<run_info_t>(events[1].bytes)->program, "replay");
}

TEST_F(Recorder, SendsRunInfoAgainWhenTheHostsClockIsSetBack) {
  Service service = Make();
  now_ -= seconds(3600);
  service.AdvanceTo(now_);
  service.Flush();
  EXPECT_EQ(Events(service.log_file()).size(), 2U);
}

// Nobody has to ask for it: what is killed a second later is on the disk.
TEST_F(Recorder, HandsOverWhatItHoldsByItself) {
  Service service = Make();
  Send(bus::kLidarNmea, lidar_nmea_t{});
  const auto deadline = std::chrono::steady_clock::now() + seconds(20);
  while (Events(service.log_file()).size() < 2 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(Events(service.log_file()).size(), 2U);
}

// Sends bytes on a channel that is in no table.
void SendUnknown(bus::MemoryBus& bus, std::string_view name) {
  bus.Publish(bus::Channel{name, "", "", 1, 1, false, false}, std::vector<std::uint8_t>{1, 2, 3});
}

TEST_F(Recorder, WarnsOnceOfEachUnknownChannelAndKeepsItsNamePrintable) {
  Service service = Make();
  const std::string ugly = "UGLY\x1b[2J\xff";
  for (int i = 0; i < 3; ++i) {
    SendUnknown(bus_, "SOMEBODY_ELSES");
    SendUnknown(bus_, ugly);
  }
  HandleAll();
  const auto warnings = service.TakeWarnings();
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "channel SOMEBODY_ELSES is not in the channel table; it is recorded");
  EXPECT_EQ(warnings[1], "channel UGLY?[2J? is not in the channel table; it is recorded");
  EXPECT_TRUE(service.TakeWarnings().empty());
  EXPECT_EQ(support::CountOf(service, "unknown_channel"), 6);
  EXPECT_EQ(service.Report().state, HealthState::kOk);
  service.Flush();
  EXPECT_EQ(Events(service.log_file()).back().channel, ugly) << "as it came";
}

TEST_F(Recorder, NamesTwentyUnknownChannelsAndCountsTheRest) {
  Service service = Make();
  std::vector<std::string> names;
  for (int i = 0; i < 30; ++i) names.push_back("CHANNEL_" + std::to_string(i));
  for (const auto& name : names) SendUnknown(bus_, name);
  HandleAll();
  const auto warnings = service.TakeWarnings();
  ASSERT_EQ(warnings.size(), 20U);
  EXPECT_NE(warnings.back().find("further ones are not named"), std::string::npos);
  EXPECT_EQ(support::CountOf(service, "unknown_channel"), 30);
}

// A bus that hands over whatever a transport other than UDP may bring.
class AnythingBus final : public bus::Bus {
 public:
  bool HandleOnce(std::chrono::milliseconds /*timeout*/) override { return false; }
  int QueueDepth(std::string_view /*channel*/) const override { return -1; }
  void Bring(std::string_view channel, Bytes bytes) { handler_(channel, bytes); }

 protected:
  bool Send(const bus::Channel& /*channel*/, std::vector<std::uint8_t>&& /*bytes*/) override { return true; }
  void Attach(const bus::Channel* /*channel*/, RawHandler handler) override { handler_ = std::move(handler); }

 private:
  RawHandler handler_;
};

TEST_F(Recorder, CountsAndTellsOnceWhatALogCannotHold) {
  AnythingBus anything;
  Service service(anything, params_, run_info_t{}, [this] { return now_; });
  const std::vector<std::uint8_t> most(16U * 1024 * 1024);
  auto more = most;
  more.push_back(0);
  const std::string longest(63, 'N');
  for (int i = 0; i < 2; ++i) {
    anything.Bring("HUGE\x1b", more);
    anything.Bring(longest + "N", Bytes(most).first(3));
    anything.Bring(std::string(2000, 'N'), Bytes(most).first(3));
    anything.Bring("", Bytes(most).first(3));
  }
  anything.Bring("LARGE", most);
  anything.Bring(longest, Bytes(most).first(3));
  EXPECT_EQ(support::CountOf(service, "event_too_large"), 2);
  EXPECT_EQ(support::CountOf(service, "channel_name_too_long"), 4);
  EXPECT_EQ(support::CountOf(service, "nameless_channel"), 2);
  const auto warnings = service.TakeWarnings();
  ASSERT_EQ(warnings.size(), 5U);
  EXPECT_EQ(warnings[0], "an event of 16777217 bytes on channel HUGE? (16777216 are allowed) cannot be recorded; further ones are counted in HEALTH");
  EXPECT_NE(warnings[1].find("a name of 64 bytes (63 are allowed)"), std::string::npos) << warnings[1];
  EXPECT_NE(warnings[2].find("without name"), std::string::npos) << warnings[2];
  service.Flush();
  const auto events = Events(service.log_file());
  ASSERT_EQ(events.size(), 3U) << "RUN_INFO and what can be recorded";
  EXPECT_EQ(events[1].bytes, most);
  EXPECT_EQ(events[2].channel, longest);
}

TEST_F(Recorder, CountsRawMessagesThatDidNotArrive) {
  Service service = Make();
  nav_raw_t message{};
  for (const std::int64_t seq : {0, 1, 2, 5, 0, 1}) {  // 3 and 4 are missing; then navigator starts again
    message.seq = seq;
    bus::Publish(bus_, bus::kNavRaw, message);
  }
  bus_.Publish(bus::kNavRaw, std::vector<std::uint8_t>{1, 2, 3});
  HandleAll();
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "raw_missing"), 2);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(support::CountOf(service, "events"), 8) << "all are recorded, also what cannot be read";
}

// Messages of navigators that go on by turns, and the recorder's clock with them.
class RecorderOfNumbers : public Recorder {
 protected:
  void Send(std::int64_t seq, int milliseconds_later = 20) {
    now_ += std::chrono::milliseconds(milliseconds_later);
    nav_raw_t message{};
    message.seq = seq;
    message.utime_us = ToUtimeUs(now_);
    BusTest::Send(bus::kNavRaw, message);
  }
  void Pass(Service& service, int num_seconds) {
    for (int i = 0; i < 2 * num_seconds; ++i) {
      now_ += std::chrono::milliseconds(500);
      service.AdvanceTo(now_);
    }
  }
};

TEST_F(RecorderOfNumbers, ALossIsToldForAMinuteAndItsCountStays) {
  Service service = Make();
  for (const std::int64_t seq : {0, 1, 2, 5, 6}) Send(seq);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  Pass(service, 59);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  Pass(service, 1);
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  EXPECT_EQ(support::CountOf(service, "raw_missing"), 2);
  Send(9);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded) << "and the next one is told again";
}

TEST_F(RecorderOfNumbers, AStepOfTheClockIsNoMinute) {
  Service service = Make();
  for (const std::int64_t seq : {0, 1, 2, 5}) Send(seq);
  for (const int hours : {-24, 48, -24}) {
    now_ += std::chrono::hours(hours);
    service.AdvanceTo(now_);
    EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  }
  Pass(service, 60);
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
}

TEST_F(RecorderOfNumbers, OneJumpOfTheNumbersIsNoLoss) {
  Service service = Make();
  for (std::int64_t seq = 0; seq < 20; ++seq) Send(seq);
  Send(900'000'000);
  for (std::int64_t seq = 20; seq < 40; ++seq) Send(seq);
  EXPECT_EQ(support::CountOf(service, "raw_missing"), 0);
  EXPECT_EQ(support::CountOf(service, "second_publishers_messages"), 1);
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "events"), 42) << "it is recorded all the same";
}

TEST_F(RecorderOfNumbers, TwoPublishersAreRecordedAndToldUntilAMinuteAfter) {
  Service service = Make();
  for (std::int64_t i = 0; i < 20; ++i) {
    Send(5000 + i);
    Send(3 + i);
  }
  Send(5020);
  auto report = service.Report();
  EXPECT_EQ(report.state, HealthState::kDegraded);
  EXPECT_EQ(report.reason.rfind("NAV_RAW: two publishers; all is recorded", 0), 0U) << report.reason;
  EXPECT_EQ(support::CountOf(service, "second_publishers_messages"), 20);
  EXPECT_EQ(support::CountOf(service, "raw_missing"), 0);
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "events"), 42);
  Pass(service, 60);
  report = service.Report();
  EXPECT_EQ(report.state, HealthState::kOk) << report.reason;
  EXPECT_EQ(support::CountOf(service, "second_publishers_messages"), 20);
}

// For its lifetime no file can grow: writes fail as on a full disk.
class FullDisk {
 public:
  FullDisk() {
    signal_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit_);
    rlimit none = limit_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_FSIZE, &none);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit limit_{};
  void (*signal_)(int) = nullptr;
};

TEST_F(Recorder, GoesOnInANewLogWhenADiskThatWasFullIsNotAnyMore) {
  Service service = Make();
  const auto first = service.log_file();
  Send(bus::kLidarNmea, lidar_nmea_t{});
  service.Flush();
  HealthReport report_when_full;
  {
    const FullDisk full;
    for (int i = 0; i < 3; ++i) {
      Send(bus::kLidarNmea, lidar_nmea_t{});
      service.Flush();
      now_ += seconds(1);
      service.AdvanceTo(now_);
      service.Flush();
    }
    report_when_full = service.Report();
  }
  EXPECT_EQ(report_when_full.state, HealthState::kFailed);
  EXPECT_EQ(report_when_full.reason.rfind("not recording: ", 0), 0U) << report_when_full.reason;
  EXPECT_EQ(service.TakeWarnings().size(), 1U) << "once, not at each attempt";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "attempts leave no empty logs";
  EXPECT_EQ(support::CountOf(service, "lost"), 3);

  now_ += seconds(1);
  service.AdvanceTo(now_);
  Send(bus::kLidarNmea, lidar_nmea_t{});
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service.Report().reason.rfind("recording again; 3 events lost", 0), 0U) << service.Report().reason;
  ASSERT_NE(service.log_file(), first);
  EXPECT_EQ(Events(first).size(), 2U);
  const auto events = Events(service.log_file());
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].channel, "RUN_INFO");
  EXPECT_EQ(events[1].channel, "LIDAR_NMEA");
}

TEST(RecorderParams, AreThoseOfTheFileAndTheFolderMustBeNamed) {
  const auto params = LoadParams(support::kCatabotConfig.string());
  EXPECT_EQ(params.log_folder, "logs");
  EXPECT_EQ(params.max_file_bytes, 2'000'000'000);
  EXPECT_EQ(params.max_file_time, std::chrono::hours(1));
  EXPECT_EQ(params.reserve_bytes, 1'000'000'000);
  EXPECT_EQ(params.queue_bytes, 64'000'000);
  const support::TempDir folder;
  std::ofstream(folder / "recorder.txtpb") << "log_folder: \"\"\n";
  EXPECT_THROW(LoadParams(folder), std::runtime_error);
}

}  // namespace
}  // namespace lookout::recorder
