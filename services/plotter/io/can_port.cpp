#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "common/io/network.hpp"
#include "services/plotter/core/n2k_frame.hpp"
#include "services/plotter/io/ports.hpp"

namespace lookout::plotter {

namespace {

std::string TextOfError(int error) { return std::generic_category().message(error); }

// PDU formats of requests, claims, and the two of a broadcast of several packets: a busy network has a thousand other frames a second.
constexpr std::array<std::uint32_t, 4> kTakenFormats{0xEA, 0xEE, 0xEC, 0xEB};

can_frame ToCanFrame(const N2kFrame& frame) {
  can_frame message{};
  message.can_id = frame.id | CAN_EFF_FLAG;
  message.can_dlc = static_cast<std::uint8_t>(frame.bytes.size());
  std::ranges::copy(frame.bytes, std::begin(message.data));
  return message;
}

class CanPort final : public Port {
 public:
  CanPort(std::shared_ptr<Loop> loop, const CanOptions& options)
      : Port(std::move(loop)),
        interface_(options.interface),
        place_("CAN interface " + options.interface),
        names_(options.name, {"sent", "dropped", "unsent", "received", "refused", "openings"}) {
    Open(std::chrono::steady_clock::now());
  }
  ~CanPort() override { Close(); }

  void Send(std::string_view message) override {
    while (!message.empty()) {
      const auto end = std::min(message.find("\r\n"), message.size());
      if (!SendLine(message.substr(0, end))) return;
      message.remove_prefix(std::min(end + 2, message.size()));
    }
  }

  void Tick(SteadyTime now) override {
    if (descriptor_ < 0) {
      if (now - last_attempt_ >= kPause) Open(now);
      return;
    }
    ReadFrames(now);
    if (!fault_.empty() && now - last_failure_ > kFaultHold) fault_.clear();
  }

  bool is_open() const override { return descriptor_ >= 0; }
  // The kernel queues ten frames at least, and tells when there is no room.
  std::size_t room_bytes() const override { return is_open() ? kRoomBytes : 0; }
  std::string fault() const override { return fault_; }
  std::vector<Counter> counters() const override {
    return names_.With(
        {traffic_->num_sent, traffic_->num_dropped, traffic_->num_unsent, traffic_->num_received, traffic_->num_refused, traffic_->num_openings});
  }

 private:
  static constexpr std::chrono::seconds kPause{1};
  static constexpr std::chrono::seconds kFaultHold{5};
  static constexpr std::size_t kRoomBytes = 50'000;
  static constexpr int kMostReadAtOnce = 256;

  // A frame that is not sent ends its message: the rest of a fast packet is worth nothing.
  bool SendLine(std::string_view line) {
    if (descriptor_ < 0) {
      ++traffic_->num_unsent;
      return false;
    }
    const auto frame = ReadRawLine(line);
    if (!frame) {
      ++traffic_->num_dropped;
      return false;
    }
    const auto bytes = ToCanFrame(*frame);
    if (write(descriptor_, &bytes, sizeof bytes) == static_cast<ssize_t>(sizeof bytes)) {
      ++traffic_->num_sent;
      return true;
    }
    ++traffic_->num_dropped;
    NoteError(errno, std::chrono::steady_clock::now());
    return false;
  }

  void ReadFrames(SteadyTime now) {
    for (int i = 0; i < kMostReadAtOnce; ++i) {
      can_frame message{};
      const auto num_bytes = recv(descriptor_, &message, sizeof message, MSG_DONTWAIT);
      if (num_bytes < 0) {
        if (errno != EAGAIN && errno != EWOULDBLOCK) NoteError(errno, now);
        return;
      }
      const bool is_frame = num_bytes == static_cast<ssize_t>(sizeof message) && message.can_dlc <= CAN_MAX_DLEN;
      if (!is_frame) {
        ++traffic_->num_refused;
        continue;
      }
      auto line = "00:00:00.000 R " + RawLine({message.can_id & CAN_EFF_MASK, {message.data, message.data + message.can_dlc}});
      line.resize(line.size() - 2);
      traffic_->Add(std::move(line));
    }
  }

  void Open(SteadyTime now) {
    last_attempt_ = now;
    descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (descriptor_ < 0) return Fail("this kernel has no SocketCAN: " + TextOfError(errno), now);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface_.c_str()));
    if (address.can_ifindex == 0) return CloseWith(io::NoInterfaceText(interface_), now);
    std::array<can_filter, kTakenFormats.size()> filters{};
    for (std::size_t i = 0; i < filters.size(); ++i) {
      filters.at(i) = {.can_id = kTakenFormats.at(i) << 16U | CAN_EFF_FLAG, .can_mask = 0xFFU << 16U | CAN_EFF_FLAG | CAN_RTR_FLAG};
    }
    if (setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), sizeof filters) < 0 ||
        bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0) {
      return CloseWith(TextOfError(errno), now);
    }
    if (!io::IsInterfaceUp(interface_)) return CloseWith("is down", now);
    fault_.clear();
    ++traffic_->num_openings;
  }

  // A full queue is a network on which nobody takes a frame, or too few of them. An interface that comes again is another one to the kernel.
  void NoteError(int error, SteadyTime now) {
    if (error == ENOBUFS) return Fail("takes no frames: nobody else is on the network, or it is too busy", now);
    CloseWith(TextOfError(error), now);
  }

  void CloseWith(const std::string& why, SteadyTime now) {
    Close();
    Fail(why, now);
  }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  void Fail(const std::string& why, SteadyTime now) {
    fault_ = place_ + ": " + why;
    last_failure_ = now;
    last_attempt_ = now;
  }

  std::string interface_;
  std::string place_;
  CounterNames names_;
  int descriptor_ = -1;
  SteadyTime last_attempt_{};
  SteadyTime last_failure_{};
  std::string fault_;
};

}  // namespace

std::unique_ptr<Port> MakeCanPort(std::shared_ptr<Loop> loop, const CanOptions& options) {
  return std::make_unique<CanPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
