#include "tools/log/commands.hpp"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <limits>
#include <sstream>

#include "tests/unit/log/small_log.hpp"
#include "tools/log/log_span.hpp"

namespace lookout::log {
namespace {

namespace fs = std::filesystem;

class LogCommands : public log_test::SmallLog {
 protected:
  std::ostringstream out_;
  std::ostringstream errors_;

  // Two minutes: RUN_INFO at 0 and 60 s, POSE each 10 s, NOISE each 20 s.
  std::vector<bus::LogEvent> TwoMinutes() const {
    std::vector<bus::LogEvent> events;
    for (int second = 0; second <= 120; second += 10) {
      if (second % 60 == 0) events.push_back(RunInfo(second));
      events.push_back(Pose(second, second / 10));
      if (second % 20 == 0) events.push_back(Event(start_ + std::chrono::seconds(second), "NOISE", {1, 2, 3}));
    }
    return events;
  }
  bool Said(const std::string& text) const { return out_.str().find(text) != std::string::npos; }
  std::string InfoOf(const fs::path& file) {
    out_.str("");
    Info({file}, out_);
    return out_.str();
  }
  SliceRequest Request(const fs::path& in) const {
    SliceRequest request;
    request.inputs = {in};
    request.output = folder_ / "out";
    request.force = true;
    return request;
  }
  // "POSE 10" and so on: channel and second.
  std::vector<std::string> Sliced(const SliceRequest& request) {
    Slice(request, out_, errors_);
    std::vector<std::string> lines;
    for (const auto& event : Read(request.output)) {
      lines.push_back(event.channel + " " + std::to_string((event.time - start_) / std::chrono::seconds(1)));
    }
    return lines;
  }
};

TEST_F(LogCommands, InfoTellsChannelsTypesRatesGapsAndWhoMadeIt) {
  const auto file =
      Write("log", {RunInfo(0), Pose(1, 0), Pose(2, 1), Pose(3, 5), Pose(7, 6), Event(start_ + std::chrono::seconds(10), "UGLY\n", {1})});
  Info({file}, out_);
  EXPECT_TRUE(Said("damage    none\n"));
  EXPECT_TRUE(Said("events    6\n"));
  EXPECT_TRUE(Said("start     2027-01-15T08:00:00.000000Z\n"));
  EXPECT_TRUE(Said("span      10.000000 s\n"));
  EXPECT_TRUE(Said("made by   recorder 0.1.0 on boat, wire types " + bus::SchemaDigest().substr(0, 12) + "\n"));
  EXPECT_TRUE(Said("POSE                 pose_t                     4         3268     0.500        3       4.000  3.000000 s\n")) << out_.str();
  EXPECT_TRUE(Said("UGLY?                ?                          1            1")) << out_.str();
}

TEST_F(LogCommands, InfoTellsTheMachineInALineForEach) {
  run_info_t info{};
  info.file_name = {"boat.txtpb", "machine.txt"};
  info.file_text = {
      "name: 1\n", "architecture: aarch64\nprocessor: implementer 0x41\nprocessor_features: fp asimd\nc_library: glibc 2.36\nglibc_tunables: none\n"};
  info.num_files = 2;
  const auto first = Event(start_, "RUN_INFO", bus::Encode(info));
  info.file_text[1] = "architecture: \x1b[2J\n";
  const auto other = Event(start_, "RUN_INFO", bus::Encode(info));
  Info({Write("log", {first, first, other, RunInfo(1)})}, out_);
  EXPECT_TRUE(Said("machine   aarch64, implementer 0x41, fp asimd, glibc 2.36, glibc_tunables: none\nmachine   ?[2J\n")) << out_.str();
}

// In a chroot without /proc: "unknown, unknown" said nothing.
TEST_F(LogCommands, InfoNamesWhatIsNotKnownOfTheMachine) {
  run_info_t info{};
  info.file_name = {"machine.txt"};
  info.file_text = {"architecture: x86_64\nprocessor: unknown\nprocessor_features: unknown\nc_library: glibc 2.36\n"};
  info.num_files = 1;
  Info({Write("log", {Event(start_, "RUN_INFO", bus::Encode(info))})}, out_);
  EXPECT_TRUE(Said("machine   x86_64, processor: unknown, processor_features: unknown, glibc 2.36\n")) << out_.str();
}

TEST_F(LogCommands, InfoReadsRotatedLogsAsOne) {
  const auto first = Write("1", {RunInfo(0), Pose(0, 0), Pose(1, 1)});
  const auto second = Write("2", {RunInfo(2), Pose(3, 3)});
  Info({first, second}, out_);
  EXPECT_TRUE(Said("span      3.000000 s\n"));
  EXPECT_TRUE(Said("POSE                 pose_t                     3         2451     0.667        1       2.000  1.000000 s\n")) << out_.str();
}

TEST_F(LogCommands, InfoShowsATypeThatThisVersionDoesNotKnow) {
  std::vector<std::uint8_t> message = log_test::kUnknownFingerprint;
  message.resize(24);
  Info({Write("log", {Event(start_, "LATER", message)})}, out_);
  EXPECT_TRUE(Said("LATER                ?  ")) << out_.str();
}

TEST_F(LogCommands, InfoTellsWhereALogIsDamaged) {
  const auto file = Write("log", TwoMinutes());
  const auto text = Content(file);
  SetContent(file, text.substr(0, 10'000) + std::string(500, 'x') + text.substr(10'000, text.size() - 10'100));
  Info({file}, out_);
  EXPECT_TRUE(Said("damage    2 stretches, ")) << out_.str();
}

TEST_F(LogCommands, RefuseWhatIsNoLog) {
  SetContent(folder_ / "text", "this is no log");
  EXPECT_THROW(Info({folder_ / "text"}, out_), std::runtime_error);
  EXPECT_THROW(Info({folder_ / "nowhere"}, out_), std::runtime_error);
  EXPECT_THROW(Repair(folder_ / "text", folder_ / "out", false, out_, errors_), std::runtime_error);
  EXPECT_THROW(Slice(Request(folder_ / "text"), out_, errors_), std::runtime_error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing half done is left";
}

TEST_F(LogCommands, SliceTakesFromToAndBeginsWithTheRunInfoBefore) {
  auto request = Request(Write("log", TwoMinutes()));
  request.from = "15";
  request.to = "40";
  EXPECT_EQ(Sliced(request), (std::vector<std::string>{"RUN_INFO 20", "POSE 20", "NOISE 20", "POSE 30"}));
  request.from = "2027-01-15T08:01:35Z";
  request.to = "2027-01-15T08:01:40.000001Z";
  EXPECT_EQ(Sliced(request), (std::vector<std::string>{"RUN_INFO 100", "POSE 100", "NOISE 100"}));
  // LCM's reader takes it, and the numbers of the events are continuous.
  lcm_eventlog_t* log = lcm_eventlog_create(request.output.c_str(), "r");
  std::int64_t number = 0;
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    EXPECT_EQ(event->eventnum, number++);
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  EXPECT_EQ(number, 3);
}

TEST_F(LogCommands, InfoSaysWhetherTheLogHoldsARunFromItsStartToItsEnd) {
  const auto start = Packets(0, 0, lidar_packets_t::MARK_START);
  const auto end = Packets(9, 9, lidar_packets_t::MARK_END);
  Info({Write("whole", {start, NavRaw(0, 0, nav_raw_t::KIND_START), Packets(5, 1), NavRaw(5, 1), end, NavRaw(9, 2, nav_raw_t::KIND_END)})}, out_);
  EXPECT_TRUE(Said("begins    with a start mark: LIDAR_PACKETS, NAV_RAW\n")) << out_.str();
  EXPECT_TRUE(Said("ends      with an end mark: LIDAR_PACKETS, NAV_RAW\n")) << out_.str();
  out_.str("");
  Info({Write("cut", {start, NavRaw(3, 7), Packets(5, 1)})}, out_);
  EXPECT_TRUE(Said("begins    with a start mark: LIDAR_PACKETS\n")) << out_.str();
  EXPECT_TRUE(Said("begins    without a start mark: NAV_RAW; what a replay gives first need not equal the live run\n")) << out_.str();
  EXPECT_TRUE(Said("ends      without an end mark: LIDAR_PACKETS, NAV_RAW; cut there")) << out_.str();
  EXPECT_FALSE(Said("within")) << out_.str();
  // Of a second lidar.
  auto second = Packets(0, 0, lidar_packets_t::MARK_START);
  second.channel = "LIDAR_PACKETS_2";
  out_.str("");
  Info({Write("two", {start, second, end})}, out_);
  EXPECT_TRUE(Said("begins    with a start mark: LIDAR_PACKETS, LIDAR_PACKETS_2\n")) << out_.str();
  EXPECT_TRUE(Said("ends      without an end mark: LIDAR_PACKETS_2; cut there")) << out_.str();
  // A run that was cut, and a whole one behind it.
  const auto cut = Write("log", {Packets(0, 0, lidar_packets_t::MARK_START), Packets(1, 1), Packets(5, 0, lidar_packets_t::MARK_START),
                                 Packets(6, 1, lidar_packets_t::MARK_END)});
  out_.str("");
  Info({cut}, out_);
  EXPECT_TRUE(Said("within    a run without an end mark is followed by another: LIDAR_PACKETS; ")) << out_.str();
  // Rotated files are one run.
  out_.str("");
  Info({Write("1", {start, Packets(1, 1)}), Write("2", {Packets(2, 2), end})}, out_);
  EXPECT_TRUE(Said("begins    with a start mark: LIDAR_PACKETS\n")) << out_.str();
  EXPECT_TRUE(Said("ends      with an end mark: LIDAR_PACKETS\n")) << out_.str();
  out_.str("");
  Info({Write("none", {Pose(0, 0), Event(start_, "LIDAR_PACKETS", {1, 2, 3})})}, out_);
  EXPECT_TRUE(Said("marks     no raw channel")) << out_.str();
}

TEST_F(LogCommands, InfoSaysFromWhichEventOnAChannelHasTwoPublishers) {
  std::vector<bus::LogEvent> events{RunInfo(0)};
  const auto pose = [&](int milliseconds, std::int64_t seq) {
    pose_t message{};
    message.seq = seq;
    message.utime_us = 1000 * milliseconds;
    events.push_back(Event(start_ + std::chrono::milliseconds(milliseconds), "POSE", bus::Encode(message)));
  };
  for (int i = 0; i < 10; ++i) pose(20 * i, 700 + i);
  EXPECT_EQ(InfoOf(Write("one", events)).find("two publishers"), std::string::npos);
  for (int i = 10; i < 20; ++i) {
    pose(20 * i, i);
    pose(20 * i + 5, 700 + i);
  }
  const auto text = InfoOf(Write("two", events));
  EXPECT_NE(text.find("mixed     two publishers of POSE from event 11 on, 2027-01-15T08:00:00.200000Z: 10 messages are of the second\n"
                      "          from there on the log stands outside the proof"),
            std::string::npos)
      << text;
}

TEST_F(LogCommands, InfoTakesARestartForOne) {
  std::vector<bus::LogEvent> events{RunInfo(0)};
  for (int i = 0; i < 10; ++i) events.push_back(NavRaw(i, 700 + i));
  for (int i = 0; i < 10; ++i) events.push_back(NavRaw(10 + i, i, i == 0 ? std::int32_t{nav_raw_t::KIND_START} : std::int32_t{nav_raw_t::KIND_TICK}));
  const auto text = InfoOf(Write("log", events));
  EXPECT_EQ(text.find("two publishers"), std::string::npos) << text;
}

TEST_F(LogCommands, SliceTakesChannelsAndTheFirstRunInfoAllTheSame) {
  auto request = Request(Write("log", TwoMinutes()));
  request.channels = {"NOISE"};
  request.from = "70";
  EXPECT_EQ(Sliced(request), (std::vector<std::string>{"RUN_INFO 80", "NOISE 80", "NOISE 100", "NOISE 120"}));
}

TEST_F(LogCommands, SliceOfEverythingIsTheSameFile) {
  const auto request = Request(Write("log", TwoMinutes()));
  Slice(request, out_, errors_);
  EXPECT_EQ(Content(request.output), Content(request.inputs[0]));
}

TEST_F(LogCommands, NoCommandReplacesAFileUnlessItIsForced) {
  const auto file = Write("log", TwoMinutes());
  SetContent(folder_ / "out", "another recording");
  auto request = Request(file);
  request.force = false;
  EXPECT_THROW(Slice(request, out_, errors_), std::runtime_error);
  EXPECT_THROW(Repair(file, folder_ / "out", false, out_, errors_), std::runtime_error);
  EXPECT_EQ(Content(folder_ / "out"), "another recording");
  Repair(file, folder_ / "out", true, out_, errors_);
  EXPECT_EQ(Content(folder_ / "out"), Content(file));
}

TEST_F(LogCommands, SliceGoesAcrossRotatedLogs) {
  auto request = Request(Write("1", {RunInfo(0), Pose(0, 0), Pose(1, 1)}));
  request.inputs.push_back(Write("2", {RunInfo(2), Pose(2, 2)}));
  request.from = "1";
  EXPECT_EQ(Sliced(request), (std::vector<std::string>{"RUN_INFO 1", "POSE 1", "RUN_INFO 2", "POSE 2"}));
}

TEST_F(LogCommands, SliceSaysWhatIsWrongWithItsRequest) {
  const auto file = Write("log", TwoMinutes());
  for (const char* wrong : {"-5", "1e3", "soon", "1.", ".5", "1.1234567", "2027-01-15", "2027-13-15T08:00:00Z", "2027-02-30T08:00:00Z",
                            "2027-01-15T24:00:00Z", "2027-01-15T08:00:60Z", "99999999999999999999", "2027-01-15T08:00:00"}) {
    auto request = Request(file);
    request.from = wrong;
    EXPECT_THROW(Slice(request, out_, errors_), UsageError) << wrong;
  }
  auto backwards = Request(file);
  backwards.from = "20";
  backwards.to = "10";
  EXPECT_THROW(Slice(backwards, out_, errors_), UsageError);
  auto empty = Request(file);
  empty.channels = {"NOSUCH"};
  EXPECT_THROW(Slice(empty, out_, errors_), std::runtime_error);
  auto onto_itself = Request(file);
  onto_itself.output = file;
  const auto before = Content(file);
  EXPECT_THROW(Slice(onto_itself, out_, errors_), std::runtime_error);
  EXPECT_EQ(Content(file), before);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(LogCommands, SliceTakesEveryNotationOfATimeAndRefusesWhatLiesOutside) {
  auto request = Request(Write("log", TwoMinutes()));
  for (const char* from : {"95", "+95", "1:35", "2027-01-15T08:01:35Z", "08:01:35Z", "1800000095000000"}) {
    request.from = from;
    EXPECT_EQ(Sliced(request),
              (std::vector<std::string>{"RUN_INFO 100", "POSE 100", "NOISE 100", "POSE 110", "RUN_INFO 120", "POSE 120", "NOISE 120"}))
        << from;
  }
  for (const char* from : {"122", "2027-01-15T07:00:00Z", "2027-01-16T08:01:35Z", "1800000195000000", "1800000095"}) {
    request.from = from;
    try {
      Slice(request, out_, errors_);
      FAIL() << from;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("lies outside of the log, which goes from 2027-01-15T08:00:00.000000Z to 2027-01-15T08:02:00.000000Z"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST_F(LogCommands, SpanIsFoundWithoutReadingTheWholeLog) {
  std::vector<bus::LogEvent> events;
  for (int i = 0; i < 100; ++i) events.push_back(Event(start_ + std::chrono::seconds(i), "NOISE", std::vector<std::uint8_t>(100'000, 7)));
  const auto file = Write("log", events);
  EXPECT_EQ(SpanOf({file}).begin, start_);
  EXPECT_EQ(SpanOf({file}).end, start_ + std::chrono::seconds(99));
  // Damage at the end that is longer than what is looked at first.
  const auto text = Content(file);
  SetContent(file, text.substr(0, text.size() - text.size() / 100) + std::string(3'000'000, 'x'));
  EXPECT_EQ(SpanOf({file}).end, start_ + std::chrono::seconds(98));
  EXPECT_EQ(SpanOf({Write("empty", {}), file, Write("later", {Pose(500, 0)})}).end, start_ + std::chrono::seconds(500));
  EXPECT_THROW(SpanOf({folder_ / "empty"}), std::runtime_error);
}

TEST_F(LogCommands, RepairKeepsEveryWholeEventAndTellsWhatWasLost) {
  const auto events = TwoMinutes();
  const auto file = Write("log", events);
  const auto text = Content(file);
  // The third event loses its sync word, the last is torn.
  std::size_t third = 0;
  for (int i = 0; i < 2; ++i) third += 28 + events[static_cast<std::size_t>(i)].channel.size() + events[static_cast<std::size_t>(i)].bytes.size();
  auto damaged = text.substr(0, text.size() - 1);
  damaged[third] = 'x';
  SetContent(file, damaged);
  Repair(file, folder_ / "out", false, out_, errors_);
  const auto kept = Read(folder_ / "out");
  ASSERT_EQ(kept.size(), events.size() - 2);
  EXPECT_EQ(kept[2].bytes, events[3].bytes);
  EXPECT_TRUE(Said("lost: 36 bytes at byte " + std::to_string(third) + ", between 2027-01-15T08:00:00.000000Z and 2027-01-15T08:00:10.000000Z\n"))
      << out_.str();
  EXPECT_TRUE(Said("lost: 35 bytes at byte " + std::to_string(text.size() - 36) + ", between 2027-01-15T08:02:00.000000Z and the end\n"))
      << out_.str();
  EXPECT_TRUE(Said("71 bytes lost in 2 stretches\n")) << out_.str();
}

TEST_F(LogCommands, RepairOfAWholeLogIsTheSameFile) {
  const auto file = Write("log", TwoMinutes());
  Repair(file, folder_ / "out", false, out_, errors_);
  EXPECT_EQ(Content(folder_ / "out"), Content(file));
  EXPECT_TRUE(Said("0 bytes lost in 0 stretches"));
}

// A recorder that appended, and a writer that gives each event the same number: a copy numbered them anew, and was another file.
TEST_F(LogCommands, CopiesKeepTheNumbersOfEvents) {
  const auto events = TwoMinutes();
  const std::vector<std::vector<std::int64_t>> kinds{{0, 1, 2, 0, 1}, {0, 0, 0, 0}, {7}, {-3, std::numeric_limits<std::int64_t>::max(), 5}};
  for (const auto& numbers : kinds) {
    std::vector<std::uint8_t> log;
    for (std::size_t i = 0; i < events.size(); ++i) {
      bus::AppendLogEvent(log, numbers[i % numbers.size()], events[i].time, events[i].channel, events[i].bytes);
    }
    SetContent(folder_ / "log", {log.begin(), log.end()});
    Repair(folder_ / "log", folder_ / "out", true, out_, errors_);
    EXPECT_EQ(Content(folder_ / "out"), Content(folder_ / "log"));
    auto request = Request(folder_ / "log");
    Slice(request, out_, errors_);
    EXPECT_EQ(Content(folder_ / "out"), Content(folder_ / "log"));
    request.from = "0";
    request.to = "60";
    Slice(request, out_, errors_);
    EXPECT_TRUE(Content(folder_ / "log").starts_with(Content(folder_ / "out"))) << "a slice of the beginning is the beginning";
  }
}

// An image of a camera on the same bus is no damage.
TEST_F(LogCommands, KeepLargeEventsOfOthers) {
  std::vector<std::uint8_t> image(20'000'000);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint8_t>(i % 241);
  const auto file = Write("log", {RunInfo(0), Event(start_, "CAMERA", image), Pose(1, 0)});
  const auto text = InfoOf(file);
  EXPECT_NE(text.find("damage    none\n"), std::string::npos) << text;
  EXPECT_NE(text.find("CAMERA               ?                          1     20000000"), std::string::npos) << text;
  Repair(file, folder_ / "out", true, out_, errors_);
  EXPECT_TRUE(Content(folder_ / "out") == Content(file));
  Slice(Request(file), out_, errors_);
  EXPECT_TRUE(Content(folder_ / "out") == Content(file));
}

// "damage none" stood beside messages in which replay found flipped bits.
TEST_F(LogCommands, InfoTellsMessagesWhosePayloadIsNotWhole) {
  pose_t pose{};
  pose.utime_us = ToUtimeUs(start_);
  const auto whole = Event(start_, "POSE", bus::Encode(pose));
  auto flipped = whole;
  flipped.bytes[3] ^= 0x10;  // its fingerprint
  auto cut = whole;
  cut.bytes.resize(cut.bytes.size() - 8);
  auto packets = Packets(0, 0, lidar_packets_t::MARK_START);
  auto bad_packets = packets;
  bad_packets.bytes[24] ^= 0x40;  // marks that do not exist
  EXPECT_NE(InfoOf(Write("sound", {packets, NavRaw(0, 0, nav_raw_t::KIND_START), Event(start_, "OTHER", {1})}))
                .find("payloads  2 messages of known channels checked, nothing wrong; 1 of other channels are not looked into\n"),
            std::string::npos);
  const auto text = InfoOf(Write("log", {packets, flipped, bad_packets, cut, NavRaw(0, 1, 99), flipped}));
  EXPECT_NE(text.find("damage    none\npayloads  6 messages of known channels checked, 5 are wrong\n"), std::string::npos) << text;
  EXPECT_NE(text.find("          2 POSE: of another type than the channel's; the first is event 1, 2027-01-15T08:00:00.000000Z\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("          1 POSE: do not decode; the first is event 3"), std::string::npos) << text;
  EXPECT_NE(text.find("          of another version of Lookout, or damaged: lookout-replay makes POSE anew of the log\n"), std::string::npos) << text;
  EXPECT_NE(text.find("          1 NAV_RAW: nav_raw_bad_kind; the first is event 4"), std::string::npos) << text;
  EXPECT_NE(text.find("          1 LIDAR_PACKETS: hold packets of the lidar that do not fill them"), std::string::npos) << text;
}

// Any stretch of noise at any place: never more is lost than the events that it touched.
TEST_F(LogCommands, RepairLosesNoEventThatNoDamageTouched) {
  const auto events = TwoMinutes();
  const auto file = Write("log", events);
  const auto text = Content(file);
  for (std::size_t place = 0; place + 40 < text.size(); place += 211) {
    auto damaged = text;
    for (std::size_t i = 0; i < 40; ++i) damaged[place + i] = static_cast<char>(place * 31 + i * 7);
    SetContent(file, damaged);
    Repair(file, folder_ / "out", true, out_, errors_);
    const auto kept = Read(folder_ / "out");
    std::size_t end = 0;
    std::size_t num_untouched = 0;
    for (const auto& event : events) {
      const auto start = end;
      end += 28 + event.channel.size() + event.bytes.size();
      if (end <= place || start >= place + 40) ++num_untouched;
    }
    EXPECT_GE(kept.size(), num_untouched) << "noise at " << place;
  }
}

}  // namespace
}  // namespace lookout::log