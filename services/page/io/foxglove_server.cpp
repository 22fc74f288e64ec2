#include "services/page/io/foxglove_server.hpp"

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/io/network.hpp"
#include "services/page/io/viewer.hpp"

namespace lookout::page {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds kViewerPauseAfterFault{100};
constexpr std::chrono::seconds kViewerTickPeriod{1};
constexpr std::chrono::milliseconds kMaxViewersEnding{700};
constexpr int kViewerSendBufferBytes = 256 * 1024;
constexpr std::size_t kMaxWaitingBytes = std::size_t{32} * 1024 * 1024;  // that the server's thread has not seen yet
constexpr int kMaxStrangers = 16;                                        // connections that are no viewers, or not yet

}  // namespace

struct FoxgloveServer::Implementation {
  explicit Implementation(FoxgloveOptions options) : hub(std::move(options)) {
    const auto why_not = Listen();
    if (!why_not.empty() && !hub.options.waits_for_port) throw std::runtime_error(why_not);
    if (why_not.empty()) {
      Accept();
    } else {
      ListenLater();
    }
    Tick();
    thread = std::thread([this] { Run(); });
  }

  ~Implementation() {
    asio::post(hub.context, [this] { End(); });
    thread.join();
    hub.viewers.clear();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  // @return why not, for people; empty: it listens
  std::string Listen() {
    const auto& options = hub.options;
    std::string why_not;
    try {
      const tcp::endpoint endpoint(asio::ip::make_address(options.bind_address), static_cast<std::uint16_t>(options.port));
      acceptor.open(endpoint.protocol());
      acceptor.set_option(tcp::acceptor::reuse_address(true));
      acceptor.bind(endpoint);
      acceptor.listen();
      port = acceptor.local_endpoint().port();
    } catch (const boost::system::system_error& error) {
      error_code ignored;
      acceptor.close(ignored);
      why_not = "Foxglove cannot be served on " + options.bind_address + " port " + std::to_string(options.port) + ": " +
                io::CannotListenText(error.code().value(), options.port);
    }
    const std::lock_guard lock(fault_mutex);
    fault = why_not;
    return why_not;
  }

  void ListenLater() {
    pause.expires_after(io::kListenPause);
    pause.async_wait([this](error_code) {
      if (hub.is_ending) return;
      if (Listen().empty()) return Accept();
      ListenLater();
    });
  }

  void Run() {
    while (true) {
      try {
        hub.context.run();
        return;
      } catch (...) {
        // Of one connection; most likely there was no memory.
        hub.counts->Add("foxglove_faults");
      }
    }
  }

  void Accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (hub.is_ending) return;
      if (error) {
        hub.counts->Add("foxglove_faults");
        pause.expires_after(kViewerPauseAfterFault);
        pause.async_wait([this](error_code) {
          if (!hub.is_ending) Accept();
        });
        return;
      }
      Accept();
      // Each has 5 s to ask.
      if (hub.counts->Of("foxglove_connections") - hub.counts->Of("foxglove_clients") >= kMaxStrangers)
        return hub.counts->Add("foxglove_refused_full");
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      socket.set_option(asio::socket_base::keep_alive(true), ignored);
      socket.set_option(asio::socket_base::send_buffer_size(kViewerSendBufferBytes), ignored);
      std::make_shared<Viewer>(hub, std::move(socket))->Start();
    });
  }

  // A viewer's action may take it off the list.
  template <class Function>
  void ForEachViewer(Function&& function) {
    const std::vector<std::shared_ptr<Viewer>> viewers(hub.viewers.begin(), hub.viewers.end());
    for (const auto& viewer : viewers) function(*viewer);
  }

  void Tick() {
    tick.expires_after(kViewerTickPeriod);
    tick.async_wait([this](error_code) {
      if (hub.is_ending) return;
      Tick();
      const auto now = std::chrono::steady_clock::now();
      ForEachViewer([now](Viewer& viewer) { viewer.Tick(now); });
    });
  }

  void End() {
    hub.is_ending = true;
    error_code ignored;
    acceptor.close(ignored);
    pause.cancel();
    ForEachViewer([](Viewer& viewer) { viewer.Close(boost::beast::websocket::close_code::going_away, "the server ends"); });
    end_since = std::chrono::steady_clock::now();
    AwaitEnd();
  }

  // Until all viewers have heard of it, or for long enough.
  void AwaitEnd() {
    if (hub.viewers.empty() || std::chrono::steady_clock::now() - end_since > kMaxViewersEnding) return hub.context.stop();
    tick.expires_after(std::chrono::milliseconds(10));
    tick.async_wait([this](error_code) { AwaitEnd(); });
  }

  ViewerHub hub;
  tcp::acceptor acceptor{hub.context};
  asio::steady_timer pause{hub.context};
  asio::steady_timer tick{hub.context};
  Viewer::Time end_since{};
  std::atomic<int> port = 0;
  std::atomic<std::size_t> num_waiting_bytes = 0;
  mutable std::mutex fault_mutex;  // guards the next
  std::string fault;
  std::thread thread;
};

FoxgloveServer::FoxgloveServer(FoxgloveOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}

FoxgloveServer::~FoxgloveServer() = default;

int FoxgloveServer::port() const { return implementation_->port; }

std::string FoxgloveServer::Fault() const {
  const std::lock_guard lock(implementation_->fault_mutex);
  return implementation_->fault;
}

bool FoxgloveServer::IsWatched(std::size_t channel) const {
  const auto& num_watching = implementation_->hub.num_watching;
  return channel < num_watching.size() && num_watching[channel] > 0;
}

void FoxgloveServer::Publish(std::size_t channel, Utime time, std::string message) {
  if (!IsWatched(channel)) return;
  auto& server = *implementation_;
  const auto num_bytes = message.size();
  if (server.num_waiting_bytes + num_bytes > kMaxWaitingBytes) return server.hub.counts->Add("foxglove_dropped");
  server.num_waiting_bytes += num_bytes;
  asio::post(server.hub.context, [&server, num_bytes, one = ViewerMessage{channel, time, std::make_shared<const std::string>(std::move(message))}] {
    server.num_waiting_bytes -= num_bytes;
    server.ForEachViewer([&one](Viewer& viewer) { viewer.Offer(one); });
  });
}

ServerCounts FoxgloveServer::Counts() const { return implementation_->hub.counts->All(); }

}  // namespace lookout::page
