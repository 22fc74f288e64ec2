// All processes live with the default config, a simulated boat at 10 scans a second: how late are the obstacles, and what do they cost? Run by
// ./dev bench live in a network namespace; tools/replay/README.md says what is measured. Exit code 1 when a target is missed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/datagram_filter.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/guarded_bind.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/sequence.hpp"
#include "common/bus/services.hpp"
#include "common/core/angles.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace lookout;
using namespace lookout::support;
namespace fs = std::filesystem;

const std::vector<std::string> kServices = bus::StartOrder();

// Targets of the suite, on the boat's computer.
constexpr double kMaxLatencyMs = 10.0;
constexpr double kMaxCpuPercent = 20.0;
constexpr double kMaxMegabytes = 64.0;
// The longest memory in the suite is the georeferencer's: poses of 120 s. From then on a process keeps its size, but for crumbs of the heap. A leak
// of 10 kB a turn is 17 MB in the rest of five minutes.
constexpr int kSettlingSeconds = 130;
constexpr double kMaxGrowthMegabytes = 1.0;

struct ProcessCost {
  double cpu_s = 0.0;
  double resident_megabytes = 0.0;
  double peak_megabytes = 0.0;
};

// proc(5): utime and stime are the 14th and 15th word of stat; the second is a name in brackets.
ProcessCost CostOf(int pid) {
  ProcessCost cost;
  const std::string folder = "/proc/" + std::to_string(pid);
  std::ifstream stat(folder + "/stat");
  std::string text;
  std::getline(stat, text);
  std::istringstream words(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string word;
  for (int i = 3; i < 14; ++i) words >> word;
  double user_ticks = 0.0;
  double system_ticks = 0.0;
  words >> user_ticks >> system_ticks;
  cost.cpu_s = (user_ticks + system_ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
  constexpr double kMegabytesPerKibibyte = 1024.0 / 1e6;
  std::ifstream status(folder + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) cost.resident_megabytes = std::stod(line.substr(6)) * kMegabytesPerKibibyte;
    if (line.rfind("VmHWM:", 0) == 0) cost.peak_megabytes = std::stod(line.substr(6)) * kMegabytesPerKibibyte;
  }
  return cost;
}

// When tracks that were known before come into the guard zone, and when ALERTS tell of them.
class Entries {
 public:
  void Take(const tracks_t& message, const alerts_t& limits) {
    if (limits.guard_zone_range_m <= 0.0F) return;
    const double width_rad = WrapTo2Pi(double{limits.guard_zone_to_rad} - double{limits.guard_zone_from_rad});
    for (const auto& track : message.tracks) {
      if (track.status != track_t::STATUS_CONFIRMED) continue;
      const double off_rad = WrapTo2Pi(double{track.bearing_rad} - double{limits.guard_zone_from_rad});
      const bool is_inside = track.range_m <= limits.guard_zone_range_m && (width_rad == 0.0 || off_rad <= width_rad);
      auto& known = tracks_.try_emplace(track.id, Known{is_inside, is_inside}).first->second;
      const bool is_known = message.utime_us - track.first_utime_us >= kKnownUs && !known.was_inside;
      if (is_inside && is_known) waiting_[track.id] = {message.utime_us, known.is_told};
      if (is_inside) known.was_inside = true;
    }
  }
  // @param sent_us  when the message was on the bus
  // @param last_us  of each scan, by its utime_us: its last packet
  void Take(const alerts_t& message, std::int64_t sent_us, const std::map<std::int64_t, std::int64_t>& last_us) {
    for (auto& [id, known] : tracks_) known.is_told = false;
    for (const auto& alert : message.alerts) {
      if (alert.state != alert_t::STATE_ACTIVE && alert.state != alert_t::STATE_ACKNOWLEDGED) continue;
      if (const auto known = tracks_.find(alert.track_id); known != tracks_.end()) known->second.is_told = true;
      const auto entry = waiting_.find(alert.track_id);
      if (entry == waiting_.end()) continue;
      const auto last = last_us.find(entry->second.scan_us);
      constexpr double kMsPerUs = 1e-3;
      if (last != last_us.end()) (entry->second.was_told ? known_ms : anew_ms).push_back(kMsPerUs * static_cast<double>(sent_us - last->second));
      waiting_.erase(entry);
    }
    num_untold += static_cast<int>(std::erase_if(waiting_, [&](const auto& item) { return message.utime_us - item.second.scan_us > kMostUs; }));
  }

  std::vector<double> known_ms;  // of things that had an alert before: with the scan of the entry
  std::vector<double> anew_ms;   // of things that had none: 3 scans of 5 must say so
  int num_untold = 0;            // within 2 s: they are told as parts of a thing of which another place is nearer

 private:
  static constexpr std::int64_t kKnownUs = 1'000'000;
  static constexpr std::int64_t kMostUs = 2'000'000;
  struct Known {
    bool was_inside = false;
    bool is_told = false;
  };
  struct Entry {
    std::int64_t scan_us = 0;
    bool was_told = false;
  };
  std::map<std::int64_t, Known> tracks_;
  std::map<std::int64_t, Entry> waiting_;
};

// Times of what went over the bus, by the kernel's receive stamps; those of this computer for all processes.
class Listener {
 public:
  Listener() : lcm_(Url()) {
    // LCM opens its socket with the first subscription: as the processes do, with a filter.
    const auto multicast = bus::ParseMulticast(Url());
    std::optional<bus::BindGuard> guard;
    if (multicast) guard.emplace(bus::DatagramFilter(*multicast));
    Subscribe(bus::kLidarPackets, &Listener::OnPackets);
    Subscribe(bus::kPose, &Listener::OnPose);
    Subscribe(bus::kObstacles, &Listener::OnObstacles);
    Subscribe(bus::kTracks, &Listener::OnTracks);
    Subscribe(bus::kAlerts, &Listener::OnAlerts);
    Subscribe(bus::kHealth, &Listener::OnHealth);
  }

  void HandleFor(std::chrono::milliseconds timeout) { lcm_.handleTimeout(static_cast<int>(timeout.count())); }

  std::vector<double> beyond_pose_ms;  // from the later of last packet and POSE to OBSTACLES
  std::vector<double> from_packet_ms;  // from the last packet to OBSTACLES
  std::vector<double> alerts_ms;       // from the last packet to ALERTS
  Entries entries;
  std::map<std::string, health_t> health;
  std::int64_t num_lost = 0;  // by this listener: times of those turns are missing
  std::int64_t num_turns = 0;
  std::int64_t num_timeouts = 0;  // turns that went out without waiting for POSE

 private:
  using Handler = void (Listener::*)(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  static std::string Url() {
    const auto url = bus::DefaultLcmUrl();
    return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=4194304";
  }
  void Subscribe(const bus::Channel& channel, Handler handler) {
    lcm_.subscribe(std::string(channel.name), handler, this)->setQueueCapacity(channel.queue_depth);
  }
  template <typename T>
  static T Decoded(const lcm::ReceiveBuffer* buffer) {
    return bus::Decode<T>(Bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size)).value_or(T{});
  }

  void OnPackets(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const auto message = Decoded<lidar_packets_t>(buffer);
    num_lost += packet_sequence_.NumLostBefore(message.seq);
    if (!message.host_utime_us.empty()) last_packet_us_[message.seq] = message.host_utime_us.back();
    while (last_packet_us_.size() > kKept) last_packet_us_.erase(last_packet_us_.begin());
  }
  void OnPose(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const auto message = Decoded<pose_t>(buffer);
    num_lost += pose_sequence_.NumLostBefore(message.seq);
    pose_sent_us_[message.utime_us] = buffer->recv_utime;
    while (pose_sent_us_.size() > kKept) pose_sent_us_.erase(pose_sent_us_.begin());
  }
  // LCM hands messages over in the order in which they came: what a turn waited for is here before its obstacles.
  void OnObstacles(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const auto message = Decoded<obstacles_t>(buffer);
    num_lost += obstacles_sequence_.NumLostBefore(message.seq, message.part_index, message.num_parts);
    if (message.part_index + 1 < message.num_parts) return;
    ++num_turns;
    const auto is_late = [](const obstacle_t& one) { return one.status == obstacle_t::STATUS_POSE_TIMEOUT; };
    num_timeouts += std::ranges::any_of(message.obstacles, is_late) ? 1 : 0;
    const auto packet = last_packet_us_.find(message.raw_seq);
    const auto pose = pose_sent_us_.lower_bound(message.end_utime_us);
    if (packet == last_packet_us_.end() || pose == pose_sent_us_.end()) return;
    constexpr double kMsPerUs = 1e-3;
    from_packet_ms.push_back(kMsPerUs * static_cast<double>(buffer->recv_utime - packet->second));
    beyond_pose_ms.push_back(kMsPerUs * static_cast<double>(buffer->recv_utime - std::max(packet->second, pose->second)));
  }
  void OnTracks(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) { entries.Take(Decoded<tracks_t>(buffer), limits_); }
  void OnAlerts(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const auto message = Decoded<alerts_t>(buffer);
    const auto packet = last_packet_us_.find(message.raw_seq);
    if (message.is_watch != 0 || packet == last_packet_us_.end()) return;
    constexpr double kMsPerUs = 1e-3;
    alerts_ms.push_back(kMsPerUs * static_cast<double>(buffer->recv_utime - packet->second));
    scan_end_us_[message.utime_us] = packet->second;
    while (scan_end_us_.size() > kKept) scan_end_us_.erase(scan_end_us_.begin());
    entries.Take(message, buffer->recv_utime, scan_end_us_);
    limits_ = message;
  }
  void OnHealth(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const auto message = Decoded<health_t>(buffer);
    health[message.process] = message;
  }

  static constexpr std::size_t kKept = 2000;
  lcm::LCM lcm_;
  std::map<std::int64_t, std::int64_t> last_packet_us_;  // by seq of LIDAR_PACKETS: a bundle ends with the packet that ends the turn
  std::map<std::int64_t, std::int64_t> pose_sent_us_;    // by time of the pose
  std::map<std::int64_t, std::int64_t> scan_end_us_;     // last packet, by utime_us of the scan
  alerts_t limits_{};                                    // as told last
  bus::SequenceWatch packet_sequence_;
  bus::SequenceWatch pose_sequence_;
  bus::SequenceWatch obstacles_sequence_;
};

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

// What the processes count as lost, in words.
std::vector<std::string> Losses(const Listener& listener) {
  std::vector<std::string> losses;
  for (const auto& [process, health] : listener.health) {
    for (const auto& channel : health.channels) {
      const auto count = channel.num_lost + channel.num_undecodable;
      if (count > 0) losses.push_back(process + ": " + std::to_string(count) + " of " + channel.channel);
    }
    for (const auto& counter : health.counters) {
      const bool is_loss = counter.name == "messages_not_sent" || counter.name == "data_lost" || counter.name.ends_with("_kernel_drops");
      if (is_loss && counter.count > 0) losses.push_back(process + ": " + counter.name + " " + std::to_string(counter.count));
    }
  }
  if (listener.num_timeouts > 0) losses.push_back(std::to_string(listener.num_timeouts) + " turns went out without their POSE");
  return losses;
}

// Prints a value beside its target. @return whether it is met
bool Judge(const char* what, double value, double target, const char* unit) {
  const bool is_met = value <= target;
  std::printf("%-58s %8.2f %s, at most %.0f: %s\n", what, value, unit, target, is_met ? "met" : "MISSED");
  return is_met;
}

class Run {
 public:
  Run(const fs::path& folder, std::string scene, int num_seconds) : folder_(folder), scene_(std::move(scene)), num_seconds_(num_seconds) {
    fs::create_directories(folder);
    fs::copy(kDemoConfig, folder / "config");
    fs::current_path(folder);  // the recorder's logs/ is made here
  }

  bool IsGood() {
    for (const auto& service : kServices) Start(service, {"--config", "config"});
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (listener_.health.size() < kServices.size() && std::chrono::steady_clock::now() < deadline) Handle();
    if (listener_.health.size() < kServices.size()) {
      std::fprintf(stderr, "not every process reports\n");
      return false;
    }
    Start("sim", {"--config", "config", "--scene", scene_, "--seed", "1", "--seconds", std::to_string(num_seconds_), "--udp", "127.0.0.1"});
    const auto start = std::chrono::steady_clock::now();
    const auto settled = start + std::chrono::seconds(std::min(kSettlingSeconds, num_seconds_ / 2));
    while (std::chrono::steady_clock::now() < settled) Handle();
    const auto before = Costs();
    const auto counted_from = std::chrono::steady_clock::now();
    while (children_["sim"]->IsRunning()) Handle();
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - counted_from).count();
    const auto after = Costs();
    const auto last_report = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (std::chrono::steady_clock::now() < last_report) Handle();
    for (const auto& service : kServices) children_[service]->Terminate();
    return Print(before, after, elapsed_s);
  }

 private:
  using CostOfProcess = std::map<std::string, ProcessCost>;

  void Start(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), Bin(name));
    children_[name] = std::make_unique<Child>(arguments, name + ".out");
  }
  void Handle() { listener_.HandleFor(std::chrono::milliseconds(20)); }
  CostOfProcess Costs() const {
    CostOfProcess costs;
    for (const auto& service : kServices) costs[service] = CostOf(children_.at(service)->pid());
    return costs;
  }

  bool Print(const CostOfProcess& before, const CostOfProcess& after, double elapsed_s) const {
    std::printf("%d s of the scene '%s', %lld turns; cpu and growth over the last %.0f s\n", num_seconds_, scene_.c_str(),
                static_cast<long long>(listener_.num_turns), elapsed_s);
    std::printf("%-14s %8s %12s %10s %10s\n", "process", "cpu %", "resident MB", "peak MB", "growth MB");
    double total_percent = 0.0;
    double most_megabytes = 0.0;
    double most_growth_megabytes = 0.0;
    for (const auto& service : kServices) {
      const auto& end = after.at(service);
      const double percent = 100.0 * (end.cpu_s - before.at(service).cpu_s) / elapsed_s;
      const double growth_megabytes = end.resident_megabytes - before.at(service).resident_megabytes;
      std::printf("%-14s %8.2f %12.1f %10.1f %10.2f\n", service.c_str(), percent, end.resident_megabytes, end.peak_megabytes, growth_megabytes);
      total_percent += percent;
      most_megabytes = std::max(most_megabytes, end.peak_megabytes);
      most_growth_megabytes = std::max(most_growth_megabytes, growth_megabytes);
    }
    std::printf("OBSTACLES after the last packet of the turn: p50 %.2f ms, p99 %.2f ms (with the wait for POSE)\n",
                Quantile(listener_.from_packet_ms, 0.5), Quantile(listener_.from_packet_ms, 0.99));
    std::printf("OBSTACLES beyond the wait for POSE: p50 %.2f ms, greatest %.2f ms, %zu turns measured\n", Quantile(listener_.beyond_pose_ms, 0.5),
                Quantile(listener_.beyond_pose_ms, 1.0), listener_.beyond_pose_ms.size());
    PrintAlerts();
    bool is_good = Judge("OBSTACLES beyond the wait for POSE, p99", Quantile(listener_.beyond_pose_ms, 0.99), kMaxLatencyMs, "ms");
    is_good &= Judge("cpu of all processes together", total_percent, kMaxCpuPercent, "% of one core");
    is_good &= Judge("memory of the largest process, peak", most_megabytes, kMaxMegabytes, "MB");
    is_good &= Judge("growth of any process", most_growth_megabytes, kMaxGrowthMegabytes, "MB");
    const auto losses = Losses(listener_);
    is_good &= Judge("kinds of loss that any process counts", static_cast<double>(losses.size()), 0.0, "");
    for (const auto& loss : losses) std::printf("  %s\n", loss.c_str());
    const bool is_whole = listener_.num_turns >= 10 * num_seconds_ - 2;
    if (!is_whole) std::printf("turns are missing\n");
    if (listener_.num_lost > 0) std::printf("this listener itself lost %lld messages\n", static_cast<long long>(listener_.num_lost));
    return is_good && is_whole;
  }

  void PrintAlerts() const {
    const auto print = [](const char* what, const std::vector<double>& values_ms) {
      std::printf("%s: p50 %.1f ms, p99 %.1f ms, greatest %.1f ms, %zu\n", what, Quantile(values_ms, 0.5), Quantile(values_ms, 0.99),
                  Quantile(values_ms, 1.0), values_ms.size());
    };
    const auto& entries = listener_.entries;
    print("ALERTS after the last packet of the scan", listener_.alerts_ms);
    print("entries into the guard zone, of what had an alert, to ALERTS", entries.known_ms);
    print("entries of what had none", entries.anew_ms);
    std::printf("entries told as parts of a thing that is nearer elsewhere: %d\n", entries.num_untold);
  }

  fs::path folder_;
  std::string scene_;
  int num_seconds_;
  Listener listener_;
  std::map<std::string, std::unique_ptr<Child>> children_;
};

}  // namespace

int main(int argc, char** argv) {
  int seconds = 300;
  std::string scene = "lake";
  CLI::App app("Runs all processes live on a simulated boat and measures latency, cpu, memory and losses.");
  app.add_option("--seconds", seconds, "length")->check(CLI::Range(2, 86400))->capture_default_str();
  app.add_option("--scene", scene, "of config/scenes")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto start_folder = fs::current_path();
  const auto folder = fs::temp_directory_path() / ("lookout_live_load_" + std::to_string(getpid()));
  const bool is_good = Run(folder, scene, seconds).IsGood();
  fs::current_path(start_folder);
  fs::remove_all(folder);
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}
