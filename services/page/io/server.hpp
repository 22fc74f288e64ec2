// HTTP and WebSocket server of the page, on a thread of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "services/page/core/frame.hpp"
#include "services/page/core/recordings.hpp"

namespace lookout::page {

/// A file of the page, compressed by gzip.
struct Asset {
  std::string_view path;  // "/page.js"
  std::string_view content_type;
  Bytes gzip_bytes;
};

struct ServerOptions {
  std::string bind_address = "127.0.0.1";    // numeric
  int port = 0;                              // 0: any
  bool waits_for_port = false;               // where the port cannot be had now, the server tries again and again, and Faults() says so
  std::vector<std::string> host_names = {};  // that `Host` may name besides the address bound to, localhost and 127.0.0.1; without port
  int max_clients = 16;                      // WebSockets
  int max_connections = 64;
  std::string token = {};  // empty: nobody acknowledges
  bool is_log = false;
  std::string version = {};
  std::string host = {};  // name of this computer, for hello
};

/// The tile as it stands in the file, and its type; nullopt: there is none.
struct Tile {
  std::string content_type;
  std::vector<std::uint8_t> bytes;
};

/// Calls of the server to the rest of the process. Made on its threads: acknowledge and order on the server's, the others on the one that reads
/// disks.
struct ServerParts {
  std::vector<Asset> assets = {};
  std::shared_ptr<Recordings> recordings = {};                        // may be none
  std::function<std::string()> tiles_text = {};                       // tiles.json; none: no map
  std::function<std::optional<Tile>(int z, int x, int y)> tile = {};  // none: no map
  std::function<void(const Acknowledgement&)> acknowledge = {};
  std::function<void(const Order&)> order = {};
};

/// Counts by name, for HEALTH; one that is 0 may be missing.
/// Now: clients (WebSockets), connections. Since the start:
/// requests (by HTTP), openings (of WebSockets), answers (out of recordings), acknowledgements, orders, frames_sent, frames_replaced (a newer one
/// came before there was room), frames_dropped (the server's own thread did not keep up); refused_host (421), refused_origin (403), refused_token
/// (401), refused_full (503), refused_request (other refusals), connections_silent (asked for nothing), connections_let_go (closed for new ones),
/// connections_refused (too many), requests_late and answers_late (cut off), client_faults (a WebSocket said something that it should not have said),
/// clients_silent (let go); accept_faults (no descriptor was left, say), faults (of the server: an exception, a map that cannot be read).
using ServerCounts = std::map<std::string, std::int64_t, std::less<>>;

class Server {
 public:
  /// Listens when it returns, or waits for its port.
  /// @throws std::runtime_error when the address cannot be had and is not waited for
  Server(ServerOptions options, ServerParts parts);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// 0 while it waits for it.
  int port() const;

  /// Faults that keep browsers away, or did within the last minute, a sentence each.
  std::vector<std::string> Faults() const;

  /// Whether any client watches the channel: else nobody needs its messages.
  bool IsWatched(ChannelIndex channel) const;

  /// Sends a live message to the clients that watch its channel. Any thread; returns at once.
  /// @param slot   messages of one slot replace each other: of HEALTH the process, else empty
  /// @param group  messages of one group stand beside each other: utime_us
  /// @param part   within the group
  void Publish(ChannelIndex channel, std::string_view slot, std::int64_t group, int part, Utime time, Bytes message);

  /// Tells all clients that the sources have changed, or how far an index is. Any thread.
  void TellSources();
  void TellIndexing(int source, double share);

  ServerCounts Counts() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::page
