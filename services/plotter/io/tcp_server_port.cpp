#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>

#include "common/io/network.hpp"
#include "services/plotter/io/ports.hpp"
#include "services/plotter/io/tcp.hpp"

namespace lookout::plotter {

namespace {

using boost::asio::ip::tcp;

class TcpServerPort final : public Port {
 public:
  TcpServerPort(std::shared_ptr<Loop> loop, const TcpServerOptions& options)
      : Port(std::move(loop)),
        place_("TCP server at " + PlaceOf(options.bind_address, options.port)),
        endpoint_(ParseAddress(options.name, options.bind_address), static_cast<std::uint16_t>(options.port)),
        max_clients_(static_cast<std::size_t>(options.max_clients)),
        names_(options.name, {"sent", "dropped", "unsent", "received", "refused", "openings", "clients", "clients_dropped", "clients_refused"}),
        acceptor_(context()) {
    Listen(std::chrono::steady_clock::now());
  }

  ~TcpServerPort() override {
    for (const auto& client : clients_) client->Close("");
  }

  void Send(std::string_view message) override {
    if (clients_.empty()) ++traffic_->num_unsent;
    for (const auto& client : clients_) client->Send(message);
  }

  void Tick(SteadyTime now) override {
    if (!acceptor_.is_open() && now - last_attempt_ >= io::kListenPause) Listen(now);
    if (acceptor_.is_open()) Accept();
    for (const auto& client : clients_) client->Tick(now);
    num_dropped_ += std::erase_if(clients_, [](const auto& client) { return client->state() == Connection::State::kClosed && client->is_late(); });
    std::erase_if(clients_, [](const auto& client) { return client->state() == Connection::State::kClosed; });
  }

  bool is_open() const override {
    return std::ranges::any_of(clients_, [](const auto& client) { return client->is_open(); });
  }
  // A client that does not read must not hold up the others: a message without room cuts it off.
  std::size_t room_bytes() const override {
    std::size_t room = 0;
    for (const auto& client : clients_) room = std::max(room, client->room_bytes());
    return room;
  }
  std::string fault() const override { return fault_; }
  std::vector<Counter> counters() const override {
    return names_.With({traffic_->num_sent, traffic_->num_dropped, traffic_->num_unsent, traffic_->num_received, traffic_->num_refused,
                        traffic_->num_openings, static_cast<std::int64_t>(clients_.size()), static_cast<std::int64_t>(num_dropped_), num_refused_});
  }

 private:
  // A client that connects again and again must not keep the process here.
  static constexpr int kMaxAcceptedAtOnce = 16;

  // A port that is taken, or an address that comes later, costs this output alone, and is tried again.
  void Listen(SteadyTime now) {
    last_attempt_ = now;
    boost::system::error_code error;
    acceptor_.open(endpoint_.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error && endpoint_.address().is_v6()) acceptor_.set_option(boost::asio::ip::v6_only(true), error);
    if (!error) acceptor_.bind(endpoint_, error);
    if (!error) acceptor_.listen(boost::asio::socket_base::max_listen_connections, error);
    if (!error) acceptor_.non_blocking(true, error);
    if (!error) return fault_.clear();
    fault_ = place_ + ": " + io::CannotListenText(error.value(), endpoint_.port());
    boost::system::error_code ignored;
    acceptor_.close(ignored);
  }

  void Accept() {
    for (int i = 0; i < kMaxAcceptedAtOnce; ++i) {
      tcp::socket socket(context());
      boost::system::error_code error;
      acceptor_.accept(socket, error);
      if (error == boost::asio::error::would_block) return fault_.clear();
      if (error) {
        fault_ = place_ + ": " + error.message();  // this process may have no descriptor left: the client is accepted at a later try
        return;
      }
      if (clients_.size() >= max_clients_) {
        ++num_refused_;
        continue;
      }
      clients_.push_back(std::make_shared<TcpConnection>(std::move(socket), TcpConnection::Made::kByClient, traffic_));
      clients_.back()->Start();
      ++traffic_->num_openings;
    }
  }

  std::string place_;
  tcp::endpoint endpoint_;
  std::size_t max_clients_;
  CounterNames names_;
  tcp::acceptor acceptor_;
  std::vector<std::shared_ptr<TcpConnection>> clients_;
  std::size_t num_dropped_ = 0;
  std::int64_t num_refused_ = 0;
  SteadyTime last_attempt_{};
  std::string fault_;
};

}  // namespace

std::unique_ptr<Port> MakeTcpServerPort(std::shared_ptr<Loop> loop, const TcpServerOptions& options) {
  return std::make_unique<TcpServerPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
