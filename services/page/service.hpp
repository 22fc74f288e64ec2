// The page process without its clock and its sockets: messages of the bus to browsers that watch them and to the last minutes; acknowledgements back.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/utime.hpp"
#include "lookout/alerts_t.hpp"
#include "services/page/io/server.hpp"

namespace lookout::page {

/// Commands of browsers to the look-out, on their way from the server's thread to the thread of the bus.
template <typename Command>
class CommandQueue {
 public:
  /// May be called from any thread. While kMost commands wait, a further command is dropped and counted.
  void Push(const Command& command) {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMost) {
      waiting_.push_back(command);
    } else {
      ++num_dropped_;
    }
  }
  std::vector<Command> TakeAll() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waiting_, {});
  }
  std::int64_t num_dropped() const {
    const std::lock_guard lock(mutex_);
    return num_dropped_;
  }

  static constexpr std::size_t kMost = 100;

 private:
  mutable std::mutex mutex_;
  std::vector<Command> waiting_;
  std::int64_t num_dropped_ = 0;
};
using AcknowledgementQueue = CommandQueue<Acknowledgement>;
using OrderQueue = CommandQueue<Order>;

/// Inputs of the service besides its bus.
struct ServiceParts {
  Server& server;
  AcknowledgementQueue& acknowledgements;
  OrderQueue& orders;
  std::function<Utime()> now;  // host time
  std::function<void(Utime time, std::string_view channel, Bytes message)> keep =
      {};  // keeps messages for the last minutes; empty: they are not kept
  std::function<void(Utime time, std::string_view channel, Bytes message)> draw =
      {};                                                        // draws messages for viewers of Foxglove's protocol; empty: there are none
  std::function<void(HealthReport& report)> add_to_report = {};  // further parts of the report
};

/// It subscribes all channels that a page shows: not the raw ones, LIDAR_NMEA and SIM_TRUTH. A message that does not decode, or is of a second
/// publisher, is shown to nobody. An acknowledgement counts while ALERTS came within kFresh of host time and hold that alert, active or rectified; an
/// order while ALERTS come.
class Service {
 public:
  static constexpr std::chrono::seconds kFresh{1};

  Service(bus::Bus& bus, ServiceParts parts);

  /// Ten times a second or more.
  void AdvanceTo(Utime host_time);

  HealthReport Report();

 private:
  using AlertKey = std::pair<std::int64_t, std::int64_t>;  // id, raised_utime_us

  template <typename T>
  void Forward(const bus::Channel& channel);
  void OnAlerts(const alerts_t& message, Utime time);
  bool HasFreshAlerts(Utime host_time) const;
  void Acknowledge(const Acknowledgement& acknowledgement, Utime host_time);
  void SendOrder(const Order& order, Utime host_time);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"acks_sent", "acks_of_no_alert", "acks_repeated", "orders_sent", "orders_unheard", "orders_repeated"});

  bus::Bus& bus_;
  ServiceParts parts_;
  // The channels of a complete look-out.
  std::array<InputWatch, 6> watches_{InputWatch(bus::kLidarScan.name), InputWatch(bus::kSegments.name), InputWatch(bus::kPose.name),
                                     InputWatch(bus::kObstacles.name), InputWatch(bus::kTracks.name),   InputWatch(bus::kAlerts.name)};
  std::set<AlertKey> alerts_;         // alerts of the last ALERTS that want an acknowledgement
  std::optional<Utime> alerts_time_;  // host time when the last ALERTS came
  std::map<AlertKey, Utime> acknowledged_;
  std::int64_t ack_seq_ = 0;
  std::optional<std::pair<Order, Utime>> ordered_;  // last
  std::int64_t order_seq_ = 0;
  Counts<kCountNames> counts_;
  ServerCounts server_counts_;  // owns the names in a report
};

}  // namespace lookout::page
