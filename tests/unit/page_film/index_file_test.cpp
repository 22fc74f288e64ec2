#include "services/page/film/index_file.hpp"

#include <gtest/gtest.h>

#include "tests/unit/page_film/scene.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

class IndexFile : public ::testing::Test {
 protected:
  IndexFile() { WriteScans(log_, 0, 20); }

  LogPart Load() {
    return *LoadIndex(log_, true, {}, [this](const std::string& line) { told_.push_back(line); });
  }

  support::TempDir folder_;
  fs::path log_ = folder_ / "a.lcmlog";
  fs::path index_ = folder_ / "a.lcmlog.index";
  std::vector<std::string> told_;
};

TEST_F(IndexFile, GivesBackWhatWasWritten) {
  const auto made = Load();
  ASSERT_TRUE(fs::exists(index_));
  EXPECT_EQ(made.entries.size(), 100U);
  const auto bytes = support::ReadFile(index_);
  const auto read = FromIndexBytes(Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), IdentityOf(log_));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, made);
}

TEST_F(IndexFile, IsTheSameForTheSameLog) {
  Load();
  const auto first = support::ReadFile(index_);
  fs::remove(index_);
  Load();
  EXPECT_EQ(support::ReadFile(index_), first);
}

TEST_F(IndexFile, IsMadeAnewForALogThatChanged) {
  Load();
  const auto time = fs::last_write_time(log_);
  WriteScans(log_, 0, 25);
  fs::last_write_time(log_, time);
  EXPECT_EQ(Load().entries.size(), 125U);
  auto bytes = support::ReadFile(log_);  // of the same size and time
  bytes.back() ^= 1;
  support::WriteFile(log_, bytes);
  fs::last_write_time(log_, time);
  const auto before = support::ReadFile(index_);
  Load();
  EXPECT_NE(support::ReadFile(index_), before);
}

TEST_F(IndexFile, IsMadeAnewWhereItIsTornOrForged) {
  const auto made = Load();
  const auto whole = support::ReadFile(index_);
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    support::WriteFile(index_, whole.substr(0, size));
    ASSERT_EQ(Load(), made) << size;
  }
  for (std::size_t place = 0; place < whole.size(); place += 53) {
    auto forged = whole;
    forged[place] = static_cast<char>(forged[place] ^ 0x40);
    support::WriteFile(index_, forged);
    ASSERT_EQ(Load(), made) << place;
  }
  EXPECT_EQ(support::ReadFile(index_), whole);
}

// With a right digest, but places outside of the log.
TEST_F(IndexFile, RefusesPlacesThatTheLogCannotHave) {
  const auto identity = IdentityOf(log_);
  const auto made = Load();
  EXPECT_TRUE(FromIndexBytes(ToIndexBytes(identity, made), identity));
  const auto is_refused = [&](const auto& spoil) {
    auto part = made;
    spoil(part);
    return !FromIndexBytes(ToIndexBytes(identity, part), identity);
  };
  EXPECT_TRUE(is_refused([&](LogPart& part) { part.entries.back().offset_bytes = identity.size_bytes; }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.entries.front().offset_bytes = -1; }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.entries.front().time += std::chrono::hours(1); }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.entries.front().channel = 999; }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.entries.front().channel = IndexOfChannel(bus::kLidarPackets); }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.entries.front().channel = IndexOfChannel(bus::kHealth); }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.cells.front().alert_level = 9; }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.processes.resize(kMaxFilmProcesses + 1); }));
  EXPECT_TRUE(is_refused([](LogPart& part) { part.events.resize(kMaxFilmEvents + 1); }));
}

TEST_F(IndexFile, StaysInMemoryWhereNothingCanBeWritten) {
  fs::create_directory(index_);  // its name is taken; also root cannot write there
  EXPECT_EQ(Load().entries.size(), 100U);
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_NE(told_[0].find("kept in memory"), std::string::npos);
}

TEST_F(IndexFile, EndsWhenItIsAskedTo) {
  {
    SceneLog log(log_);
    for (int seq = 0; seq < 300; ++seq) log->Scan(seq);  // more than a slice
  }
  EXPECT_FALSE(LoadIndex(log_, true, [](std::int64_t) { return false; }, {}));
  EXPECT_FALSE(fs::exists(index_));
}

}  // namespace
}  // namespace lookout::page
