// The lidar, the network to it, its clock and this computer's.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kLidarSubject = "lidar";
constexpr const char* kNetworkSubject = "network";
constexpr const char* kClockSubject = "clock";

// Share of the packets that may be missing without a warning: at 1 % every second scan has a gap.
constexpr double kMaxLostShare = 0.01;
// After such a silence the lidar process complains.
constexpr double kLidarSilenceS = 1.0;
// As TIME_AUTO (lidar.proto).
constexpr double kMaxClockDifferenceS = 0.25;
constexpr const char* kFactorySensor = "192.168.1.201";  // VLP-16 User Manual 63-9243 Rev E: as delivered; sends to 255.255.255.255
constexpr const char* kLidarCure =
    "check the lidar's power and cable; open its page http://192.168.1.201 (as delivered): its destination must be this computer or "
    "255.255.255.255, with the ports of lidar.txtpb; check that a firewall lets UDP in";

std::string InterfacesInWords(const std::vector<InterfaceSeen>& interfaces) {
  std::vector<std::string> words;
  for (const auto& interface : interfaces) {
    if (interface.is_loopback) continue;
    const auto address = interface.address ? io::ToText(*interface.address) + "/" + std::to_string(interface.prefix_bits) : std::string("no address");
    words.push_back(interface.name + " " + address + (interface.has_carrier ? "" : " (no carrier: cable out, or other end off)"));
  }
  return words.empty() ? "no interface but loopback" : Joined(words);
}

bool IsInNetwork(const InterfaceSeen& interface, const io::IpAddress& address) {
  if (!interface.address || interface.address->is_ipv4() != address.is_ipv4()) return false;
  constexpr int kMappedBits = 96;  // in front of a mapped IPv4 address
  const int num_bits = interface.prefix_bits + (address.is_ipv4() ? kMappedBits : 0);
  for (int bit = 0; bit < num_bits; ++bit) {
    const auto mask = static_cast<std::uint8_t>(0x80 >> bit % 8);
    const auto byte = static_cast<std::size_t>(bit / 8);
    if ((interface.address->bytes.at(byte) & mask) != (address.bytes.at(byte) & mask)) return false;
  }
  return true;
}

Finding CheckSender(const Observations& seen, const std::string& sender, std::int64_t num_datagrams) {
  const std::string words = Count(num_datagrams, "datagram") + " from " + sender + " to port " + std::to_string(seen.config.lidar->data_port);
  const auto& allowed = seen.config.lidar->sources.allowed_source_addresses;
  const auto address = io::ParseIpAddress(sender);
  const bool is_allowed =
      allowed.empty() || std::ranges::any_of(allowed, [&address](const std::string& text) { return io::ParseIpAddress(text) == address; });
  if (!is_allowed) {
    return Warning(kNetworkSubject, words + ": refused, because allowed_source_address does not name it",
                   "if that is the lidar: allowed_source_address: \"" + sender + "\" in lidar.txtpb");
  }
  const auto own = std::ranges::find_if(seen.interfaces, [&address](const auto& interface) { return address && IsInNetwork(interface, *address); });
  if (own == seen.interfaces.end()) {
    return Warning(
        kNetworkSubject, words + ", but no address of this computer is in its network (" + InterfacesInWords(seen.interfaces) + ")",
        "broadcasts arrive, but the lidar's own page and packets to this computer alone do not: give the interface to the lidar an address of that "
        "network, e.g. ip address add <like " +
            sender + " with another last number>/24 dev <interface>");
  }
  return Ok(kNetworkSubject, words + "; this computer is " + io::ToText(*own->address) + " on " + own->name);
}

// Why nothing comes, as far as the interfaces tell.
Finding CheckSilentNetwork(const Observations& seen) {
  const auto factory = io::ParseIpAddress(kFactorySensor);
  const auto& allowed = seen.config.lidar->sources.allowed_source_addresses;
  const auto sensor = allowed.empty() ? factory : io::ParseIpAddress(allowed.front());
  const auto own = std::ranges::find_if(seen.interfaces, [&sensor](const auto& interface) { return sensor && IsInNetwork(interface, *sensor); });
  const auto name = sensor ? io::ToText(*sensor) : std::string();
  if (own == seen.interfaces.end()) {
    return Warning(
        kNetworkSubject, "no address of this computer is in the network of a lidar at " + name + " (" + InterfacesInWords(seen.interfaces) + ")",
        "give the interface to the lidar an address there, e.g. ip address add " + name.substr(0, name.rfind('.')) + ".77/24 dev <interface>");
  }
  if (!own->has_carrier) {
    return Fault(kNetworkSubject, own->name + " (" + io::ToText(*own->address) + ") has no carrier", "the cable to the lidar, and its power");
  }
  return Ok(kNetworkSubject, "this computer is " + io::ToText(*own->address) + " on " + own->name + ", in the network of a lidar at " + name);
}

std::string ReturnMode(const LidarSeen& lidar) {
  if (lidar.num_returns == 2) return "dual return";
  switch (lidar.return_kind) {
    case lidar_scan_t::RETURN_LAST:
      return "last return";
    case lidar_scan_t::RETURN_FIRST:
      return "first return";
    case lidar_scan_t::RETURN_SECOND:
      return "second return";
    default:
      return "strongest return";
  }
}

Finding CheckPackets(const Observations& seen) {
  const auto& lidar = seen.lidar;
  if (lidar.num_packets == 0 || (!lidar.is_capture && ToSeconds(seen.end - lidar.heard_last) > kLidarSilenceS)) {
    return Fault(kLidarSubject, lidar.complaint.empty() ? "no lidar packets" : lidar.complaint, kLidarCure);
  }
  if (lidar.model.empty()) {
    return Fault(kLidarSubject,
                 Count(lidar.num_packets, "packet") + ", but no scan was made of them" + (lidar.complaint.empty() ? "" : ": " + lidar.complaint),
                 "model in lidar.txtpb; services/lidar/README.md says which sensors are read");
  }
  const double span_s = ToSeconds(lidar.last - lidar.first);
  const double rate_hz = span_s > 0.0 ? static_cast<double>(lidar.num_packets - 1) / span_s : 0.0;
  const double period_s = ToSeconds(lidar.num_returns == 2 ? vlp16::format::kPacketPeriodDual : vlp16::format::kPacketPeriodSingle);
  const std::string expected = seen.config.lidar->other ? "" : " (" + Fixed(1.0 / period_s, 0) + " expected)";
  const double rpm = lidar.last_clock ? lidar.last_clock->rotation_rpm : std::nan("");
  const std::string words = lidar.model + ", " + ReturnMode(lidar) + ", " + Fixed(rate_hz, 0) + " packets/s" + expected + ", " +
                            (std::isfinite(rpm) ? Fixed(rpm, 0) + " rpm" : "rotation not known");
  if (lidar.first_clock && lidar.last_clock) {
    const auto num_lost = lidar.last_clock->num_lost_packets - lidar.first_clock->num_lost_packets;
    const auto num_came = lidar.last_clock->num_packets - lidar.first_clock->num_packets;
    if (static_cast<double>(num_lost) > kMaxLostShare * static_cast<double>(num_lost + num_came)) {
      return Warning(kLidarSubject, words + "; " + std::to_string(num_lost) + " packets lost of " + std::to_string(num_lost + num_came),
                     "cable and switch; load of this computer; receive buffers above");
    }
  }
  if (!lidar.complaint.empty())
    return Warning(kLidarSubject, words + "; " + lidar.complaint, "services/lidar/README.md tells what each complaint means");
  return Ok(kLidarSubject, words);
}

// The meaning of a state of the lidar's clock, and advice; the locked one apart.
struct ClockState {
  std::int32_t state;  // lidar_clock_t::STATE_...
  const char* text;
  const char* cure;
};
constexpr std::array kClockStates{
    ClockState{lidar_clock_t::STATE_LOCKED_WITHOUT_TIME, "the lidar has PPS, but no valid GPRMC",
               "the receiver's serial line to the lidar's interface box: 9600 baud, GPRMC once a second, polarity; and a fix"},
    ClockState{lidar_clock_t::STATE_ACQUIRING, "the lidar has PPS and is being set to it", "wait a few seconds and ask again"},
    ClockState{lidar_clock_t::STATE_NO_PPS, "the lidar gets no PPS", "the receiver's PPS line to the lidar's interface box; it needs a fix first"},
    ClockState{lidar_clock_t::STATE_FREE_RUNNING, "the lidar's clock runs free: PPS is gone, or does not fit the GPRMC",
               "the receiver's PPS and serial lines to the lidar's interface box"},
    ClockState{lidar_clock_t::STATE_ERROR, "the lidar says that its PPS is wrong", "PPS once a second, 3 to 15 V, at the lidar's interface box"}};
constexpr ClockState kClockNotKnown{lidar_clock_t::STATE_UNKNOWN, "no position packets of the lidar, so the state of its clock is not known",
                                    "position_port in lidar.txtpb and in the lidar; a firewall"};

Finding CheckSensorClock(const lidar_clock_t& clock) {
  const std::string source = clock.time_source == lidar_clock_t::TIME_SENSOR ? "; scans have the sensor's time" : "; scans have this computer's time";
  if (clock.state != lidar_clock_t::STATE_LOCKED) {
    const auto* const known = std::ranges::find(kClockStates, clock.state, &ClockState::state);
    const auto& state = known == kClockStates.end() ? kClockNotKnown : *known;
    return Warning(kClockSubject, state.text + source, state.cure);
  }
  const std::string locked = "the lidar is locked to PPS and GNSS time";
  if (std::abs(clock.offset_s) > kMaxClockDifferenceS) {
    return Warning(kClockSubject, locked + ", and this computer's clock is " + Fixed(clock.offset_s, 3) + " s ahead of it" + source,
                   "set this computer's clock: chrony with the GNSS receiver or NTP");
  }
  return Ok(kClockSubject, locked + "; this computer's clock is " + Fixed(1e3 * clock.offset_s, 1) + " ms ahead" + source);
}

// A clock that stamps with the whole time: nothing but this computer's clock, or that of the capture, says whether it is right.
Finding CheckWholeClock(const Observations& seen, std::chrono::microseconds host_minus_stamp, Utime stamp, const std::string& used) {
  const std::string whose = seen.lidar.is_capture ? "the capture's" : "this computer's";
  const auto difference = lidar::ClockDifferenceText(host_minus_stamp, stamp, whose);
  if (difference.empty())
    return Ok(kClockSubject, "the lidar's clock agrees with " + whose + " to " + Fixed(1e3 * ToSeconds(host_minus_stamp), 1) + " ms" + used);
  return Warning(
      kClockSubject, "the lidar's clock is not synchronised to UTC: " + difference + used,
      "nothing need be done where time_source is TIME_AUTO: this computer's clock stamps the scans, to some ms; else PTP with a master that "
      "sends UTC, or PPS with GPRMC");
}

std::optional<Finding> CheckWholeClock(const Observations& seen) {
  const auto& config = *seen.config.lidar;
  if (const auto& clock = seen.lidar.last_clock; clock && std::isfinite(clock->offset_s)) {
    const auto apart = std::chrono::microseconds(std::llround(clock->offset_s * 1e6));
    const bool is_sensors = clock->time_source == lidar_clock_t::TIME_SENSOR;
    const Utime stamp = Utime(std::chrono::microseconds(clock->utime_us)) - (is_sensors ? std::chrono::microseconds(0) : apart);
    return CheckWholeClock(seen, apart, stamp, is_sensors ? "; scans have the sensor's time" : "; scans have this computer's time");
  }
  for (const auto& speaker : seen.lidar.speakers) {
    if (speaker.host_minus_stamp && speaker.data_port == config.data_port)
      return CheckWholeClock(seen, *speaker.host_minus_stamp, *speaker.stamp, "");
  }
  return std::nullopt;
}

// Whether packets of the config's model are stamped with the whole time.
bool HasWholeClock(const Observations& seen) {
  const auto& config = seen.config.lidar;
  return config && config->other && !lidar::RowOf(config->other->model).has_position_packets;
}

// Without a config for them.
Findings CheckClocksOfSpeakers(const Observations& seen) {
  Findings findings;
  for (const auto& speaker : seen.lidar.speakers) {
    if (speaker.host_minus_stamp) findings.push_back(CheckWholeClock(seen, *speaker.host_minus_stamp, *speaker.stamp, ""));
  }
  return findings;
}

}  // namespace

Findings CheckLidar(const Observations& seen) {
  if (!seen.config.lidar) return {Warning(kLidarSubject, "not checked: lidar.txtpb is wrong", "correct it first")};
  const auto& lidar = seen.lidar;
  const auto kind = seen.config.lidar->sources.kind;
  const bool is_sensor = lidar.is_capture || kind == lidar::Sources::Kind::kUdp || kind == lidar::Sources::Kind::kInterface;
  if (!is_sensor) return {Warning(kLidarSubject, "lidar.txtpb names captures or a log: no sensor is checked", "source: UDP for a sensor")};
  if (!lidar.fault.empty()) {
    return {Fault(kLidarSubject, lidar.fault, "correct what the line names; if lookout-lidar is running on another bus, end it")};
  }
  Findings findings{CheckPackets(seen)};
  for (const auto& [sender, num_datagrams] : lidar.num_by_sender) findings.push_back(CheckSender(seen, sender, num_datagrams));
  if (lidar.num_packets == 0 && lidar.num_by_sender.empty() && !lidar.is_capture) findings.push_back(CheckSilentNetwork(seen));
  return findings;
}

Findings CheckClocks(const Observations& seen) {
  Findings findings;
  if (seen.lidar.is_capture && seen.lidar.model.empty()) return CheckClocksOfSpeakers(seen);
  if (HasWholeClock(seen)) {
    const auto finding = CheckWholeClock(seen);
    if (finding) findings.push_back(*finding);
    if (finding && finding->grade == Grade::kOk) return findings;
  } else if (const auto& clock = seen.lidar.last_clock) {
    findings.push_back(CheckSensorClock(*clock));
    if (clock->state == lidar_clock_t::STATE_LOCKED) return findings;  // which has measured this computer's
  }
  if (seen.lidar.is_capture) return findings;
  findings.push_back(seen.is_host_clock_set
                         ? Ok(kClockSubject, "this computer's clock is steered (NTP or PPS)")
                         : Warning(kClockSubject, "nothing steers this computer's clock, which stamps data without a time of their own",
                                   "install chrony, with the GNSS receiver or NTP as its source"));
  return findings;
}

}  // namespace lookout::doctor
