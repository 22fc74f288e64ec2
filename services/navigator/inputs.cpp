#include "services/navigator/inputs.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"
#include "common/core/elementary.hpp"
#include "common/io/ip_address.hpp"
#include "services/navigator/core/day.hpp"
#include "services/navigator/core/nmea.hpp"
#include "services/navigator/core/sentence.hpp"

namespace lookout::navigator {

namespace {

// What termios of Linux has names for, from 1200 on.
constexpr std::array kBauds{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 1000000, 2000000, 4000000};

Role ToRole(config::NavigationInput::Role role) {
  switch (role) {
    case config::NavigationInput::GNSS:
      return Role::kGnss;
    case config::NavigationInput::HEADING:
      return Role::kHeading;
    case config::NavigationInput::ATTITUDE:
      return Role::kAttitude;
    case config::NavigationInput::IMU:
      return Role::kImu;
    case config::NavigationInput::RECORD_ONLY:
      return Role::kNothing;
    default:
      return Role::kAll;
  }
}

SourceParams ToSource(const config::NavigationInput& input) {
  SourceParams source;
  source.name = input.name();
  source.role = ToRole(input.role());
  source.requires_checksum = input.checksum_required();
  if (input.has_latency_s()) source.latency = std::chrono::microseconds(std::llround(input.latency_s() * 1e6));
  source.roll_sign = input.roll_positive() == config::NavigationInput::PORT_DOWN ? -1.0 : 1.0;
  source.pitch_sign = input.pitch_positive() == config::NavigationInput::BOW_DOWN ? -1.0 : 1.0;
  if (input.has_deviation_deg()) source.deviation_rad = DegToRad(input.deviation_deg());
  if (input.has_declination_deg()) source.declination_rad = DegToRad(input.declination_deg());
  return source;
}

bool IsReadableFile(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error) && std::ifstream(file);
}

// Collects what is wrong with the inputs, each fault at the line where its input begins.
class Inputs {
 public:
  Inputs(const std::filesystem::path& config_folder, const config::Navigator& message) : folder_(config_folder), message_(message) {}

  void TakeInto(Params& params) {
    const bool has_udp = !message_.bind_address().empty();
    if (has_udp) {
      Require(io::ParseIpAddress(message_.bind_address()).has_value(), "bind_address", "'" + message_.bind_address() + "' is no numeric address");
      params.connections.push_back(
          {.name = kUdpSource, .kind = Connection::Kind::kUdp, .address = message_.bind_address(), .port = message_.nmea_port(), .file = {}});
      params.source_of_port[message_.nmea_port()] = kUdpSource;
    }
    for (index_ = 0; index_ < message_.input_size(); ++index_) Take(message_.input(index_), params);
    // In captures there is always one, unless another input has its port.
    params.source_of_port.try_emplace(message_.nmea_port(), kUdpSource);
    if (message_.source() == config::Navigator::LIVE) {
      CheckTextLogs(params);
      Require(!params.connections.empty() || message_.use_lidar_nmea(), "source",
              "is LIVE, but there is nothing to take: neither bind_address, nor use_lidar_nmea, nor an input");
    }
    if (!faults_.empty()) throw config::ConfigError(faults_);
  }

 private:
  void Require(bool is_fine, const std::string& field, const std::string& reason, int index = 0) {
    if (!is_fine) faults_.push_back(config::FaultLine(folder_ / "navigator.txtpb", field, reason, static_cast<std::size_t>(index)));
  }
  void RequireOfInput(bool is_fine, const std::string& reason) {
    Require(is_fine, "input", "'" + message_.input(index_).name() + "': " + reason, index_);
  }

  // A text log has times of its own, and what comes live those of now: they make no one sequence.
  void CheckTextLogs(const Params& params) {
    const auto is_text_log = [](const Connection& connection) { return connection.kind == Connection::Kind::kTextLog; };
    const auto first = std::ranges::find_if(params.connections, is_text_log);
    if (first == params.connections.end()) return;
    const auto line_of = [this](const std::string& name) {
      int index = 0;
      while (index < message_.input_size() && message_.input(index).name() != name) ++index;
      return index;
    };
    for (const auto& connection : params.connections) {
      if (!is_text_log(connection)) {
        Require(false, "input",
                "'" + first->name + "': a text log is played at its own times, and input '" + connection.name +
                    "' comes at those of now: take one of them away",
                line_of(first->name));
      } else if (connection.speed != first->speed) {
        Require(false, "input", "'" + connection.name + "': text_log.speed must be that of input '" + first->name + "'", line_of(connection.name));
      }
    }
    Require(!message_.use_lidar_nmea(), "use_lidar_nmea",
            "must be false beside the text log of input '" + first->name + "', which is played at its own times: those of the lidar are of now");
  }

  void Take(const config::NavigationInput& input, Params& params) {
    RequireOfInput(IsSourceName(input.name()), "name must be 1 to 32 characters of a to z and 0 to 9");
    RequireOfInput(names_.insert(input.name()).second, "the name stands twice");
    const int num_kinds = static_cast<int>(input.has_serial()) + static_cast<int>(input.has_udp()) + static_cast<int>(input.has_tcp()) +
                          static_cast<int>(input.has_gpsd()) + static_cast<int>(input.has_text_log());
    const bool is_given_above = input.name() == kUdpSource || input.name() == kLidarSource;
    if (is_given_above) {
      RequireOfInput(num_kinds == 0, "is given by bind_address and nmea_port, or by use_lidar_nmea: it takes no connection here");
    } else {
      RequireOfInput(num_kinds == 1, "must have one of serial, udp, tcp, gpsd and text_log, and has " + std::to_string(num_kinds));
    }
    params.navigator.sources.push_back(ToSource(input));
    if (num_kinds != 1 || is_given_above) return;
    const auto connection = ToConnection(input);
    if (connection.kind == Connection::Kind::kUdp) {
      const bool is_free = params.source_of_port.try_emplace(connection.port, connection.name).second;
      RequireOfInput(is_free, "udp port " + std::to_string(connection.port) + " belongs to input '" + params.source_of_port[connection.port] + "'");
    } else {
      RequireOfInput(places_.insert(PlaceOf(connection)).second, PlaceOf(connection) + " is taken by an input before it");
    }
    params.connections.push_back(connection);
  }

  Connection ToConnection(const config::NavigationInput& input) {
    Connection connection;
    connection.name = input.name();
    if (input.has_serial()) {
      connection.kind = Connection::Kind::kSerial;
      connection.file = input.serial().device();
      connection.baud = input.serial().baud();
      RequireOfInput(connection.file.is_absolute(), "serial.device must be the whole path of a device, as /dev/ttyUSB0");
      RequireOfInput(std::ranges::find(kBauds, connection.baud) != kBauds.end(),
                     "serial.baud " + std::to_string(connection.baud) + " is none that serial ports have (4800, 9600, 38400, 115200 ...)");
    } else if (input.has_udp()) {
      connection.kind = Connection::Kind::kUdp;
      connection.address = input.udp().bind_address();
      connection.port = input.udp().port();
    } else if (input.has_tcp()) {
      connection.kind = Connection::Kind::kTcp;
      connection.address = input.tcp().address();
      connection.port = input.tcp().port();
    } else if (input.has_gpsd()) {
      connection.kind = Connection::Kind::kGpsd;
      connection.address = input.gpsd().address();
      connection.port = input.gpsd().port();
    } else {
      connection.kind = Connection::Kind::kTextLog;
      connection.file = folder_ / input.text_log().file();
      connection.speed = input.text_log().speed();
      // Slower, a pause of the log may be more than a clock can tell.
      constexpr double kMinSpeed = 0.001;
      RequireOfInput(connection.speed == 0.0 || connection.speed >= kMinSpeed, "text_log.speed must be 0 or at least 0.001");
      RequireOfInput(IsReadableFile(connection.file), "text_log.file '" + connection.file.string() + "' cannot be read");
      std::error_code error;
      RequireOfInput(!std::filesystem::is_regular_file(connection.file, error) || std::filesystem::file_size(connection.file, error) > 0,
                     "text_log.file '" + connection.file.string() + "' is empty");
      connection.day = ParseDay(input.text_log().date());
      RequireOfInput(connection.day || !input.text_log().has_date(), "text_log.date '" + input.text_log().date() + "' is no day as 2026-07-01");
    }
    const bool has_address =
        connection.kind == Connection::Kind::kUdp || connection.kind == Connection::Kind::kTcp || connection.kind == Connection::Kind::kGpsd;
    RequireOfInput(!has_address || io::ParseIpAddress(connection.address), "address '" + connection.address + "' is no numeric address");
    return connection;
  }

  // Two inputs at one place would take the sentences from each other.
  static std::string PlaceOf(const Connection& connection) {
    std::error_code error;
    switch (connection.kind) {
      case Connection::Kind::kSerial:  // /dev/serial/by-id/... is another name of /dev/ttyUSB0
        return "serial port " + std::filesystem::weakly_canonical(connection.file, error).string();
      case Connection::Kind::kTextLog:
        return "text log " + std::filesystem::weakly_canonical(connection.file, error).string();
      case Connection::Kind::kGpsd:
        return "gpsd " + connection.address + " port " + std::to_string(connection.port);
      default:
        return "tcp " + connection.address + " port " + std::to_string(connection.port);
    }
  }

  std::filesystem::path folder_;
  const config::Navigator& message_;
  std::vector<std::string> faults_;
  std::set<std::string> names_;
  std::set<std::string> places_;
  int index_ = 0;
};

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
      return "all that its sentences say is taken";
    case Role::kGnss:
      return "positions and velocities are taken";
    case Role::kHeading:
      return "headings and rates of turn are taken";
    case Role::kAttitude:
      return "headings, roll, pitch and rates of turn are taken";
    case Role::kImu:
      return "raw angular velocity and specific force are taken";
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
    const auto parsed = ParseSentence(line);
    if (parsed.fault != SentenceFault::kNone) continue;
    if (const auto* rmc = std::get_if<Rmc>(&parsed.sentence); rmc != nullptr && rmc->position && IsMeasured(rmc->quality)) return rmc->position;
    if (const auto* gns = std::get_if<Gns>(&parsed.sentence); gns != nullptr && gns->position && IsMeasured(gns->quality)) return gns->position;
    if (const auto* gga = std::get_if<Gga>(&parsed.sentence); gga != nullptr && gga->position && IsMeasured(gga->quality)) return gga->position;
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

// "0.87 m"
std::string Metres(double length_m) {
  constexpr double kCentimetresPerMetre = 100.0;
  const auto centimetres = std::llround(std::abs(length_m) * kCentimetresPerMetre);
  const auto hundredths = std::to_string(centimetres % 100);
  return std::to_string(centimetres / 100) + "." + (hundredths.size() < 2 ? "0" : "") + hundredths + " m";
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
             " is positive; where the sensor says +5 deg, an object 10 m ahead along the deck would be at " + Metres(ahead_up_m) +
             (ahead_up_m < 0 ? " below" : " above") + " the level of the reference point.\n";
    words += "#   roll: " + std::string(source.roll_sign > 0 ? "starboard" : "port") +
             " side down is positive; where the sensor says +5 deg, an object 10 m to starboard along the deck would be at " +
             Metres(starboard_up_m) + (starboard_up_m < 0 ? " below" : " above") + " the level of the reference point.\n";
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

void TakeInputs(const std::filesystem::path& config_folder, const config::Navigator& message, Params& params) {
  Inputs(config_folder, message).TakeInto(params);
}

std::string InWords(const Params& params) {
  if (params.input == Input::kLog) return "# takes NAV_RAW from the bus; nothing is opened\n";
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
