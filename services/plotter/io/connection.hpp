// One receiver of messages: it is opened, is sent whole messages, and is closed when it does not confirm them in time.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "services/plotter/io/port.hpp"
#include "services/plotter/io/waiting.hpp"

namespace lookout::plotter {

class Connection {
 public:
  /// A connection that is not made after this is given up.
  static constexpr std::chrono::seconds kMaxOpening{5};

  enum class State { kOpening, kOpen, kClosed };

  explicit Connection(std::shared_ptr<Traffic> traffic) : traffic_(std::move(traffic)), began_(std::chrono::steady_clock::now()) {}
  virtual ~Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  State state() const { return state_; }
  bool is_open() const { return state_ == State::kOpen && !is_late_; }
  /// The connection was or is being closed because its receiver accepted too little.
  bool is_late() const { return is_late_; }
  /// Why the connection was closed.
  const std::string& reason() const { return reason_; }

  /// @param message  whole. A message that waits behind a full buffer closes the connection.
  void Send(std::string_view message);

  void Tick(SteadyTime now);

  /// Bytes that Send accepts now.
  std::size_t room_bytes() const {
    const auto num_queued = num_queued_bytes();
    return is_open() && num_queued < kOfferedBytes ? kOfferedBytes - num_queued : 0;
  }

  /// Waiting bytes are dropped, in the kernel too. Nothing of this connection happens any more.
  void Close(const std::string& reason);

 protected:
  void Open() { state_ = State::kOpen; }

  /// Sends the message, or lets it wait in this process.
  virtual void Write(std::string_view message) = 0;
  /// Bytes that the receiver has not confirmed: num_queued_bytes in this process, num_waiting_bytes in this process and in the kernel.
  virtual std::size_t num_queued_bytes() const = 0;
  virtual std::size_t num_waiting_bytes() = 0;
  /// Whether the other side would learn now that the connection is closed.
  virtual bool IsReachable() { return true; }
  /// Drops waiting bytes and closes at once.
  virtual void CloseNow() = 0;
  /// Checks that are due from time to time.
  virtual void Check() {}

  Traffic& traffic() { return *traffic_; }

 private:
  // A late connection whose other side cannot be told of the end is kept no longer than this.
  static constexpr std::chrono::seconds kMaxUnreachable{15};

  std::shared_ptr<Traffic> traffic_;
  SteadyTime began_;
  State state_ = State::kOpening;
  Waiting waiting_;
  bool is_late_ = false;
  SteadyTime late_since_{};
  std::string reason_;
};

}  // namespace lookout::plotter
