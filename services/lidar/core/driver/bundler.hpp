// The edge towards the network: collects raw payloads into bundles, as they go on the bus and into the log.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"

namespace lookout::lidar {

/// Raw payloads as they came.
struct PacketBundle {
  Utime time;  // host time of the first payload; of a bundle that is a mark alone, host time when the mark was set
  std::int64_t seq = 0;
  bool is_start = false;  // state before this bundle is void
  bool is_end = false;    // the input ends: no bundle follows

  struct Item {
    Utime host_time;
    int udp_port = 0;
    std::size_t offset = 0;  // in payload
    std::size_t size_bytes = 0;
  };
  std::vector<Item> items;
  std::vector<std::uint8_t> payload;  // back to back, in the order of arrival

  Bytes PayloadOf(const Item& item) const { return Bytes(payload).subspan(item.offset, item.size_bytes); }
};

class Bundler {
 public:
  /// 24 x 1206 bytes make a message of 29 kB.
  static constexpr std::size_t kMaxItems = 24;
  /// Payloads do not wait longer for others.
  static constexpr std::chrono::milliseconds kMaxWait{100};

  /// With them a message is smaller than what the bus carries.
  static constexpr std::size_t kMaxPayloadBytes = 110'000;

  /// How the bundler tells packets of the lidar's model without parsing them.
  struct Form {
    std::function<bool(std::size_t)> is_data_size;
    std::function<bool(std::size_t)> is_position_size;
    /// Called once with each data packet; true ends the bundle with this packet. Empty: bundles are short enough without.
    std::function<bool(Bytes)> ends_scan;
    std::chrono::milliseconds max_wait = kMaxWait;
  };

  Bundler(int data_port, int position_port, Form form);

  /// Accepts a datagram, or refuses and counts it: another port, or another size than that port's packets. A bundle is raw: no more is checked.
  ///
  /// @return the bundle that this datagram completes
  std::optional<PacketBundle> Add(Utime host_time, int udp_port, Bytes payload);

  /// @return the bundle that has waited too long
  std::optional<PacketBundle> AdvanceTo(Utime host_time);

  /// @return the last bundle of the run, with the end mark; nullopt when the run has none. A datagram after it begins a new run.
  std::optional<PacketBundle> Finish(Utime host_time);

  bool IsDataSize(std::size_t size_bytes) const { return form_.is_data_size(size_bytes); }
  bool IsPositionSize(std::size_t size_bytes) const { return form_.is_position_size(size_bytes); }

  std::vector<Counter> counters() const;

  /// Sensor that the last payload of a wrong size on the data port seems to come from; empty when it is not known, or none came. For people.
  std::string_view foreign_sensor() const { return foreign_sensor_; }

 private:
  PacketBundle Close();
  void Append(Utime host_time, int udp_port, Bytes payload);

  int data_port_;
  int position_port_;
  Form form_;
  PacketBundle bundle_;
  std::int64_t next_seq_ = 0;
  std::string_view foreign_sensor_;  // a literal
  std::int64_t num_other_port_ = 0;
  std::int64_t num_data_wrong_size_ = 0;
  std::int64_t num_position_wrong_size_ = 0;
  std::int64_t num_bad_host_time_ = 0;
};

}  // namespace lookout::lidar
