// HEALTH of the processes, obstacles, and the look-out.
#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/services.hpp"
#include "common/core/utime.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kProcessSubject = "process";
constexpr const char* kObstaclesSubject = "obstacles";
constexpr const char* kLookOutSubject = "look-out";

// HEALTH comes once a second: two may be lost.
constexpr double kHealthSilenceS = 3.5;
// ALERTS come with every scan, and twice a second where none comes.
constexpr double kLookOutSilenceS = 1.0;

bool IsAlive(const ProcessSeen& process, Utime end) { return ToSeconds(end - process.heard_last) <= kHealthSilenceS; }

// Counter messages_not_sent is of any process, raw_missing of the recorder.
bool IsLoss(const health_counter_t& counter) { return counter.name == "messages_not_sent" || counter.name == "raw_missing"; }

std::int64_t NumLost(const health_t& health) {
  std::int64_t num_lost = 0;
  for (const auto& channel : health.channels) num_lost += channel.is_input ? channel.num_lost : 0;
  for (const auto& counter : health.counters) num_lost += IsLoss(counter) ? counter.count : 0;
  return num_lost;
}

std::string LossesInWords(const ProcessSeen& process) {
  std::vector<std::string> words;
  for (const auto& channel : process.last.channels) {
    if (channel.is_input && channel.num_lost > 0) words.push_back(Count(channel.num_lost, "message") + " of " + channel.channel);
  }
  for (const auto& counter : process.last.counters) {
    if (IsLoss(counter) && counter.count > 0) words.push_back(std::to_string(counter.count) + " " + counter.name);
  }
  return Joined(words);
}

Finding CheckProcess(const std::string& name, const ProcessSeen& process) {
  const auto& health = process.last;
  const std::string who = name + " (pid " + std::to_string(health.pid) + " on " + health.host + ")";
  switch (health.state) {
    case health_t::STATE_OK:
      break;
    case health_t::STATE_STARTING:
      return Warning(kProcessSubject, who + " is starting: " + health.reason, "ask again in a few seconds");
    case health_t::STATE_DEGRADED:
      return Warning(kProcessSubject, who + " is degraded: " + health.reason, "the lines above; services/" + name + "/README.md tells more");
    default:
      return Fault(kProcessSubject, who + " has failed: " + health.reason, "mend what the reason names; its journal: journalctl -u lookout-" + name);
  }
  const std::string words = who + " is ok: " + Fixed(100.0 * health.cpu_fraction, 1) + " % of a core, " +
                            Fixed(static_cast<double>(health.resident_bytes) / 1e6, 0) + " MB, up " + Fixed(health.uptime_s, 0) + " s";
  const auto losses = LossesInWords(process);
  if (NumLost(health) > NumLost(process.first)) {
    return Warning(kProcessSubject, words + "; it loses messages now: " + losses,
                   "load of this computer; receive buffers above; the network between two computers");
  }
  return Ok(kProcessSubject, words + (losses.empty() ? "" : "; lost since its start: " + losses));
}

Finding Missing(const std::string& name, bool was_heard) {
  return Fault(kProcessSubject, name + (was_heard ? " was heard, and has stopped" : " is not heard, others are"),
               "start lookout-" + name + "; its last lines (journalctl -u lookout-" + name + ") say why it ended");
}

Findings CheckObstacles(const Observations& seen) {
  const auto& obstacles = seen.obstacles;
  if (obstacles.num_scans == 0) {
    if (seen.lidar.via != Via::kBus || seen.lidar.num_packets == 0) return {};  // no packets, so no OBSTACLES can come
    return {Fault(kObstaclesSubject, "the lidar runs, but no OBSTACLES come", "the processes' lines above")};
  }
  const std::string words = Fixed(static_cast<double>(obstacles.num_scans) / seen.watched_s, 1) + " scans/s, " +
                            Fixed(static_cast<double>(obstacles.num_obstacles) / static_cast<double>(obstacles.num_scans), 1) + " obstacles in each";
  if (obstacles.num_timeouts > 0) {
    return {Warning(kObstaclesSubject, words + "; for " + std::to_string(obstacles.num_timeouts) + " the wait for POSE was given up",
                    "clocks of lidar and navigation differ, or navigator is late: the clock lines above")};
  }
  if (obstacles.num_placed < obstacles.num_obstacles) {
    return {Warning(kObstaclesSubject,
                    words + "; " + std::to_string(obstacles.num_obstacles - obstacles.num_placed) + " of " + std::to_string(obstacles.num_obstacles) +
                        " in the vessel frame only",
                    "the gnss and heading lines above")};
  }
  return {Ok(kObstaclesSubject, words + (obstacles.num_obstacles > 0 ? ", all placed on the earth" : ""))};
}

Findings CheckLookOut(const Observations& seen) {
  const auto& look_out = seen.look_out;
  const std::string cure = "the process and lidar lines above; keep a look-out by eye meanwhile";
  if (!look_out.alerts && look_out.num_scans == 0) {
    if (seen.obstacles.num_scans == 0) return {};  // no OBSTACLES, so no TRACKS can come
    return {Fault(kLookOutSubject, "no look-out: OBSTACLES come, but no TRACKS and ALERTS: nothing will warn you", cure)};
  }
  const double alerts_age_s = ToSeconds(seen.end - look_out.alerts_heard);
  const double tracks_age_s = ToSeconds(seen.end - look_out.tracks_heard);
  if (!look_out.alerts || alerts_age_s > kLookOutSilenceS) {
    return {Fault(kLookOutSubject, "no look-out: no ALERTS" + (look_out.alerts ? " for " + Fixed(alerts_age_s, 1) + " s" : ""), cure)};
  }
  const auto is_active = [](const alert_t& alert) { return alert.state == alert_t::STATE_ACTIVE && alert.cause != alert_t::CAUSE_WATCH; };
  const auto& alerts = look_out.alerts->alerts;
  const auto is_of_watch = [](const alert_t& alert) { return alert.cause == alert_t::CAUSE_WATCH && alert.state <= alert_t::STATE_ACKNOWLEDGED; };
  const auto nobody = std::ranges::find_if(alerts, [&](const alert_t& alert) { return is_of_watch(alert) && alert.id <= 0; });
  if (nobody != alerts.end()) return {Fault(kLookOutSubject, nobody->text, cure)};
  if (look_out.num_scans == 0 || tracks_age_s > kLookOutSilenceS) {
    return {Fault(kLookOutSubject, "ALERTS come, but no TRACKS" + (look_out.num_scans > 0 ? " for " + Fixed(tracks_age_s, 1) + " s" : ""), cure)};
  }
  const std::string words = Fixed(static_cast<double>(look_out.num_scans) / seen.watched_s, 1) + " scans/s, " + Count(look_out.num_tracks, "track") +
                            ", " + std::to_string(look_out.num_moving) + " moving";
  Findings findings;
  for (const auto& alert : alerts) {
    if (!is_of_watch(alert)) continue;
    findings.push_back(Warning(kLookOutSubject, alert.text, "the zone and process lines above; keep a look-out by eye there"));
  }
  const auto num_active = std::ranges::count_if(alerts, is_active);
  if (num_active == 0) {
    findings.push_back(Ok(kLookOutSubject, words + ", no alert"));
    return findings;
  }
  findings.push_back(Warning(kLookOutSubject,
                             words + "; " + Count(num_active, "alert") + ", the gravest: " + std::ranges::find_if(alerts, is_active)->text,
                             "look there; if it is the own boat or spray: correct own_vessel in boat.txtpb, guard_zone in tracker.txtpb"));
  return findings;
}

}  // namespace

Findings CheckProcesses(const Observations& seen) {
  if (seen.processes.empty() && !seen.bus.fault.empty()) {
    return {Fault(kProcessSubject, "none of Lookout's processes can be heard: the bus cannot be opened", "the route line above")};
  }
  if (seen.processes.empty()) {
    return {Warning(kProcessSubject, "none of Lookout's processes is heard on " + seen.bus.url + "; the doctor checked the sensors itself",
                    "start them, then ask again: bus and log are checked only then")};
  }
  std::set<std::string> names;
  for (const auto& service : bus::kServices) names.emplace(service.name);
  if (seen.config.files.contains("lidar_2.txtpb")) names.emplace("lidar_2");
  for (const auto& [name, instances] : seen.processes) names.insert(name);
  Findings findings;
  for (const auto& name : names) {
    std::vector<const ProcessSeen*> alive;
    const auto found = seen.processes.find(name);
    if (found != seen.processes.end()) {
      for (const auto& process : found->second) {
        if (IsAlive(process, seen.end)) alive.push_back(&process);
      }
    }
    if (alive.empty() && name == "plotter" && !seen.config.has_plotter_outputs) continue;
    if (alive.empty()) {
      findings.push_back(Missing(name, found != seen.processes.end()));
      continue;
    }
    for (const auto* process : alive) {
      findings.push_back(CheckProcess(name, *process));
    }
    if (alive.size() > 1) {
      findings.push_back(Fault(kProcessSubject, name + " runs " + std::to_string(alive.size()) + " times on one bus: a channel has one publisher",
                               "end all but one, or give the other boat another LCM address"));
    }
  }
  for (auto& finding : CheckObstacles(seen)) findings.push_back(std::move(finding));
  for (auto& finding : CheckLookOut(seen)) findings.push_back(std::move(finding));
  return findings;
}

Findings CheckAll(const Observations& seen) {
  Findings all;
  for (const auto& part :
       {CheckConfig(seen.config), CheckBus(seen.bus), CheckPort(seen), CheckBuffers(seen.buffers), CheckLidar(seen), CheckSpeakers(seen),
        CheckWindow(seen), CheckClocks(seen), CheckNavigation(seen), CheckMounting(seen.config), CheckMountingSeen(seen), CheckGuardZone(seen),
        CheckDisk(seen.disk), CheckProcesses(seen), CheckPlotter(seen), CheckAis(seen), CheckPage(seen)}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

}  // namespace lookout::doctor
