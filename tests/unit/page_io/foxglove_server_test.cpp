// Viewers of Foxglove's protocol: who may look, what they are sent, what is refused, and what a slow one costs.
#include "services/page/io/foxglove_server.hpp"

#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/unit/page_io/peer.hpp"

namespace {

using namespace lookout;
using namespace lookout::page;
using namespace lookout::page::test;

const std::string kAllowed = "https://app.foxglove.dev";
const std::string kBothProtocols = "foxglove.sdk.v1, foxglove.websocket.v1";

class FoxgloveServing : public ::testing::Test {
 protected:
  FoxgloveServing() {
    FoxgloveOptions options;
    options.allowed_origins = {kAllowed};
    options.name = "boat";
    options.session = "7";
    options.max_clients = 3;
    options.channels = {{"/points", "foxglove.PointCloud", "abc"}, {"/alerts", "foxglove.Log", "def"}};
    server_ = std::make_unique<FoxgloveServer>(options);
  }

  std::int64_t Count(std::string_view name) const {
    const auto counts = server_->Counts();
    const auto found = counts.find(name);
    return found == counts.end() ? 0 : found->second;
  }
  /// One that has heard what there is.
  Browser Open(int buffer_bytes = 0) const {
    Browser viewer(server_->port(), buffer_bytes, kAllowed, kBothProtocols);
    EXPECT_TRUE(viewer.answer().starts_with("HTTP/1.1 101")) << viewer.answer();
    EXPECT_TRUE(viewer.Next().Holds(R"("op":"advertise")"));
    return viewer;
  }
  void Subscribe(Browser& viewer, int id, int channel) {
    viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) + R"(,"channelId":)" + std::to_string(channel) + "}]}");
    EXPECT_TRUE(Until([&] { return server_->IsWatched(static_cast<std::size_t>(channel - 1)); }));
  }
  void Publish(std::size_t channel, std::int64_t utime_us, const std::string& message) {
    server_->Publish(channel, Utime(std::chrono::microseconds(utime_us)), message);
  }

  std::unique_ptr<FoxgloveServer> server_;
};

TEST_F(FoxgloveServing, SaysWhatThereIs) {
  Browser viewer(server_->port(), 0, kAllowed, "foxglove.websocket.v1");
  EXPECT_NE(viewer.answer().find("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"), std::string::npos) << viewer.answer();
  const auto info = nlohmann::json::parse(viewer.hello().bytes);
  EXPECT_EQ(info, (nlohmann::json{{"op", "serverInfo"}, {"name", "boat"}, {"capabilities", nlohmann::json::array()}, {"sessionId", "7"}}));
  const auto channels = nlohmann::json::parse(viewer.Next().bytes).at("channels");
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0].at("topic"), "/points");
  EXPECT_EQ(channels[1].at("schema"), "ZGVm");
  Browser newer(server_->port(), 0, "", kBothProtocols);
  EXPECT_NE(newer.answer().find("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"), std::string::npos) << newer.answer();
}

TEST_F(FoxgloveServing, SendsWhatIsSubscribedWithItsNumberAndTime) {
  auto viewer = Open();
  Subscribe(viewer, 9, 2);
  EXPECT_FALSE(server_->IsWatched(0));
  Publish(0, 1, "points");
  Publish(1, 2, "alert");
  const auto frame = viewer.Next();
  EXPECT_EQ(frame.kind, 2);
  EXPECT_EQ(frame.bytes, std::string("\x01\x09\0\0\0\xD0\x07\0\0\0\0\0\0", 13) + "alert");
  viewer.Say(R"({"op":"unsubscribe","subscriptionIds":[9,10]})");
  EXPECT_TRUE(Until([&] { return !server_->IsWatched(1); }));
  Subscribe(viewer, 9, 1);
  Publish(0, 3, "points");
  EXPECT_EQ(viewer.Next().bytes.substr(13), "points");
}

TEST_F(FoxgloveServing, ShowsOnly) {
  auto viewer = Open();
  int num_refused = 0;
  const auto expect_refusal = [&](const std::string& words) {
    const auto status = nlohmann::json::parse(viewer.Next().bytes);
    EXPECT_EQ(status.at("op"), "status");
    EXPECT_EQ(status.at("level"), 2);
    EXPECT_NE(status.at("message").get<std::string>().find(words), std::string::npos) << status;
    EXPECT_EQ(Count("foxglove_not_served"), ++num_refused);
  };
  for (const std::string op :
       {"advertise", "getParameters", "setParameters", "subscribeParameterUpdates", "subscribeConnectionGraph", "fetchAsset"}) {
    viewer.Say(R"({"op":")" + op + R"(","channels":[{"id":1,"topic":"/x","encoding":"json","schemaName":""}]})");
    expect_refusal(op + " is refused");
  }
  viewer.SayBinary(std::string("\x01\x01\0\0\0{}", 7));
  expect_refusal("messages of clients and calls of services");
  viewer.SayBinary(std::string("\x02\x01\0\0\0\x01\0\0\0\x04\0\0\0json{}", 19));
  expect_refusal("messages of clients and calls of services");
  Subscribe(viewer, 1, 1);
}

TEST_F(FoxgloveServing, RefusesPagesOfOtherOrigins) {
  for (const std::string origin : {"https://evil.example", "http://app.foxglove.dev", "https://app.foxglove.dev.evil.example", "null"}) {
    const Browser viewer(server_->port(), 0, origin, kBothProtocols);
    EXPECT_TRUE(viewer.answer().starts_with("HTTP/1.1 403")) << viewer.answer();
  }
  const Browser both(server_->port(), 0, kAllowed + "\r\nOrigin: https://evil.example", kBothProtocols);
  EXPECT_TRUE(both.answer().starts_with("HTTP/1.1 403")) << both.answer();
  EXPECT_EQ(Count("foxglove_refused_origin"), 5);
  const Browser program(server_->port(), 0, "", kBothProtocols);
  EXPECT_TRUE(program.answer().starts_with("HTTP/1.1 101")) << "a program has no origin";
}

TEST_F(FoxgloveServing, RefusesWhatIsNoViewer) {
  const Browser page(server_->port(), 0, kAllowed, "lookout.page.v1");
  EXPECT_TRUE(page.answer().starts_with("HTTP/1.1 400")) << page.answer();
  EXPECT_TRUE(Peer(server_->port()).Get("/").starts_with("HTTP/1.1 426"));
  Peer other(server_->port());
  other.Write("hello\r\n\r\n");
  EXPECT_TRUE(other.Ends());
  Peer long_head(server_->port());
  long_head.Write("GET / HTTP/1.1\r\nX: " + std::string(20'000, 'x'));
  EXPECT_TRUE(long_head.Ends());
  EXPECT_TRUE(Until([&] { return Count("foxglove_refused_request") == 4; })) << Count("foxglove_refused_request");
}

TEST_F(FoxgloveServing, HasRoomForSoManyAndForTheNextWhenOneGoes) {
  std::vector<Browser> viewers;
  for (int i = 0; i < 3; ++i) viewers.push_back(Open());
  EXPECT_TRUE(Browser(server_->port(), 0, kAllowed, kBothProtocols).answer().starts_with("HTTP/1.1 503"));
  EXPECT_EQ(Count("foxglove_refused_full"), 1);
  viewers.pop_back();
  EXPECT_TRUE(Until([&] { return Count("foxglove_clients") == 2; }));
  Open();
}

// 16 of them had kept viewers out for ever, had they no time limit.
TEST_F(FoxgloveServing, ConnectionsThatDoNotAskKeepNobodyOutForLong) {
  std::vector<std::unique_ptr<Peer>> silent;
  for (int i = 0; i < 20; ++i) silent.push_back(std::make_unique<Peer>(server_->port()));
  EXPECT_TRUE(Until([&] { return Count("foxglove_refused_full") == 4; }));
  EXPECT_TRUE(Until([&] { return Count("foxglove_connections") == 0; }, 8s));
  Open();
}

TEST_F(FoxgloveServing, WarnsOfWrongRequestsAndEndsWhereThereAreTooMany) {
  auto viewer = Open();
  Subscribe(viewer, 1, 1);
  viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})");
  EXPECT_TRUE(viewer.Next().Holds("is taken already"));
  viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":1}]})");
  EXPECT_TRUE(viewer.Next().Holds("is taken already"));
  for (const char* channel : {"0", "3", "18446744073709551615"}) {
    viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":)" + std::string(channel) + "}]}");
    EXPECT_TRUE(viewer.Next().Holds("there is no channel " + std::string(channel)));
  }
  for (int i = 0; i < 8; ++i) viewer.Say("{}");
  FromServer last;
  for (int i = 0; i < 8; ++i) last = viewer.Next();
  EXPECT_EQ(last.close_code(), 1008);
  EXPECT_EQ(Count("foxglove_client_faults"), 11);
  EXPECT_TRUE(Until([&] { return !server_->IsWatched(0); }));
}

TEST_F(FoxgloveServing, ARequestThatIsTooLongEndsItsConnectionAlone) {
  auto other = Open();
  auto viewer = Open();
  viewer.Write(ClientFrame(0x81, "", std::uint64_t{1} << 40U));
  EXPECT_EQ(viewer.Next().close_code(), 1009);
  Subscribe(other, 1, 1);
}

// A viewer that stands still: it loses messages, and the others none.
TEST_F(FoxgloveServing, OneThatReadsNothingLosesMessagesAndCostsTheOthersNothing) {
  auto stuck = Open(4096);
  Subscribe(stuck, 1, 1);
  auto viewer = Open();
  viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":4,"channelId":1}]})");
  viewer.Say("{}");
  EXPECT_TRUE(viewer.Next().Holds("status")) << "what it says is handled in order";
  const std::string cloud(400'000, 'x');
  for (int i = 0; i < 60; ++i) {
    Publish(0, i, cloud + std::to_string(i));
    ASSERT_EQ(viewer.Next().bytes.substr(13), cloud + std::to_string(i));
  }
  EXPECT_GE(Count("foxglove_dropped"), 50);
  EXPECT_LE(Count("foxglove_sent"), 60 + 6);
}

TEST_F(FoxgloveServing, WhatNobodyReadsOfItsStatusIsNotAskedFor) {
  auto viewer = Open(4096);
  const std::string request = R"({"op":"fetchAsset","uri":")" + std::string(60'000, 'x') + "\"}";
  int num_written = 0;
  while (num_written < 200 && viewer.WriteNow(ClientFrame(0x81, request, request.size()), 300ms)) ++num_written;
  Open();
}

TEST_F(FoxgloveServing, ViewersHearOfItsEnd) {
  auto viewer = Open();
  server_.reset();
  EXPECT_EQ(viewer.Next().close_code(), 1001);
}

TEST_F(FoxgloveServing, APortThatIsTakenIsWaitedForOrTold) {
  FoxgloveOptions options;
  options.port = server_->port();
  EXPECT_THROW(FoxgloveServer{options}, std::runtime_error);
  options.waits_for_port = true;
  const FoxgloveServer waiting(options);
  EXPECT_EQ(waiting.port(), 0);
  EXPECT_NE(waiting.Fault().find("Foxglove cannot be served on 127.0.0.1 port " + std::to_string(options.port)), std::string::npos)
      << waiting.Fault();
  server_.reset();
  EXPECT_TRUE(Until([&] { return waiting.port() == options.port; }));
  EXPECT_EQ(waiting.Fault(), "");
}

}  // namespace
