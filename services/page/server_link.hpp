// For threads that tell the server something before it is there and after it has gone.
#pragma once

#include <mutex>

#include "services/page/io/server.hpp"

namespace lookout::page {

class ServerLink {
 public:
  /// The server is there while this stands.
  class Holder {
   public:
    Holder(ServerLink& link, Server& server) : link_(link) { link_.Set(&server); }
    ~Holder() { link_.Set(nullptr); }
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;

   private:
    ServerLink& link_;
  };

  /// Calls `tell` with the server where there is one. Any thread.
  template <typename Tell>
  void With(const Tell& tell) {
    const std::lock_guard lock(mutex_);
    if (server_ != nullptr) tell(*server_);
  }

 private:
  void Set(Server* server) {
    const std::lock_guard lock(mutex_);
    server_ = server;
  }

  std::mutex mutex_;
  Server* server_ = nullptr;
};

}  // namespace lookout::page
