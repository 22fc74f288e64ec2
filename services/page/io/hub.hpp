// State that connections and clients of one server share. All but Counts and the watched channels is of the server's thread.
#pragma once

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "services/page/core/access.hpp"
#include "services/page/io/assets.hpp"
#include "services/page/io/counts.hpp"
#include "services/page/io/server.hpp"

namespace lookout::page {

class Client;
class Connection;

using SteadyTime = std::chrono::steady_clock::time_point;

struct Hub {
  Hub(ServerOptions server_options, ServerParts server_parts)
      : options(std::move(server_options)), parts(std::move(server_parts)), assets(parts.assets), counts(std::make_shared<Counts>()) {}

  bool may_acknowledge() const { return !options.token.empty() && !options.is_log && parts.acknowledge && parts.order; }

  const ServerOptions options;
  const ServerParts parts;
  Assets assets;
  OwnHosts own_hosts = {};
  const std::shared_ptr<Counts> counts;
  std::array<std::atomic<int>, kMaxChannels> num_watching{};  // clients, by channel
  std::set<std::shared_ptr<Client>> clients = {};
  std::set<Connection*> connections = {};  // connections that have not become clients
  std::string sources = "[]";              // JSON
  std::size_t num_answer_bytes = 0;        // found and not yet sent, of all clients
  bool is_ending = false;
  // Last, so that work that waits in them goes first.
  boost::asio::io_context context{1};
  boost::asio::thread_pool disk{1};
};

}  // namespace lookout::page
