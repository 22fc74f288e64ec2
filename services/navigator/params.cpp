#include "services/navigator/params.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <utility>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/io/network.hpp"
#include "config/schema/navigator.pb.h"
#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

namespace {

std::chrono::microseconds ToMicroseconds(double duration_s) { return std::chrono::microseconds(std::llround(duration_s * 1e6)); }

// Rates for which termios of Linux has names, from 1200 on.
constexpr std::array kBauds{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 1000000, 2000000, 4000000};

static_assert(static_cast<int>(Role::kAll) == config::NavigationInput::ALL && static_cast<int>(Role::kGnss) == config::NavigationInput::GNSS &&
              static_cast<int>(Role::kHeading) == config::NavigationInput::HEADING &&
              static_cast<int>(Role::kAttitude) == config::NavigationInput::ATTITUDE &&
              static_cast<int>(Role::kImu) == config::NavigationInput::IMU &&
              static_cast<int>(Role::kNothing) == config::NavigationInput::RECORD_ONLY);
static_assert(static_cast<int>(Protocol::kNmea0183) == config::NavigationInput::NMEA0183 &&
              static_cast<int>(Protocol::kMavlink) == config::NavigationInput::MAVLINK);

SourceParams ToSource(const config::NavigationInput& input) {
  SourceParams source;
  source.name = input.name();
  source.role = static_cast<Role>(input.role());
  source.protocol = static_cast<Protocol>(input.protocol());
  source.mavlink_system_id = input.mavlink_system_id();
  source.requires_checksum = input.checksum_required();
  if (input.has_latency_s()) source.latency = ToMicroseconds(input.latency_s());
  source.roll_sign = input.roll_positive() == config::NavigationInput::PORT_DOWN ? -1.0 : 1.0;
  source.pitch_sign = input.pitch_positive() == config::NavigationInput::BOW_DOWN ? -1.0 : 1.0;
  if (input.has_deviation_deg()) source.deviation_rad = DegToRad(input.deviation_deg());
  if (input.has_declination_deg()) source.declination_rad = DegToRad(input.declination_deg());
  return source;
}

// Reads the inputs and collects their faults, each at the line where its input begins.
class InputsReader {
 public:
  InputsReader(const std::filesystem::path& config_folder, const config::Navigator& message) : folder_(config_folder), message_(message) {}

  /// Fills connections, source_of_port and navigator.sources. @throws config::ConfigError with every fault
  void ReadInto(Params& params) {
    const bool has_udp = !message_.bind_address().empty();
    if (has_udp) {
      Require(io::ParseIpAddress(message_.bind_address()).has_value(), "bind_address", "'" + message_.bind_address() + "' is no numeric address");
      params.connections.push_back(
          {.name = kUdpSource, .kind = Connection::Kind::kUdp, .address = message_.bind_address(), .port = message_.nmea_port(), .file = {}});
      params.source_of_port[message_.nmea_port()] = kUdpSource;
    }
    for (index_ = 0; index_ < message_.input_size(); ++index_) ReadInput(message_.input(index_), params);
    // In captures there is always one, unless another input has its port.
    params.source_of_port.try_emplace(message_.nmea_port(), kUdpSource);
    if (message_.source() == config::Navigator::LIVE) {
      CheckTextLogs(params);
      Require(!params.connections.empty() || message_.use_lidar_nmea(), "source",
              "is LIVE, but there is nothing to read: neither bind_address, nor use_lidar_nmea, nor an input");
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

  // A text log has times of its own, live inputs have the present time: the two cannot form one sequence.
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

  void ReadInput(const config::NavigationInput& input, Params& params) {
    RequireOfInput(IsSourceName(input.name()), "name must be 1 to 32 characters of a to z and 0 to 9");
    RequireOfInput(input.name() != kOdometerSource, "is the name of LIDAR_ODOMETRY in NAV_RAW: give it another");
    RequireOfInput(names_.insert(input.name()).second, "the name stands twice");
    const int num_kinds = static_cast<int>(input.has_serial()) + static_cast<int>(input.has_udp()) + static_cast<int>(input.has_tcp()) +
                          static_cast<int>(input.has_gpsd()) + static_cast<int>(input.has_text_log());
    const bool is_given_above = input.name() == kUdpSource || input.name() == kLidarSource;
    if (is_given_above) {
      RequireOfInput(num_kinds == 0, "is opened by bind_address and nmea_port, or by use_lidar_nmea: remove its connection here");
    } else {
      RequireOfInput(num_kinds == 1, "must have one of serial, udp, tcp, gpsd and text_log, and has " + std::to_string(num_kinds));
    }
    CheckProtocol(input);
    params.navigator.sources.push_back(ToSource(input));
    if (num_kinds != 1 || is_given_above) return;
    const auto connection = ToConnection(input);
    if (connection.kind == Connection::Kind::kUdp) {
      const bool is_free = params.source_of_port.try_emplace(connection.port, connection.name).second;
      RequireOfInput(is_free, "udp port " + std::to_string(connection.port) + " belongs to input '" + params.source_of_port[connection.port] + "'");
    } else {
      RequireOfInput(places_.insert(PlaceOf(connection)).second, PlaceOf(connection) + " is used by an input before it");
    }
    params.connections.push_back(connection);
  }

  // MAVLink states checksums, signs and true headings itself: a setting for them would be an error that nobody sees.
  void CheckProtocol(const config::NavigationInput& input) {
    if (input.protocol() != config::NavigationInput::MAVLINK) {
      RequireOfInput(!input.has_mavlink_system_id(), "mavlink_system_id is for protocol MAVLINK: add that, or remove it");
      return;
    }
    RequireOfInput(input.has_serial() || input.has_udp(), "protocol MAVLINK needs serial or udp of this input's own");
    RequireOfInput(input.role() != config::NavigationInput::IMU, "role IMU: no IMU samples are read from MAVLINK");
    RequireOfInput(input.checksum_required(), "checksum_required must not be false with MAVLINK, which always has checksums");
    RequireOfInput(!input.has_roll_positive() && !input.has_pitch_positive(),
                   "roll_positive and pitch_positive are fixed by MAVLINK: remove them, and correct AHRS_ORIENTATION in the autopilot");
    RequireOfInput(!input.has_deviation_deg() && !input.has_declination_deg(),
                   "deviation_deg and declination_deg are not for MAVLINK: the autopilot states its heading from true north");
  }

  Connection ToConnection(const config::NavigationInput& input) {
    Connection connection;
    connection.name = input.name();
    const auto at_server = [&](Connection::Kind kind, const std::string& address, int port) {
      connection.kind = kind;
      connection.address = address;
      connection.port = port;
      RequireOfInput(io::ParseIpAddress(address).has_value(), "address '" + address + "' is no numeric address");
    };
    if (input.has_serial()) {
      connection.kind = Connection::Kind::kSerial;
      connection.file = input.serial().device();
      connection.baud = input.serial().baud();
      RequireOfInput(connection.file.is_absolute(), "serial.device must be the whole path of a device, as /dev/ttyUSB0");
      RequireOfInput(std::ranges::find(kBauds, connection.baud) != kBauds.end(),
                     "serial.baud " + std::to_string(connection.baud) + " is none that serial ports have (4800, 9600, 38400, 115200 ...)");
    } else if (input.has_udp()) {
      at_server(Connection::Kind::kUdp, input.udp().bind_address(), input.udp().port());
    } else if (input.has_tcp()) {
      at_server(Connection::Kind::kTcp, input.tcp().address(), input.tcp().port());
    } else if (input.has_gpsd()) {
      at_server(Connection::Kind::kGpsd, input.gpsd().address(), input.gpsd().port());
    } else {
      ReadTextLog(input.text_log(), connection);
    }
    return connection;
  }

  void ReadTextLog(const config::TextLog& log, Connection& connection) {
    connection.kind = Connection::Kind::kTextLog;
    connection.file = folder_ / log.file();
    connection.speed = log.speed();
    connection.day = ParseDay(log.date());
    // Slower, a pause of the log may be more than a clock can tell.
    constexpr double kMinSpeed = 0.001;
    const auto quoted = "text_log.file '" + connection.file.string() + "' ";
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(connection.file, error);
    RequireOfInput(connection.speed == 0.0 || connection.speed >= kMinSpeed, "text_log.speed must be 0 or at least 0.001");
    RequireOfInput(is_file && std::ifstream(connection.file), quoted + "cannot be read");
    RequireOfInput(!is_file || std::filesystem::file_size(connection.file, error) > 0, quoted + "is empty");
    RequireOfInput(connection.day || !log.has_date(), "text_log.date '" + log.date() + "' is no day as 2026-07-01");
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

}  // namespace

std::optional<std::chrono::sys_days> ParseDay(std::string_view text) {
  static const std::regex kForm("(19[7-9][0-9]|2[01][0-9]{2})-([0-9]{2})-([0-9]{2})");
  std::cmatch match;
  if (!std::regex_match(text.begin(), text.end(), match, kForm)) return std::nullopt;
  const auto number = [&match](std::size_t group) { return std::stoi(match[group].str()); };
  const auto day = std::chrono::year(number(1)) / number(2) / number(3);
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day);
}

Params LoadParams(const std::filesystem::path& config_folder) {
  Params params;
  config::FaultList faults;
  const auto loaded_boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  const auto loaded = faults.Take([&] { return config::Load<config::Navigator>(config_folder, "navigator.txtpb"); });
  if (loaded && loaded->max_sentence_latency_s() > loaded->max_attitude_age_s()) {
    faults.Add(config::FaultLine(config_folder / "navigator.txtpb", "max_sentence_latency_s", "must not be greater than max_attitude_age_s"));
  }
  if (loaded) faults.Try([&] { InputsReader(config_folder, *loaded).ReadInto(params); });
  faults.ThrowIfAny();
  const auto& boat = *loaded_boat;
  const auto& message = *loaded;
  params.reads_nav_raw = message.source() == config::Navigator::LOG;
  params.use_lidar_nmea = message.use_lidar_nmea();
  params.navigator.use_lidar_odometry = message.use_lidar_odometry();

  auto& navigator = params.navigator;
  navigator.max_sentence_latency = ToMicroseconds(message.max_sentence_latency_s());
  navigator.position_sd_m = message.position_sd_m();
  navigator.heading_offset_rad = DegToRad(message.heading_offset_deg());
  navigator.pitch_offset_rad = DegToRad(message.pitch_offset_deg());
  navigator.roll_offset_rad = DegToRad(message.roll_offset_deg());

  auto& filter = navigator.filter;
  filter.datum = boat.datum;
  filter.p_vessel_antenna_m = boat.p_vessel_antenna_m;
  filter.p_vessel_imu_m = boat.p_vessel_imu_m;
  filter.gyro_noise_radps_rthz = DegToRad(message.gyro_noise_degps_rthz());
  filter.gyro_bias_sd_radps = DegToRad(message.gyro_bias_sd_degps());
  filter.accelerometer_noise_mps2_rthz = message.accelerometer_noise_mps2_rthz();
  filter.accelerometer_bias_sd_mps2 = message.accelerometer_bias_sd_mps2();
  filter.max_latency = navigator.max_sentence_latency;
  filter.max_position_age = ToMicroseconds(message.max_position_age_s());
  filter.max_coast_sd_m = message.max_coast_sd_m();
  filter.max_attitude_age = ToMicroseconds(message.max_attitude_age_s());
  filter.max_heading_coast_sd_rad = DegToRad(message.max_heading_coast_sd_deg());
  filter.velocity_sd_mps = message.velocity_sd_mps();
  filter.heading_sd_rad = DegToRad(message.heading_sd_deg());
  filter.tilt_sd_rad = DegToRad(message.tilt_sd_deg());
  filter.use_course_as_heading = message.use_course_as_heading();
  filter.min_course_speed_mps = message.min_course_speed_mps();
  filter.course_heading_sd_rad = DegToRad(message.course_heading_sd_deg());
  filter.unmeasured_tilt_sd_rad = DegToRad(message.unmeasured_tilt_sd_deg());
  return params;
}

}  // namespace lookout::navigator
