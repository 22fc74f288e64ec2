// Which lidars speak, the lines that lidar.txtpb needs for them, and where they look.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/ouster_metadata.hpp"
#include "services/lidar/survey.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kSensorSubject = "lidar";
constexpr const char* kCableSubject = "network";
constexpr const char* kWindowSubject = "window";

// "data_port: 7502 position_port: 7503", for one line.
std::string LinesOf(const lidar::Speaker& speaker) {
  auto lines = lidar::ConfigLines(speaker);
  std::ranges::replace(lines, '\n', ' ');
  if (!lines.empty()) lines.pop_back();
  return lines;
}

std::string LayoutText(const lidar::OusterLayout& layout) {
  return fmt::format("{} with {} rings, {} columns a packet", NameOf(layout.profile), layout.pixels_per_column, layout.columns_per_packet);
}

std::string LayoutsText(const lidar::Speaker& speaker) {
  std::vector<std::string> texts;
  texts.reserve(speaker.layouts.size());
  for (const auto& layout : speaker.layouts) texts.push_back(LayoutText(layout));
  return fmt::format("{}", fmt::join(texts, " or "));
}

std::string SpeakerText(const lidar::Speaker& speaker) {
  std::string text = speaker.name;
  if (!speaker.layouts.empty()) text += " (" + LayoutsText(speaker) + ")";
  if (!speaker.source_address.empty()) text += " at " + speaker.source_address;
  text +=
      " sends to " + (speaker.destination_address.empty() ? "" : speaker.destination_address + ", ") + "port " + std::to_string(speaker.data_port);
  return text + ": " + Count(speaker.num_packets, "packet") + " of " + std::to_string(speaker.size_bytes) + " bytes";
}

// A finding where the packets do not fit the metadata file; nullopt where they do, or where the sensor itself is asked.
std::optional<Finding> CheckMetadata(const lidar::Speaker& speaker, const lidar::Params& config) {
  if (config.other->beam_text.empty()) return std::nullopt;
  const auto metadata = lidar::ParseOusterMetadata(config.other->beam_text);
  const lidar::OusterLayout told{metadata.profile, metadata.pixels_per_column, metadata.columns_per_packet};
  if (std::ranges::find(speaker.layouts, told) != speaker.layouts.end()) return std::nullopt;
  return Fault(kSensorSubject, "the metadata file says " + LayoutText(told) + ", but the " + metadata.ModelName() + " sends " + LayoutsText(speaker),
               "the sensor was set to another profile or mode, or the file is of another sensor: fetch the metadata anew, curl http://" +
                   (speaker.source_address.empty() ? "SENSOR" : speaker.source_address) + "/api/v1/sensor/metadata");
}

bool IsOf(const lidar::Speaker& speaker, const lidar::Params& config) {
  const bool is_model = config.other ? speaker.other == config.other->model : speaker.is_of_vlp16_family;
  return is_model && config.data_port == speaker.data_port;
}

// The config of this speaker, of the boat's two; nullptr: it fits neither.
const lidar::Params* ConfigOf(const lidar::Speaker& speaker, const ConfigSeen& config) {
  if (config.lidar && IsOf(speaker, *config.lidar)) return &*config.lidar;
  if (config.lidar_2 && IsOf(speaker, *config.lidar_2)) return &*config.lidar_2;
  return nullptr;
}

std::string ConfigText(const ConfigSeen& seen, const lidar::Params& config) {
  return (config.number == 1 ? seen.lidar_place : lidar::ConfigFileName(config.number)) + " is for " +
         lidar::ModelWord(config.other ? std::optional(config.other->model) : std::nullopt) + " on port " + std::to_string(config.data_port);
}

Finding CheckSpeaker(const lidar::Speaker& speaker, const Observations& seen) {
  const auto text = SpeakerText(speaker);
  if (!speaker.is_of_vlp16_family && !speaker.other) {
    return Warning(kSensorSubject, text + ", which are not read", "services/lidar/README.md says which sensors are read");
  }
  const auto& config = seen.config;
  if (!config.lidar) return Warning(kSensorSubject, text, "lines for " + config.lidar_place + ": " + LinesOf(speaker));
  if (const auto* own = ConfigOf(speaker, config)) {
    if (speaker.other == lidar::OtherModel::kOuster) {
      if (auto fault = CheckMetadata(speaker, *own)) return *fault;
    }
    return Ok(kSensorSubject, text);
  }
  const auto config_for = ConfigText(config, *config.lidar) + (config.lidar_2 ? ", " + ConfigText(config, *config.lidar_2) : "");
  // A lidar beside the one that is used takes no place of its.
  const bool is_first_heard =
      !seen.lidar.model.empty() || std::ranges::any_of(seen.lidar.speakers, [&](const auto& other) { return IsOf(other, *config.lidar); });
  if (!is_first_heard) return Fault(kSensorSubject, text + ", but " + config_for, "lines for " + config.lidar_place + ": " + LinesOf(speaker));
  return Warning(kSensorSubject, text + "; " + config_for,
                 "if it is the second lidar of the boat (services/lidar/README.md, \"Two lidars\"): lines for lidar_2.txtpb: " + LinesOf(speaker) +
                     "; if that is the lidar to use: the same lines for " + config.lidar_place);
}

bool IsBroadcast(const std::string& address) { return address.size() > 4 && address.ends_with(".255"); }

// Where it sends to, as far as frames tell.
std::optional<Finding> CheckDestination(const lidar::Speaker& speaker, const Observations& seen) {
  const auto& to = speaker.destination_address;
  const auto address = io::ParseIpAddress(to);
  if (!address || address->is_multicast()) return std::nullopt;
  const auto who = speaker.name + " sends to " + to + ", port " + std::to_string(speaker.data_port);
  const bool is_own = std::ranges::any_of(seen.interfaces, [&](const auto& interface) { return interface.address == address; });
  if (!seen.lidar.is_capture && !is_own && !IsBroadcast(to)) {
    return Warning(kCableSubject, who + ", which is no address of this computer: its sockets do not hear that",
                   "the destination on the lidar's own page: this computer's address or 255.255.255.255; or source: INTERFACE in lidar.txtpb");
  }
  const auto* const own = ConfigOf(speaker, seen.config);
  const auto* const config = own != nullptr ? own : seen.config.lidar ? &*seen.config.lidar : nullptr;
  if (config == nullptr || config->sources.kind != lidar::Sources::Kind::kUdp) return std::nullopt;
  const auto& bind = config->sources.bind_address;
  const auto file = lidar::ConfigFileName(config->number);
  const auto bound = io::ParseIpAddress(bind.substr(0, bind.find('%')));
  if (bound && !bound->is_any() && bound != address) {
    return Warning(kCableSubject, who + ", but bind_address in " + file + " is " + bind + ", which does not hear that",
                   "bind_address: \"0.0.0.0\" in " + file + ", or the destination on the lidar's own page");
  }
  return std::nullopt;
}

// Stretch of the circle, in whole degrees.
struct Stretch {
  int begin_deg = 0;
  int size_deg = 0;
};

// The longest stretch into which nothing is fired.
Stretch DarkStretch(const std::array<AzimuthSeen, 360>& azimuths) {
  Stretch longest;
  Stretch now;
  for (int i = 0; i < 720; ++i) {
    if (azimuths.at(static_cast<std::size_t>(i % 360)).num_shots > 0) {
      now = {};
      continue;
    }
    if (now.size_deg++ == 0) now.begin_deg = i % 360;
    if (now.size_deg > longest.size_deg && now.size_deg <= 360) longest = now;
  }
  return longest;
}

// Clockwise from the bow, of an azimuth of the lidar.
double BearingDeg(const config::BoatFacts& boat, double azimuth_deg) {
  const double azimuth_rad = DegToRad(azimuth_deg);
  const Eigen::Vector3d direction = boat.T_vessel_lidar.linear() * Eigen::Vector3d(std::cos(azimuth_rad), -std::sin(azimuth_rad), 0.0);
  return RadToDeg(WrapTo2Pi(-std::atan2(direction.y(), direction.x())));
}

}  // namespace

Findings CheckSpeakers(const Observations& seen) {
  Findings findings;
  for (const auto& speaker : seen.lidar.speakers) {
    auto finding = CheckSpeaker(speaker, seen);
    // Live the line of the packets tells of the lidar that is used.
    if (seen.lidar.is_capture || finding.grade != Grade::kOk) findings.push_back(std::move(finding));
    if (const auto destination = CheckDestination(speaker, seen)) findings.push_back(*destination);
  }
  if (seen.lidar.num_fragments_lost > 0) {
    findings.push_back(Warning(
        kCableSubject, Count(seen.lidar.num_fragments_lost, "datagram") + " lost because IP fragments of them did not come: each is a lidar packet",
        "cable and switch; jumbo frames on both ends; sysctl net.ipv4.ipfrag_high_thresh; a profile with smaller packets"));
  }
  return findings;
}

Findings CheckWindow(const Observations& seen) {
  const auto& azimuths = seen.lidar.azimuths;
  std::int64_t num_shots = 0;
  for (const auto& azimuth : azimuths) num_shots += azimuth.num_shots;
  if (num_shots > 0 && std::ranges::all_of(azimuths, [](const auto& azimuth) { return azimuth.num_returns == 0; })) {
    return {Warning(kWindowSubject, fmt::format("the lidar fires, and none of its {} beams returned: lasers off, or window covered", num_shots),
                    "look at the lidar, and walk past it; over flat water, with nothing near and the own boat not in sight, it may be well")};
  }
  const auto dark = DarkStretch(azimuths);
  constexpr int kWholeDeg = 5;  // a gap as small as that is no window
  if (dark.size_deg <= kWholeDeg || dark.size_deg >= 360) return {};
  const int begin_deg = (dark.begin_deg + dark.size_deg) % 360;
  const int size_deg = 360 - dark.size_deg;
  std::string text = fmt::format("the lidar fires into {} of 360 deg alone, azimuth {} to {} deg", size_deg, begin_deg, dark.begin_deg);
  if (!seen.config.boat) return {Ok(kWindowSubject, text)};
  const auto& boat = *seen.config.boat;
  double from_deg = BearingDeg(boat, begin_deg);
  double to_deg = BearingDeg(boat, dark.begin_deg);
  if (boat.T_vessel_lidar.linear()(2, 2) < 0.0) std::swap(from_deg, to_deg);
  text += fmt::format(", which is {:.0f} to {:.0f} deg clockwise from the bow", from_deg, to_deg);
  const auto num_own = std::ranges::count_if(azimuths, [](const auto& azimuth) { return 2 * azimuth.num_own > azimuth.num_shots; });
  const char* const cure =
      "the azimuth window on the lidar's own page (Ouster: azimuth_window; Velodyne, Hesai: field of view); away from the mast, and ahead";
  constexpr int kMaxOwnQuarter = 4;
  if (kMaxOwnQuarter * num_own > size_deg) {
    return {Warning(kWindowSubject, text + fmt::format("; in {} deg of it most shots hit own_vessel: it faces the mast or the hull", num_own), cure)};
  }
  const bool is_ahead = WrapTo2Pi(DegToRad(0.0 - from_deg)) <= WrapTo2Pi(DegToRad(to_deg - from_deg));
  if (!is_ahead) return {Warning(kWindowSubject, text + ": nothing ahead is seen", cure)};
  constexpr int kNarrowDeg = 120;
  if (size_deg < kNarrowDeg) return {Warning(kWindowSubject, text + ": that is narrow for a look-out", cure)};
  return {Ok(kWindowSubject, text)};
}

Findings CheckCaptures(const Observations& seen) {
  Findings findings;
  const auto file = seen.config.files.find("lidar.txtpb");
  if (file != seen.config.files.end()) {
    ConfigSeen lidar_alone;
    lidar_alone.files.insert(*file);
    findings = CheckConfig(lidar_alone);
  }
  const auto add = [&findings](Findings more) { std::ranges::move(more, std::back_inserter(findings)); };
  add(CheckSpeakers(seen));
  if (seen.lidar.speakers.empty()) {
    findings.push_back(Fault(kSensorSubject, "no datagram in the captures is of a lidar that is known",
                             "services/lidar/README.md says which sensors are read; capture with tcpdump -s 0 -i <interface> udp"));
  }
  if (seen.config.lidar && !seen.lidar.speakers.empty()) add(CheckLidar(seen));
  add(CheckWindow(seen));
  add(CheckClocks(seen));
  return findings;
}

}  // namespace lookout::doctor
