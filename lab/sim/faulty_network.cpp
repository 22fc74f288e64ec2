#include "lab/sim/faulty_network.hpp"

#include <array>
#include <stdexcept>
#include <utility>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kFaultStream = 6;

// A datagram right behind a data packet comes this much later: its frame of 1248 bytes takes 100 us at 100 Mbit/s. Packets are more than 600 us
// apart, also in dual return.
constexpr std::chrono::microseconds kFrameTime = 100us;

}  // namespace

FaultyNetwork::FaultyNetwork(Source source, Observer observer, const FaultParams& params, int data_port, Utime start, Utime end, std::uint64_t seed)
    : source_(std::move(source)),
      observer_(std::move(observer)),
      params_(params),
      plan_(params.timed, start),
      data_port_(data_port),
      first_fault_(start + kFaultFree),
      last_fault_(end - kFaultFree),
      random_(seed, kFaultStream) {
  // The shares grow only where a fault begins.
  for (const auto& fault : plan_.faults()) {
    const Utime time = plan_.Begin(fault);
    if (Share(FaultKind::kDropped, time) + Share(FaultKind::kDoubled, time) + Share(FaultKind::kSwapped, time) > 1.0) {
      throw std::invalid_argument("faults drop, double and swap: together with --drop, --double and --swap they must not be more than 1");
    }
  }
}

double FaultyNetwork::Share(FaultKind kind, Utime time) const {
  // The first three kinds of TimedFaultKind are these.
  const std::array shares{params_.drop_share, params_.double_share, params_.swap_share};
  return shares.at(static_cast<std::size_t>(kind)) + plan_.ValueAt(static_cast<TimedFaultKind>(kind), time);
}

std::optional<Datagram> FaultyNetwork::Next() {
  for (;;) {
    if (!next_) next_ = source_();
    if (!following_.empty() && (!next_ || following_.front().time <= next_->time)) {
      Datagram datagram = std::move(following_.front());
      following_.pop_front();
      ++totals_.num_sent;
      return datagram;
    }
    if (!next_) {
      // Nothing came that could overtake it.
      if (overtaken_) ++totals_.num_sent;
      return std::exchange(overtaken_, std::nullopt);
    }
    Datagram datagram = *std::exchange(next_, std::nullopt);
    if (datagram.port != data_port_) return datagram;
    if (auto passed = Pass(std::move(datagram))) return passed;
  }
}

// @return the data packet, unless it is dropped or waits for the next
std::optional<Datagram> FaultyNetwork::Pass(Datagram datagram) {
  const std::int64_t packet_index = totals_.num_made++;
  const auto fault = Draw(datagram.time);
  if (overtaken_) {
    Report(FaultKind::kSwapped, overtaken_->time, packet_index - 1);
    ++totals_.num_swapped;
    overtaken_->time = datagram.time + kFrameTime;
    following_.push_back(*std::exchange(overtaken_, std::nullopt));
  } else if (fault == FaultKind::kDropped) {
    Report(FaultKind::kDropped, datagram.time, packet_index);
    ++totals_.num_dropped;
    return std::nullopt;
  } else if (fault == FaultKind::kDoubled) {
    Report(FaultKind::kDoubled, datagram.time, packet_index);
    ++totals_.num_doubled;
    following_.push_back({datagram.time + kFrameTime, datagram.port, datagram.payload});
  } else if (fault == FaultKind::kSwapped) {
    overtaken_ = std::move(datagram);
    return std::nullopt;
  }
  ++totals_.num_sent;
  return datagram;
}

// One number a packet, so that the fate of a packet does not depend on the fate of the packet before.
std::optional<FaultKind> FaultyNetwork::Draw(Utime time) {
  const double number = random_.Uniform();
  if (time < first_fault_ || time > last_fault_) return std::nullopt;
  double limit = 0.0;
  for (const auto kind : {FaultKind::kDropped, FaultKind::kDoubled, FaultKind::kSwapped}) {
    limit += Share(kind, time);
    if (number < limit) return kind;
  }
  return std::nullopt;
}

void FaultyNetwork::Report(FaultKind kind, Utime time, std::int64_t packet_index) {
  if (observer_) observer_({kind, time, packet_index});
}

}  // namespace lookout::sim
