#include "tools/eval/machine.hpp"

namespace lookout::eval {
namespace {

PacketTotals Sum(const PacketTotals& a, const lidar_clock_t& b) {
  return {a.num_packets + b.num_packets, a.num_lost + b.num_lost_packets, a.num_duplicate + b.num_duplicate_packets,
          a.num_reordered + b.num_reordered_packets};
}

}  // namespace

void Machine::Add(const health_t& message) {
  auto& process = processes[message.process];
  process.state = message.state;
  process.reason = message.reason;
  process.cpu_fraction.Add(message.cpu_fraction);
  process.resident_bytes = message.resident_bytes;
  for (const auto& channel : message.channels) {
    auto& entry = traffic[{message.process, {channel.is_input == 0, channel.channel}}];
    entry.num_messages = channel.num_messages;
    entry.num_undecodable = channel.num_undecodable;
    entry.num_lost = channel.num_lost;
    if (channel.handling_p50_us >= 0) entry.p50_us.Add(static_cast<double>(channel.handling_p50_us));
    if (channel.handling_p99_us >= 0) entry.p99_us.Add(static_cast<double>(channel.handling_p99_us));
  }
}

void Machine::Add(const lidar_clock_t& message) {
  if (last_clock && message.seq < last_clock->seq) earlier_runs_ = Sum(earlier_runs_, *last_clock);
  last_clock = message;
  (message.time_source == lidar_clock_t::TIME_SENSOR ? num_scans_by_sensor : num_scans_by_host) += 1;
}

PacketTotals Machine::Packets() const { return last_clock ? Sum(earlier_runs_, *last_clock) : earlier_runs_; }

}  // namespace lookout::eval
