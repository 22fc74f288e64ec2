#include "common/bus/log_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sstream>
#include <stdexcept>

#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"

namespace lookout::bus {
namespace {

namespace fs = std::filesystem;

class LogFile : public ::testing::Test {
 protected:
  support::TempDir folder_;
  fs::path file_ = folder_ / "log";

  void WriteThree() {
    support::FileLog writer(file_);
    for (int i = 0; i < 3; ++i) {
      const std::vector<std::uint8_t> bytes(100, static_cast<std::uint8_t>(i));
      writer.Write(Utime(std::chrono::microseconds(1000 + i)), "CHANNEL", bytes);
    }
  }
  std::string Content() { return support::ReadFile(file_); }
  void SetContent(const std::string& text) { support::WriteFile(file_, text); }
  static constexpr std::size_t kEventBytes = 28 + 7 + 100;
};

TEST_F(LogFile, GivesBackWhatWasWritten) {
  WriteThree();
  LogReader reader(file_);
  for (int i = 0; i < 3; ++i) {
    const auto event = reader.Next();
    ASSERT_TRUE(event);
    EXPECT_EQ(ToUtimeUs(event->time), 1000 + i);
    EXPECT_EQ(event->channel, "CHANNEL");
    EXPECT_EQ(event->bytes, std::vector<std::uint8_t>(100, static_cast<std::uint8_t>(i)));
  }
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 0);
}

TEST_F(LogFile, EventsAsBytesAreThoseOfLcmsWriter) {
  lcm_eventlog_t* writer = lcm_eventlog_create(file_.c_str(), "w");
  ASSERT_NE(writer, nullptr);
  for (int i = 0; i < 3; ++i) {
    std::string channel = "CHANNEL";
    std::vector<std::uint8_t> bytes(100, static_cast<std::uint8_t>(i));
    lcm_eventlog_event_t event{};
    event.timestamp = 1000 + i;
    event.channellen = static_cast<std::int32_t>(channel.size());
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.channel = channel.data();
    event.data = bytes.data();
    ASSERT_EQ(lcm_eventlog_write_event(writer, &event), 0);
  }
  lcm_eventlog_destroy(writer);
  std::vector<std::uint8_t> log;
  for (int i = 0; i < 3; ++i) {
    AppendLogEvent(log, i, Utime(std::chrono::microseconds(1000 + i)), "CHANNEL", std::vector<std::uint8_t>(100, static_cast<std::uint8_t>(i)));
  }
  EXPECT_EQ(std::string(log.begin(), log.end()), Content());
}

TEST_F(LogFile, IsReadOnFromAPlaceThatWasNoted) {
  WriteThree();
  LogReader reader(file_);
  EXPECT_EQ(reader.position_bytes(), 0);
  EXPECT_TRUE(reader.Next());
  EXPECT_TRUE(reader.Next());
  EXPECT_EQ(reader.position_bytes(), static_cast<std::int64_t>(2 * kEventBytes));
  EXPECT_EQ(reader.size_bytes(), static_cast<std::int64_t>(3 * kEventBytes));
  reader.Seek(static_cast<std::int64_t>(kEventBytes));
  EXPECT_EQ(ToUtimeUs(reader.Next()->time), 1001);
  EXPECT_EQ(reader.num_damaged(), 0);
}

TEST_F(LogFile, CountsATornTail) {
  WriteThree();
  SetContent(Content().substr(0, 2 * kEventBytes + 50));
  LogReader reader(file_);
  EXPECT_TRUE(reader.Next());
  EXPECT_TRUE(reader.Next());
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 1);
}

TEST_F(LogFile, FindsTheNextEventAfterADamagedLength) {
  WriteThree();
  auto text = Content();
  text[kEventBytes + 24] = '\x7F';  // data length of the second event: 2 GB
  SetContent(text);
  LogReader reader(file_);
  EXPECT_EQ(ToUtimeUs(reader.Next()->time), 1000);
  EXPECT_EQ(ToUtimeUs(reader.Next()->time), 1002);
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 1);
}

TEST_F(LogFile, DoesNotBelieveADamagedLengthThatStillFits) {
  WriteThree();
  auto text = Content();
  text[27] = static_cast<char>(100 + kEventBytes / 2);  // the first event now ends in the middle of the second
  SetContent(text);
  LogReader reader(file_);
  EXPECT_EQ(ToUtimeUs(reader.Next()->time), 1001);
  EXPECT_EQ(ToUtimeUs(reader.Next()->time), 1002);
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 1);
}

TEST_F(LogFile, SkipsJunkInFrontAndBetween) {
  WriteThree();
  const auto text = Content();
  SetContent("junk" + text.substr(0, kEventBytes) + std::string(1000, '\xED') + text.substr(kEventBytes));
  LogReader reader(file_);
  int num_events = 0;
  while (reader.Next()) ++num_events;
  EXPECT_EQ(num_events, 3);
  EXPECT_EQ(reader.num_damaged(), 2);
}

TEST_F(LogFile, PassesOverWhatIsNotWanted) {
  const std::vector<std::uint8_t> large(200'000, 7);  // more than is read at once
  {
    support::FileLog writer(file_);
    for (int i = 0; i < 20; ++i) {
      writer.Write(Utime(std::chrono::microseconds(i)), i % 2 == 0 ? "LARGE" : "SMALL", i % 2 == 0 ? Bytes(large) : Bytes(large).first(10));
    }
  }
  for (const std::string wanted : {"LARGE", "SMALL"}) {
    LogReader reader(file_);
    for (int i = 0; i < 20; ++i) {
      const auto event = reader.NextView([&wanted](std::string_view channel) { return channel == wanted; });
      ASSERT_TRUE(event);
      EXPECT_EQ(ToUtimeUs(event->time), i);
      EXPECT_EQ(event->channel, i % 2 == 0 ? "LARGE" : "SMALL");
      const std::size_t size = event->channel == "LARGE" ? large.size() : 10;
      EXPECT_EQ(event->bytes.size(), event->channel == wanted ? size : 0);
      EXPECT_TRUE(std::ranges::all_of(event->bytes, [](std::uint8_t byte) { return byte == 7; }));
    }
    EXPECT_FALSE(reader.NextView([](std::string_view) { return false; }));
    EXPECT_EQ(reader.position_bytes(), static_cast<std::int64_t>(fs::file_size(file_)));
    EXPECT_EQ(reader.num_damaged(), 0);
  }
}

TEST_F(LogFile, IsGivenInPiecesToWhoTakesThem) {
  WriteThree();
  std::string taken;
  LogWriter writer([&taken](Bytes bytes) { taken.append(bytes.begin(), bytes.end()); });
  for (int i = 0; i < 3; ++i) {
    writer.Write(Utime(std::chrono::microseconds(1000 + i)), "CHANNEL", std::vector<std::uint8_t>(100, static_cast<std::uint8_t>(i)));
  }
  writer.Flush();
  EXPECT_EQ(taken, Content());
  EXPECT_EQ(writer.num_bytes(), static_cast<std::int64_t>(taken.size()));
  writer.Flush();
  EXPECT_EQ(taken.size(), Content().size());
}

TEST_F(LogFile, TellsWhatTheTakerThrows) {
  LogWriter writer([](Bytes) { throw std::runtime_error("the disk is full"); });
  writer.Write(Utime(), "CHANNEL", {});
  EXPECT_THROW(writer.Flush(), std::runtime_error);
}

TEST_F(LogFile, ThatDoesNotExistIsAnError) { EXPECT_THROW(LogReader("/nonexistent/file"), std::runtime_error); }

TEST_F(LogFile, OfLcmsOwnToolsCanBeRead) {
  const fs::path recording = support::kRecordings / "lcm/lcmproj_example.lcmlog";
  if (!fs::exists(recording)) GTEST_SKIP() << "no recording at " << recording;
  LogReader reader(recording);
  int num_events = 0;
  while (reader.Next()) ++num_events;
  EXPECT_GT(num_events, 0);
  EXPECT_EQ(reader.num_damaged(), 0);
}

TEST_F(LogFile, GivesTheBeginningOfWhatIsLarge) {
  {
    support::FileLog writer(file_);
    for (int i = 0; i < 20; ++i) {
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(i) * 9'000, 7);
      if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(i);
      writer.Write(Utime(std::chrono::microseconds(i)), "CHANNEL", bytes);
    }
  }
  LogReader reader(file_);
  for (std::size_t i = 0; i < 20; ++i) {
    const auto place = reader.position_bytes();
    const auto event = reader.NextHead([](std::string_view) { return 16; });
    ASSERT_TRUE(event);
    EXPECT_EQ(event->position_bytes, place);
    EXPECT_EQ(event->num_data_bytes, i * 9'000);
    ASSERT_EQ(event->bytes.size(), i == 0 ? 0U : 16U);
    if (i > 0) {
      EXPECT_EQ(event->bytes[0], i);
    }
  }
  EXPECT_FALSE(reader.NextHead([](std::string_view) { return 16; }));
  EXPECT_EQ(reader.num_damaged(), 0);
}

// A camera's image on the same bus: an event of 20 MB was skipped as damage. LCM's format allows up to 2 GB.
TEST_F(LogFile, PassesOverALargeEventAndGivesItsRestInPieces) {
  constexpr std::size_t kLargeBytes = 40'000'003;
  std::vector<std::uint8_t> large(kLargeBytes);
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<std::uint8_t>(i % 251);
  {
    support::FileLog writer(file_);
    writer.Write(Utime(std::chrono::microseconds(1)), "CHANNEL", Bytes(large).first(10));
    writer.Write(Utime(std::chrono::microseconds(2)), "CAMERA", large);
    writer.Write(Utime(std::chrono::microseconds(3)), "CHANNEL", Bytes(large).first(10));
  }
  LogReader passing(file_);
  const auto is_wanted = [](std::string_view channel) { return channel == "CHANNEL"; };
  EXPECT_EQ(passing.NextView(is_wanted)->bytes.size(), 10U);
  EXPECT_EQ(passing.NextView(is_wanted)->num_data_bytes, kLargeBytes);
  EXPECT_EQ(passing.NextView(is_wanted)->bytes.size(), 10U);
  EXPECT_FALSE(passing.NextView(is_wanted));
  EXPECT_EQ(passing.num_damaged(), 0);

  LogReader reader(file_);
  EXPECT_EQ(reader.Next()->num_data_bytes, 10U);
  const auto event = reader.Next();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->bytes.size(), kMaxLogDataBytes) << "no more is held";
  EXPECT_EQ(event->num_data_bytes, kLargeBytes);
  EXPECT_TRUE(std::ranges::equal(event->bytes, Bytes(large).first(kMaxLogDataBytes)));
  std::vector<std::uint8_t> rest(kLargeBytes - kMaxLogDataBytes);
  reader.ReadData(event->position_bytes, event->channel.size(), kMaxLogDataBytes, rest);
  EXPECT_TRUE(std::ranges::equal(rest, Bytes(large).last(rest.size())));
  EXPECT_TRUE(reader.Next());
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 0);

  // A damaged length of that size is told from it: events stand behind it.
  auto text = Content();
  text[24] = '\x01';  // the first event: 16 MB more
  SetContent(text);
  LogReader damaged(file_);
  EXPECT_EQ(ToUtimeUs(damaged.Next()->time), 2);
  EXPECT_EQ(ToUtimeUs(damaged.Next()->time), 3);
  EXPECT_EQ(damaged.num_damaged(), 1);
}

TEST_F(LogFile, TellsTheNumbersOfItsEvents) {
  std::vector<std::uint8_t> log;
  for (const std::int64_t number : {5, 5, 0, -1}) AppendLogEvent(log, number, Utime(), "CHANNEL", {});
  SetContent({log.begin(), log.end()});
  LogReader reader(file_);
  for (const std::int64_t number : {5, 5, 0, -1}) EXPECT_EQ(reader.Next()->number, number);
}

// A log that is packed, or none at all, was read through in vain.
TEST_F(LogFile, SaysWhatAnotherKindOfFileIs) {
  SetContent(std::string("\x1F\x8B\x08", 3));
  try {
    const LogReader reader(file_);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), file_.string() + ": is compressed by gzip, no lcm-log; unpack it first: gunzip -k " + file_.string());
  }
  EXPECT_THROW(LogReader{folder_.path()}, std::runtime_error);
}

// A damaged length of a log that grows is not waited for.
TEST_F(LogFile, WaitsForALargeEventButNotForADamagedLength) {
  std::vector<std::uint8_t> large(20'000'000, 7);
  {
    support::FileLog writer(file_);
    writer.Write(Utime(std::chrono::microseconds(1)), "CAMERA", large);
  }
  const auto whole = Content();
  const auto none = [](std::string_view) { return std::size_t{0}; };
  SetContent(whole.substr(0, 1'000'000));
  LogReader reader(file_);
  EXPECT_FALSE(reader.NextHeadSoFar(none));
  SetContent(whole);
  reader.UpdateSize();
  EXPECT_TRUE(reader.NextHeadSoFar(none));
  EXPECT_EQ(reader.num_damaged(), 0);
  WriteThree();
  auto text = Content();
  text[24] = '\x70';
  SetContent(text);
  LogReader damaged(file_);
  EXPECT_EQ(ToUtimeUs(damaged.NextHeadSoFar(none)->time), 1001);
  EXPECT_EQ(damaged.num_damaged(), 1);
}

// An event of which the writer has written a part is no damage: the rest comes.
TEST_F(LogFile, WaitsForTheRestOfAnEventOfALogThatGrows) {
  WriteThree();
  const auto content = Content();
  const auto all = [](std::string_view) { return kMaxLogDataBytes; };
  SetContent("");
  LogReader reader(file_);
  int num_events = 0;
  for (std::size_t size = 0; size <= content.size(); ++size) {
    std::ofstream(file_, std::ios::binary | std::ios::in).write(content.data(), static_cast<std::streamsize>(size));
    reader.UpdateSize();
    while (const auto event = reader.NextHeadSoFar(all)) {
      EXPECT_EQ(event->bytes[0], num_events++);
      EXPECT_EQ(size, static_cast<std::size_t>(num_events) * kEventBytes);
    }
  }
  EXPECT_EQ(num_events, 3);
  EXPECT_EQ(reader.num_damaged(), 0);
}

}  // namespace
}  // namespace lookout::bus
