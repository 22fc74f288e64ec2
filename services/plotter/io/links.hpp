// The ways out of this computer that a config can name, and the loop that drives them: no thread, no waiting.
#pragma once

#include <memory>
#include <string>

#include "services/plotter/io/link.hpp"

namespace lookout::plotter {

class Loop;

// In all options `name` is the output's name, which precedes the names of its counters; addresses are numeric, IPv4 or IPv6; ports are 1 to 65535.

struct UdpOptions {
  std::string name;
  std::string address;  // one computer's, a network's broadcast address, or a multicast group's (datagrams to a group stay within the own network)
  int port = 0;
  std::string interface {};  // interface by which datagrams are sent; empty = as the routes say
  bool receives = false;     // datagrams that come back to the socket that sends; else nothing is received
};

struct TcpServerOptions {
  std::string name;
  std::string bind_address;
  int port = 0;
  int max_clients = 8;  // more are closed at once
};

struct TcpClientOptions {
  std::string name;
  std::string address;
  int port = 0;
};

struct SerialOptions {
  std::string name;
  std::string device;
  int baud = 0;
  bool is_binary = false;  // bytes are received in pieces, as they come; else in lines
};

struct CanOptions {
  std::string name;
  std::string interface;  // "can0"
};

struct WebSocketOptions {
  std::string name;
  std::string address;
  int port = 0;
  std::string path;     // with the query
  std::string token{};  // sent as "Authorization: Bearer TOKEN"; empty = none
};

/// Opens links and does their work.
///
/// A failure at the other side (a server that is down, an unplugged device, a network without a route) is a fault() of its link, which tries again
/// until the failure is over. A receiver that has not got a message after 2 s is cut off, as it would get old targets as new ones; its waiting
/// messages are dropped. A stream carries whole messages only, but for its last one.
///
/// Counters of each link, behind `name`: _sent (messages that a receiver's computer has confirmed; over UDP: handed to the network), _dropped (the
/// receiver was too slow, or was lost), _unsent (nobody was there, or the network refused it), _openings; over UDP: _unheard (the receiver's computer
/// said that nobody listens there, or nobody knows that computer); of links that also receive: _received, _refused (too long, no text, or more than
/// could wait); of a server: _clients (now), _clients_dropped (too slow), _clients_refused (too many).
class Links {
 public:
  Links();
  ~Links();
  Links(const Links&) = delete;
  Links& operator=(const Links&) = delete;

  /// @throws std::runtime_error when the address is not numeric
  std::unique_ptr<Link> Udp(const UdpOptions& options);
  /// A port that is in use, or an address that this computer has not yet, is a fault() as well.
  /// @throws std::runtime_error when the address is not numeric
  std::unique_ptr<Link> TcpServer(const TcpServerOptions& options);
  /// @throws std::runtime_error when the address is not numeric
  std::unique_ptr<Link> TcpClient(const TcpClientOptions& options);
  std::unique_ptr<Link> Serial(const SerialOptions& options);
  /// SocketCAN. Its messages are lines of RAW text (core/n2k_frame.hpp), a frame each; among received frames only requests, claims of addresses and
  /// broadcasts of several packets are returned, as heard lines without a time. Anything else in a message is counted as dropped.
  std::unique_ptr<Link> Can(const CanOptions& options);
  /// @throws std::runtime_error when the address is not numeric, or path or token hold a character that cannot stand in a request (blanks, line ends)
  std::unique_ptr<Link> WebSocket(const WebSocketOptions& options);

  /// Sends waiting messages, receives, opens closed links. Must be called every 5 to 10 ms, and after a number of Send calls. Never waits.
  void Poll();

 private:
  std::shared_ptr<Loop> loop_;
};

}  // namespace lookout::plotter
