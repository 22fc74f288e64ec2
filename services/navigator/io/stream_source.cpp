#include "services/navigator/io/stream_source.hpp"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace lookout::navigator {

namespace {

// A second of a fast serial port comes in some pieces.
constexpr std::size_t kPieceBytes = 4096;

}  // namespace

StreamSource::StreamSource(const std::string& name, std::string place)
    : place_(std::move(place)),
      opened_name_(name + "_opened"),
      lost_name_(name + "_lost"),
      bytes_name_(name + "_bytes"),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      fault_(place_ + " is not open yet") {
  if (epoll_ < 0) throw std::runtime_error("epoll_create1 failed");
}

StreamSource::~StreamSource() {
  if (epoll_ >= 0) close(epoll_);
}

int StreamSource::OnConnected(int descriptor, std::string&) { return descriptor; }

void StreamSource::Close(int descriptor) { close(descriptor); }

void StreamSource::CloseNow() {
  if (descriptor_ == kNone) return;
  // Its descriptor may have been closed by a library: then the kernel has forgotten it, and this does nothing.
  epoll_ctl(epoll_, EPOLL_CTL_DEL, descriptor_, nullptr);
  Close(descriptor_);
  descriptor_ = kNone;
  state_ = State::kClosed;
}

StreamSource::Result StreamSource::Read(int descriptor, std::vector<std::uint8_t>& bytes) {
  std::array<std::uint8_t, kPieceBytes> piece{};
  const auto num_bytes = read(descriptor, piece.data(), piece.size());
  if (num_bytes > 0) {
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + num_bytes);
    return Result::kSome;
  }
  if (num_bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return Result::kNothing;
  if (num_bytes == 0) errno = 0;
  return Result::kEnd;
}

void StreamSource::Watch(int descriptor, bool for_writing) const {
  epoll_event event{};
  event.events = for_writing ? EPOLLOUT : EPOLLIN;
  event.data.fd = descriptor;
  if (epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event) < 0 && errno == EEXIST) epoll_ctl(epoll_, EPOLL_CTL_MOD, descriptor, &event);
}

void StreamSource::Fail(const std::string& fault, Utime now) {
  CloseNow();
  fault_ = place_ + ": " + fault;
  last_attempt_ = now;
  pause_ = pause_.count() == 0 ? kFirstPause : std::min(2 * pause_, kLastPause);
}

std::string StreamSource::Poll(Utime now) {
  if (state_ == State::kConnecting) {
    Connect(now);
  } else if (state_ == State::kClosed) {
    // A clock that was set back does not make the pause longer.
    const bool is_time = !last_attempt_ || now - *last_attempt_ >= pause_ || now < *last_attempt_;
    if (is_time) {
      Attempt(now);
      // A server of this computer answers at once: the next call tells the result.
      if (state_ == State::kConnecting) return {};
    }
  }
  if (fault_ == reported_fault_) return {};
  reported_fault_ = fault_;
  return fault_.empty() ? place_ + " is open" : fault_;
}

void StreamSource::Attempt(Utime now) {
  last_attempt_ = now;
  std::string fault;
  descriptor_ = Open(fault);
  if (descriptor_ == kNone) return Fail(fault, now);
  state_ = State::kConnecting;
  if (IsConnecting()) {
    Watch(descriptor_, true);
  } else {
    Connect(now);
  }
}

void StreamSource::Connect(Utime now) {
  if (IsConnecting()) {
    pollfd waiting{descriptor_, POLLOUT, 0};
    if (poll(&waiting, 1, 0) == 0) {
      if (now - *last_attempt_ > kConnectTimeout) Fail("does not answer", now);
      return;
    }
    int error = 0;
    socklen_t size = sizeof error;
    if (getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size) < 0) error = errno;
    if (error != 0) return Fail(std::strerror(error), now);
  }
  std::string fault;
  const int connected = OnConnected(descriptor_, fault);
  if (connected != descriptor_) {
    epoll_ctl(epoll_, EPOLL_CTL_DEL, descriptor_, nullptr);
    close(descriptor_);
    descriptor_ = kNone;
    state_ = State::kClosed;
  }
  if (connected == kNone) return Fail(fault, now);
  descriptor_ = connected;
  Watch(descriptor_, false);
  state_ = State::kOpen;
  fault_.clear();
  ++num_opened_;
}

std::optional<io::Source::Piece> StreamSource::Receive(Utime now) {
  if (state_ == State::kConnecting) Connect(now);
  if (state_ != State::kOpen) return std::nullopt;
  buffer_.clear();
  switch (Read(descriptor_, buffer_)) {
    case Result::kNothing:
      return std::nullopt;
    case Result::kEnd:
      ++num_lost_;
      Fail(errno == 0 ? "ended" : std::strerror(errno), now);
      return Piece{.host_time = now, .bytes = {}, .kind = Kind::kBreak};
    case Result::kSome:
      break;
  }
  // A connection that delivers something is sound: the next failure begins with the short pause.
  pause_ = std::chrono::milliseconds(0);
  num_bytes_ += static_cast<std::int64_t>(buffer_.size());
  return Piece{.host_time = now, .bytes = buffer_, .kind = Kind::kStream};
}

std::vector<Counter> StreamSource::counters() { return {{opened_name_, num_opened_}, {lost_name_, num_lost_}, {bytes_name_, num_bytes_}}; }

}  // namespace lookout::navigator
