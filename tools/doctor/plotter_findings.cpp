// Whether those to whom the plotter sends take it: by the counters of its HEALTH, "output_NAME_sent" and others.
#include <optional>
#include <string>
#include <string_view>

#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kSubject = "plotter";

std::optional<std::int64_t> CountOf(const health_t& health, const std::string& name) {
  for (const auto& counter : health.counters) {
    if (counter.name == name) return counter.count;
  }
  return std::nullopt;
}

// Growth while the doctor watched.
std::int64_t Grown(const ProcessSeen& process, const std::string& name) {
  return CountOf(process.last, name).value_or(0) - CountOf(process.first, name).value_or(0);
}

// An autopilot tells of itself once a second over each link that it uses. Nullopt: the output has none.
std::optional<Finding> CheckAutopilot(const ProcessSeen& process, const std::string& output) {
  const auto counter = "output_" + output + "_heartbeats";
  const auto num_heartbeats = CountOf(process.last, counter);
  if (!num_heartbeats || Grown(process, counter) > 0) return std::nullopt;
  // HEALTH comes once a second, so a short watch may lie between two heartbeats; and the plotter may just have begun.
  constexpr double kLeastWatchS = 4.0;
  if (1e-6 * static_cast<double>(process.last.utime_us - process.first.utime_us) < kLeastWatchS) return std::nullopt;
  const auto text = *num_heartbeats == 0 ? "no HEARTBEAT of an autopilot has come back" : "the autopilot's HEARTBEAT has stopped";
  return Warning(
      kSubject, "output '" + output + "' sends, but " + text,
      "whether the autopilot is on; both wires of the cable, its baud and SERIALn_PROTOCOL 2; over UDP its address and port, and a firewall "
      "that holds its answers back");
}

Finding CheckOutput(const ProcessSeen& process, const std::string& output) {
  const auto who = "output '" + output + "' ";
  const auto counter = "output_" + output;
  const auto num_clients = CountOf(process.last, counter + "_clients");
  if (num_clients == 0) {
    return Warning(kSubject, who + "waits: nobody is connected", "the plotter's connection to this computer: TCP, address and port of plotter.txtpb");
  }
  const auto num_dropped = Grown(process, counter + "_dropped");
  if (num_dropped > 0 || Grown(process, counter + "_clients_dropped") > 0) {
    return Warning(kSubject, who + "is too slow: " + Count(num_dropped, "message") + " dropped",
                   "the plotter, or the network to it, does not take our data");
  }
  const auto num_unsent = Grown(process, counter + "_unsent");
  if (num_unsent > 0) {
    return Warning(kSubject, who + "takes nothing: " + Count(num_unsent, "message") + " not sent",
                   "the process line above; whether the plotter is on");
  }
  if (auto silent = CheckAutopilot(process, output)) return *silent;
  // Over UDP nobody confirms, but who is off may be told of.
  if (Grown(process, counter + "_unheard") > 0) return Ok(kSubject, who + "sends, but nobody listens there: the receiver is off");
  const auto num_sent = Grown(process, counter + "_sent");
  const auto clients = num_clients ? " to " + Count(*num_clients, "client") : std::string();
  const auto* const heard = CountOf(process.last, counter + "_heartbeats") ? ", the autopilot's HEARTBEAT comes" : "";
  return Ok(kSubject, who + "sends" + clients + ", " + Count(num_sent, "message") + " taken" + heard);
}

}  // namespace

Findings CheckPlotter(const Observations& seen) {
  Findings findings;
  const auto found = seen.processes.find("plotter");
  if (found == seen.processes.end()) return findings;
  constexpr std::string_view kOutput = "output_";
  constexpr std::string_view kSent = "_sent";
  for (const auto& process : found->second) {
    for (const auto& counter : process.last.counters) {
      const std::string_view name = counter.name;
      if (!name.starts_with(kOutput) || !name.ends_with(kSent)) continue;
      findings.push_back(CheckOutput(process, std::string(name.substr(kOutput.size(), name.size() - kOutput.size() - kSent.size()))));
    }
  }
  return findings;
}

}  // namespace lookout::doctor
