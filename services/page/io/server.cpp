#include "services/page/io/server.hpp"

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

#include "common/io/network.hpp"
#include "services/page/core/frame.hpp"
#include "services/page/io/client.hpp"
#include "services/page/io/connection.hpp"
#include "services/page/io/hub.hpp"
#include "services/page/io/listener.hpp"

namespace lookout::page {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::seconds kTickPeriod{1};
constexpr std::chrono::minutes kCrowdToldFor{1};
constexpr std::chrono::milliseconds kMaxEnding{700};
constexpr std::size_t kMaxPublishedBytes = std::size_t{32} * 1024 * 1024;  // that the server's thread has not seen yet

}  // namespace

struct Server::Implementation {
  Implementation(ServerOptions options, ServerParts parts)
      : hub(std::move(options), std::move(parts)),
        listener(
            hub.context,
            {.served = "the page", .bind_address = hub.options.bind_address, .port = hub.options.port, .waits_for_port = hub.options.waits_for_port},
            {.on_listening = [this](const tcp::endpoint& endpoint) { KnowOwnHosts(endpoint); },
             .on_socket = [this](tcp::socket socket) { Welcome(std::move(socket)); },
             .on_fault = [this] { hub.counts->Add("accept_faults"); }}) {
    if (hub.parts.recordings) hub.sources = hub.parts.recordings->SourcesText();
    Tick();
    // A fault is of one connection, which ends by it.
    thread = std::thread([this] { RunThroughFaults(hub.context, [this] { hub.counts->Add("faults"); }); });
  }

  ~Implementation() {
    asio::post(hub.context, [this] { End(); });
    thread.join();
    hub.disk.stop();
    hub.disk.join();
    hub.clients.clear();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void KnowOwnHosts(const tcp::endpoint& endpoint) {
    const auto& options = hub.options;
    hub.own_hosts.port = endpoint.port();
    hub.own_hosts.names = {"localhost", "127.0.0.1", "[::1]", endpoint.address().is_v6() ? "[" + options.bind_address + "]" : options.bind_address};
    hub.own_hosts.names.insert(hub.own_hosts.names.end(), options.host_names.begin(), options.host_names.end());
  }

  void Welcome(tcp::socket socket) {
    if (hub.counts->Of("connections") >= hub.options.max_connections && !MakeRoom()) {
      hub.counts->Add("connections_refused");
      return;
    }
    SetServedOptions(socket);
    std::make_shared<Connection>(hub, std::move(socket))->Start();
  }

  // A connection that asks for nothing keeps nobody out: for a new connection an old one is closed, first one that has asked for nothing yet, of the
  // address that holds most of them. A page that looks on (a WebSocket) stays. @return whether there is room
  bool MakeRoom() {
    std::map<std::string_view, std::int64_t> number;
    for (const auto* one : hub.connections) ++number[one->remote()];
    const auto worth = [&number](const Connection* one) { return std::tuple(one->stage(), -number[one->remote()], one->since()); };
    Connection* least = nullptr;
    std::int64_t num_staying = static_cast<std::int64_t>(hub.clients.size());
    for (auto* one : hub.connections) {
      if (one->is_let_go()) continue;
      ++num_staying;
      if (least == nullptr || worth(one) < worth(least)) least = one;
    }
    // Connections that were let go a moment ago do not count.
    if (num_staying < hub.options.max_connections) return true;
    if (least == nullptr) return false;
    // Each connection that was let go holds memory until the disk thread has answered it.
    if (static_cast<std::int64_t>(hub.connections.size()) >= 2 * hub.options.max_connections) return false;
    hub.counts->Add("connections_let_go");
    {
      const std::lock_guard lock(faults_mutex);
      crowd_text = std::to_string(hub.options.max_connections) + " connections at one time, " + std::to_string(number[least->remote()]) +
                   " of them from " + least->remote() + ": the oldest are closed for new ones; end the program that connects and does not ask";
      crowded_at = std::chrono::steady_clock::now();
    }
    least->LetGo();
    return true;
  }

  // A client's action may take it off the list.
  template <class Function>
  void ForEachClient(Function&& function) {
    const std::vector<std::shared_ptr<Client>> clients(hub.clients.begin(), hub.clients.end());
    for (const auto& client : clients) function(*client);
  }

  void Tick() {
    tick.expires_after(kTickPeriod);
    tick.async_wait([this](error_code) {
      if (hub.is_ending) return;
      Tick();
      const auto now = std::chrono::steady_clock::now();
      ForEachClient([&](Client& client) { client.Tick(now); });
      if (are_sources_new.exchange(false)) ReadSources();
    });
  }

  void ReadSources() {
    asio::post(hub.disk, [this] {
      try {
        asio::post(hub.context, [this, text = hub.parts.recordings->SourcesText()]() mutable {
          hub.sources = std::move(text);
          ForEachClient([](Client& client) { client.TellSources(); });
        });
      } catch (const std::exception&) {
        hub.counts->Add("faults");
      }
    });
  }

  void End() {
    hub.is_ending = true;
    listener.Close();
    ForEachClient([](Client& client) { client.Close(boost::beast::websocket::close_code::going_away, "the server ends"); });
    end_since = std::chrono::steady_clock::now();
    AwaitEnd();
  }

  // Until all clients have heard of it, or for long enough.
  void AwaitEnd() {
    if (hub.clients.empty() || std::chrono::steady_clock::now() - end_since > kMaxEnding) return hub.context.stop();
    tick.expires_after(std::chrono::milliseconds(10));
    tick.async_wait([this](error_code) { AwaitEnd(); });
  }

  Hub hub;
  Listener listener;
  asio::steady_timer tick{hub.context};
  SteadyTime end_since{};
  mutable std::mutex faults_mutex;  // guards crowd_text and crowded_at
  std::string crowd_text;
  std::optional<SteadyTime> crowded_at;
  std::atomic<bool> are_sources_new = false;
  std::atomic<std::size_t> num_published_bytes = 0;
  std::thread thread;
};

Server::Server(ServerOptions options, ServerParts parts) : implementation_(std::make_unique<Implementation>(std::move(options), std::move(parts))) {}

Server::~Server() = default;

int Server::port() const { return implementation_->listener.port(); }

std::vector<std::string> Server::Faults() const {
  const auto& server = *implementation_;
  const std::lock_guard lock(server.faults_mutex);
  std::vector<std::string> faults;
  if (auto fault = server.listener.Fault(); !fault.empty()) faults.push_back(std::move(fault));
  if (server.crowded_at && std::chrono::steady_clock::now() - *server.crowded_at < kCrowdToldFor) faults.push_back(server.crowd_text);
  return faults;
}

bool Server::IsWatched(ChannelIndex channel) const { return channel < kMaxChannels && implementation_->hub.num_watching[channel] > 0; }

void Server::Publish(ChannelIndex channel, std::string_view slot, std::int64_t group, int part, Utime time, Bytes message) {
  if (!IsWatched(channel)) return;
  auto& server = *implementation_;
  const auto num_bytes = kFrameHeadBytes + message.size();
  if (server.num_published_bytes + num_bytes > kMaxPublishedBytes) return server.hub.counts->Add("frames_dropped");
  server.num_published_bytes += num_bytes;
  auto frame = std::make_shared<const std::vector<std::uint8_t>>(ToFrame({kLiveSource, channel, 0, time}, message));
  asio::post(server.hub.context, [&server, channel, slot = std::string(slot), group, part, num_bytes, frame = std::move(frame)] {
    server.num_published_bytes -= num_bytes;
    server.ForEachClient([&](Client& client) { client.Offer(channel, slot, group, part, frame); });
  });
}

void Server::TellSources() {
  if (implementation_->hub.parts.recordings) implementation_->are_sources_new = true;
}

void Server::TellIndexing(int source, double share) {
  auto& server = *implementation_;
  asio::post(server.hub.context, [&server, source, share] { server.ForEachClient([&](Client& client) { client.TellIndexing(source, share); }); });
}

ServerCounts Server::Counts() const { return implementation_->hub.counts->All(); }

}  // namespace lookout::page
