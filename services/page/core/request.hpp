// Requests of a browser over its WebSocket (PROTOCOL.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::page {

using ChannelIndex = std::uint16_t;  // into ChannelNames()

struct Watch {
  std::vector<ChannelIndex> channels;
};
struct Got {
  std::uint64_t num_frames = 0;
};
/// Either `time` or `scan_time` is set.
struct At {
  std::uint32_t id = 0;
  int source = 0;
  std::optional<Utime> time;       // of the log
  std::optional<Utime> scan_time;  // of measurement
  int num_scans_on = 0;            // a step by this many scans from there
  std::vector<ChannelIndex> channels;
};
struct Range {
  std::uint32_t id = 0;
  int source = 0;
  ChannelIndex channel = 0;
  Utime from;
  Utime to;
  int max_messages = 0;  // 1 to kMaxRangeMessages
};
struct StripRequest {
  std::uint32_t id = 0;
  int source = 0;
  Utime from;
  Utime to;
  int num_buckets = 0;  // 1 to kMaxBuckets
};
using Request = std::variant<Watch, Got, At, Range, StripRequest>;

inline constexpr std::size_t kMaxRequestBytes = 4096;
inline constexpr int kMaxRangeMessages = 5000;
inline constexpr int kMaxBuckets = 4000;
inline constexpr int kMaxSources = 4;
inline constexpr std::size_t kMaxChannels = 64;

/// Names of the channels that a page may show, in the order of the channel table, whose indices count.
const std::vector<std::string_view>& ChannelNames();

/// The fault of a text that is no request.
struct RequestFault {
  std::uint32_t id = 0;  // 0: the text had none
  std::string reason;
};

/// @param fault  set when nothing is returned
/// @return nullopt when the text is no request; never throws
std::optional<Request> ParseRequest(std::string_view text, RequestFault& fault);

/// An acknowledgement that a browser with a valid token has sent.
struct Acknowledgement {
  std::int64_t alert_id = 0;  // not 0; below 0: an alert of the watch
  Utime raised;
};

/// The body of POST /acknowledge.
/// @return nullopt when the text is none; never throws
std::optional<Acknowledgement> ParseAcknowledgement(std::string_view text);

/// An order of a browser with a valid token to the look-out: silence for a while, mode and limits, or the name of a track (order_t).
struct Order {
  enum class Kind : std::uint8_t { kSilence, kSettings, kName };
  enum class Mode : std::uint8_t { kOpenWater, kHarbour };
  Kind kind = Kind::kSilence;
  Mode mode = Mode::kOpenWater;  // `mode` to `cpa_limit_m` are of kSettings; nullopt: as the config says
  std::optional<double> guard_zone_range_m = {};
  std::optional<double> guard_zone_from_deg = {};
  std::optional<double> guard_zone_to_deg = {};
  std::optional<double> cpa_limit_m = {};
  std::int64_t track_id = 0;  // `track_id` and `name` are of kName
  std::string name = {};      // empty: as it was called before

  friend bool operator==(const Order&, const Order&) = default;
};

/// The body of POST /order.
/// @return nullopt when the text is none; never throws
std::optional<Order> ParseOrder(std::string_view text);

}  // namespace lookout::page
