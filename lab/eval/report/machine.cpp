#include "lab/eval/report/machine.hpp"

namespace lookout::eval {

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
  const bool is_new_run = !last_clock_ || message.seq < last_clock_->seq;
  const lidar_clock_t before = is_new_run ? lidar_clock_t{} : *last_clock_;
  packets.num_packets += message.num_packets - before.num_packets;
  packets.num_lost += message.num_lost_packets - before.num_lost_packets;
  packets.num_duplicate += message.num_duplicate_packets - before.num_duplicate_packets;
  packets.num_reordered += message.num_reordered_packets - before.num_reordered_packets;
  last_clock_ = message;
  (message.time_source == lidar_clock_t::TIME_SENSOR ? num_scans_by_sensor : num_scans_by_host) += 1;
}

}  // namespace lookout::eval
