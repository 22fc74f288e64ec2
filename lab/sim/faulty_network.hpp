// Faults of the network between lidar and host: data packets that are lost, come twice, or are overtaken by the next. All other datagrams pass.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "lab/sim/datagram.hpp"
#include "lab/sim/fault_plan.hpp"
#include "lab/sim/random.hpp"

namespace lookout::sim {

/// Shares of the data packets, together at most 1. The first and the last kFaultFree of a run have no faults, nor has a packet that overtakes one.
struct FaultParams {
  double drop_share = 0.0;
  double double_share = 0.0;
  double swap_share = 0.0;
  std::vector<TimedFault> timed{};  // drop, double and swap add their shares while they last; others are ignored
};

enum class FaultKind { kDropped, kDoubled, kSwapped };
inline constexpr std::array<std::string_view, 3> kFaultNames{"dropped", "doubled", "swapped"};

struct Fault {
  FaultKind kind = FaultKind::kDropped;
  Utime time;                     // at which the packet would have come
  std::int64_t packet_index = 0;  // among the data packets made, from 0; of two packets that change places the one that comes late
};

/// Numbers of data packets. Once a run has ended, num_sent = num_made - num_dropped + num_doubled.
struct FaultTotals {
  std::int64_t num_made = 0;
  std::int64_t num_sent = 0;
  std::int64_t num_dropped = 0;
  std::int64_t num_doubled = 0;
  std::int64_t num_swapped = 0;  // pairs
};

/// A receiver can see a loss only while packets come after it, and before it: 30 ms are 22 of them (45 in dual return).
inline constexpr std::chrono::milliseconds kFaultFree{30};

class FaultyNetwork {
 public:
  using Source = std::function<std::optional<Datagram>()>;
  using Observer = std::function<void(const Fault&)>;

  /// @param source    datagrams by time; nullopt at the end
  /// @param observer  is called for each fault
  /// @throws std::invalid_argument  as FaultPlan, and when shares are more than 1 together at any time
  FaultyNetwork(Source source, Observer observer, const FaultParams& params, int data_port, Utime start, Utime end, std::uint64_t seed);

  /// @return the next datagram by time; nullopt at the end
  std::optional<Datagram> Next();

  const FaultTotals& totals() const { return totals_; }

 private:
  double Share(FaultKind kind, Utime time) const;
  std::optional<FaultKind> Draw(Utime time);
  std::optional<Datagram> Pass(Datagram datagram);
  void Report(FaultKind kind, Utime time, std::int64_t packet_index);

  Source source_;
  Observer observer_;
  FaultParams params_;
  FaultPlan plan_;
  int data_port_;
  Utime first_fault_;
  Utime last_fault_;
  Random random_;
  std::optional<Datagram> next_;       // from the source, not yet looked at
  std::optional<Datagram> overtaken_;  // goes behind the next data packet
  std::deque<Datagram> following_;     // copies, and packets that were overtaken; by time
  FaultTotals totals_;
};

}  // namespace lookout::sim
