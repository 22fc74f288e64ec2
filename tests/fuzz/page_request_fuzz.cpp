// Any text as a request of a browser, and as the headers by which it may ask: a refusal with its reason, or what is within bounds.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <variant>

#include "services/page/core/access.hpp"
#include "services/page/core/request.hpp"
#include "services/page/core/viewer_protocol.hpp"

using namespace lookout::page;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  RequestFault fault;
  const auto request = ParseRequest(text, fault);
  if (request.has_value() != fault.reason.empty()) std::abort();
  if (request) {
    const auto* range = std::get_if<Range>(&*request);
    if (range != nullptr && (range->to < range->from || range->max_messages < 1 || range->max_messages > kMaxRangeMessages)) std::abort();
    const auto* at = std::get_if<At>(&*request);
    if (at != nullptr && (at->time.has_value() == at->scan_time.has_value() || at->source < 0 || at->source >= kMaxSources)) std::abort();
    const auto* watch = std::get_if<Watch>(&*request);
    if (watch != nullptr && watch->channels.size() > ChannelNames().size()) std::abort();
  }
  if (const auto acknowledgement = ParseAcknowledgement(text); acknowledgement && acknowledgement->alert_id == 0) std::abort();
  if (const auto order = ParseOrder(text); order && order->cpa_limit_m && !(*order->cpa_limit_m >= 0.0)) std::abort();

  const auto viewer_request = ParseViewerRequest(text);
  if (const auto* none = std::get_if<NoRequest>(&viewer_request); none != nullptr && none->reason.empty()) std::abort();
  ChooseViewerProtocol(text);

  static const OwnHosts kOwn{{"localhost", "[::1]"}, 8080};
  // What is taken for a host of ours stands in a header of the answer.
  if (IsOwnHost(text, kOwn) && (size > 14 || text.find_first_of(" \r\n;,\"'") != std::string_view::npos)) std::abort();
  if (IsOwnOrigin(text, kOwn) && !IsOwnHost(text.substr(7), kOwn)) std::abort();
  if (HasToken(text, "token") && text.substr(text.size() - 5) != "token") std::abort();
  AcceptsGzip(text);
  HoldsWord(text, "lookout.page.v1");
  TileAddress address;
  if (ParseTilePath(text, address) && (address.x >> address.z != 0 || address.y >> address.z != 0)) std::abort();
  return 0;
}
