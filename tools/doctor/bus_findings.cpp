// Config files, the bus and its buffers.
#include <algorithm>
#include <string>
#include <vector>

#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kConfigSubject = "config";
constexpr const char* kRouteSubject = "route";
constexpr const char* kPortSubject = "port";
constexpr const char* kBuffersSubject = "buffers";

// LCM's own programs ask for no buffer; its setup page for multicast asks for net.core.rmem_default of 2 MiB for them.
constexpr std::int64_t kWantedByLcmBytes = 2 * 1024 * 1024;

// "239.255.76.67" -> "239.255.76.0/24"
std::string NetworkOfGroup(const std::string& group) { return group.substr(0, group.rfind('.')) + ".0/24"; }

std::string KibiBytes(std::int64_t bytes) { return std::to_string(bytes / 1024) + " KiB"; }

}  // namespace

Findings CheckConfig(const ConfigSeen& config) {
  Findings findings;
  std::string right;
  for (const auto& [file, faults] : config.files) {
    if (faults.empty()) right += (right.empty() ? "" : ", ") + file;
    for (const auto& fault : faults) {
      const bool is_of_file = fault.find(": file: ") != std::string::npos;
      findings.push_back(Fault(kConfigSubject, fault,
                               is_of_file ? "the folder holds one file for each schema of config/schema, as config/catabot does, and no other"
                                          : "correct that line; config/schema says what it may hold"));
    }
  }
  if (!right.empty()) findings.insert(findings.begin(), Ok(kConfigSubject, right));
  return findings;
}

Findings CheckBus(const BusSeen& bus) {
  if (bus.group.empty()) {
    if (!bus.fault.empty()) return {Fault(kRouteSubject, bus.fault, "LCM_DEFAULT_URL or --lcm-url names the bus")};
    return {Ok(kRouteSubject, "the bus is " + bus.url + ": no multicast, so it needs no route")};
  }
  const auto network = NetworkOfGroup(bus.group);
  if (!bus.fault.empty()) {
    return {Fault(kRouteSubject, bus.fault,
                  bus.time_to_live > 0 ? "as root: ip route add " + network + " dev <the interface to the other computer>"
                                       : "as root: ip route add " + network + " dev lo")};
  }
  const auto place = "multicast to " + bus.group + " goes by " + (bus.route_device.empty() ? "an interface that is not known" : bus.route_device);
  if (bus.time_to_live > 0 && bus.route_device == "lo") {
    return {Warning(kRouteSubject,
                    place + ", but the bus has a time-to-live of " + std::to_string(bus.time_to_live) + ": other computers cannot hear it",
                    "as root: ip route replace " + network + " dev <the interface to the other computer>; or ttl=0 in LCM_DEFAULT_URL")};
  }
  if (bus.time_to_live == 0 && !bus.route_device.empty() && bus.route_device != "lo") {
    return {Warning(kRouteSubject, place + ": when that interface goes down, the processes of this computer no longer hear each other",
                    "as root: ip route replace " + network + " dev lo")};
  }
  return {
      Ok(kRouteSubject, place + (bus.time_to_live == 0 ? "; nothing leaves this computer" : "; time-to-live " + std::to_string(bus.time_to_live)))};
}

Findings CheckPort(const Observations& seen) {
  if (seen.bus.group.empty()) return {};
  const auto port = "port " + std::to_string(seen.bus.port);
  if (seen.port.is_closed) return {Ok(kPortSubject, port + " of the bus is closed to other interfaces than that of the bus (lookout-firewall)")};
  std::vector<std::string> outside;
  for (const auto& interface : seen.interfaces) {
    if (!interface.is_loopback && interface.has_carrier && std::ranges::find(outside, interface.name) == outside.end())
      outside.push_back(interface.name);
  }
  if (outside.empty()) return {Ok(kPortSubject, port + " of the bus: no interface leads to another computer")};
  const auto open = port + " of the bus is open on " + Joined(outside);
  if (seen.port.without_filter.empty()) {
    return {Ok(kPortSubject, open + "; Lookout's programs accept only valid datagrams" +
                                 (seen.bus.time_to_live == 0 ? " of this computer" : " to the group") + ", and no other program listens")};
  }
  return {Warning(
      kPortSubject,
      open + ", and one datagram can end a program that listens there without a filter, as LCM's own tools do: " + Joined(seen.port.without_filter),
      "end it before casting off; or close the port: LOOKOUT_BUS_FIREWALL=on in /etc/default/lookout, then as root: systemctl restart "
      "lookout-firewall")};
}

Findings CheckBuffers(const BuffersSeen& buffers) {
  Findings findings;
  if (buffers.granted < buffers.asked) {
    findings.push_back(Warning(kBuffersSubject,
                               "a socket that asks for " + KibiBytes(buffers.asked) + " gets " + KibiBytes(buffers.granted) +
                                   ": a burst while the computer is busy is lost (and counted)",
                               "as root: sysctl -w net.core.rmem_max=" + std::to_string(buffers.asked) + ", and the same line in /etc/sysctl.d"));
  } else {
    findings.push_back(Ok(kBuffersSubject, "a socket that asks for " + KibiBytes(buffers.asked) + " gets it"));
  }
  if (buffers.by_default < kWantedByLcmBytes) {
    findings.push_back(Warning(
        kBuffersSubject,
        "a socket that asks for none gets " + KibiBytes(buffers.by_default) + ": Lookout's processes ask, but lcm-spy and lcm-logger may lose bursts",
        "as root: sysctl -w net.core.rmem_default=" + std::to_string(kWantedByLcmBytes)));
  }
  return findings;
}

}  // namespace lookout::doctor
