#include "services/page/core/viewer_protocol.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "services/page/core/access.hpp"

namespace lookout::page {

namespace {

using ViewerJson = nlohmann::ordered_json;

constexpr std::uint8_t kMessageData = 1;
constexpr int kMaxViewerDepth = 8;

std::string ViewerText(const ViewerJson& message) { return message.dump(-1, ' ', false, ViewerJson::error_handler_t::replace); }

// RFC 4648.
std::string Base64(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::size_t kGroupBytes = 3;
  constexpr unsigned kLetterBits = 6;
  constexpr unsigned kLetterMask = 63;
  std::string text;
  text.reserve((bytes.size() + 2) / kGroupBytes * 4);
  for (std::size_t i = 0; i < bytes.size(); i += kGroupBytes) {
    const std::size_t num_bytes = std::min(kGroupBytes, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < kGroupBytes; ++k) group = group << 8U | (k < num_bytes ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (unsigned k = 0; k < 4; ++k) text += k <= num_bytes ? kLetters[group >> (3 - k) * kLetterBits & kLetterMask] : '=';
  }
  return text;
}

std::optional<std::uint64_t> NumberOf(const ViewerJson& object, const char* name) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  return found->get<std::uint64_t>();
}

bool IsSubscription(const std::optional<std::uint64_t>& number) { return number && *number <= std::numeric_limits<std::uint32_t>::max(); }

ViewerRequest ToSubscribe(const ViewerJson& object) {
  const auto list = object.find("subscriptions");
  if (list == object.end() || !list->is_array()) return NoRequest{"subscribe without subscriptions"};
  Subscribe request;
  for (const auto& one : *list) {
    const auto id = NumberOf(one, "id");
    const auto channel = NumberOf(one, "channelId");
    if (!IsSubscription(id) || !channel) return NoRequest{"a subscription without id or channelId"};
    request.subscriptions.emplace_back(static_cast<std::uint32_t>(*id), *channel);
  }
  return request;
}

ViewerRequest ToUnsubscribe(const ViewerJson& object) {
  const auto list = object.find("subscriptionIds");
  if (list == object.end() || !list->is_array()) return NoRequest{"unsubscribe without subscriptionIds"};
  Unsubscribe request;
  for (const auto& one : *list) {
    if (!one.is_number_unsigned() || !IsSubscription(one.get<std::uint64_t>())) return NoRequest{"a subscriptionId that is none"};
    request.subscriptions.push_back(one.get<std::uint32_t>());
  }
  return request;
}

}  // namespace

std::string_view ChooseViewerProtocol(std::string_view offered) {
  const auto* const found = std::ranges::find_if(kViewerProtocols, [offered](std::string_view one) { return HoldsWord(offered, one); });
  return found == kViewerProtocols.end() ? std::string_view{} : *found;
}

std::string ServerInfoText(const std::string& name, const std::string& session) {
  return ViewerText({{"op", "serverInfo"}, {"name", name}, {"capabilities", ViewerJson::array()}, {"sessionId", session}});
}

std::string AdvertiseText(std::span<const ViewerChannel> channels) {
  auto list = ViewerJson::array();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    list.push_back({{"id", kFirstViewerChannel + i},
                    {"topic", channels[i].topic},
                    {"encoding", "protobuf"},
                    {"schemaName", channels[i].schema_name},
                    {"schemaEncoding", "protobuf"},
                    {"schema", Base64(channels[i].schema)}});
  }
  return ViewerText({{"op", "advertise"}, {"channels", list}});
}

std::string StatusText(StatusLevel level, const std::string& message) {
  return ViewerText({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::array<std::uint8_t, kMessageDataHeadBytes> MessageDataHead(std::uint32_t subscription, Utime time) {
  std::array<std::uint8_t, kMessageDataHeadBytes> head{};
  head[0] = kMessageData;
  WriteU32LittleEndian(head, 1, subscription);
  const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ToUtimeUs(time))) * 1000;
  WriteU32LittleEndian(head, 5, static_cast<std::uint32_t>(time_ns));
  WriteU32LittleEndian(head, 9, static_cast<std::uint32_t>(time_ns >> 32U));
  return head;
}

ViewerRequest ParseViewerRequest(std::string_view text) {
  if (text.size() > kMaxViewerRequestBytes) return NoRequest{"a request that is too long"};
  bool is_deep = false;
  const auto look = [&is_deep](int depth, ViewerJson::parse_event_t /*event*/, ViewerJson& /*parsed*/) {
    is_deep = is_deep || depth > kMaxViewerDepth;
    return !is_deep;
  };
  const auto object = ViewerJson::parse(text.begin(), text.end(), look, false);
  if (is_deep || !object.is_object()) return NoRequest{"this is no JSON object"};
  const auto op = object.find("op");
  if (op == object.end() || !op->is_string()) return NoRequest{"a request without op"};
  const auto& name = op->get_ref<const std::string&>();
  if (name == "subscribe") return ToSubscribe(object);
  if (name == "unsubscribe") return ToUnsubscribe(object);
  constexpr std::array<std::string_view, 9> kNotServed{"advertise",
                                                       "unadvertise",
                                                       "getParameters",
                                                       "setParameters",
                                                       "subscribeParameterUpdates",
                                                       "unsubscribeParameterUpdates",
                                                       "subscribeConnectionGraph",
                                                       "unsubscribeConnectionGraph",
                                                       "fetchAsset"};
  if (std::ranges::find(kNotServed, name) != kNotServed.end()) return NotServed{name};
  return NoRequest{"an op that is not known"};
}

}  // namespace lookout::page
