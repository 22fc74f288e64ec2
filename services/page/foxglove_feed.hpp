// Messages of the bus, as viewers of Foxglove's protocol draw them, to their server.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/config/boat.hpp"
#include "common/viewer/foxglove_messages.hpp"
#include "services/page/io/foxglove_server.hpp"

namespace lookout::page {

/// The topics of `lookout-export --format mcap`, in the order of viewer::kFoxgloveChannels.
std::vector<ViewerChannel> FoxgloveChannels();

class FoxgloveFeed {
 public:
  FoxgloveFeed(FoxgloveServer& server, std::optional<config::BoatFacts> boat);
  FoxgloveFeed(const FoxgloveFeed&) = delete;
  FoxgloveFeed& operator=(const FoxgloveFeed&) = delete;

  /// Draws a message where a viewer has subscribed a topic for it; else it costs nothing.
  /// @param time  of reception
  void Take(Utime time, std::string_view channel, Bytes message);

 private:
  FoxgloveServer& server_;
  Utime time_;
  viewer::FoxgloveMessages messages_;
};

}  // namespace lookout::page
