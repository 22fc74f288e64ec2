// Real receivers: what gpsd reads out of its own logs, and what boats' networks carry.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "services/navigator/core/interpreter.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/nmea.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

namespace fs = std::filesystem;

using support::kRecordings;
using support::ReadFile;

// The value behind "key": in a line of JSON; empty when there is none.
std::string JsonValue(const std::string& json, const std::string& key) {
  const auto place = json.find("\"" + key + "\":");
  if (place == std::string::npos) return {};
  auto begin = place + key.size() + 3;
  if (json[begin] == '"') ++begin;
  return json.substr(begin, json.find_first_of(",\"}", begin) - begin);
}

// "2020-03-18T13:28:19.600Z"
Utime FromIso(const std::string& text) {
  int year = 0;
  int month = 0;
  int day = 0;
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  EXPECT_EQ(std::sscanf(text.c_str(), "%d-%d-%dT%d:%d:%lfZ", &year, &month, &day, &hour, &minute, &second), 6) << text;
  return std::chrono::sys_days(std::chrono::year(year) / month / day) + std::chrono::hours(hour) + std::chrono::minutes(minute) +
         std::chrono::microseconds(std::llround(second * 1e6));
}

struct Expectation {
  const char* name;
  int min_positions;  // compared with the report behind the sentence
  int min_times;      // compared with reports of the same time
  bool compares_time;
};

class GpsdTimes : public ::testing::TestWithParam<Expectation> {};
class GpsdLog : public ::testing::TestWithParam<Expectation> {};

TEST_P(GpsdLog, HasTheFixesThatGpsdReads) {
  const fs::path file = kRecordings / "gpsd" / (std::string(GetParam().name) + ".log.chk");
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  std::istringstream lines(ReadFile(file));
  std::optional<ParseResult> last;
  int num_positions = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("$", 0) == 0) {
      while (!line.empty() && line.back() == '\r') line.pop_back();
      last = ParseSentence(line);
      continue;
    }
    // The report that stands right behind a sentence is what gpsd made of it.
    if (last && last->fault == SentenceFault::kNone && JsonValue(line, "class") == "TPV" && !JsonValue(line, "lat").empty()) {
      const auto& sentence = last->sentence;
      const bool is_rmc = sentence.type == SentenceType::kRmc;
      const bool is_gga = sentence.type == SentenceType::kGga;
      if ((is_rmc || is_gga) && sentence.position) {
        EXPECT_NEAR(sentence.position->latitude_deg, std::stod(JsonValue(line, "lat")), 1e-9) << line;
        EXPECT_NEAR(sentence.position->longitude_deg, std::stod(JsonValue(line, "lon")), 1e-9) << line;
        ++num_positions;
      }
      if (is_rmc && sentence.date && sentence.time_of_day && GetParam().compares_time) {
        EXPECT_EQ(*sentence.date + *sentence.time_of_day, FromIso(JsonValue(line, "time"))) << line;
      }
      if (is_gga && !std::isnan(sentence.EllipsoidHeightM())) {
        EXPECT_NEAR(sentence.msl_height_m, std::stod(JsonValue(line, "altMSL")), 1e-4);
        EXPECT_NEAR(sentence.EllipsoidHeightM(), std::stod(JsonValue(line, "altHAE")), 2e-3);
      }
    }
    last.reset();
  }
  EXPECT_GE(num_positions, GetParam().min_positions);
}

// gpsd often reports later, when an epoch is whole: its reports of the time of an RMC hold the place of that RMC.
TEST_P(GpsdTimes, HasThePlacesThatGpsdReadsAtThem) {
  const fs::path file = kRecordings / "gpsd" / (std::string(GetParam().name) + ".log.chk");
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  std::istringstream lines(ReadFile(file));
  std::map<Utime, GeodeticPlace> expected;
  std::map<Utime, GeodeticPlace> found;
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (JsonValue(line, "class") == "TPV" && !JsonValue(line, "time").empty() && !JsonValue(line, "lat").empty()) {
      expected[FromIso(JsonValue(line, "time"))] = {std::stod(JsonValue(line, "lat")), std::stod(JsonValue(line, "lon"))};
    }
    const auto [fault, rmc] = ParseSentence(line);
    const bool is_rmc = fault == SentenceFault::kNone && rmc.type == SentenceType::kRmc;
    if (is_rmc && rmc.date && rmc.time_of_day && rmc.position) found[*rmc.date + *rmc.time_of_day] = *rmc.position;
  }
  int num_compared = 0;
  for (const auto& [time, position] : found) {
    if (!expected.contains(time)) continue;
    EXPECT_NEAR(position.latitude_deg, expected[time].latitude_deg, 1e-9);
    EXPECT_NEAR(position.longitude_deg, expected[time].longitude_deg, 1e-9);
    ++num_compared;
  }
  EXPECT_GE(num_compared, GetParam().min_times);
}

const auto kNameOfLog = [](const auto& log) {
  std::string name = log.param.name;
  std::ranges::replace(name, '-', '_');
  return name;
};

// gpsd mends rolled over weeks and, in tcp-torture, sets a year of its own; bu303 is not NMEA: gpsd wrote the sentences, and one digit short.
INSTANTIATE_TEST_SUITE_P(Logs, GpsdLog,
                         ::testing::Values(Expectation{"nmea-rtk", 80, 80, true}, Expectation{"ublox-zed-f9p-nmea", 2, 25, true},
                                           Expectation{"april6_2019", 1, 1, true}, Expectation{"tcp-torture", 2, 0, false},
                                           Expectation{"hemi", 0, 0, false}, Expectation{"sounder", 0, 0, false},
                                           Expectation{"pypilot", 0, 0, false}),
                         kNameOfLog);
INSTANTIATE_TEST_SUITE_P(Logs, GpsdTimes,
                         ::testing::Values(Expectation{"nmea-rtk", 80, 80, true}, Expectation{"ublox-zed-f9p-nmea", 2, 25, true},
                                           Expectation{"april6_2019", 1, 1, true}),
                         kNameOfLog);

struct GpsdComparison {
  const char* name;
  int num_with_time;     // epochs compared with reports of the same time of day
  int num_without_time;  // fixes compared with reports that hold no time, in their order
};

class GpsdEpochs : public ::testing::TestWithParam<GpsdComparison> {};

struct EpochFix {
  GeodeticPlace position;
  double speed_mps = kNan;
};

// The raw log, through all that a fix goes through, against gpsd's last report of each epoch.
TEST_P(GpsdEpochs, HaveGpsdsPositionsTimesOfDayAndSpeeds) {
  constexpr double kMaxPositionErrorDeg = 1e-7;
  constexpr double kMaxSpeedErrorMps = 0.01;
  const fs::path log = kRecordings / "gpsd" / (std::string(GetParam().name) + ".log");
  if (!fs::exists(log)) GTEST_SKIP() << log << " is not at hand";

  InterpreterParams params;
  params.max_sentence_latency = std::chrono::milliseconds(500);
  params.position_sd_m = 2.5;
  Interpreter interpreter(params);
  std::map<std::int64_t, EpochFix> found;  // by milliseconds of the day
  std::vector<EpochFix> found_without_time;
  std::optional<std::int64_t> last;
  std::int64_t seq = 0;
  for (const auto& line : SplitDatagram(ToBytes(ReadFile(log))).lines) {
    // Far from the time in the sentences: the computer's clock says nothing.
    const auto [fix, attitude, velocity, turn_rate, imu] =
        interpreter.Read({NoonPlus(static_cast<double>(seq) * 0.01), seq, ItemKind::kSentence, "udp", line});
    ++seq;
    if (velocity && last) found[*last].speed_mps = velocity->speed_mps;  // VTG, behind the fix of its epoch
    if (!fix || !fix->position || !IsMeasured(fix->quality)) continue;
    if (!fix->when.has_sentence_utc) {
      found_without_time.push_back({*fix->position, fix->speed_mps});
      continue;
    }
    const auto time_of_day = fix->when.utc - std::chrono::floor<std::chrono::days>(fix->when.utc);
    last = std::chrono::round<std::chrono::milliseconds>(time_of_day).count();
    found[*last] = {*fix->position, fix->speed_mps};
    found_without_time.push_back({*fix->position, fix->speed_mps});
  }

  std::istringstream lines(ReadFile(log.string() + ".chk"));
  std::map<std::int64_t, std::string> expected;
  std::vector<std::string> expected_without_time;
  for (std::string line; std::getline(lines, line);) {
    if (JsonValue(line, "class") != "TPV" || JsonValue(line, "lat").empty()) continue;
    const auto time = JsonValue(line, "time");
    if (time.empty()) {
      expected_without_time.push_back(line);
    } else {
      const auto utc = FromIso(time);
      expected[std::chrono::round<std::chrono::milliseconds>(utc - std::chrono::floor<std::chrono::days>(utc)).count()] = line;
    }
  }
  int num_speeds = 0;
  const auto compare = [&](const EpochFix& fix, const std::string& json) {
    EXPECT_NEAR(fix.position.latitude_deg, std::stod(JsonValue(json, "lat")), kMaxPositionErrorDeg) << json;
    EXPECT_NEAR(fix.position.longitude_deg, std::stod(JsonValue(json, "lon")), kMaxPositionErrorDeg) << json;
    const auto speed = JsonValue(json, "speed");
    if (!speed.empty() && !std::isnan(fix.speed_mps)) {
      EXPECT_NEAR(fix.speed_mps, std::stod(speed), kMaxSpeedErrorMps) << json;
      ++num_speeds;
    }
  };
  int num_with_time = 0;
  for (const auto& [time_of_day_ms, fix] : found) {
    const auto report = expected.find(time_of_day_ms);
    if (report == expected.end()) continue;
    compare(fix, report->second);
    ++num_with_time;
  }
  std::cout << GetParam().name << ": " << found.size() << " epochs here, " << expected.size() << " there, " << num_with_time << " compared; "
            << expected_without_time.size() << " reports without a time, " << num_speeds << " speeds compared\n";
  EXPECT_EQ(num_with_time, GetParam().num_with_time);
  // gpsd gives no time where no sentence has told a date: compared in order.
  int num_without_time = 0;
  if (expected.empty()) {
    ASSERT_EQ(found_without_time.size(), expected_without_time.size());
    for (std::size_t i = 0; i < found_without_time.size(); ++i) {
      compare(found_without_time[i], expected_without_time[i]);
      ++num_without_time;
    }
  }
  EXPECT_EQ(num_without_time, GetParam().num_without_time);
}

INSTANTIATE_TEST_SUITE_P(Logs, GpsdEpochs,
                         ::testing::Values(GpsdComparison{"nmea-rtk", 122, 0}, GpsdComparison{"ublox-zed-f9p-nmea", 29, 0},
                                           GpsdComparison{"april6_2019", 1, 0}, GpsdComparison{"tcp-torture", 1, 0}, GpsdComparison{"hemi", 6, 0},
                                           GpsdComparison{"sounder", 0, 122}, GpsdComparison{"pypilot", 0, 0}, GpsdComparison{"bu303-moving", 0, 0},
                                           GpsdComparison{"bu303-nofix", 0, 0}),
                         kNameOfLog);

// How many lines of a log are of each kind.
std::map<std::string, int> Census(const fs::path& file) {
  const auto lines = SplitDatagram(ToBytes(ReadFile(file)));
  std::map<std::string, int> census;
  census["no start"] = static_cast<int>(lines.num_no_start);
  census["not printable"] = static_cast<int>(lines.num_not_printable);
  for (const auto& line : lines.lines) {
    static const char* const kFaults[] = {"", "no checksum", "bad checksum", "bad field", "implausible"};
    static const char* const kTypes[] = {"other", "RMC", "GGA", "GNS", "XDR",   "TNTHTM", "VTG",   "HDT",      "PASHR",    "GST", "GLL",
                                         "ZDA",   "HDG", "ROT", "HPR", "VNINS", "VNYMR",  "VNIMU", "ATTITUDE", "POSITION", "GPS"};
    static_assert(std::size(kTypes) == kNumSentenceTypes);
    const auto result = ParseSentence(line);
    ++census[result.fault == SentenceFault::kNone ? kTypes[static_cast<std::size_t>(result.sentence.type)] : kFaults[static_cast<int>(result.fault)]];
  }
  return census;
}

// Every sentence that is understood goes through: nothing is refused, and time never runs backwards.
TEST(Recordings, OfABoatInAmsterdamAreReadWhole) {
  const auto file = kRecordings / "nmea/signalk_gps.log";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  InterpreterParams params;
  params.max_sentence_latency = std::chrono::milliseconds(500);
  params.position_sd_m = 2.5;
  Interpreter interpreter(params);
  std::int64_t seq = 0;
  int num_fixes = 0;
  Utime last{};
  for (const auto& line : SplitDatagram(ToBytes(ReadFile(file))).lines) {
    const auto fix = interpreter.Read({NoonPlus(static_cast<double>(seq) * 0.25), seq, ItemKind::kSentence, "gnss", line}).fix;
    ++seq;
    if (!fix) continue;
    ++num_fixes;
    if (num_fixes > 1) {  // the first GGA cannot know its day
      EXPECT_GE(fix->when.utc, last);
      last = fix->when.utc;
    }
  }
  EXPECT_EQ(num_fixes, 1202 + 1201);
  for (const auto& counter : interpreter.counters()) {
    const bool is_refusal = counter.name == "bad_field" || counter.name == "implausible_value" || counter.name == "bad_checksum" ||
                            counter.name == "no_checksum" || counter.name == "time_backwards" || counter.name == "date_unusable";
    EXPECT_EQ(is_refusal ? counter.count : 0, 0) << counter.name;
  }
}

struct Kinds {
  const char* log;
  std::map<std::string, int> exactly;  // lines of a kind
  std::map<std::string, int> more_than;
};

class RecordedKinds : public ::testing::TestWithParam<Kinds> {};

TEST_P(RecordedKinds, OfLinesAreThoseThatTheLogHolds) {
  const auto file = kRecordings / GetParam().log;
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  auto census = Census(file);
  for (const auto& [kind, number] : GetParam().exactly) EXPECT_EQ(census[kind], number) << kind;
  for (const auto& [kind, number] : GetParam().more_than) EXPECT_GT(census[kind], number) << kind;
}

// Of a boat in Amsterdam; of a boat's network, with AIS as "other" lines; with numbers for talkers, and HDM; of a receiver with empty and full
// headings; of a binary protocol.
INSTANTIATE_TEST_SUITE_P(
    Logs, RecordedKinds,
    ::testing::Values(
        Kinds{"nmea/signalk_gps.log", {{"bad field", 0}, {"implausible", 0}, {"no checksum", 0}}, {{"RMC", 1000}, {"GGA", 1000}, {"VTG", 1000}}},
        Kinds{"nmea/signalk_gofree-merrimac.log", {{"bad field", 0}, {"implausible", 0}, {"not printable", 0}}, {{"RMC", 10}, {"other", 1000}}},
        Kinds{"nmea/signalk_n2kd-183-merrimac.log", {{"bad field", 0}, {"implausible", 0}, {"bad checksum", 0}}, {{"other", 100}, {"HDG", 10}}},
        Kinds{"gpsd/hemi.log", {{"HDT", 215}, {"GGA", 215}, {"VTG", 215}, {"ZDA", 108}}, {}},
        Kinds{"gpsd/bu303-nofix.log", {{"RMC", 0}, {"GGA", 0}, {"HDT", 0}, {"other", 0}}, {}}),
    [](const auto& log) {
      std::string name = fs::path(log.param.log).stem();
      std::ranges::replace(name, '-', '_');
      return name;
    });

}  // namespace
}  // namespace lookout::navigator
