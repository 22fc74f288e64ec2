#include "common/bus/lcm_bus.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <stdexcept>
#include <vector>

#include "common/bus/datagram_filter.hpp"
#include "common/bus/guarded_bind.hpp"

namespace lookout::bus {

namespace {

// Messages of channels that are not in the table, and of all channels together for a recorder.
constexpr int kAllChannelsQueueDepth = 4000;

std::string RouteLine(const MulticastAddress& address) {
  const auto last_dot = address.group.rfind('.');
  const std::string device = address.time_to_live > 0 ? "<the interface to the other computers>" : "lo";
  return "ip route add " + address.group.substr(0, last_dot) + ".0/24 dev " + device;
}

std::string WithReceiveBuffer(const std::string& url) {
  if (url.rfind("udpm://", 0) != 0 || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=" + std::to_string(kReceiveBufferBytes);
}

// LCM takes channel names as regular expressions.
std::string Escaped(std::string_view name) {
  std::string escaped;
  for (const char letter : name) {
    const bool is_plain = letter == '_' || (letter >= '0' && letter <= '9') || (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z');
    if (!is_plain) escaped += '\\';
    escaped += letter;
  }
  return escaped;
}

}  // namespace

bool HasRoute(const MulticastAddress& address) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  sockaddr_in target{};
  target.sin_family = AF_INET;
  target.sin_port = htons(static_cast<std::uint16_t>(address.port));
  bool has_route = inet_pton(AF_INET, address.group.c_str(), &target.sin_addr) == 1;
  has_route = has_route && connect(descriptor, reinterpret_cast<const sockaddr*>(&target), sizeof target) == 0;
  close(descriptor);
  return has_route;
}

struct LcmBus::Implementation {
  struct Subscription {
    Implementation* owner = nullptr;
    RawHandler handler;
  };

  lcm_t* lcm = nullptr;
  std::string url;
  std::optional<MulticastAddress> multicast;
  std::vector<int> sockets;  // LCM's, with our filter
  std::string guard_fault;
  bool is_receiving = false;
  std::vector<std::unique_ptr<Subscription>> subscriptions;
  std::exception_ptr thrown;  // by a handler: LCM is C and cannot carry an exception

  // LCM makes its socket and the thread that reads it when it is first asked for something to read.
  void StartReceiver() {
    if (is_receiving) return;
    if (!multicast) {
      is_receiving = true;
      return;
    }
    BindGuard guard(DatagramFilter(*multicast));
    if (lcm_get_fileno(lcm) < 0) throw std::runtime_error("LCM cannot receive at " + url);
    is_receiving = true;
    sockets = guard.sockets();
    guard_fault = guard.fault();
    if (sockets.empty() && guard_fault.empty()) guard_fault = "LCM's socket was not seen when it was made";
  }

  static void OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
    auto& subscription = *static_cast<Subscription*>(user);
    if (subscription.owner->thrown) return;
    try {
      subscription.handler(channel, Bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size));
    } catch (...) {
      subscription.owner->thrown = std::current_exception();
    }
  }
};

LcmBus::LcmBus(const std::string& url) : implementation_(std::make_unique<Implementation>()) {
  if (const auto fault = LcmUrlFault(url); !fault.empty() && url.rfind("memq:", 0) != 0) throw std::runtime_error(fault);
  implementation_->url = WithReceiveBuffer(url);
  implementation_->multicast = ParseMulticast(url);
  if (const auto& address = implementation_->multicast; address && !HasRoute(*address)) {
    throw std::runtime_error("LCM needs a multicast route to " + address->group + " and there is none. As root: " + RouteLine(*address));
  }
  implementation_->lcm = lcm_create(implementation_->url.c_str());
  if (implementation_->lcm == nullptr) throw std::runtime_error("LCM cannot be opened at " + implementation_->url);
}

LcmBus::~LcmBus() { lcm_destroy(implementation_->lcm); }

std::optional<std::int64_t> LcmBus::NumDatagramsDropped() const {
  std::optional<std::int64_t> sum;
  for (const int descriptor : implementation_->sockets) {
    if (const auto num_dropped = NumDropped(descriptor); num_dropped >= 0) sum = sum.value_or(0) + num_dropped;
  }
  return sum;
}

std::string LcmBus::GuardFault() const { return implementation_->guard_fault; }

// LCM starts its receiver when it is asked for the descriptor: a program that only sends would read the traffic of the whole bus, to throw it away.
int LcmBus::file_descriptor() const { return implementation_->subscriptions.empty() ? -1 : lcm_get_fileno(implementation_->lcm); }

bool LcmBus::HandleOnce(std::chrono::milliseconds timeout) {
  implementation_->StartReceiver();
  const int handled = lcm_handle_timeout(implementation_->lcm, static_cast<int>(timeout.count()));
  if (implementation_->thrown) std::rethrow_exception(std::exchange(implementation_->thrown, nullptr));
  if (handled < 0) throw std::runtime_error("LCM failed at " + implementation_->url);
  return handled > 0;
}

// LCM 1.3.1 does not tell how many messages wait.
int LcmBus::QueueDepth(std::string_view /*channel*/) const { return -1; }

bool LcmBus::Send(const Channel& channel, std::vector<std::uint8_t>&& bytes) {
  const std::string name(channel.name);
  return lcm_publish(implementation_->lcm, name.c_str(), bytes.data(), static_cast<unsigned int>(bytes.size())) == 0;
}

void LcmBus::Attach(const Channel* channel, RawHandler handler) {
  auto subscription = std::make_unique<Implementation::Subscription>();
  subscription->owner = implementation_.get();
  subscription->handler = std::move(handler);
  implementation_->StartReceiver();
  const std::string pattern = channel == nullptr ? ".*" : Escaped(channel->name);
  auto* handle = lcm_subscribe(implementation_->lcm, pattern.c_str(), &Implementation::OnMessage, subscription.get());
  if (handle == nullptr) throw std::runtime_error("LCM cannot subscribe to " + pattern);
  lcm_subscription_set_queue_capacity(handle, channel == nullptr ? kAllChannelsQueueDepth : channel->queue_depth);
  implementation_->subscriptions.push_back(std::move(subscription));
}

}  // namespace lookout::bus
