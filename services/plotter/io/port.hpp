// The common parts of all links: the loop that drives them, received messages, counters.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/io/link.hpp"
#include "services/plotter/io/links.hpp"

namespace lookout::plotter {

using SteadyTime = std::chrono::steady_clock::time_point;

/// A receiver that has not confirmed a message after this is cut off.
inline constexpr std::chrono::seconds kMaxWait{2};
/// Most bytes that wait for one receiver in this process.
inline constexpr std::size_t kMaxWaitingBytes = std::size_t{256} * 1024;
/// Most messages of one link that wait for Receive().
inline constexpr std::size_t kMaxReceived = 64;
/// The part of kMaxWaitingBytes that room_bytes() offers.
inline constexpr std::size_t kOfferedBytes = kMaxWaitingBytes - std::size_t{64} * 1024;

/// Counters and received messages of a link. Its connections share them, and may outlive the link.
struct Traffic {
  std::int64_t num_sent = 0;
  std::int64_t num_dropped = 0;
  std::int64_t num_unsent = 0;
  std::int64_t num_openings = 0;
  std::int64_t num_received = 0;
  std::int64_t num_refused = 0;
  std::deque<std::string> received;

  void Add(std::string message) {
    if (received.size() >= kMaxReceived) {
      ++num_refused;
      return;
    }
    ++num_received;
    received.push_back(std::move(message));
  }
};

class Port;

/// The loop that drives the ports. They share it, so that nothing of Asio outlives its context.
class Loop {
 public:
  boost::asio::io_context& context() { return context_; }
  void Add(Port* port) { ports_.push_back(port); }
  void Remove(Port* port) { std::erase(ports_, port); }
  void Poll();

 private:
  boost::asio::io_context context_{1};
  std::vector<Port*> ports_;
};

/// A link that is driven by Links.
class Port : public Link {
 public:
  explicit Port(std::shared_ptr<Loop> loop) : loop_(std::move(loop)) { loop_->Add(this); }
  ~Port() override { loop_->Remove(this); }

  /// Does due work.
  virtual void Tick(SteadyTime now) = 0;

  std::optional<std::string> Receive() override {
    if (traffic_->received.empty()) return std::nullopt;
    auto message = std::move(traffic_->received.front());
    traffic_->received.pop_front();
    return message;
  }
  void NoteUnsent() override { ++traffic_->num_unsent; }
  std::int64_t num_openings() const override { return traffic_->num_openings; }

 protected:
  /// A counter's name must stay where it is: this object keeps it.
  class CounterNames {
   public:
    CounterNames(const std::string& name, std::initializer_list<const char*> endings) {
      for (const char* ending : endings) names_.push_back(name + "_" + ending);
    }
    std::vector<Counter> With(std::initializer_list<std::int64_t> counts) const {
      std::vector<Counter> counters;
      for (const auto count : counts) counters.push_back({names_[counters.size()], count});
      return counters;
    }

   private:
    std::vector<std::string> names_;
  };

  boost::asio::io_context& context() { return loop_->context(); }

  std::shared_ptr<Traffic> traffic_ = std::make_shared<Traffic>();

 private:
  std::shared_ptr<Loop> loop_;
};

}  // namespace lookout::plotter
