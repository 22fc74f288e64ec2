#include "lab/eval/tracks/alert_kept.hpp"

#include <chrono>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "lab/eval/tracks/track_sources.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;

const std::string kFingerprint(64, 'a');

void WriteRun(const fs::path& file) {
  KeptRunWriter writer(file, kFingerprint);
  writer.AddMessage(Utime(microseconds(5)), "OBSTACLES", std::vector<std::uint8_t>{1, 2, 3});
  writer.AddMessage(Utime(microseconds(6)), "TRACKS", std::vector<std::uint8_t>{4});  // made anew
  writer.AddMessage(Utime(microseconds(7)), "POSE", std::vector<std::uint8_t>{});
  writer.AddReturns(100, {{1, 20}, {7, 3}});
  writer.AddReturns(200, {});
  writer.Commit();
}

TEST(KeptRun, GivesBackWhatTheTrackerReads) {
  const TempFolder folder;
  const auto file = folder.path() / "a.run";
  EXPECT_FALSE(KeptRun::IsThere(file, kFingerprint));
  WriteRun(file);
  WriteRun(file);  // anew
  EXPECT_TRUE(KeptRun::IsThere(file, kFingerprint));
  EXPECT_FALSE(KeptRun::IsThere(file, std::string(64, 'b')));
  const KeptRun kept(file);
  EXPECT_EQ(kept.returns(), (ReturnsOfScans{{100, {{1, 20}, {7, 3}}}, {200, {}}}));
  std::vector<std::string> told;
  kept.Send([&](Utime time, std::string_view channel, Bytes bytes) {
    told.push_back(std::string(channel) + " " + std::to_string(ToUtimeUs(time)) + " " + std::to_string(bytes.size()));
  });
  EXPECT_EQ(told, (std::vector<std::string>{"OBSTACLES 5 3", "POSE 7 0"}));
}

TEST(KeptRun, WhatIsCutOffIsRefused) {
  const TempFolder folder;
  const auto file = folder.path() / "a.run";
  WriteRun(file);
  const auto size = fs::file_size(file);
  for (const auto cut : {size - 8, size - 20, std::uintmax_t{70}, std::uintmax_t{3}}) {
    WriteRun(file);
    fs::resize_file(file, cut);
    const auto read = [&file] { KeptRun(file).Send([](Utime, std::string_view, Bytes) {}); };
    EXPECT_THROW(read(), std::runtime_error) << cut;
  }
}

TEST(KeptRun, OfAnotherBoatSceneSeedOrLengthHasAnotherFingerprint) {
  const TempFolder folder;
  fs::copy(support::kCatabotConfig, folder.path() / "boat");
  const auto scene = support::kSources / "config/scenes/marina.txtpb";
  const auto other_scene = support::kSources / "config/scenes/dense.txtpb";
  const auto print = FingerprintOfRun(folder.path() / "boat", scene, 1, 20.0);
  EXPECT_EQ(print.size(), 64U);
  EXPECT_NE(FingerprintOfRun(folder.path() / "boat", other_scene, 1, 20.0), print);
  EXPECT_NE(FingerprintOfRun(folder.path() / "boat", scene, 2, 20.0), print);
  EXPECT_NE(FingerprintOfRun(folder.path() / "boat", scene, 1, 21.0), print);
  support::WriteFile(folder.path() / "boat/tracker.txtpb", "cpa_limit_m: 7\n");
  EXPECT_EQ(FingerprintOfRun(folder.path() / "boat", scene, 1, 20.0), print) << "the tracker runs anew";
  support::WriteFile(folder.path() / "boat/boat.txtpb", "name: \"another\"\n");
  EXPECT_NE(FingerprintOfRun(folder.path() / "boat", scene, 1, 20.0), print);
}

}  // namespace
}  // namespace lookout::eval
