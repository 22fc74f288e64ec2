#include "common/runtime/health.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <systemd/sd-daemon.h>
#include <utility>
#include <vector>

#include "common/bus/services.hpp"
#include "common/core/recently.hpp"
#include "common/runtime/process.hpp"

namespace lookout::runtime {

namespace {

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::int64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t total_pages = 0;
  std::int64_t resident_pages = 0;
  statm >> total_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

// A process that waits for its first input is starting, not ill, for so long.
constexpr std::chrono::seconds kStartTime(3);

// For so long HEALTH tells of losses.
constexpr std::chrono::seconds kLossTime(10);
constexpr std::size_t kMostLosses = 3;  // channels that are named

// Channels whose messages are parts of scans.
bool IsInParts(std::string_view channel) {
  constexpr std::array kInParts{bus::kLidarScan, bus::kSegments, bus::kObstacles, bus::kTracks};
  return std::ranges::find(kInParts, channel, &bus::Channel::name) != kInParts.end();
}

std::string SecondPublisherText(const std::string& channel, std::int64_t num_refused) {
  const auto* entry = bus::FindChannel(channel);
  return channel + " has two publishers: " + std::to_string(num_refused) +
         " messages of the second were refused; end one of them (lookout-top and lookout-doctor show every " +
         (entry != nullptr ? std::string(bus::PublisherName(*entry)) : "process") + " by host and pid), or give the other boat another LCM address";
}

// The value that a share `quantile` of the times does not exceed; -1 without times.
std::int64_t QuantileUs(const std::vector<std::chrono::microseconds>& sorted, double quantile) {
  if (sorted.empty()) return -1;
  const auto index = static_cast<std::size_t>(std::lround(quantile * static_cast<double>(sorted.size() - 1)));
  return sorted[index].count();
}

// In the order of the wire.
constexpr std::array kStateNames{"ok", "degraded", "failed", "starting"};
static_assert(health_t::STATE_OK == 0 && health_t::STATE_DEGRADED == 1 && health_t::STATE_FAILED == 2 && health_t::STATE_STARTING == 3);

}  // namespace

HealthReporter::HealthReporter(std::string process)
    : process_(std::move(process)), start_(std::chrono::steady_clock::now()), last_(start_), last_cpu_s_(CpuSeconds()) {}

void HealthReporter::Fill(Utime now, const HealthReport& report, health_t& message) {
  const auto uptime = std::chrono::steady_clock::now() - start_;
  message.utime_us = ToUtimeUs(now);
  message.seq = seq_++;
  message.process = process_;
  message.host = HostName();
  message.pid = getpid();
  message.uptime_s = ToSeconds(uptime);
  if (report.state == HealthState::kOk || uptime > kStartTime) is_started_ = true;
  message.state = static_cast<std::int32_t>(report.state);
  if (!is_started_ && report.state == HealthState::kDegraded) message.state = health_t::STATE_STARTING;
  message.reason = report.reason;
  if (!bus_text_.empty()) {
    if (message.state != health_t::STATE_FAILED) message.state = health_t::STATE_DEGRADED;
    message.reason += (message.reason.empty() ? "" : "; ") + bus_text_;
  }
  auto counters = report.counters;
  counters.push_back({"messages_not_sent", last_num_unsent_});
  counters.push_back({"second_publisher", last_num_refused_});
  if (last_num_dropped_) counters.push_back({"datagrams_dropped", *last_num_dropped_});
  message.counters.clear();
  for (const auto& [name, count] : counters) message.counters.push_back({std::string(name), count});
  message.num_counters = static_cast<std::int32_t>(message.counters.size());
}

// "17 of 100 scans of LIDAR_SCAN were lost ..." within the last kLossTime; empty where nothing was.
std::string HealthReporter::LossText(std::chrono::steady_clock::time_point now, bus::Bus& bus) {
  Inputs inputs{.time = now, .whole_and_lost = {}};
  for (const auto& [name, traffic] : bus.input_traffic()) inputs.whole_and_lost[name] = {traffic.scans.num_whole(), traffic.scans.num_lost()};
  inputs_.push_back(std::move(inputs));
  while (inputs_.size() > 2 && now - inputs_[1].time >= kLossTime) inputs_.pop_front();
  struct Loss {
    std::string_view name;
    std::int64_t num_lost;
    std::int64_t number;  // of those that should have come
  };
  std::vector<Loss> losses;
  for (const auto& [name, counts] : inputs_.back().whole_and_lost) {
    const auto found = inputs_.front().whole_and_lost.find(name);
    const auto before = found == inputs_.front().whole_and_lost.end() ? std::pair<std::int64_t, std::int64_t>() : found->second;
    const auto num_lost = counts.second - before.second;
    if (num_lost > 0) losses.push_back({name, num_lost, counts.first - before.first + num_lost});
  }
  if (losses.empty()) return {};
  // The costliest losses first: scans, then by share. All of them would hide other reasons.
  std::ranges::stable_sort(losses, {}, [](const Loss& loss) {
    return std::pair(!IsInParts(loss.name), -static_cast<double>(loss.num_lost) / static_cast<double>(loss.number));
  });
  const auto seconds = std::chrono::round<std::chrono::seconds>(now - inputs_.front().time).count();
  std::string text = "lost on the bus in the last " + std::to_string(seconds) + " s:";
  for (std::size_t i = 0; i < std::min(losses.size(), kMostLosses); ++i) {
    const auto& [name, num_lost, number] = losses[i];
    text += std::string(i == 0 ? " " : ", ") + std::to_string(num_lost) + " of " + std::to_string(number) +
            (IsInParts(name) ? " scans of " : " messages of ") + std::string(name);
  }
  if (losses.size() > kMostLosses) text += " and on " + std::to_string(losses.size() - kMostLosses) + " more";
  return text + " (receive buffers too small, or this computer too busy: lookout-doctor tells)";
}

health_t HealthReporter::MakeBetween(Utime now, const HealthReport& report) {
  health_t message = last_message_;
  Fill(now, report, message);
  return message;
}

health_t HealthReporter::Make(Utime now, const HealthReport& report, bus::Bus& bus) {
  const auto steady_now = std::chrono::steady_clock::now();
  const double cpu_s = CpuSeconds();
  health_t message{};
  const auto num_unsent = bus.num_unsent() - std::exchange(last_num_unsent_, bus.num_unsent());
  bus_text_ = num_unsent > 0 ? std::to_string(num_unsent) + " messages could not be sent" : std::string();
  if (const auto text = LossText(steady_now, bus); !text.empty()) bus_text_ += (bus_text_.empty() ? "" : "; ") + text;
  last_num_refused_ = 0;
  for (const auto& [name, traffic] : bus.input_traffic()) {
    last_num_refused_ += traffic.num_refused;
    if (!traffic.second_heard || bus.GuardNow() - *traffic.second_heard >= Recently::kToldFor) continue;
    bus_text_ += (bus_text_.empty() ? "" : "; ") + SecondPublisherText(name, traffic.num_refused);
  }
  last_num_dropped_ = bus.NumDatagramsDropped();
  if (const auto fault = bus.GuardFault(); !fault.empty()) {
    bus_text_ += (bus_text_.empty() ? "" : "; ") + ("one datagram to the bus can end this process: " + fault);
  }
  Fill(now, report, message);
  message.interval_s = ToSeconds(steady_now - last_);
  message.cpu_fraction = message.interval_s > 0.0 ? (cpu_s - last_cpu_s_) / message.interval_s : 0.0;
  message.resident_bytes = ResidentBytes();

  const auto add_channel = [&](const std::string& name, const bus::ChannelTraffic& traffic, bool is_input) {
    health_channel_t channel{};
    channel.channel = name;
    channel.is_input = is_input ? 1 : 0;
    channel.num_messages = traffic.num_messages;
    channel.num_undecodable = traffic.num_undecodable;
    channel.num_lost = traffic.num_lost;
    auto& last_count = last_counts_[(is_input ? "in " : "out ") + name];
    if (message.interval_s > 0.0) channel.rate_hz = static_cast<double>(traffic.num_messages - last_count) / message.interval_s;
    last_count = traffic.num_messages;
    channel.queue_depth = is_input ? bus.QueueDepth(name) : -1;
    const auto* entry = bus::FindChannel(name);
    channel.queue_limit = is_input && entry != nullptr ? entry->queue_depth : 0;
    std::vector<std::chrono::microseconds> times(traffic.handling_times.begin(), traffic.handling_times.end());
    std::ranges::sort(times);
    channel.handling_p50_us = QuantileUs(times, 0.50);
    channel.handling_p99_us = QuantileUs(times, 0.99);
    std::vector<std::chrono::microseconds> latencies;
    for (const auto& sent : traffic.sent) {
      // Subtracted as unsigned: a time out of a corrupt message must not overflow.
      const auto utime_us = static_cast<std::uint64_t>(ToUtimeUs(now)) - static_cast<std::uint64_t>(sent.utime_us);
      latencies.push_back(std::chrono::microseconds(static_cast<std::int64_t>(utime_us)) -
                          std::chrono::duration_cast<std::chrono::microseconds>(steady_now - sent.time));
    }
    std::ranges::sort(latencies);
    channel.latency_p50_us = QuantileUs(latencies, 0.50);
    channel.latency_p99_us = QuantileUs(latencies, 0.99);
    message.channels.push_back(channel);
  };
  for (auto& [name, traffic] : bus.input_traffic()) {
    add_channel(name, traffic, true);
    traffic.handling_times.clear();
  }
  for (auto& [name, traffic] : bus.output_traffic()) {
    add_channel(name, traffic, false);
    traffic.sent.clear();
  }
  message.num_channels = static_cast<std::int32_t>(message.channels.size());

  last_ = steady_now;
  last_cpu_s_ = cpu_s;
  last_message_ = message;
  return message;
}

// sd_notify opens the socket anew each time; a message that nobody reads is no reason to end a look-out.
void NotifyReady() { sd_notify(0, "READY=1\nSTATUS=started"); }

void NotifyAlive(const health_t& health) {
  std::string reason = health.reason;
  std::ranges::replace(reason, '\n', ' ');  // a line is an assignment of its own
  const auto* const state = kStateNames.at(static_cast<std::size_t>(health.state));
  const std::string message = std::string("WATCHDOG=1\nSTATUS=") + state + (reason.empty() ? "" : ": ") + reason;
  sd_notify(0, message.c_str());
}

}  // namespace lookout::runtime
