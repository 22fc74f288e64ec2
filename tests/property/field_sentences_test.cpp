// Inputs of a field trial (shared/data/field) whose sentences, datagrams and files have forms that others really send: each gives what its README
// says is right.
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/input.hpp"

namespace lookout {
namespace {

// The boat sails east at 2 m/s from here, at 10:00:00 UTC.
constexpr Utime kStart = std::chrono::sys_days(std::chrono::year(2026) / 8 / 29) + std::chrono::hours(10);
constexpr double kSpeedMps = 2.0;
constexpr double kMetresPerDegree = 111'320.0;  // of longitude on the equator, to some parts in a thousand

struct Given {
  std::vector<gnss_fix_t> fixes;
  std::vector<attitude_t> attitudes;
  std::vector<pose_t> poses;
  std::map<std::string, std::int64_t> counters;  // above 0
};

Given Replayed(const std::filesystem::path& file) {
  Given given;
  const std::vector files{file};
  const auto inspection = replay::Inspect(files, {});
  replay::Chain chain(support::kDemoConfig, inspection.plan, [&given](Utime, std::string_view channel, Bytes bytes) {
    if (channel == bus::kGnssFix.name) given.fixes.push_back(bus::Decode<gnss_fix_t>(bytes).value());
    if (channel == bus::kAttitude.name) given.attitudes.push_back(bus::Decode<attitude_t>(bytes).value());
    if (channel == bus::kPose.name) given.poses.push_back(bus::Decode<pose_t>(bytes).value());
  });
  runtime::Progress progress("test", nullptr);
  replay::Finish(replay::Feed(files, inspection, chain, progress), inspection, chain);
  for (const auto& [name, count] : chain.Counters()) given.counters[name] = count;
  return given;
}

struct Right {
  const char* file;
  std::size_t num_fixes;
  std::size_t num_headings;
  double latitude_deg = 54.5;
  double longitude_deg = 10.2;
  double seconds_from_start = 0.0;  // of the first fix
};

class FieldSentences : public ::testing::TestWithParam<Right> {};

TEST_P(FieldSentences, GiveWhatIsRight) {
  const auto& right = GetParam();
  const auto file = support::kRecordings / "field" / right.file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not at hand";
  const auto given = Replayed(file);
  EXPECT_EQ(given.fixes.size(), right.num_fixes);
  EXPECT_EQ(given.attitudes.size(), right.num_headings);
  const auto expect_on_the_way = [&right](const auto& message, double bound_m) {
    const double seconds = static_cast<double>(message.utime_us - ToUtimeUs(kStart)) * 1e-6 - right.seconds_from_start;
    const double metres_per_degree = kMetresPerDegree * std::cos(right.latitude_deg * M_PI / 180.0);
    EXPECT_NEAR(message.latitude_deg, right.latitude_deg, bound_m / kMetresPerDegree);
    EXPECT_NEAR((message.longitude_deg - right.longitude_deg) * metres_per_degree, kSpeedMps * seconds, bound_m);
  };
  for (const auto& fix : given.fixes) {
    expect_on_the_way(fix, 1.1);  // a thousandth of a minute is 1.07 m
    EXPECT_FALSE(fix.hdop < 0.35) << "of no sky";
    EXPECT_GE(fix.horizontal_sd_m, 1.0) << "of a receiver without RTK";
  }
  for (const auto& attitude : given.attitudes) EXPECT_NEAR(attitude.heading_rad, M_PI / 2.0, 1e-6);
  std::size_t num_ok = 0;
  for (const auto& pose : given.poses) {
    if (pose.status != pose_t::STATUS_OK) continue;
    ++num_ok;
    expect_on_the_way(pose, 5.0);
  }
  EXPECT_GT(num_ok * 10, given.poses.size() * 9);
  for (const char* refusal : {"no_checksum", "bad_checksum", "bad_field", "implausible_value", "no_start", "too_long", "not_printable", "cut_off",
                              "sentence_time_unusable"}) {
    EXPECT_EQ(given.counters.count("navigator." + std::string(refusal)), 0U) << refusal;
  }
}

std::string NameOf(const ::testing::TestParamInfo<Right>& info) {
  std::string name = info.param.file;
  for (auto& letter : name) letter = letter == '.' ? '_' : letter;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, FieldSentences,
                         ::testing::Values(Right{"lon_not_padded.nmea", 20, 20},                                              //
                                           Right{"lon_minutes_only.nmea", 20, 20, 50.7, 0.014},                               //
                                           Right{"gll_not_padded_no_time.pcap", 20, 20, 54.5, 10.2, 0.2},                     // at receipt
                                           Right{"gga_lon_4_digits.pcap", 20, 20},                                            //
                                           Right{"rmc_space_padded.nmea", 20, 20}, Right{"eol_trailing_space.nmea", 20, 20},  //
                                           Right{"eol_trailing_tab.nmea", 20, 20}, Right{"udp_split_64.pcap", 40, 20},        //
                                           Right{"udp_glued.pcap", 40, 20}, Right{"opencpn_vdr.csv", 20, 20},                 //
                                           Right{"utf16.nmea", 20, 20}, Right{"packed.nmea.gz", 20, 20}),
                         NameOf);

}  // namespace
}  // namespace lookout
