#include "common/bus/lcm_url.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/core/printable.hpp"

namespace lookout::bus {

namespace {

constexpr std::string_view kDefaultGroup = "239.255.76.67";
constexpr int kDefaultPort = 7667;
constexpr std::string_view kMulticast = "udpm://";
constexpr std::string_view kExample = "udpm://239.255.76.67:7667?ttl=0";

// A whole decimal number without anything around it. LCM takes one that begins with 0 for an octal: it would listen at another port than its filter.
std::optional<int> ParseNumber(std::string_view text, int least, int greatest) {
  if (text.size() > 1 && text.front() == '0') return std::nullopt;
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > greatest) return std::nullopt;
  return value;
}

bool IsMulticastGroup(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1 && (ntohl(address.s_addr) >> 28) == 0xE;  // 224.0.0.0/4
}

// The printed text may come from the environment, and be of any length.
std::string Shown(std::string_view text) {
  constexpr std::size_t kMaxShownLetters = 200;
  return Printable(text.substr(0, kMaxShownLetters));
}

struct Parsed {
  MulticastAddress address{std::string(kDefaultGroup), kDefaultPort, 0};
  std::string fault;
};

Parsed ParseUdpm(std::string_view url) {
  Parsed parsed;
  const auto fault = [&parsed](const std::string& text) {
    parsed.fault = text;
    return parsed;
  };
  url.remove_prefix(kMulticast.size());
  const auto question = url.find('?');
  const auto network = url.substr(0, question);
  const auto colon = network.find(':');
  if (const auto group = network.substr(0, colon); !group.empty()) parsed.address.group = group;
  if (!IsMulticastGroup(parsed.address.group)) {
    return fault(Shown(parsed.address.group) + " is no IPv4 multicast group (224.0.0.0 to 239.255.255.255)");
  }
  if (colon != std::string_view::npos) {
    const auto port = ParseNumber(network.substr(colon + 1), 1, 65'535);
    if (!port) return fault("the port \"" + Shown(network.substr(colon + 1)) + "\" is no number from 1 to 65535");
    parsed.address.port = *port;
  }
  std::string_view arguments = question == std::string_view::npos ? std::string_view() : url.substr(question + 1);
  while (!arguments.empty()) {
    const auto argument = arguments.substr(0, arguments.find('&'));
    arguments.remove_prefix(std::min(argument.size() + 1, arguments.size()));
    const auto equals = argument.find('=');
    const auto name = argument.substr(0, equals);
    const auto value = equals == std::string_view::npos ? std::string_view() : argument.substr(equals + 1);
    if (name == "ttl") {
      const auto time_to_live = ParseNumber(value, 0, 255);
      if (!time_to_live) return fault("ttl=" + Shown(value) + ": 0 (this computer only) to 255");
      parsed.address.time_to_live = *time_to_live;
    } else if (name == "recv_buf_size") {
      if (!ParseNumber(value, 1, 1 << 30)) return fault("recv_buf_size=" + Shown(value) + ": 1 to 1073741824 bytes");
    } else {
      return fault("\"" + Shown(name) + "\" is neither ttl nor recv_buf_size");
    }
  }
  return parsed;
}

std::string Reason(const std::string& url) {
  const auto begins_with = [&](std::string_view scheme) { return url.rfind(scheme, 0) == 0; };
  if (begins_with(kMulticast)) return ParseUdpm(url).fault;
  if (begins_with("tcpq://")) return {};
  if (begins_with("memq:")) return "memq:// stays inside one process: no other would hear this one";
  if (begins_with("file:")) return "file:// is a log and no bus: lookout-replay reads logs, lcm-logplayer sends one to a bus";
  if (begins_with("mpudpm:")) return "mpudpm:// has a port per channel, which Lookout does not guard";
  return "neither udpm:// nor tcpq://";
}

}  // namespace

std::string LcmUrlFault(const std::string& url) {
  const auto reason = Reason(url);
  if (reason.empty()) return {};
  return "LCM address \"" + Shown(url) + "\": " + reason + ". Write it as " + std::string(kExample) +
         " (--lcm-url, or LCM_DEFAULT_URL in the environment)";
}

std::optional<MulticastAddress> ParseMulticast(const std::string& url) {
  if (url.rfind(kMulticast, 0) != 0) return std::nullopt;
  auto parsed = ParseUdpm(url);
  if (!parsed.fault.empty()) return std::nullopt;
  return std::move(parsed.address);
}

std::string DefaultLcmUrl() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  if (url != nullptr && *url != '\0') return url;
  return std::string(kMulticast) + std::string(kDefaultGroup) + ":" + std::to_string(kDefaultPort) + "?ttl=0";
}

}  // namespace lookout::bus
