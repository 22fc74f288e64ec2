#include "services/page/foxglove_feed.hpp"

#include <gtest/gtest.h>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/unit/page_io/peer.hpp"

namespace lookout::page {
namespace {

test::Browser Subscribed(const FoxgloveServer& server, const std::string& topic) {
  test::Browser viewer(server.port(), 0, "", "foxglove.sdk.v1");
  const auto channels = FoxgloveChannels();
  std::size_t index = 0;
  while (channels.at(index).topic != topic) ++index;
  EXPECT_TRUE(viewer.Next().Holds("\"topic\":\"" + topic + "\",\"encoding\":\"protobuf\",\"schemaName\":\"" + channels[index].schema_name + "\""));
  viewer.Say(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":)" + std::to_string(index + 1) + "}]}");
  EXPECT_TRUE(test::Until([&] { return server.IsWatched(index); }));
  return viewer;
}

TEST(FoxgloveFeed, HasTheTopicsOfTheExport) {
  const auto channels = FoxgloveChannels();
  ASSERT_EQ(channels.size(), viewer::kFoxgloveChannels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    EXPECT_EQ(channels[i].topic, viewer::kFoxgloveChannels[i].name);
    EXPECT_EQ(channels[i].schema, viewer::FoxgloveDescriptors(viewer::kFoxgloveChannels[i].schema));
  }
}

TEST(FoxgloveFeed, DrawsWhatIsSubscribed) {
  FoxgloveOptions options;
  options.channels = FoxgloveChannels();
  FoxgloveServer server(options);
  FoxgloveFeed feed(server, std::nullopt);
  auto viewer = Subscribed(server, "/tracks/map");
  tracks_t tracks{};
  tracks.num_parts = 1;
  feed.Take(Utime(std::chrono::microseconds(3)), bus::kAlerts.name, bus::Encode(alerts_t{}));
  feed.Take(Utime(std::chrono::microseconds(4)), bus::kTracks.name, bus::Encode(tracks));
  const auto frame = viewer.Next();
  const std::string text = R"({"type":"FeatureCollection","features":[]})";
  // In Protobuf: field 1, a text of so many bytes.
  EXPECT_EQ(frame.bytes, std::string("\x01\x05\0\0\0\xA0\x0F\0\0\0\0\0\0\x0A", 14) + static_cast<char>(text.size()) + text);
  EXPECT_EQ(server.Counts().at("foxglove_sent"), 1);
}

}  // namespace
}  // namespace lookout::page
