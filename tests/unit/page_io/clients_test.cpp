// Browsers that look at the page: what they are told, in which order, and what one costs the others.
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/page_io/page_server.hpp"

namespace {

using namespace lookout;
using namespace lookout::page;
using namespace lookout::page::test;

class PageClients : public PageServerTest {};

TEST_F(PageClients, AreToldWhatThereIs) {
  const auto browser = Open();
  EXPECT_TRUE(browser.answer().starts_with("HTTP/1.1 101")) << browser.answer();
  EXPECT_NE(browser.answer().find("Sec-WebSocket-Protocol: lookout.page.v1\r\n"), std::string::npos);
  EXPECT_EQ(browser.hello().kind, 1);
  for (const char* part : {R"("type":"hello")", R"("mode":"live")", R"("version":"1.2")", R"("host":"boat")", R"("may_acknowledge":true)",
                           R"("channels":["LIDAR_BEAMS","LIDAR_PACKETS",)", R"("processes":["lidar_2","lidar","segmenter",)",
                           R"("sources":[{"id":0,)", R"("server_utime_us":1)"})
    EXPECT_TRUE(browser.hello().Holds(part)) << part << " in " << browser.hello().bytes;
}

TEST_F(PageClients, SeeWhatTheyWatchAndNothingElse) {
  EXPECT_FALSE(server_->IsWatched(IndexOf("TRACKS")));
  auto browser = OpenWatching();
  EXPECT_TRUE(server_->IsWatched(IndexOf("TRACKS")));
  EXPECT_FALSE(server_->IsWatched(IndexOf("POSE")));
  Publish("POSE", 1, "pose");
  Publish("TRACKS", 2, "tracks");
  const auto frame = browser.Next();
  EXPECT_EQ(MessageOf(frame), "tracks");
  EXPECT_EQ(frame.bytes.substr(0, 8), std::string("\x01\xFF", 2) + static_cast<char>(IndexOf("TRACKS")) + std::string(5, '\0'));
  EXPECT_EQ(frame.bytes[8], 2);
  browser.Watch("");
  EXPECT_TRUE(Until([&] { return !server_->IsWatched(IndexOf("TRACKS")); }));
}

TEST_F(PageClients, NobodyWatchesOnceAllAreGone) {
  { const auto browser = OpenWatching(); }
  EXPECT_TRUE(Until([&] { return !server_->IsWatched(IndexOf("TRACKS")) && CountOf(*server_, "clients") == 0; }));
}

// 24 frames are let go; then the newest alone waits.
TEST_F(PageClients, AreSentTheNewestOnceTheyHaveConfirmed) {
  auto browser = OpenWatching();
  for (int i = 1; i <= 40; ++i) {
    Publish("TRACKS", i, "tracks " + std::to_string(i));
    if (i <= 24) {
      EXPECT_EQ(MessageOf(browser.Next()), "tracks " + std::to_string(i));
    }
  }
  EXPECT_EQ(browser.Next(100ms).kind, -1) << "nothing was confirmed";
  browser.Confirm(1);
  EXPECT_EQ(MessageOf(browser.Next()), "tracks 40");
  EXPECT_EQ(browser.Next(50ms).kind, -1);
  EXPECT_EQ(CountOf(*server_, "frames_replaced"), 15);
  EXPECT_EQ(CountOf(*server_, "frames_sent"), 25);
}

TEST_F(PageClients, AreSentNoMoreThanTwoMegabytesUnconfirmed) {
  auto browser = OpenWatching();
  const std::string large(900'000, 'x');
  for (int i = 1; i <= 5; ++i) {
    Publish("TRACKS", i, large);
    if (i <= 3) {
      EXPECT_EQ(MessageOf(browser.Next()).size(), large.size()) << i;
    }
  }
  EXPECT_EQ(browser.Next(100ms).kind, -1);
  browser.Confirm(2);
  EXPECT_EQ(browser.Next().bytes[8], 5);
}

TEST_F(PageClients, SeePartsOfAScanTogether) {
  auto browser = OpenWatching();
  for (int i = 1; i <= 24; ++i) Publish("TRACKS", 100 + i, "fill"), browser.Next();
  Publish("TRACKS", 1, "old 0", 0);
  Publish("TRACKS", 1, "old 1", 1);
  Publish("TRACKS", 2, "new 0", 0);
  Publish("TRACKS", 2, "new 1", 1);
  browser.Confirm(24);
  EXPECT_EQ(MessageOf(browser.Next()), "new 0");
  EXPECT_EQ(MessageOf(browser.Next()), "new 1");
}

TEST_F(PageClients, SeeHealthOfEachProcess) {
  auto browser = Open();
  browser.Watch(R"("HEALTH")");
  ASSERT_TRUE(Until([&] { return server_->IsWatched(IndexOf("HEALTH")); }));
  Publish("HEALTH", 1, "tracker", 0, "tracker");
  Publish("HEALTH", 1, "lidar", 0, "lidar");
  EXPECT_EQ(MessageOf(browser.Next()), "tracker");
  EXPECT_EQ(MessageOf(browser.Next()), "lidar");
}

// A tab that stands still, or a browser that was stopped.
TEST_F(PageClients, OneThatReadsNothingCostsTheOthersNothing) {
  auto stuck = OpenWatching(4096);
  auto browser = OpenWatching();
  const std::string message(100'000, 'x');
  for (int i = 1; i <= 300; ++i) {
    Publish("TRACKS", i, message + std::to_string(i));
    ASSERT_EQ(MessageOf(browser.Next()), message + std::to_string(i));
    browser.Confirm(i);
  }
  EXPECT_LE(CountOf(*server_, "frames_sent"), 300 + 24);
}

TEST_F(PageClients, AnswerComesAfterItsFrames) {
  auto browser = Open();
  browser.Say(AtText(5, 3));
  for (int i = 0; i < 3; ++i) {
    const auto frame = browser.Next();
    ASSERT_EQ(frame.kind, 2);
    EXPECT_EQ(frame.bytes[1], 0) << "source";
    EXPECT_EQ(frame.bytes[4], 5) << "request";
    EXPECT_EQ(frame.bytes[8], i) << "time";
  }
  const auto answer = browser.Next();
  EXPECT_TRUE(answer.Holds(R"("type":"answer")") && answer.Holds(R"("id":5)") && answer.Holds(R"("num_frames":3)")) << answer.bytes;
}

TEST_F(PageClients, AnswersWaitForRoomToo) {
  auto browser = Open();
  browser.Say(AtText(5, 30));
  for (int i = 0; i < 24; ++i) EXPECT_EQ(browser.Next().kind, 2);
  EXPECT_EQ(browser.Next(100ms).kind, -1);
  browser.Confirm(24);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(browser.Next().kind, 2);
  EXPECT_TRUE(browser.Next().Holds("answer"));
}

TEST_F(PageClients, OfPlacesOnTheTimeLineTheLastCounts) {
  recordings_->Hold(true);
  auto browser = Open();
  browser.Say(AtText(1, 1));
  ASSERT_TRUE(Until([&] { return recordings_->is_waiting(); }));
  browser.Say(AtText(2, 1));
  browser.Say(R"({"op":"strip","id":3,"source":0,"from_utime_us":1,"to_utime_us":2,"buckets":1})");
  browser.Say(AtText(4, 1));
  const auto refused = browser.Next();
  EXPECT_TRUE(refused.Holds(R"("id":2)") && refused.Holds("replaced")) << refused.bytes;
  recordings_->Hold(false);
  std::vector<std::string> texts;
  while (texts.size() < 3) {
    const auto message = browser.Next();
    ASSERT_NE(message.kind, -1);
    if (message.kind == 1) texts.push_back(message.bytes);
  }
  EXPECT_NE(texts[0].find(R"("id":1)"), std::string::npos);
  EXPECT_NE(texts[1].find(R"("id":3)"), std::string::npos);
  EXPECT_NE(texts[2].find(R"("id":4)"), std::string::npos);
}

TEST_F(PageClients, ASlowDiskHoldsNoLivePictureUp) {
  recordings_->Hold(true);
  auto browser = Open();
  browser.Watch(R"("TRACKS")");
  browser.Say(AtText(1, 1));
  ASSERT_TRUE(Until([&] { return recordings_->is_waiting(); }));
  Publish("TRACKS", 1, "live");
  EXPECT_EQ(MessageOf(browser.Next()), "live");
  EXPECT_EQ(Open().hello().kind, 1) << "another may come";
}

TEST_F(PageClients, AskForNoMoreThanTheQueueHolds) {
  recordings_->Hold(true);
  auto browser = Open();
  for (int id = 1; id <= 20; ++id)
    browser.Say(R"({"op":"strip","id":)" + std::to_string(id) + R"(,"source":0,"from_utime_us":1,"to_utime_us":2,"buckets":1})");
  for (int id = 18; id <= 20; ++id) {
    const auto refused = browser.Next();
    EXPECT_TRUE(refused.Holds("too many") && refused.Holds("\"id\":" + std::to_string(id))) << refused.bytes;
  }
  recordings_->Hold(false);
  for (int id = 1; id <= 17; ++id) EXPECT_TRUE(browser.Next().Holds("\"id\":" + std::to_string(id) + "}"));
}

TEST_F(PageClients, AreToldWhyThereIsNoAnswer) {
  auto browser = Open();
  browser.Say(R"({"op":"at","id":1,"source":3,"utime_us":1,"channels":[]})");
  EXPECT_TRUE(browser.Next().Holds("no such source"));
  browser.Say(R"({"op":"range","id":2,"source":0,"channel":"POSE","from_utime_us":1,"to_utime_us":2,"max_messages":13})");
  EXPECT_TRUE(browser.Next().Holds("the recording cannot be read"));
  browser.Say(R"({"op":"at","id":3,"source":0,"utime_us":40000,"channels":[]})");
  EXPECT_TRUE(browser.Next().Holds("too much"));
}

TEST_F(PageClients, AreToldOfNewSourcesOnceASecond) {
  auto browser = Open();
  for (int i = 0; i < 100; ++i) server_->TellSources();
  const auto told = browser.Next();
  EXPECT_TRUE(told.Holds(R"("type":"sources")") && told.Holds(R"("num":2)")) << told.bytes;
  EXPECT_EQ(browser.Next(1500ms).kind, -1);
  server_->TellIndexing(1, 0.25);
  const auto indexing = browser.Next();
  EXPECT_TRUE(indexing.Holds(R"("type":"indexing")") && indexing.Holds(R"("share":0.25)") && indexing.Holds(R"("source":1)")) << indexing.bytes;
}

TEST_F(PageClients, AreSixteenAtMost) {
  std::vector<Browser> browsers;
  for (int i = 0; i < 16; ++i) browsers.push_back(Open());
  EXPECT_TRUE(browsers.back().answer().starts_with("HTTP/1.1 101"));
  EXPECT_TRUE(Open().answer().starts_with("HTTP/1.1 503"));
  EXPECT_EQ(CountOf(*server_, "refused_full"), 1);
  browsers.clear();
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "clients") == 0; }));
  EXPECT_TRUE(Open().answer().starts_with("HTTP/1.1 101"));
}

TEST_F(PageClients, AreToldThatTheServerEnds) {
  auto browser = Open();
  auto stuck = OpenWatching(4096);  // does not hold the end up
  for (int i = 0; i < 50; ++i) Publish("TRACKS", i, std::string(100'000, 'x'));
  const auto begin = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s);
  EXPECT_EQ(browser.Next().close_code(), 1001);
}

}  // namespace
