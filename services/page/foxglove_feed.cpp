#include "services/page/foxglove_feed.hpp"

#include <algorithm>
#include <utility>

namespace lookout::page {

namespace {

std::size_t FoxgloveIndexOf(viewer::FoxgloveTopic topic) {
  const auto& rows = viewer::kFoxgloveChannels;
  return static_cast<std::size_t>(std::ranges::find(rows, topic, &viewer::FoxgloveChannel::topic) - rows.begin());
}

}  // namespace

std::vector<ViewerChannel> FoxgloveChannels() {
  std::vector<ViewerChannel> channels;
  channels.reserve(viewer::kFoxgloveChannels.size());
  for (const auto& row : viewer::kFoxgloveChannels) {
    channels.push_back({std::string(row.name), std::string(row.schema), viewer::FoxgloveDescriptors(row.schema)});
  }
  return channels;
}

FoxgloveFeed::FoxgloveFeed(FoxgloveServer& server, std::optional<config::BoatFacts> boat)
    : server_(server),
      messages_([this](viewer::FoxgloveTopic topic, const std::string& bytes) { server_.Publish(FoxgloveIndexOf(topic), time_, bytes); },
                std::move(boat)) {}

void FoxgloveFeed::Take(Utime time, std::string_view channel, Bytes message) {
  const auto is_wanted = [&](const viewer::FoxgloveChannel& row) {
    return viewer::IsDrawnFrom(row.topic, channel) && server_.IsWatched(FoxgloveIndexOf(row.topic));
  };
  if (std::ranges::none_of(viewer::kFoxgloveChannels, is_wanted)) return;
  time_ = time;
  messages_.Take(channel, message);
}

}  // namespace lookout::page
