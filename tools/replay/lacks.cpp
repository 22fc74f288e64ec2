#include "tools/replay/lacks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lookout::replay {

namespace {

constexpr std::size_t kMaxPortsNamed = 8;
// So much of a run is without a place before the first position; a longer time is told.
constexpr double kUsualShareWithoutPlace = 0.1;

std::string PortList(const std::vector<int>& ports) { return fmt::format("{} {}", ports.size() == 1 ? "port" : "ports", fmt::join(ports, ", ")); }

// Ports whose datagrams look as if they were meant.
std::vector<int> Likely(const OtherPorts& ports, std::int64_t OtherPort::*count) {
  std::vector<int> likely;
  for (const auto& [port, seen] : ports) {
    if (2 * seen.*count > seen.num_datagrams) likely.push_back(port);
  }
  return likely;
}

// "; datagrams came to other ports: ..." and what to do where one looks right.
std::string OtherPortsHint(const OtherPorts& ports, std::int64_t OtherPort::*count, const std::string& remedy) {
  if (ports.empty()) return "";
  const auto likely = Likely(ports, count);
  return "; datagrams came to other ports: " + PortsText(ports) + (likely.empty() ? "" : fmt::format("; {} {}", remedy, fmt::join(likely, " or ")));
}

// Without scans.
std::string NoScans(const Seen& seen) {
  constexpr const char* kSo = "no scans, segments, obstacles, tracks and alerts are computed";
  if (seen.input == Seen::Input::kTextLog) return fmt::format("a text log holds no lidar packets: {}", kSo);
  if (seen.input == Seen::Input::kLog) {
    return seen.num_lidar_packets == 0 ? fmt::format("the log holds no LIDAR_PACKETS: {}", kSo)
                                       : fmt::format("no scan came out of {} messages of LIDAR_PACKETS: {}", seen.num_lidar_packets, kSo);
  }
  if (seen.num_lidar_packets > 0) return fmt::format("no scan came out of {} lidar packets: {}", seen.num_lidar_packets, kSo);
  return fmt::format("no lidar packet came to port {} (data_port of lidar.txtpb): {}{}", seen.data_port, kSo,
                     OtherPortsHint(seen.other_ports, &OtherPort::num_lidar_packets, "set data_port to"));
}

std::string NoSentences(const Seen& seen) {
  if (seen.input == Seen::Input::kLog) return "the log holds no sentence of NMEA 0183 (NAV_RAW, LIDAR_NMEA)";
  if (seen.input == Seen::Input::kTextLog) return "the text log holds no sentence of NMEA 0183";
  const auto where = seen.sentence_ports.empty() ? std::string("no input of navigator.txtpb has a UDP port")
                                                 : fmt::format("none to {} (navigator.txtpb)", PortList(seen.sentence_ports));
  return fmt::format("no sentence of NMEA 0183 came: none from the lidar, {}{}", where,
                     OtherPortsHint(seen.other_ports, &OtherPort::num_sentences, "give navigator.txtpb the port"));
}

// Consequences where nothing is placed.
std::string NoPlaceMeans(const Seen& seen) {
  if (!seen.wants_tracks || seen.num_scans == 0) return "";
  if (seen.poses.num_relative > 0) {
    return ": obstacles, tracks, closest approach and alerts are there, but without a place on the earth: " + seen.poses.RelativeInWords() +
           "; charts, KML and GPX stay empty. For places give the boat a GNSS receiver and a compass";
  }
  return ": obstacles are known in the vessel frame alone (range and bearing), there are no tracks and no closest approach; the guard zone works";
}

}  // namespace

std::string PortsText(const OtherPorts& ports) {
  std::vector<std::pair<int, OtherPort>> busiest(ports.begin(), ports.end());
  std::ranges::stable_sort(busiest, [](const auto& one, const auto& other) { return one.second.num_datagrams > other.second.num_datagrams; });
  std::string text;
  for (std::size_t i = 0; i < std::min(busiest.size(), kMaxPortsNamed); ++i) {
    const auto& [port, seen] = busiest[i];
    const char* const looks = 2 * seen.num_lidar_packets > seen.num_datagrams ? ", as a lidar sends them"
                              : 2 * seen.num_sentences > seen.num_datagrams   ? ", sentences"
                                                                              : "";
    text +=
        fmt::format("{}{} ({} {}{})", text.empty() ? "" : ", ", port, seen.num_datagrams, seen.num_datagrams == 1 ? "datagram" : "datagrams", looks);
  }
  if (busiest.size() > kMaxPortsNamed) text += fmt::format(" and {} more", busiest.size() - kMaxPortsNamed);
  return text;
}

std::vector<std::string> Lacks(const Seen& seen) {
  std::vector<std::string> lines;
  if (seen.wants_scans && seen.num_scans == 0) lines.push_back(NoScans(seen));
  const auto& poses = seen.poses;
  const auto why = poses.WhyNotPlaced();
  if (!why.empty() && (seen.wants_poses || seen.wants_tracks)) {
    const bool has_no_sentence = seen.wants_poses && seen.num_sentences == 0;
    lines.push_back(fmt::format("nothing has a place on the earth, as {}{}", has_no_sentence ? NoSentences(seen) : why, NoPlaceMeans(seen)));
    return lines;
  }
  if (poses.num_placed > 0 && poses.num_by_course == poses.num_placed) {
    lines.push_back(
        fmt::format("heading is course over ground in all {} poses that have one (no compass): at rest, adrift and astern it is not where "
                    "the bow points",
                    poses.num_placed));
  }
  if (poses.num_relative > 0) {
    lines.push_back("position and heading on the earth were known for a part of the run only; of the rest, obstacles and tracks have no latitude: " +
                    poses.RelativeInWords());
  }
  if (!seen.wants_tracks || seen.num_scans == 0) return lines;
  const auto num_obstacles = seen.num_obstacles_placed + seen.num_obstacles_unplaced;
  if (num_obstacles > 0 && seen.num_obstacles_placed == 0) {
    lines.push_back(fmt::format("position and heading are known, but not at the time of a scan{}", NoPlaceMeans(seen)));
  } else if (static_cast<double>(seen.num_obstacles_unplaced) > kUsualShareWithoutPlace * static_cast<double>(num_obstacles)) {
    lines.push_back(
        fmt::format("{} of {} obstacles have no place, as position or heading was not known at their time: while that is so there are no "
                    "tracks; the guard zone works",
                    seen.num_obstacles_unplaced, num_obstacles));
  }
  return lines;
}

}  // namespace lookout::replay
