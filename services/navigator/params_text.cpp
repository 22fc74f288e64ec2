// What --check says of the inputs.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"
#include "common/core/elementary.hpp"
#include "services/navigator/core/nmea.hpp"
#include "services/navigator/core/sentence.hpp"
#include "services/navigator/params.hpp"

namespace lookout::navigator {

namespace {

std::string PlaceInWords(const Params& params, const std::string& name) {
  const auto connection = std::ranges::find(params.connections, name, &Connection::name);
  if (connection == params.connections.end()) return name == kLidarSource ? "the lidar's position packets" : "not opened live";
  const auto port = " port " + std::to_string(connection->port);
  switch (connection->kind) {
    case Connection::Kind::kUdp:
      return "UDP on " + connection->address + port;
    case Connection::Kind::kSerial:
      return "serial port " + connection->file.string() + ", " + std::to_string(connection->baud) + " baud, 8N1";
    case Connection::Kind::kTcp:
      return "TCP server " + connection->address + port;
    case Connection::Kind::kGpsd:
      return "gpsd at " + connection->address + port;
    case Connection::Kind::kTextLog:
      return "text log " + connection->file.string() + ", played at its own times: POSE is not of now";
  }
  return {};
}

std::string RoleInWords(Role role) {
  switch (role) {
    case Role::kAll:
      return "all that its sentences say is used";
    case Role::kGnss:
      return "positions and velocities are used";
    case Role::kHeading:
      return "headings and rates of turn are used";
    case Role::kAttitude:
      return "headings, roll, pitch and rates of turn are used";
    case Role::kImu:
      return "raw angular velocity and specific force are used";
    case Role::kNothing:
      return "recorded only";
  }
  return {};
}

// The first position in what a text log begins with; a live input has none before it is opened.
std::optional<GeodeticPosition> FirstPosition(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = 1'000'000;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  std::ifstream in(file, std::ios::binary);
  std::string text(kMaxBytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  for (const auto& line : lines.lines) {
    const auto [fault, sentence] = ParseSentence(line);
    if (fault == SentenceFault::kNone && sentence.position && IsMeasured(sentence.quality)) return sentence.position;
  }
  return std::nullopt;
}

// Before the first fix nothing can be said of a datum, but against the positions of text logs.
std::string DatumInWords(const Params& params) {
  const auto& datum = params.navigator.filter.datum;
  if (!datum) return "# datum: the first fix of the run.\n";
  const GeodeticPlace place{datum->latitude_deg, datum->longitude_deg, 0.0};
  std::string words = "# datum: " + PlaceInWords(place) + ", of boat.txtpb.";
  bool is_compared = false;
  for (const auto& connection : params.connections) {
    if (connection.kind != Connection::Kind::kTextLog) continue;
    const auto position = FirstPosition(connection.file);
    if (!position) continue;
    is_compared = true;
    const auto complaint =
        DatumComplaint(place, {position->latitude_deg, position->longitude_deg, 0.0}, "the first position of text log " + connection.file.string());
    words += complaint.empty() ? " The first position of text log " + connection.file.string() + " is within 50 km." : "\n# WARNING: " + complaint;
  }
  return words +
         (is_compared
              ? "\n"
              : " Not compared with a position: there is none before the run; HEALTH and lookout-doctor name a datum that is far from the fix.\n");
}

// "0.87 m below the level of the reference point"
std::string HeightInWords(double height_m) {
  constexpr double kCentimetresPerMetre = 100.0;
  const auto centimetres = std::llround(std::abs(height_m) * kCentimetresPerMetre);
  const auto hundredths = std::to_string(centimetres % 100);
  return std::to_string(centimetres / 100) + "." + (hundredths.size() < 2 ? "0" : "") + hundredths + " m " + (height_m < 0 ? "below" : "above") +
         " the level of the reference point.\n";
}

std::string SourceInWords(const Params& params, const SourceParams& source) {
  // What the sensor says in the examples.
  constexpr double kExampleDeg = 5.0;
  constexpr double kExampleM = 10.0;
  const auto& navigator = params.navigator;
  const double pitch_rad = source.pitch_sign * DegToRad(kExampleDeg) + navigator.pitch_offset_rad;
  const double roll_rad = source.roll_sign * DegToRad(kExampleDeg) + navigator.roll_offset_rad;
  const double ahead_up_m = kExampleM * Sin(pitch_rad);
  const double starboard_up_m = -kExampleM * Sin(roll_rad);
  std::string words = "# input '" + source.name + "': " + PlaceInWords(params, source.name) + "; " + RoleInWords(source.role) + ".\n";
  if (source.role == Role::kAll || source.role == Role::kAttitude) {
    words += "#   pitch: bow " + std::string(source.pitch_sign > 0 ? "up" : "down") +
             " is positive; where the sensor says +5 deg, an object 10 m ahead along the deck would be at " + HeightInWords(ahead_up_m);
    words += "#   roll: " + std::string(source.roll_sign > 0 ? "starboard" : "port") +
             " side down is positive; where the sensor says +5 deg, an object 10 m to starboard along the deck would be at " +
             HeightInWords(starboard_up_m);
  }
  if (source.role != Role::kGnss && source.role != Role::kImu && source.role != Role::kNothing) {
    const bool has_all = source.deviation_rad && source.declination_rad;
    words +=
        std::string("#   magnetic headings (HDG, HDM): ") + (source.deviation_rad ? "deviation" : "no deviation") + " and " +
        (source.declination_rad ? "declination" : "no declination") + " given here; " +
        (has_all ? "they count.\n" : "where their sentence says neither they are refused (a declination in RMC of the same input counts too).\n");
  }
  words += source.latency ? "#   sentences without a time: measured " + std::to_string(source.latency->count() / 1000) + " ms before they arrive.\n"
                          : "#   sentences without a time: measured when they arrive, for latency_s is not given.\n";
  return words;
}

}  // namespace

std::string InWords(const Params& params) {
  if (params.input == Input::kLog) return "# reads NAV_RAW from the bus; nothing is opened\n";
  // Those that config does not name have the defaults.
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
