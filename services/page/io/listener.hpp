// A TCP port that is served: opened now or once it can be, and kept open whatever single connections do.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <mutex>
#include <string>

namespace lookout::page {

class Listener {
 public:
  struct Options {
    std::string served;  // for people: "the page" cannot be served on ...
    std::string bind_address;
    int port = 0;  // 0: any
    bool waits_for_port = false;
  };
  /// All are called on the thread of the context.
  struct Handlers {
    std::function<void(const boost::asio::ip::tcp::endpoint&)> on_listening;  // each time that the port was opened; may be empty
    std::function<void(boost::asio::ip::tcp::socket)> on_socket;
    std::function<void()> on_fault;  // a connection could not be accepted: no descriptor is left, say
  };

  /// @throws std::runtime_error with the reason when it cannot listen and is not to wait
  Listener(boost::asio::io_context& context, Options options, Handlers handlers);

  /// No connection is accepted any more. On the thread of the context.
  void Close();

  /// 0 while it cannot listen. Any thread.
  int port() const { return port_; }

  /// Why it cannot listen, for people; empty: it does. Any thread.
  std::string Fault() const;

 private:
  std::string Listen();
  void ListenLater();
  void Accept();

  Options options_;
  Handlers handlers_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  bool is_closed_ = false;
  std::atomic<int> port_ = 0;
  mutable std::mutex mutex_;  // guards fault_
  std::string fault_;
};

/// Runs the context until it is stopped, over whatever a connection throws; most likely there was no memory.
void RunThroughFaults(boost::asio::io_context& context, const std::function<void()>& on_fault);

/// Sends small messages at once, and bounds the bytes that the kernel holds for a peer that does not read.
void SetServedOptions(boost::asio::ip::tcp::socket& socket);

}  // namespace lookout::page
