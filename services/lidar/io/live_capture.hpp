// UDP datagrams out of the frames that a network interface sees.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "common/io/network.hpp"
#include "common/io/source.hpp"
#include "services/lidar/io/frame.hpp"

namespace lookout::lidar {

struct LiveOptions {
  std::string interface;  // "eth0"
  std::string filter;     // pcap-filter(7); empty = FilterOfPorts
  int data_port = 0;
  int position_port = 0;
  bool has_large_packets = false;                     // above 1472 bytes
  int receive_buffer_bytes = 0;                       // of the ring that kernel and process share
  std::vector<std::string> allowed_source_addresses;  // as inet_ntop writes them; empty = all
};

/// Datagrams to one of two ports, plain or in up to two VLAN tags.
///
/// @param has_vlan  whether the link type knows VLAN tags: Ethernet does
std::string FilterOfPorts(int data_port, int position_port, bool has_vlan);

/// @return why a filter cannot be compiled for Ethernet; empty = it can
std::string FilterFault(const std::string& filter);

class LiveCapture final : public io::Source {
 public:
  /// @throws std::runtime_error when the interface is not there or the right to capture is missing (the text says how to get it). An interface that
  ///         is down is waited for
  explicit LiveCapture(LiveOptions options);

  /// Looks once a second: closes when the interface goes down or away, opens when it is back. Says, and counts, an outage that is over by then, too.
  std::string Poll(Utime now) override;

  /// The next datagram from an allowed source.
  std::optional<Piece> Receive(Utime now) override;

  /// So that a flood of other frames does not hold the caller.
  static constexpr int kMaxSkippedPerCall = 64;

  bool is_empty() const override { return is_empty_; }
  Utime last_time() const override { return last_time_; }
  std::string fault() const override { return fault_; }

  /// The filter given to the kernel; empty while nothing can be captured.
  const std::string& filter() const { return filter_; }

  /// capture_kernel_drops, capture_interface_drops (reads the kernel's), capture_source_refused, capture_outages, capture_read_errors,
  /// frames_read, frames_datagram, then skipped frames by reason.
  std::vector<Counter> counters() override;

 private:
  struct Drops {
    std::int64_t num_kernel = 0;
    std::int64_t num_interface = 0;
  };

  std::string Open();
  void Close();
  std::string CheckInterface();
  Drops CurrentDrops() const;
  std::optional<Piece> Check(Bytes bytes, bool is_cut, std::int64_t seconds, std::int64_t fraction);

  LiveOptions options_;
  CaptureHandle capture_;
  int link_type_ = 0;
  std::int64_t nanoseconds_per_fraction_ = 1;  // of a stamp, as precise as the kernel stamps
  unsigned int interface_index_ = 0;
  io::InterfaceTimer timer_;
  bool is_empty_ = true;
  Utime last_time_{};
  std::string fault_;
  std::string read_fault_;  // why reading ended; until Poll() reports it
  std::string filter_;
  Drops past_drops_;  // of closed captures
  FrameCounts frames_;
  FragmentJoiner fragments_;
  std::vector<std::uint8_t> joined_;  // the last datagram that was put together
  std::int64_t num_source_refused_ = 0;
  std::int64_t num_outages_ = 0;
  std::int64_t num_opened_ = 0;
  std::int64_t num_read_errors_ = 0;
};

}  // namespace lookout::lidar
