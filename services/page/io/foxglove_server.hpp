// Server of Foxglove's WebSocket protocol, on a thread of its own: viewers of others see the look-out, and can change nothing.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "common/core/utime.hpp"
#include "services/page/core/viewer_protocol.hpp"
#include "services/page/io/server.hpp"

namespace lookout::page {

struct FoxgloveOptions {
  std::string bind_address = "127.0.0.1";  // numeric
  int port = 0;                            // 0: any
  bool waits_for_port = false;             // where the port cannot be had now, the server tries again and again, and Fault() says so
  std::vector<std::string> allowed_origins = {};
  int max_clients = 4;
  std::string name = {};     // of the server
  std::string session = {};  // differs from start to start
  std::vector<ViewerChannel> channels = {};
};

/// Who asks with an Origin (a browser always does) that is not allowed is refused by 403; programs without one may ask. A viewer that is slow loses
/// messages, oldest first; one that says nothing and confirms no ping for 20 s is let go.
class FoxgloveServer {
 public:
  /// Listens when it returns, or waits for its port.
  /// @throws std::runtime_error when the address cannot be had and is not waited for
  explicit FoxgloveServer(FoxgloveOptions options);
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  /// 0 while the server waits for its port.
  int port() const;

  /// The fault that keeps viewers away, as a sentence; empty: no fault.
  std::string Fault() const;

  /// Whether any viewer has subscribed the channel: else nobody needs its messages.
  bool IsWatched(std::size_t channel) const;

  /// Sends a message to the viewers that have subscribed its channel. Any thread; returns at once.
  /// @param time  of reception
  void Publish(std::size_t channel, Utime time, std::string message);

  /// For HEALTH; one that is 0 may be missing.
  /// Now: foxglove_clients, foxglove_connections. Since the start: foxglove_openings, foxglove_sent, foxglove_dropped (a client, or the thread of the
  /// server, was too slow), foxglove_not_served (requests to change something), foxglove_refused_origin (403), foxglove_refused_full (503, or no room
  /// for a connection), foxglove_refused_request (other refusals), foxglove_client_faults (no request of the protocol), foxglove_clients_silent (let
  /// go), foxglove_faults (of the server).
  ServerCounts Counts() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::page
