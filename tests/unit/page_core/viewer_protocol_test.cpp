#include "services/page/core/viewer_protocol.hpp"

#include <gtest/gtest.h>
#include <string>

namespace lookout::page {
namespace {

TEST(ViewerProtocol, PrefersTheNewerOfBothNames) {
  EXPECT_EQ(ChooseViewerProtocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(ChooseViewerProtocol("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(ChooseViewerProtocol("lookout.page.v1"), "");
  EXPECT_EQ(ChooseViewerProtocol(""), "");
}

// The example of the specification has "ZXhhbXBsZSBkYXRh" for "example data".
TEST(ViewerProtocol, AdvertisesSchemasInBase64) {
  const ViewerChannel whole{"/a", "foxglove.Log", "example data"};
  const ViewerChannel one_more{"/b", "B", "example data!"};
  const ViewerChannel two_more{"/c", "C", std::string("example data\xFF\0", 14)};
  EXPECT_EQ(
      AdvertiseText(std::vector{whole, one_more, two_more}),
      R"({"op":"advertise","channels":[{"id":1,"topic":"/a","encoding":"protobuf","schemaName":"foxglove.Log","schemaEncoding":"protobuf","schema":"ZXhhbXBsZSBkYXRh"},)"
      R"({"id":2,"topic":"/b","encoding":"protobuf","schemaName":"B","schemaEncoding":"protobuf","schema":"ZXhhbXBsZSBkYXRhIQ=="},)"
      R"({"id":3,"topic":"/c","encoding":"protobuf","schemaName":"C","schemaEncoding":"protobuf","schema":"ZXhhbXBsZSBkYXRh/wA="}]})");
}

TEST(ViewerProtocol, SaysThatItCanDoNothingElse) {
  EXPECT_EQ(ServerInfoText("boat\xFF", "1"), "{\"op\":\"serverInfo\",\"name\":\"boat\xEF\xBF\xBD\",\"capabilities\":[],\"sessionId\":\"1\"}");
  EXPECT_EQ(StatusText(StatusLevel::kError, "no"), R"({"op":"status","level":2,"message":"no"})");
}

TEST(ViewerProtocol, PutsSubscriptionAndNanosecondsBeforeAMessage) {
  const auto head = MessageDataHead(0x01020304, Utime(std::chrono::microseconds(0x0001'0000'0000)));
  const std::array<std::uint8_t, kMessageDataHeadBytes> expected{1, 4, 3, 2, 1, 0, 0, 0, 0, 0xE8, 3, 0, 0};
  EXPECT_EQ(head, expected);
  EXPECT_EQ(MessageDataHead(0, Utime(std::chrono::microseconds(-1)))[5], 0);
}

TEST(ViewerProtocol, ReadsSubscriptions) {
  const auto request =
      ParseViewerRequest(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5,"more":[1]}]})");
  ASSERT_TRUE(std::holds_alternative<Subscribe>(request));
  const std::vector<std::pair<std::uint32_t, std::uint64_t>> expected{{0, 3}, {4294967295, 5}};
  EXPECT_EQ(std::get<Subscribe>(request).subscriptions, expected);
  const auto end = ParseViewerRequest(R"({"op":"unsubscribe","subscriptionIds":[7,8]})");
  ASSERT_TRUE(std::holds_alternative<Unsubscribe>(end));
  EXPECT_EQ(std::get<Unsubscribe>(end).subscriptions, (std::vector<std::uint32_t>{7, 8}));
}

TEST(ViewerProtocol, KnowsWhatItDoesNotServe) {
  for (const char* op : {"advertise", "unadvertise", "getParameters", "setParameters", "subscribeParameterUpdates", "unsubscribeParameterUpdates",
                         "subscribeConnectionGraph", "unsubscribeConnectionGraph", "fetchAsset"}) {
    const auto request = ParseViewerRequest(R"({"op":")" + std::string(op) + R"(","channels":[{"id":1,"topic":"/x"}]})");
    ASSERT_TRUE(std::holds_alternative<NotServed>(request)) << op;
    EXPECT_EQ(std::get<NotServed>(request).op, op);
  }
}

TEST(ViewerProtocol, RefusesWhatIsNoRequest) {
  for (const char* text :
       {"", "1", "[]", "{", "{}", R"({"op":1})", R"({"op":"hello"})", R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":{}})",
        R"({"op":"subscribe","subscriptions":[1]})", R"({"op":"subscribe","subscriptions":[{"id":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})", R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1.5}]})", R"({"op":"unsubscribe"})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})", R"({"op":"unsubscribe","subscriptionIds":[4294967296]})", "{\"op\":\"\xFF\"}"})
    EXPECT_TRUE(std::holds_alternative<NoRequest>(ParseViewerRequest(text))) << text;
  const std::string deep(20'000, '[');
  EXPECT_TRUE(std::holds_alternative<NoRequest>(ParseViewerRequest(R"({"op":"subscribe","subscriptions":)" + deep)));
  EXPECT_TRUE(std::holds_alternative<NoRequest>(ParseViewerRequest(std::string(kMaxViewerRequestBytes + 1, ' '))));
}

}  // namespace
}  // namespace lookout::page
