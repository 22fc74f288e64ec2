// What the suite says while it is disturbed, judged beside the truth.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/bus/services.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "tests/bench/truth_beside.hpp"

namespace lookout::bench {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

inline const std::vector<std::string> kServices = bus::StartOrder();

// An obstacle is wrong when a corner of its outline lies farther than this from all that is there: so many stated deviations, and what the outline
// itself may be off by: noise of the range, time within a scan, what rocks.
inline constexpr double kMaxDeviations = 5.0;
inline constexpr double kOutlineM = 0.5;
// The guard zone of this run, all round, and what must be within it for certain to be missed.
inline constexpr double kZoneM = 10.0;
inline constexpr double kSurelyInZoneM = 8.5;
// ALERTS without one of the zone, and no word that nobody looks, when something has been in the zone for so long, are a silent alarm.
inline constexpr milliseconds kAlarmDelay{2000};
inline constexpr seconds kMostUntilBack{10};
// Memory of a life of six minutes or more: from the fourth minute to its last.
inline constexpr double kLeastLifeS = 360.0;
inline constexpr double kSettledS = 180.0;
inline constexpr double kWindowS = 60.0;
inline constexpr double kMaxGrowthPercent = 1.0;
inline Utime HostNow() { return std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now()); }

// As the page tables have it: VmRSS of /proc/PID/status may be off by 64 pages a thread.
inline double ResidentMegabytes(int pid) {
  std::ifstream rollup("/proc/" + std::to_string(pid) + "/smaps_rollup");
  for (std::string line; std::getline(rollup, line);) {
    if (line.rfind("Rss:", 0) == 0) return std::stod(line.substr(4)) * 1024.0 / 1e6;
  }
  return 0.0;
}

inline double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// One process id of a service, from its first HEALTH on.
struct Life {
  int pid = 0;
  std::chrono::steady_clock::time_point begin;
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
  std::int64_t num_alerts_in_zone = 0;
  std::int64_t num_told = 0;
  std::int64_t num_silent = 0;
  std::int64_t num_alarms_without = 0;
  double longest_without_scan_s = 0.0;
  std::map<std::string, std::int64_t> num_kills;
  std::map<std::string, double> worst_back_s;
  std::map<std::string, std::int64_t> num_degraded;
  std::map<std::string, std::int64_t> num_reports;
  std::vector<std::string> unexpected_ends;
  std::vector<std::string> not_back;
  std::map<std::string, std::int64_t> num_disturbances;
};

class DisturbedJudge {
 public:
  using Clock = std::chrono::steady_clock;

  /// From now on it is judged.
  void Begin(const TruthBeside& truth) {
    truth_ = &truth;
    begin_ = Clock::now();
  }
  double SecondsRun() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  bool AreAllUp() const { return lives_.size() == kServices.size(); }
  int PidOf(const std::string& service) const { return lives_.at(service).back().pid; }

  /// How long it has lived, by its first HEALTH.
  double AgeS(const std::string& service) const { return std::chrono::duration<double>(Clock::now() - lives_.at(service).back().begin).count(); }

  /// A process of another boat, which is not judged.
  void AddOther(int pid) { others_.insert(pid); }

  /// What is done to the suite from now on, for so long.
  void Mark(const std::string& name, milliseconds duration) {
    ++figures_.num_disturbances[name];
    last_disturbance_ = name;
    last_disturbance_end_ = Clock::now() + duration;
    num_printed_ = 0;
  }

  void NoteKill(const std::string& service) {
    lives_[service].back().is_killed = true;
    ++figures_.num_kills[service];
    killed_[service] = Clock::now();
  }

  void OnHealth(const health_t& health) {
    if (others_.contains(health.pid) || std::ranges::find(kServices, health.process) == kServices.end()) return;
    auto& lives = lives_[health.process];
    const auto is_known = [&](const Life& life) { return life.pid == health.pid; };
    if (std::ranges::none_of(lives, is_known)) OnNewLife(health, lives);
    if (lives.back().pid != health.pid) return;
    if (truth_ == nullptr) return;
    ++figures_.num_reports[health.process];
    figures_.num_degraded[health.process] += health.state == health_t::STATE_OK ? 0 : 1;
  }

  void OnAlerts(const alerts_t& message) {
    if (message.is_watch) {
      is_unwatched_ = std::ranges::any_of(
          message.alerts, [](const alert_t& alert) { return alert.cause == alert_t::CAUSE_WATCH && alert.state != alert_t::STATE_CLEARED; });
    }
    if (truth_ != nullptr) JudgeAlarm(message);
  }

  void OnObstacles(const obstacles_t& message) {
    if (truth_ == nullptr) return;
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

  /// To be called often: looks once a second.
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

  void PrintMinute(int minute) const {
    std::printf(
        "minute %d: %lld scans, %lld sure obstacles judged, %lld wrong, worst %.2f m; %lld of %lld reports in the zone silent; %zu unexpected ends\n",
        minute, static_cast<long long>(figures_.num_scans), static_cast<long long>(figures_.num_judged), static_cast<long long>(figures_.num_wrong),
        figures_.worst_m, static_cast<long long>(figures_.num_silent), static_cast<long long>(figures_.num_alerts_in_zone),
        figures_.unexpected_ends.size());
    std::fflush(stdout);
  }

  /// The end: who was killed has come back, or never will.
  void Finish() {
    for (const auto& [service, since] : killed_) figures_.not_back.push_back(service + " not at all");
    for (auto& [service, lives] : lives_) KeepMemory(service, lives);
  }

  /// The table. @return whether every target is met
  bool Print(const std::string& title, int num_seconds) {
    std::printf("\n%.0f s, %s\n", SecondsRun(), title.c_str());
    for (const auto& [name, count] : figures_.num_disturbances) {
      std::printf("  %4lld x %s%s\n", static_cast<long long>(count), name.c_str(),
                  figures_.wrong_by_disturbance.contains(name)
                      ? ("; wrong obstacles from it until the next: " + std::to_string(figures_.wrong_by_disturbance.at(name))).c_str()
                      : "");
    }
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
    std::printf("alarm: %lld messages of ALERTS with something surely in the zone for %.1f s, %lld told; alarms with nothing there: %lld\n",
                static_cast<long long>(figures_.num_alerts_in_zone), ToSeconds(kAlarmDelay), static_cast<long long>(figures_.num_told),
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
    const bool is_enough = figures_.num_judged > 10 * num_seconds && figures_.num_alerts_in_zone * 20 > num_seconds;
    if (!is_enough) std::printf("MISSED: too little was judged\n");
    return is_good && is_enough;
  }

 private:
  std::string Now() const {
    const double since_s = std::chrono::duration<double>(Clock::now() - last_disturbance_end_).count();
    char text[64];
    std::snprintf(text, sizeof text, "%.1f s %s ", std::abs(since_s), since_s < 0.0 ? "before the end of" : "after");
    return text + last_disturbance_;
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

  void JudgeAlarm(const alerts_t& message) {
    const Utime time(std::chrono::microseconds(message.end_utime_us));
    bool is_in_zone = true;
    bool is_near = false;
    for (auto before = milliseconds(0); before <= kAlarmDelay; before += milliseconds(100)) {
      const double nearest_m = truth_->NearestM(time - before);
      is_in_zone = is_in_zone && nearest_m < kSurelyInZoneM;
      is_near = is_near || nearest_m < kZoneM + 1.0;
    }
    const bool is_alarm = std::ranges::any_of(message.alerts, [](const alert_t& alert) {
      return alert.cause == alert_t::CAUSE_GUARD_ZONE && (alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED);
    });
    // A process that has just begun says in HEALTH that nobody looks yet.
    const bool is_starting = time - Utime(std::chrono::microseconds(message.begin_utime_us)) < kAlarmDelay;
    const bool is_told = is_alarm || is_unwatched_ || is_starting;
    if (is_alarm && !is_near) ++figures_.num_alarms_without;
    if (!is_in_zone) return;
    ++figures_.num_alerts_in_zone;
    figures_.num_told += is_told ? 1 : 0;
    if (is_told) return;
    ++figures_.num_silent;
    if (++num_printed_ <= 3) std::printf("SILENT ALARM at %.1f s, %s: %.1f m\n", SecondsRun(), Now().c_str(), truth_->NearestM(time));
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

  static constexpr std::int64_t kMaxPrinted = 40;
  struct Growth {
    double life_s;
    double early_megabytes;
    double late_megabytes;
  };

  bool is_unwatched_ = false;  // by the last word of the watch
  const TruthBeside* truth_ = nullptr;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_sample_{};
  std::optional<Clock::time_point> last_scan_;
  std::map<std::string, std::vector<Life>> lives_;
  std::map<std::string, Clock::time_point> killed_;
  std::map<std::string, std::vector<Growth>> growth_;
  std::set<int> others_;
  std::string last_disturbance_ = "the start";
  Clock::time_point last_disturbance_end_ = Clock::now();
  int num_printed_ = 0;  // since the last disturbance
  Figures figures_;
};

}  // namespace lookout::bench
