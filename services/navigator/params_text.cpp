// The words of --check for the inputs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"
#include "common/core/elementary.hpp"
#include "common/io/text_file.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "services/navigator/core/nmea.hpp"
#include "services/navigator/params.hpp"

namespace lookout::navigator {

namespace {

std::string PlaceInWords(const Params& params, const std::string& name) {
  const auto connection = std::ranges::find(params.connections, name, &Connection::name);
  if (connection == params.connections.end()) return name == kLidarSource ? "the lidar's position packets" : "not opened live";
  switch (connection->kind) {
    case Connection::Kind::kUdp:
      return fmt::format("UDP on {} port {}", connection->address, connection->port);
    case Connection::Kind::kSerial:
      return fmt::format("serial port {}, {} baud, 8N1", connection->file.string(), connection->baud);
    case Connection::Kind::kTcp:
      return fmt::format("TCP server {} port {}", connection->address, connection->port);
    case Connection::Kind::kGpsd:
      return fmt::format("gpsd at {} port {}", connection->address, connection->port);
    case Connection::Kind::kTextLog:
      return fmt::format("text log {}, played at its own times: POSE is not of now", connection->file.string());
  }
  return {};
}

std::string RoleInWords(Role role) {
  static constexpr std::array kWords{"all that its sentences say is used",
                                     "positions and velocities are used",
                                     "headings and rates of turn are used",
                                     "headings, roll, pitch and rates of turn are used",
                                     "raw angular velocity and specific force are used",
                                     "recorded only"};
  return kWords.at(static_cast<std::size_t>(role) - static_cast<std::size_t>(Role::kAll));
}

// The first position in the beginning of a text log; a live input has none before it is opened.
std::optional<GeodeticPlace> FirstPosition(const std::filesystem::path& file) try {
  constexpr std::size_t kMaxBytes = 1'000'000;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  io::TextFile in(file);
  std::string text;
  for (char letter = 0; text.size() < kMaxBytes && in.Get(letter);) text += letter;
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  for (const auto& line : lines.lines) {
    const auto [fault, sentence] = ParseSentence(line);
    if (fault == SentenceFault::kNone && sentence.position && IsMeasured(sentence.quality)) return sentence.position;
  }
  return std::nullopt;
} catch (const std::runtime_error&) {
  return std::nullopt;  // the file cannot be read, which opening it will report
}

// Before the first fix nothing can be said of a datum, but against the positions of text logs.
std::string DatumInWords(const Params& params) {
  const auto& datum = params.navigator.filter.datum;
  if (!datum) return "# datum: the first fix of the run.\n";
  std::string words = "# datum: " + PlaceInWords(*datum) + ", of boat.txtpb.";
  bool is_compared = false;
  for (const auto& connection : params.connections) {
    if (connection.kind != Connection::Kind::kTextLog) continue;
    const auto position = FirstPosition(connection.file);
    if (!position) continue;
    is_compared = true;
    const auto what = "first position of text log " + connection.file.string();
    const auto complaint = DatumComplaint(*datum, *position, "the " + what);
    words += complaint.empty() ? " The " + what + " is within 50 km." : "\n# WARNING: " + complaint;
  }
  return words +
         (is_compared
              ? "\n"
              : " Not compared with a position: there is none before the run; HEALTH and lookout-doctor name a datum that is far from the fix.\n");
}

std::string HeightInWords(double height_m) {
  return fmt::format("{:.2f} m {} the level of the reference point.\n", std::abs(height_m), height_m < 0 ? "below" : "above");
}

std::string SourceInWords(const Params& params, const SourceParams& source) {
  // The sensor's angles in the examples.
  constexpr double kExampleDeg = 5.0;
  constexpr double kExampleM = 10.0;
  const auto& navigator = params.navigator;
  const double pitch_rad = source.pitch_sign * DegToRad(kExampleDeg) + navigator.pitch_offset_rad;
  const double roll_rad = source.roll_sign * DegToRad(kExampleDeg) + navigator.roll_offset_rad;
  const double ahead_up_m = kExampleM * Sin(pitch_rad);
  const double starboard_up_m = -kExampleM * Sin(roll_rad);
  const bool is_autopilot = source.protocol == Protocol::kMavlink;
  std::string words = fmt::format(
      "# input '{}': {}; {}{}.\n", source.name, PlaceInWords(params, source.name),
      is_autopilot ? fmt::format("MAVLink of system {}, component {}; ", source.mavlink_system_id, MavlinkCutter::kAutopilotComponent) : "",
      RoleInWords(source.role));
  if (is_autopilot && (source.role == Role::kAll || source.role == Role::kGnss)) {
    words +=
        "#   positions are those of the autopilot's own origin, and only while its receiver has a fix: gnss_antenna of boat.txtpb must be that "
        "place\n";
  }
  if (source.role == Role::kAll || source.role == Role::kAttitude) {
    words += fmt::format("#   pitch: bow {} is positive; where the sensor says +5 deg, an object 10 m ahead along the deck would be at {}",
                         source.pitch_sign > 0 ? "up" : "down", HeightInWords(ahead_up_m));
    words +=
        fmt::format("#   roll: {} side down is positive; where the sensor says +5 deg, an object 10 m to starboard along the deck would be at {}",
                    source.roll_sign > 0 ? "starboard" : "port", HeightInWords(starboard_up_m));
  }
  if (!is_autopilot && source.role != Role::kGnss && source.role != Role::kImu && source.role != Role::kNothing) {
    words += fmt::format("#   magnetic headings (HDG, HDM): {} and {} given here; {}.\n", source.deviation_rad ? "deviation" : "no deviation",
                         source.declination_rad ? "declination" : "no declination",
                         source.deviation_rad && source.declination_rad
                             ? "they count"
                             : "where their sentence says neither they are refused (a declination in RMC of the same input counts too)");
  }
  words += source.latency ? fmt::format("#   sentences without a time: measured {} ms before they arrive.\n", source.latency->count() / 1000)
                          : "#   sentences without a time: measured when they arrive, for latency_s is not given.\n";
  return words;
}

}  // namespace

std::string InWords(const Params& params) {
  if (params.reads_nav_raw) return "# reads NAV_RAW from the bus; nothing is opened\n";
  // Sources that config does not name have the defaults.
  auto sources = params.navigator.sources;
  const auto add = [&sources](const std::string& name) {
    if (std::ranges::find(sources, name, &SourceParams::name) == sources.end()) {
      SourceParams source;
      source.name = name;
      sources.push_back(std::move(source));
    }
  };
  for (const auto& connection : params.connections) add(connection.name);
  if (params.use_lidar_nmea) add(kLidarSource);
  std::string words;
  for (const auto& source : sources) words += SourceInWords(params, source);
  return words + DatumInWords(params);
}

}  // namespace lookout::navigator
