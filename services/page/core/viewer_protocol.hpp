// The WebSocket protocol of Foxglove and Lichtblick, as far as a server needs it that only shows. Source: foxglove/ws-protocol, docs/spec.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::page {

/// A topic with messages in Protobuf.
struct ViewerChannel {
  std::string topic;        // "/lidar/points"
  std::string schema_name;  // "foxglove.PointCloud"
  std::string schema;       // a FileDescriptorSet
};

/// Subprotocols, the preferred one first. The messages used here are the same in both.
inline constexpr std::array<std::string_view, 2> kViewerProtocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// @param offered  the header `Sec-WebSocket-Protocol`
/// @return one of kViewerProtocols; empty where none was offered
std::string_view ChooseViewerProtocol(std::string_view offered);

inline constexpr std::size_t kMaxViewerRequestBytes = std::size_t{64} * 1024;

/// The number by which viewers subscribe a channel: its index and 1.
inline constexpr std::uint64_t kFirstViewerChannel = 1;

// Messages to a viewer, in JSON.
/// @param session  differs from start to start
std::string ServerInfoText(const std::string& name, const std::string& session);
std::string AdvertiseText(std::span<const ViewerChannel> channels);
enum class StatusLevel : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };
std::string StatusText(StatusLevel level, const std::string& message);

/// Head before each message: opcode, number of the subscription, time of reception in nanoseconds.
inline constexpr std::size_t kMessageDataHeadBytes = 1 + 4 + 8;
std::array<std::uint8_t, kMessageDataHeadBytes> MessageDataHead(std::uint32_t subscription, Utime time);

struct Subscribe {
  std::vector<std::pair<std::uint32_t, std::uint64_t>> subscriptions;  // number that the viewer has chosen, number of the channel
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
/// A request that the protocol knows, and a server that only shows refuses: to publish, to set parameters, to call a service.
struct NotServed {
  std::string op;
};
/// No request of the protocol.
struct NoRequest {
  std::string reason;
};
using ViewerRequest = std::variant<Subscribe, Unsubscribe, NotServed, NoRequest>;

/// Never throws.
ViewerRequest ParseViewerRequest(std::string_view text);

}  // namespace lookout::page
