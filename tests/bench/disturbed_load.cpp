// All processes live under lookout-up on a simulated boat while everything that may happen at sea happens: sensors and processes stand still, another
// lidar sends to the same ports, datagrams come that no LCM would send, another boat is on the bus, and each process is killed once a minute. Judged
// beside the truth. Run by ./dev bench live SECONDS --disturb in a network namespace; tools/replay/README.md says what is judged. Exit code 1 when a
// target is missed. Latency is not judged: that is the other mode.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/health_t.hpp"
#include "tests/bench/disturbances.hpp"
#include "tests/bench/truth_beside.hpp"
#include "tests/system/child.hpp"
#include "tools/sim/scene_file.hpp"

namespace {

using namespace lookout;
using namespace lookout::bench;
using system_test::Child;
using system_test::RunProgram;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::vector<std::string> kServices{"recorder", "georeferencer", "segmenter", "navigator", "vlp16"};

// An obstacle is wrong when a corner of its outline lies farther than this from all that is there: so many stated deviations, and what the outline
// itself may be off by: noise of the range, time within a scan, what rocks.
constexpr double kMaxDeviations = 4.0;
constexpr double kOutlineM = 0.5;
// The guard zone of this run, all round, and what must be within it for certain to be missed.
constexpr double kZoneM = 10.0;
constexpr double kSurelyInZoneM = 8.5;
// HEALTH that says OK when something has been in the zone for so long is a silent alarm.
constexpr milliseconds kAlarmDelay{2000};
constexpr seconds kMostUntilBack{10};
// Memory of a life of six minutes or more: from the fourth minute to its last.
constexpr double kLeastLifeS = 360.0;
constexpr double kSettledS = 180.0;
constexpr double kWindowS = 60.0;
constexpr double kMaxGrowthPercent = 1.0;
constexpr double kMinuteS = 60.0;

Utime HostNow() { return std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now()); }

double ResidentMegabytes(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) * 1024.0 / 1e6;
  }
  return 0.0;
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// One process id of a service, from its first HEALTH on.
struct Life {
  int pid = 0;
  Clock::time_point begin;
  bool is_killed = false;                         // by us
  std::vector<std::pair<double, double>> memory;  // age in s, MB
};

struct Figures {
  std::int64_t num_scans = 0;
  std::int64_t num_judged = 0;
  std::int64_t num_wrong = 0;
  std::int64_t num_unplaced = 0;
  double worst_m = 0.0;                                              // corner from the truth
  double worst_excess_m = -std::numeric_limits<double>::infinity();  // over what is tolerated
  std::map<std::string, std::int64_t> wrong_by_disturbance;
  std::int64_t num_health_in_zone = 0;
  std::int64_t num_told = 0;
  std::int64_t num_silent = 0;
  std::int64_t num_alarms_without = 0;
  double in_zone_s = 0.0;
  double longest_without_scan_s = 0.0;
  std::map<std::string, std::int64_t> num_kills;
  std::map<std::string, double> worst_back_s;
  std::map<std::string, std::int64_t> num_degraded;
  std::map<std::string, std::int64_t> num_reports;
  std::vector<std::string> unexpected_ends;
  std::vector<std::string> not_back;
  std::map<std::string, std::int64_t> num_disturbances;
  std::int64_t num_hostile = 0;
};

struct Options {
  int seconds = 600;
  std::uint64_t seed = 1;
  fs::path bin_folder = LOOKOUT_BIN_DIR;
  bool is_undisturbed = false;
  bool keeps_folder = false;
};

class DisturbedRun {
 public:
  DisturbedRun(fs::path folder, fs::path program, const Options& options)
      : folder_(std::move(folder)), program_(std::move(program)), options_(options), random_(options.seed) {
    MakeConfig();
    fs::current_path(folder_);  // the recorder's logs/ is made here
    LayCable();
  }
  ~DisturbedRun() {
    foreign_.reset();
    other_boat_.clear();
    if (up_) {
      up_->Signal(SIGINT);
      up_->Wait(seconds(40));
    }
    sim_.reset();
    second_.reset();
  }
  DisturbedRun(const DisturbedRun&) = delete;
  DisturbedRun& operator=(const DisturbedRun&) = delete;

  bool IsGood() {
    up_ = std::make_unique<Child>(std::vector<std::string>{(options_.bin_folder / "lookout-up").string(), "--config", "config", "--log", "printed"},
                                  "up.out");
    const auto deadline = Clock::now() + seconds(120);
    while (lives_.size() < kServices.size() && Clock::now() < deadline) RunFor(milliseconds(100));
    if (lives_.size() < kServices.size()) {
      std::printf("not all processes start:\n%s", up_->Output().c_str());
      return false;
    }
    StartSimulator();
    begin_ = Clock::now();
    RunFor(seconds(10));
    is_judged_ = true;
    for (minute_ = 0; SecondsRun() < options_.seconds; ++minute_) {
      OneMinute();
      PrintMinute();
      RemoveOldLogs();
    }
    Mark("the end", milliseconds(0));
    RunFor(seconds(12));  // who was killed last comes back
    JudgeReturns();
    for (auto& [service, lives] : lives_) KeepMemory(service, lives);
    return Print();
  }

 private:
  double SecondsRun() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  int Below(int limit) { return static_cast<int>(random_() % static_cast<std::uint64_t>(limit)); }
  milliseconds Between(int from_ms, int to_ms) { return milliseconds(from_ms + Below(to_ms - from_ms)); }

  void MakeConfig() const {
    fs::create_directories(folder_);
    const auto demo = fs::path(LOOKOUT_SOURCE_DIR) / "config/demo";
    fs::copy(demo, folder_ / "config");
    std::ofstream(folder_ / "config/georeferencer.txtpb") << "pose_timeout_s: 0.5\nmounting_sd_deg: 0\nguard_zone { range_m: " << kZoneM << " }\n";
    // Another boat, 41 km to the north, with ports of its own.
    fs::copy(demo, folder_ / "other");
    std::ofstream(folder_ / "other/boat.txtpb", std::ios::app) << "\ndatum { latitude_deg: 44.0 longitude_deg: -72.15 ellipsoid_height_m: 201 }\n";
    std::ofstream(folder_ / "other/navigator.txtpb", std::ios::app) << "\nnmea_port: 11110\n";
    std::ofstream(folder_ / "other/vlp16.txtpb", std::ios::app) << "\ndata_port: 12368\nposition_port: 18308\n";
  }

  // A computer at the other end of a cable.
  void LayCable() {
    second_ = std::make_unique<Child>(std::vector<std::string>{"unshare", "--net", "sleep", "100000"}, "second.out");
    const auto theirs = "/proc/" + std::to_string(second_->pid()) + "/ns/net";
    std::error_code error;
    for (int i = 0; i < 1000 && fs::read_symlink("/proc/self/ns/net", error) == fs::read_symlink(theirs, error); ++i) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    const auto pid = std::to_string(second_->pid());
    const auto ip = [&](const std::string& words, bool is_there = false) {
      const std::string command = (is_there ? "nsenter --net --target " + pid + " -- ip " : "ip ") + words;
      if (RunProgram({"sh", "-c", command}, "ip.out").exit_code != 0) throw std::runtime_error("no cable to the second computer: " + command);
    };
    ip("link add cable1 type veth peer name cable2 netns " + pid);
    ip("addr add 10.76.0.1/24 broadcast 10.76.0.255 dev cable1");
    ip("link set cable1 up");
    ip("addr add 10.76.0.2/24 broadcast 10.76.0.255 dev cable2", true);
    ip("link set cable2 up", true);
    ip("route add 239.255.76.0/24 dev cable2", true);
  }

  void StartSimulator() {
    const auto scene_file = fs::path(LOOKOUT_SOURCE_DIR) / "tests/bench/round_trip.txtpb";
    sim_ = std::make_unique<Child>(
        std::vector<std::string>{LOOKOUT_BIN_DIR "/lookout-sim", "--config", "config", "--scene", scene_file.string(), "--seed",
                                 std::to_string(options_.seed), "--seconds", std::to_string(options_.seconds + 120), "--udp", "127.0.0.1"},
        "sim.out");
    const std::string mark = "begins at utime_us ";
    std::string output;
    for (int i = 0; i < 3000 && output.find(mark) == std::string::npos; ++i) {
      RunFor(milliseconds(10));
      output = sim_->Output();
    }
    const auto place = output.find(mark);
    if (place == std::string::npos) throw std::runtime_error("the simulator does not start: " + output);
    start_ = Utime(std::chrono::microseconds(std::stoll(output.substr(place + mark.size()))));
    truth_.emplace(sim::LoadScene(scene_file, options_.seed), config::LoadBoat("config"), start_);
  }

  // The schedule. Foreign packets end before anything is killed: a lidar that starts while two send takes the first.
  void OneMinute() {
    const auto begin_s = kMinuteS * minute_ + 10.0;
    if (options_.is_undisturbed) return RunUntil(begin_s + kMinuteS);
    RunUntil(begin_s + 1.0);
    Stall("sensors stand still", sim_->pid(), Between(200, 3000));
    RunUntil(begin_s + 7.0);
    const auto& sleeper = kServices[static_cast<std::size_t>(Below(static_cast<int>(kServices.size())))];
    Stall(sleeper + " stands still", PidOf(sleeper), Between(200, 3000));
    for (const double per_s : {60.0, 754.0}) {
      RunUntil(begin_s + (per_s < 100.0 ? 13.0 : 19.0));
      const auto duration = Between(2000, 5000);
      Mark("foreign packets, " + std::to_string(static_cast<int>(per_s)) + " a second", duration);
      foreign_ = std::make_unique<ForeignLidar>(per_s);
      RunFor(duration);
      foreign_.reset();
    }
    RunUntil(begin_s + 26.0);
    Mark("hostile datagrams from within", milliseconds(1000));
    num_hostile_inside_ += inside_.Send(200, tap_.samples());
    RunUntil(begin_s + 29.0);
    HostileFromOutside();
    RunUntil(begin_s + 32.0);
    OtherBoat(Between(3000, 5000));
    auto victims = kServices;
    std::ranges::shuffle(victims, random_);
    for (std::size_t i = 0; i < victims.size(); ++i) {
      RunUntil(begin_s + 40.0 + 4.0 * static_cast<double>(i));
      if (victims[i] != Spared()) Kill(victims[i]);
    }
    RunUntil(begin_s + kMinuteS);
  }

  // Of a long run a fifth each: so that there are lives in which memory can grow.
  std::string Spared() const {
    const double stretch_s = options_.seconds / static_cast<double>(kServices.size());
    if (stretch_s < kLeastLifeS + kMinuteS) return {};
    return kServices[std::min(kServices.size() - 1, static_cast<std::size_t>(kMinuteS * minute_ / stretch_s))];
  }

  void Stall(const std::string& name, int pid, milliseconds duration) {
    Mark(name, duration);
    kill(pid, SIGSTOP);
    RunFor(duration);
    kill(pid, SIGCONT);
  }

  void Kill(const std::string& service) {
    Mark("kill of " + service, seconds(2));
    auto& life = lives_[service].back();
    life.is_killed = true;
    ++figures_.num_kills[service];
    killed_[service] = Clock::now();
    kill(life.pid, SIGKILL);
  }

  void HostileFromOutside() {
    Mark("hostile datagrams from outside", seconds(1));
    std::ofstream samples("samples", std::ios::binary);
    for (const auto& sample : tap_.samples()) {
      const auto size = static_cast<std::uint32_t>(sample.size());
      samples.write(reinterpret_cast<const char*>(&size), sizeof size);
      samples.write(reinterpret_cast<const char*>(sample.data()), static_cast<std::streamsize>(size));
    }
    samples.close();
    const auto sender =
        std::make_unique<Child>(std::vector<std::string>{"nsenter", "--net", "--target", std::to_string(second_->pid()), "--", program_.string(),
                                                         "--send-hostile", "samples", "--seed", std::to_string(random_() % 1'000'000)},
                                "hostile.out");
    RunFor(milliseconds(500));
    while (sender->IsRunning()) RunFor(milliseconds(50));
    figures_.num_hostile += std::atoll(sender->Output().c_str());
  }

  void OtherBoat(milliseconds duration) {
    Mark("another boat on the bus", duration);
    const auto start = [&](const std::string& name, std::vector<std::string> words) {
      words.insert(words.begin(), {LOOKOUT_BIN_DIR "/lookout-" + name, "--config", "other"});
      other_boat_.push_back(std::make_unique<Child>(words, "other_" + name + ".out"));
      others_.insert(other_boat_.back()->pid());
    };
    start("navigator", {});
    start("vlp16", {});
    start("sim", {"--scene", "crossing", "--seed", "7", "--seconds", "60", "--udp", "127.0.0.1"});
    RunFor(duration);
    for (auto& child : other_boat_) child->Signal(SIGTERM);
    const auto deadline = Clock::now() + seconds(3);
    while (std::ranges::any_of(other_boat_, [](const auto& child) { return child->IsRunning(); }) && Clock::now() < deadline)
      RunFor(milliseconds(20));
    other_boat_.clear();
  }

  void Mark(const std::string& name, milliseconds duration) {
    ++figures_.num_disturbances[name];
    last_disturbance_ = name;
    last_disturbance_end_ = Clock::now() + duration;
    num_printed_ = 0;
  }
  std::string Now() const {
    const double since_s = std::chrono::duration<double>(Clock::now() - last_disturbance_end_).count();
    char text[64];
    std::snprintf(text, sizeof text, "%.1f s %s ", std::abs(since_s), since_s < 0.0 ? "before the end of" : "after");
    return text + last_disturbance_;
  }

  int PidOf(const std::string& service) const { return lives_.at(service).back().pid; }

  void RunUntil(double seconds_run) {
    while (SecondsRun() < seconds_run) RunFor(milliseconds(20));
  }
  void RunFor(milliseconds duration) {
    const auto end = Clock::now() + duration;
    do {
      tap_.HandleFor(milliseconds(20), [this](const std::string& channel, Bytes bytes) { OnMessage(channel, bytes); });
      SampleMemory();
    } while (Clock::now() < end);
  }

  void SampleMemory() {
    const auto now = Clock::now();
    if (now - last_sample_ < seconds(1)) return;
    last_sample_ = now;
    for (auto& [service, lives] : lives_) {
      auto& life = lives.back();
      const double megabytes = life.is_killed ? 0.0 : ResidentMegabytes(life.pid);
      if (megabytes > 0.0) life.memory.emplace_back(std::chrono::duration<double>(now - life.begin).count(), megabytes);
    }
  }

  void OnMessage(const std::string& channel, Bytes bytes) {
    if (channel == bus::kHealth.name) {
      if (const auto health = bus::Decode<health_t>(bytes)) OnHealth(*health);
    } else if (channel == bus::kObstacles.name && is_judged_) {
      if (const auto obstacles = bus::Decode<obstacles_t>(bytes)) OnObstacles(*obstacles);
    }
  }

  void OnHealth(const health_t& health) {
    if (others_.contains(health.pid) || std::ranges::find(kServices, health.process) == kServices.end()) return;
    auto& lives = lives_[health.process];
    const auto is_known = [&](const Life& life) { return life.pid == health.pid; };
    if (std::ranges::none_of(lives, is_known)) OnNewLife(health, lives);
    if (lives.back().pid != health.pid) return;
    if (!is_judged_) return;
    ++figures_.num_reports[health.process];
    figures_.num_degraded[health.process] += health.state == health_t::STATE_OK ? 0 : 1;
    if (health.process == "georeferencer") JudgeAlarm(health);
  }

  void OnNewLife(const health_t& health, std::vector<Life>& lives) {
    if (!lives.empty() && !lives.back().is_killed) {
      figures_.unexpected_ends.push_back(health.process + ", " + Now());
      std::printf("UNEXPECTED END of %s\n", figures_.unexpected_ends.back().c_str());
    }
    if (const auto killed = killed_.find(health.process); killed != killed_.end()) {
      const double back_s = std::chrono::duration<double>(Clock::now() - killed->second).count();
      auto& worst_s = figures_.worst_back_s[health.process];
      worst_s = std::max(worst_s, back_s);
      if (back_s > ToSeconds(kMostUntilBack)) figures_.not_back.push_back(health.process + " after " + std::to_string(back_s) + " s");
      killed_.erase(killed);
    }
    KeepMemory(health.process, lives);
    lives.push_back({health.pid, Clock::now(), false, {}});
  }

  // Growth of the last life, before another begins.
  void KeepMemory(const std::string& service, std::vector<Life>& lives) {
    if (lives.empty()) return;
    auto& memory = lives.back().memory;
    if (!memory.empty() && memory.back().first >= kLeastLifeS) {
      std::vector<double> early;
      std::vector<double> late;
      for (const auto& [age_s, megabytes] : memory) {
        if (age_s >= kSettledS && age_s < kSettledS + kWindowS) early.push_back(megabytes);
        if (age_s >= memory.back().first - kWindowS) late.push_back(megabytes);
      }
      if (!early.empty() && !late.empty()) growth_[service].push_back({memory.back().first, Median(early), Median(late)});
    }
    memory.clear();
  }

  void JudgeReturns() {
    for (const auto& [service, since] : killed_) figures_.not_back.push_back(service + " not at all");
  }

  void JudgeAlarm(const health_t& health) {
    const Utime time(std::chrono::microseconds(health.utime_us));
    bool is_in_zone = true;
    bool is_near = false;
    for (auto before = milliseconds(0); before <= kAlarmDelay; before += milliseconds(100)) {
      const double nearest_m = truth_->NearestM(time - before);
      is_in_zone = is_in_zone && nearest_m < kSurelyInZoneM;
      is_near = is_near || nearest_m < kZoneM + 1.0;
    }
    const bool is_told = health.state != health_t::STATE_OK;
    const bool is_alarm = health.reason.find("obstacle within") != std::string::npos;
    if (is_alarm && !is_near) ++figures_.num_alarms_without;
    if (!is_in_zone) return;
    ++figures_.num_health_in_zone;
    figures_.num_told += is_told ? 1 : 0;
    if (is_told) return;
    ++figures_.num_silent;
    if (++num_printed_ <= 3)
      std::printf("SILENT ALARM at %.1f s, %s: %.1f m\n", SecondsRun(), Now().c_str(), truth_->NearestM(time));
  }

  void OnObstacles(const obstacles_t& message) {
    const auto now = Clock::now();
    if (last_scan_)
      figures_.longest_without_scan_s = std::max(figures_.longest_without_scan_s, std::chrono::duration<double>(now - *last_scan_).count());
    last_scan_ = now;
    ++figures_.num_scans;
    for (const auto& obstacle : message.obstacles) {
      if (obstacle.confidence != obstacle_t::CONFIDENCE_SURE) continue;
      if (obstacle.status != obstacle_t::STATUS_OK) {
        ++figures_.num_unplaced;
        continue;
      }
      ++figures_.num_judged;
      const double farthest_m = truth_->FarthestM(message, obstacle);
      const double excess_m = farthest_m - kMaxDeviations * StatedSdM(obstacle) - kOutlineM;
      figures_.worst_m = std::max(figures_.worst_m, farthest_m);
      figures_.worst_excess_m = std::max(figures_.worst_excess_m, excess_m);
      if (excess_m <= 0.0) continue;
      ++figures_.wrong_by_disturbance[last_disturbance_];
      ++figures_.num_wrong;
      if (++num_printed_ <= 3) {
        std::printf(
            "WRONG at %.1f s, %s: %.2f m from anything, stated deviation %.3f m, range %.1f m, %d returns, kind %d, %.2f m long, scan flags %d, scan "
            "%.2f s old\n",
            SecondsRun(), Now().c_str(), farthest_m, StatedSdM(obstacle), static_cast<double>(obstacle.range_m), obstacle.num_points, obstacle.kind,
            static_cast<double>(obstacle.length_m), message.scan_flags, ToSeconds(HostNow() - Utime(std::chrono::microseconds(obstacle.utime_us))));
      }
    }
  }

  // An hour of recordings takes 10 GB.
  static void RemoveOldLogs() {
    std::vector<fs::path> logs;
    for (const auto& entry : fs::directory_iterator("logs")) logs.push_back(entry.path());
    std::ranges::sort(logs, {}, [](const fs::path& log) { return fs::last_write_time(log); });
    for (std::size_t i = 0; i + 2 < logs.size(); ++i) fs::remove(logs[i]);
  }

  void PrintMinute() const {
    std::printf(
        "minute %d: %lld scans, %lld sure obstacles judged, %lld wrong, worst %.2f m; %lld of %lld reports in the zone silent; %zu unexpected ends\n",
        minute_ + 1, static_cast<long long>(figures_.num_scans), static_cast<long long>(figures_.num_judged),
        static_cast<long long>(figures_.num_wrong), figures_.worst_m, static_cast<long long>(figures_.num_silent),
        static_cast<long long>(figures_.num_health_in_zone), figures_.unexpected_ends.size());
    std::fflush(stdout);
  }

  static bool Judge(const char* what, double value, double most, const char* unit) {
    const bool is_met = value <= most;
    std::printf("%-66s %9.2f %s, at most %.2f: %s\n", what, value, unit, most, is_met ? "met" : "MISSED");
    return is_met;
  }

  // Lines of sanitizers in what the processes printed.
  static std::vector<std::string> SanitizerReports() {
    std::vector<std::string> reports;
    for (const auto& entry : fs::recursive_directory_iterator("printed")) {
      if (!entry.is_regular_file()) continue;
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        if (line.find("Sanitizer") != std::string::npos || line.find("runtime error: ") != std::string::npos) reports.push_back(line);
      }
    }
    return reports;
  }

  bool Print() {
    std::printf("\n%.0f s, seed %llu, processes of %s\n", SecondsRun(), static_cast<unsigned long long>(options_.seed),
                options_.bin_folder.string().c_str());
    for (const auto& [name, count] : figures_.num_disturbances) {
      std::printf("  %4lld x %s%s\n", static_cast<long long>(count), name.c_str(),
                  figures_.wrong_by_disturbance.contains(name)
                      ? ("; wrong obstacles from it until the next: " + std::to_string(figures_.wrong_by_disturbance.at(name))).c_str()
                      : "");
    }
    std::printf("hostile datagrams sent: %lld from within, %lld from outside\n", static_cast<long long>(num_hostile_inside_),
                static_cast<long long>(figures_.num_hostile));
    std::printf("%-14s %6s %12s %10s %12s   growth of lives of %.0f s and more\n", "process", "kills", "worst back s", "reports", "not ok",
                kLeastLifeS);
    double worst_back_s = 0.0;
    double worst_growth_percent = 0.0;
    std::size_t num_grown = 0;
    for (const auto& service : kServices) {
      std::printf("%-14s %6lld %12.2f %10lld %12lld  ", service.c_str(), static_cast<long long>(figures_.num_kills[service]),
                  figures_.worst_back_s[service], static_cast<long long>(figures_.num_reports[service]),
                  static_cast<long long>(figures_.num_degraded[service]));
      worst_back_s = std::max(worst_back_s, figures_.worst_back_s[service]);
      for (const auto& growth : growth_[service]) {
        const double percent = 100.0 * (growth.late_megabytes - growth.early_megabytes) / growth.early_megabytes;
        std::printf(" %.0f s: %.2f -> %.2f MB (%+.2f %%)", growth.life_s, growth.early_megabytes, growth.late_megabytes, percent);
        worst_growth_percent = std::max(worst_growth_percent, percent);
        ++num_grown;
      }
      std::printf("\n");
    }
    std::printf("obstacles: %lld scans, longest time without one %.1f s; %lld sure ones placed, %lld not placed (and said so)\n",
                static_cast<long long>(figures_.num_scans), figures_.longest_without_scan_s, static_cast<long long>(figures_.num_judged),
                static_cast<long long>(figures_.num_unplaced));
    std::printf("farthest from the truth %.2f m; worst beyond %.0f stated deviations and %.1f m: %+.2f m\n", figures_.worst_m, kMaxDeviations,
                kOutlineM, figures_.worst_excess_m);
    std::printf("alarm: %lld reports of georeferencer with something surely in the zone for %.1f s, %lld told; alarms with nothing there: %lld\n",
                static_cast<long long>(figures_.num_health_in_zone), ToSeconds(kAlarmDelay), static_cast<long long>(figures_.num_told),
                static_cast<long long>(figures_.num_alarms_without));
    for (const auto& end : figures_.unexpected_ends) std::printf("ended by itself: %s\n", end.c_str());
    for (const auto& late : figures_.not_back) std::printf("late: %s\n", late.c_str());
    const auto reports = SanitizerReports();
    for (std::size_t i = 0; i < std::min<std::size_t>(reports.size(), kMaxPrinted); ++i) std::printf("%s\n", reports[i].c_str());

    bool is_good = Judge("wrong obstacles", static_cast<double>(figures_.num_wrong), 0.0, "");
    is_good &= Judge("silent alarms", static_cast<double>(figures_.num_silent), 0.0, "");
    is_good &= Judge("ends that nobody asked for", static_cast<double>(figures_.unexpected_ends.size()), 0.0, "");
    is_good &= Judge("killed processes back", worst_back_s, ToSeconds(kMostUntilBack), "s");
    is_good &= Judge("of them not back in time", static_cast<double>(figures_.not_back.size()), 0.0, "");
    is_good &= Judge("reports of sanitizers", static_cast<double>(reports.size()), 0.0, "");
    if (num_grown > 0) {
      is_good &= Judge("growth of memory", worst_growth_percent, kMaxGrowthPercent, "%");
    } else {
      std::printf("growth of memory is not judged: no process lived for %.0f s\n", kLeastLifeS);
    }
    // A run in which nothing was judged proves nothing.
    const bool is_enough = figures_.num_judged > 10 * options_.seconds && figures_.num_health_in_zone * 20 > options_.seconds;
    if (!is_enough) std::printf("MISSED: too little was judged\n");
    return is_good && is_enough;
  }

  static constexpr std::int64_t kMaxPrinted = 40;
  struct Growth {
    double life_s;
    double early_megabytes;
    double late_megabytes;
  };

  fs::path folder_;
  fs::path program_;
  Options options_;
  std::mt19937_64 random_;
  BusTap tap_;
  HostileSender inside_{21001, 5, {kGroup, "127.0.0.1"}};
  std::int64_t num_hostile_inside_ = 0;
  Utime start_{};
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_sample_{};
  std::optional<Clock::time_point> last_scan_;
  int minute_ = 0;
  bool is_judged_ = false;
  std::optional<TruthBeside> truth_;
  std::map<std::string, std::vector<Life>> lives_;
  std::map<std::string, Clock::time_point> killed_;
  std::map<std::string, std::vector<Growth>> growth_;
  std::set<int> others_;
  std::string last_disturbance_ = "the start";
  Clock::time_point last_disturbance_end_ = Clock::now();
  int num_printed_ = 0;  // since the last disturbance
  Figures figures_;
  std::unique_ptr<Child> second_;
  std::unique_ptr<Child> up_;
  std::unique_ptr<Child> sim_;
  std::unique_ptr<ForeignLidar> foreign_;
  std::vector<std::unique_ptr<Child>> other_boat_;
};

// On the second computer.
int SendHostile(const fs::path& samples_file, std::uint64_t seed) {
  std::deque<BusTap::Datagram> samples;
  std::ifstream in(samples_file, std::ios::binary);
  for (std::uint32_t size = 0; in.read(reinterpret_cast<char*>(&size), sizeof size) && size < 65536;) {
    BusTap::Datagram sample(size);
    in.read(reinterpret_cast<char*>(sample.data()), static_cast<std::streamsize>(size));
    samples.push_back(std::move(sample));
  }
  HostileSender sender(21002, seed, {"10.76.0.1", "10.76.0.255", kGroup});
  std::printf("%lld\n", static_cast<long long>(sender.Send(200, samples)));
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  std::string samples;
  CLI::App app("Runs all processes live on a simulated boat, disturbs them in every way, and judges them beside the truth.");
  app.add_option("--seconds", options.seconds, "length, whole minutes are run")->check(CLI::Range(60, 86400))->capture_default_str();
  app.add_option("--seed", options.seed, "of the schedule and the scene")->capture_default_str();
  app.add_option("--bin", options.bin_folder, "the processes' folder, e.g. build/asan/bin")->check(CLI::ExistingDirectory)->capture_default_str();
  app.add_flag("--undisturbed", options.is_undisturbed, "the same without disturbances: what the judge says then");
  app.add_flag("--keep", options.keeps_folder, "keep logs and what was printed");
  app.add_option("--send-hostile", samples, "of this program itself: datagrams from the second computer")->group("");
  CLI11_PARSE(app, argc, argv);
  if (!samples.empty()) return SendHostile(samples, options.seed);
  options.bin_folder = fs::absolute(options.bin_folder);
  const auto program = fs::read_symlink("/proc/self/exe");
  const auto start_folder = fs::current_path();
  const auto folder = fs::temp_directory_path() / ("lookout_disturbed_" + std::to_string(getpid()));
  bool is_good = false;
  {
    DisturbedRun run(folder, program, options);
    is_good = run.IsGood();
  }
  fs::current_path(start_folder);
  if (options.keeps_folder) {
    std::printf("kept: %s\n", folder.c_str());
  } else {
    fs::remove_all(folder);
  }
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return EXIT_FAILURE;
}
