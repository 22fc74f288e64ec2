#include <linux/errqueue.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <boost/asio/ip/udp.hpp>

#include "common/io/network.hpp"
#include "services/plotter/io/ports.hpp"
#include "services/plotter/io/tcp.hpp"

namespace lookout::plotter {

namespace {

using boost::asio::ip::udp;

class UdpPort final : public Port {
 public:
  UdpPort(std::shared_ptr<Loop> loop, const UdpOptions& options)
      : Port(std::move(loop)),
        destination_(ParseAddress(options.name, options.address), static_cast<std::uint16_t>(options.port)),
        interface_(options.interface),
        receives_(options.receives),
        place_(std::string(kTo) + PlaceOf(options.address, options.port)),
        names_(options.name, {"sent", "unsent", "unheard", "openings"}),
        socket_(context()) {
    Open(std::chrono::steady_clock::now());
  }

  void Send(std::string_view message) override {
    if (!socket_.is_open()) {
      ++traffic_->num_unsent;
      return;
    }
    room_bytes_ -= std::min(room_bytes_, message.size());
    const auto now = std::chrono::steady_clock::now();
    boost::system::error_code error;
    socket_.send_to(boost::asio::buffer(message), destination_, 0, error);
    if (error) {
      // The error may come from an earlier message: then this message was not tried yet.
      NoteError(error, now);
      ForgetErrors();
      socket_.send_to(boost::asio::buffer(message), destination_, 0, error);
    }
    if (!error) {
      ++traffic_->num_sent;
      return;
    }
    ++traffic_->num_unsent;
    NoteError(error, now);
    // An interface that comes again is another one to the kernel.
    if (error == boost::system::errc::no_such_device || error == boost::system::errc::no_such_device_or_address) Close();
  }

  void Tick(SteadyTime now) override {
    const auto elapsed = std::chrono::duration_cast<std::chrono::milliseconds>(now - last_tick_);
    room_bytes_ = std::min(kMaxAtOnceBytes, room_bytes_ + static_cast<std::size_t>(elapsed.count()) * kBytesPerMs);
    last_tick_ += elapsed;
    if (!socket_.is_open()) {
      if (now - last_attempt_ >= kPause) Open(now);
    } else {
      if (receives_) ReceiveAll(now);
      if (!fault_.empty() && now - last_failure_ > kFaultHold) fault_.clear();
      if (!remark_.empty() && now - last_unheard_ > kFaultHold) remark_.clear();
    }
  }

  bool is_open() const override { return socket_.is_open(); }
  std::size_t room_bytes() const override { return room_bytes_; }
  std::string fault() const override { return fault_; }
  std::string remark() const override { return remark_; }
  std::vector<Counter> counters() const override {
    return names_.With({traffic_->num_sent, traffic_->num_unsent, num_unheard_, traffic_->num_openings});
  }

 private:
  static constexpr std::string_view kTo = "UDP to ";
  static constexpr std::chrono::seconds kPause{1};
  // A network tells of one undelivered message and stays silent after the next.
  static constexpr std::chrono::seconds kFaultHold{5};
  // A receiver's buffer holds 212 kB by Debian's default, in which a datagram of half a kB counts as some 1.3 kB. A greater burst loses its end, and
  // with an unchanged order always the same messages.
  static constexpr std::size_t kMaxAtOnceBytes = 50'000;
  static constexpr std::size_t kBytesPerMs = 1'000;

  void Open(SteadyTime now) {
    last_attempt_ = now;
    if (!interface_.empty() && if_nametoindex(interface_.c_str()) == 0) return Fail(io::NoInterfaceText(interface_), now);
    boost::system::error_code error;
    socket_.open(destination_.protocol(), error);
    if (error) return Fail(error.message(), now);
    socket_.non_blocking(true, error);
    socket_.set_option(boost::asio::socket_base::broadcast(true), error);
    if (destination_.address().is_multicast()) socket_.set_option(boost::asio::ip::multicast::hops(1), error);
    const int yes = 1;  // without a connection the kernel reports "port unreachable" only to sockets that ask for it
    const bool is_v4 = destination_.address().is_v4();
    setsockopt(socket_.native_handle(), is_v4 ? IPPROTO_IP : IPPROTO_IPV6, is_v4 ? IP_RECVERR : IPV6_RECVERR, &yes, sizeof yes);
    if (!interface_.empty() &&
        setsockopt(socket_.native_handle(), SOL_SOCKET, SO_BINDTODEVICE, interface_.c_str(), static_cast<socklen_t>(interface_.size())) < 0) {
      const boost::system::error_code why(errno, boost::system::system_category());
      Close();
      return Fail("not by interface " + interface_ + ": " + why.message(), now);
    }
    fault_.clear();
    ++traffic_->num_openings;
  }

  // A receiver is off or not yet started: that is no fault of the look-out, and mended by nobody here.
  void NoteError(const boost::system::error_code& error, SteadyTime now) {
    if (error != boost::asio::error::connection_refused && error != boost::asio::error::host_unreachable) return Fail(error.message(), now);
    ++num_unheard_;
    remark_ = "nobody listens at " + place_.substr(kTo.size()) + ": " + error.message();
    last_unheard_ = now;
  }

  void Close() {
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

  void Fail(const std::string& why, SteadyTime now) {
    fault_ = place_ + ": " + why;
    last_failure_ = now;
  }

  // A bounded number of datagrams: a flood holds nobody up.
  void ReceiveAll(SteadyTime now) {
    std::array<char, 2048> bytes{};
    for (int i = 0; i < 64; ++i) {
      boost::system::error_code error;
      udp::endpoint sender;
      const auto num_bytes = socket_.receive_from(boost::asio::buffer(bytes), sender, 0, error);
      if (error == boost::asio::error::would_block) return;
      if (!error) {
        if (num_bytes > 0) traffic_->Add({bytes.data(), num_bytes});
        continue;
      }
      // The error comes from a message that was sent.
      NoteError(error, now);
      ForgetErrors();
    }
  }

  void ForgetErrors() {
    std::array<char, 256> about{};
    for (int i = 0; i < 100; ++i) {
      msghdr message{};
      message.msg_control = about.data();
      message.msg_controllen = about.size();
      if (recvmsg(socket_.native_handle(), &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) return;
    }
  }

  udp::endpoint destination_;
  std::string interface_;
  bool receives_;
  std::string place_;
  CounterNames names_;
  std::size_t room_bytes_ = kMaxAtOnceBytes;
  SteadyTime last_tick_ = std::chrono::steady_clock::now();
  udp::socket socket_;
  SteadyTime last_attempt_{};
  SteadyTime last_failure_{};
  std::string fault_;
  std::int64_t num_unheard_ = 0;
  SteadyTime last_unheard_{};
  std::string remark_;
};

}  // namespace

std::unique_ptr<Port> MakeUdpPort(std::shared_ptr<Loop> loop, const UdpOptions& options) {
  return std::make_unique<UdpPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
