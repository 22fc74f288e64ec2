#include "services/page/io/foxglove_server.hpp"

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>
#include <utility>

#include "services/page/io/listener.hpp"
#include "services/page/io/viewer.hpp"

namespace lookout::page {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::seconds kViewerTickPeriod{1};
constexpr std::chrono::milliseconds kMaxViewersEnding{700};
constexpr std::size_t kMaxWaitingBytes = std::size_t{32} * 1024 * 1024;  // that the server's thread has not seen yet
constexpr int kMaxStrangers = 16;                                        // connections that are no viewers, or not yet

}  // namespace

struct FoxgloveServer::Implementation {
  explicit Implementation(FoxgloveOptions options)
      : hub(std::move(options)),
        listener(
            hub.context,
            {.served = "Foxglove", .bind_address = hub.options.bind_address, .port = hub.options.port, .waits_for_port = hub.options.waits_for_port},
            {.on_listening = {},
             .on_socket = [this](tcp::socket socket) { Welcome(std::move(socket)); },
             .on_fault = [this] { hub.counts->Add("foxglove_faults"); }}) {
    Tick();
    thread = std::thread([this] { RunThroughFaults(hub.context, [this] { hub.counts->Add("foxglove_faults"); }); });
  }

  ~Implementation() {
    asio::post(hub.context, [this] { End(); });
    thread.join();
    hub.viewers.clear();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void Welcome(tcp::socket socket) {
    // Each has 5 s to ask.
    if (hub.counts->Of("foxglove_connections") - hub.counts->Of("foxglove_clients") >= kMaxStrangers) {
      return hub.counts->Add("foxglove_refused_full");
    }
    SetServedOptions(socket);
    std::make_shared<Viewer>(hub, std::move(socket))->Start();
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
    listener.Close();
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
  Listener listener;
  asio::steady_timer tick{hub.context};
  Viewer::Time end_since{};
  std::atomic<std::size_t> num_waiting_bytes = 0;
  std::thread thread;
};

FoxgloveServer::FoxgloveServer(FoxgloveOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}

FoxgloveServer::~FoxgloveServer() = default;

int FoxgloveServer::port() const { return implementation_->listener.port(); }

std::string FoxgloveServer::Fault() const { return implementation_->listener.Fault(); }

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
