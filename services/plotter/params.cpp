#include "services/plotter/params.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/io/network.hpp"
#include "config/schema/navigator.pb.h"
#include "config/schema/plotter.pb.h"
#include "config/schema/segmenter.pb.h"
#include "services/plotter/core/n2k_device.hpp"

namespace lookout::plotter {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kFile = "plotter.txtpb";

std::chrono::microseconds ToMicroseconds(double duration_s) { return std::chrono::microseconds(std::llround(duration_s * 1e6)); }

bool IsName(const std::string& name) {
  constexpr std::size_t kMostBytes = 32;
  return !name.empty() && name.size() <= kMostBytes &&
         std::ranges::all_of(name, [](char letter) { return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9'); });
}

bool IsInterfaceName(const std::string& name) {
  constexpr std::size_t kMostBytes = 15;
  return !name.empty() && name.size() <= kMostBytes && std::ranges::all_of(name, [](unsigned char letter) { return letter > ' ' && letter < 127; });
}

bool IsTalker(const std::string& talker) {
  return talker.size() == 2 && std::ranges::all_of(talker, [](char letter) { return letter >= 'A' && letter <= 'Z'; });
}

Format ToFormat(config::PlotterOutput::Format format) {
  switch (format) {
    case config::PlotterOutput::SIGNALK:
      return Format::kSignalK;
    case config::PlotterOutput::N2K_ACTISENSE:
      return Format::kN2kActisense;
    case config::PlotterOutput::N2K_YDEN:
      return Format::kN2kYden;
    case config::PlotterOutput::N2K_DEVICE:
      return Format::kN2kDevice;
    case config::PlotterOutput::MAVLINK:
      return Format::kMavlink;
    default:
      return Format::kNmea0183;
  }
}

SentTargets ToSentTargets(config::PlotterOutput::Targets targets) {
  if (targets == config::PlotterOutput::TLL) return SentTargets::kTll;
  return targets == config::PlotterOutput::TTM ? SentTargets::kTtm : SentTargets::kNone;
}

SentAlerts ToSentAlerts(config::PlotterOutput::Alerts alerts) {
  if (alerts == config::PlotterOutput::ALR) return SentAlerts::kAlr;
  return alerts == config::PlotterOutput::ALF ? SentAlerts::kAlf : SentAlerts::kNone;
}

MavlinkParams ToMavlink(const config::MavlinkOptions& options) {
  return {.system_id = options.system_id(),
          .component_id = options.component_id(),
          .form = options.form() == config::MavlinkOptions::POINTS ? MavlinkForm::kPoints : MavlinkForm::kSectors,
          .max_distance_m = options.max_distance_m(),
          .sends_alerts = options.sends_alerts()};
}

// The unique number is the same at each start: of the boat's name and the output's.
N2kParams ToN2k(const config::PlotterOutput& output, const std::string& boat) {
  const auto& options = output.n2k();
  return {.preferred_address = options.preferred_address(),
          .unique_number =
              options.has_unique_number() ? static_cast<std::uint32_t>(options.unique_number()) : UniqueNumberOf(boat + "/" + output.name())};
}

// Reads the outputs and collects their faults, each at the line where its output begins.
class OutputsReader {
 public:
  OutputsReader(fs::path folder, const config::Plotter& message, std::string boat)
      : folder_(std::move(folder)), message_(message), boat_(std::move(boat)) {
    try {
      navigator_ = config::Load<config::Navigator>(folder_, "navigator.txtpb");
    } catch (const config::ConfigError&) {  // the navigator tells of it
      navigator_.Clear();
    }
  }

  /// @throws config::ConfigError
  std::vector<OutputParams> Read() {
    std::vector<OutputParams> outputs;
    for (index_ = 0; index_ < message_.output_size(); ++index_) outputs.push_back(ReadOutput(message_.output(index_)));
    if (!faults_.empty()) throw config::ConfigError(faults_);
    return outputs;
  }

 private:
  void Require(bool is_fine, const std::string& reason) {
    if (is_fine) return;
    faults_.push_back(
        config::FaultLine(folder_ / kFile, "output", "'" + message_.output(index_).name() + "': " + reason, static_cast<std::size_t>(index_)));
  }

  // Refuses an output that the navigator would read: our own position would come back as a measured one, and hide that none is.
  void CheckAgainstNavigator(const OutputParams& params) {
    const auto& to = params.destination;
    const auto is_same_device = [&to](const config::NavigationInput& input) {
      std::error_code error;
      return input.has_serial() && fs::weakly_canonical(input.serial().device(), error) == fs::weakly_canonical(to.device, error);
    };
    const auto& inputs = navigator_.input();
    if (to.kind == Destination::Kind::kSerial) {
      Require(std::ranges::none_of(inputs, is_same_device),
              "serial port " + to.device.string() + " is an input of navigator.txtpb: one process has a port");
    }
    if (!params.sends_own_ship) return;
    const std::string cure = ": the own position would come back as one that was measured; another port, or sends_own_ship: false";
    if (to.kind == Destination::Kind::kUdp && params.format == Format::kNmea0183) {
      const bool is_read = (navigator_.has_bind_address() && navigator_.nmea_port() == to.port) ||
                           std::ranges::any_of(inputs, [&to](const auto& input) { return input.has_udp() && input.udp().port() == to.port; });
      Require(!is_read || !io::ReachesThisComputer(to.address), fmt::format("lookout-navigator reads UDP port {} of this computer", to.port) + cure);
    }
    if (to.kind == Destination::Kind::kTcpServer && params.format == Format::kNmea0183) {
      const auto is_read = [&to](const config::NavigationInput& input) {
        return input.has_tcp() && input.tcp().port() == to.port && io::ReachesThisComputer(input.tcp().address());
      };
      Require(std::ranges::none_of(inputs, is_read), fmt::format("lookout-navigator reads TCP port {} of this computer", to.port) + cure);
    }
  }

  OutputParams ReadOutput(const config::PlotterOutput& output) {
    Require(IsName(output.name()), "name must be 1 to 32 characters of a to z and 0 to 9");
    Require(names_.insert(output.name()).second, "the name stands twice");
    OutputParams params;
    params.name = output.name();
    params.format = ToFormat(output.format());
    params.sends_own_ship = output.sends_own_ship();
    params.targets = ToSentTargets(output.targets());
    params.alerts = ToSentAlerts(output.alerts());
    params.unit = output.unit() == config::PlotterOutput::NAUTICAL_MILES ? Unit::kNauticalMiles : Unit::kKilometres;
    params.target_talker = output.target_talker();
    params.own_ship_talker = output.own_ship_talker();
    params.takes_acknowledgements = output.takes_acknowledgements();
    params.targets_as_vessels = output.targets_as_vessels();
    params.mavlink = ToMavlink(output.mavlink());
    params.n2k = ToN2k(output, boat_);
    const int num_kinds = static_cast<int>(output.has_udp()) + static_cast<int>(output.has_tcp_server()) + static_cast<int>(output.has_tcp_client()) +
                          static_cast<int>(output.has_serial()) + static_cast<int>(output.has_websocket()) + static_cast<int>(output.has_can());
    Require(num_kinds == 1, fmt::format("must have one of udp, tcp_server, tcp_client, serial, websocket and can, and has {}", num_kinds));
    if (num_kinds == 1) params.destination = ReadDestination(output);
    CheckFormat(output, params);
    if (num_kinds == 1) CheckAgainstNavigator(params);
    return params;
  }

  void CheckFormat(const config::PlotterOutput& output, const OutputParams& params) {
    const bool is_nmea = params.format == Format::kNmea0183;
    Require(!output.has_websocket() || params.format == Format::kSignalK, "a websocket carries format SIGNALK only");
    const bool is_mavlink = params.format == Format::kMavlink;
    const bool is_device = params.format == Format::kN2kDevice;
    Require(!output.has_serial() || is_nmea || is_mavlink || is_device, "a serial port carries formats NMEA0183, N2K_DEVICE and MAVLINK only");
    if (is_mavlink) CheckMavlink(output);
    Require(!is_device || output.has_tcp_client() || output.has_serial() || output.has_can(),
            "format N2K_DEVICE goes over tcp_client or serial, to a gateway, or over can");
    Require(is_device || (!output.has_can() && !output.has_n2k()), "can and n2k are of format N2K_DEVICE only");
    Require(!params.targets_as_vessels || params.format == Format::kSignalK, "targets_as_vessels is of format SIGNALK only");
    Require(is_mavlink || !output.has_mavlink(), "mavlink is of format MAVLINK only");
    Require(!params.takes_acknowledgements || !output.has_udp(), "nothing comes back over udp: takes_acknowledgements must be false");
    Require(!params.takes_acknowledgements || is_nmea || params.format == Format::kSignalK, "NMEA 2000 and MAVLink bring no acknowledgements back");
    Require(!params.takes_acknowledgements || !is_nmea || params.alerts != SentAlerts::kNone,
            "takes_acknowledgements wants alerts: ALR (acknowledged by ACK) or ALF (by ACN)");
    if (is_nmea) {
      Require(IsTalker(params.target_talker), "target_talker must be two capital letters");
      Require(IsTalker(params.own_ship_talker), "own_ship_talker must be two capital letters");
    } else {
      Require(!output.has_targets() && !output.has_alerts() && !output.has_unit() && !output.has_target_talker() && !output.has_own_ship_talker(),
              "targets, alerts, unit and talkers are of format NMEA0183 only");
    }
  }

  void CheckMavlink(const config::PlotterOutput& output) {
    // Ten messages of sectors a second take a third of it, and what waits is old.
    constexpr int kLeastBaud = 57'600;
    Require(output.has_udp() || output.has_serial(), "format MAVLINK goes over udp or a serial port");
    Require(!output.has_serial() || output.serial().baud() >= kLeastBaud, fmt::format("MAVLINK wants a serial port of {} baud or more", kLeastBaud));
    Require(!output.has_sends_own_ship(), "sends_own_ship is not of format MAVLINK: an autopilot has its own position");
  }

  std::string ReadAddress(const std::string& address) {
    Require(io::ParseIpAddress(address).has_value(), "address '" + address + "' is no numeric address");
    return address;
  }

  Destination ReadDestination(const config::PlotterOutput& output) {
    Destination destination;
    if (output.has_udp()) {
      destination.kind = Destination::Kind::kUdp;
      destination.address = ReadAddress(output.udp().address());
      destination.port = output.udp().port();
      destination.interface = output.udp().interface();
      const auto address = io::ParseIpAddress(destination.address);
      Require(!address || !address->is_any(), "udp.address must be of a receiver, a broadcast or a group: " + destination.address + " is none");
    } else if (output.has_tcp_server()) {
      destination.kind = Destination::Kind::kTcpServer;
      destination.address = ReadAddress(output.tcp_server().bind_address());
      destination.port = output.tcp_server().port();
      destination.max_clients = output.tcp_server().max_clients();
      Require(ports_.insert({destination.address, destination.port}).second,
              fmt::format("port {} of {} belongs to an output before it", destination.port, destination.address));
    } else if (output.has_tcp_client()) {
      destination.kind = Destination::Kind::kTcpClient;
      destination.address = ReadAddress(output.tcp_client().address());
      destination.port = output.tcp_client().port();
    } else if (output.has_serial()) {
      destination.kind = Destination::Kind::kSerial;
      destination.device = output.serial().device();
      destination.baud = output.serial().baud();
      // Rates for which termios of Linux has names, from 1200 on.
      static const std::set<int> kBauds{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 1000000, 2000000, 4000000};
      Require(destination.device.is_absolute(), "serial.device must be the whole path of a device, as /dev/ttyUSB0");
      Require(kBauds.contains(destination.baud),
              fmt::format("serial.baud {} is none that serial ports have (4800, 9600, 38400, 115200 ...)", destination.baud));
      std::error_code error;
      Require(devices_.insert(fs::weakly_canonical(destination.device, error)).second, "the serial port belongs to an output before it");
    } else if (output.has_can()) {
      destination.kind = Destination::Kind::kCan;
      destination.interface = output.can().interface();
      Require(IsInterfaceName(destination.interface), "can.interface must be a name of 1 to 15 characters, as can0");
    } else {
      destination.kind = Destination::Kind::kWebSocket;
      destination.address = ReadAddress(output.websocket().address());
      destination.port = output.websocket().port();
      destination.path = output.websocket().path();
      const bool is_path = destination.path.starts_with('/') &&
                           std::ranges::all_of(destination.path, [](unsigned char letter) { return letter > ' ' && letter < 127; });
      Require(is_path, "websocket.path must begin with / and hold no space: '" + destination.path + "'");
      if (output.websocket().has_token_file()) destination.token = ReadToken(folder_ / output.websocket().token_file());
    }
    return destination;
  }

  // The token lets its holder write to the server: a file that all may read is refused.
  std::string ReadToken(const fs::path& file) {
    constexpr std::size_t kMostBytes = 4096;
    const auto quoted = "websocket.token_file '" + file.string() + "' ";
    std::error_code error;
    const auto status = fs::status(file, error);
    if (!fs::is_regular_file(status)) {
      Require(false, quoted + "is no file");
      return {};
    }
    const bool is_private = (status.permissions() & (fs::perms::others_read | fs::perms::others_write | fs::perms::group_write)) == fs::perms::none;
    Require(is_private, quoted + "can be read by everybody: chmod 640");
    std::string token;
    std::ifstream stream(file);
    std::getline(stream, token);
    if (token.ends_with('\r')) token.pop_back();
    const bool is_token =
        !token.empty() && token.size() <= kMostBytes && std::ranges::all_of(token, [](unsigned char letter) { return letter > ' ' && letter < 127; });
    Require(is_token, quoted + "must begin with a line that is the token: printable ASCII without spaces");
    return token;
  }

  fs::path folder_;
  const config::Plotter& message_;
  std::string boat_;
  config::Navigator navigator_;
  std::vector<std::string> faults_;
  std::set<std::string> names_;
  std::set<std::pair<std::string, int>> ports_;
  std::set<fs::path> devices_;
  int index_ = 0;
};

std::string InWords(const Destination& to) {
  switch (to.kind) {
    case Destination::Kind::kUdp:
      return fmt::format("UDP to {} port {}{}", to.address, to.port, to.interface.empty() ? "" : " by " + to.interface);
    case Destination::Kind::kTcpServer:
      return fmt::format("TCP to at most {} that connect to {} port {}", to.max_clients, to.address, to.port);
    case Destination::Kind::kTcpClient:
      return fmt::format("TCP to {} port {}", to.address, to.port);
    case Destination::Kind::kSerial:
      return fmt::format("serial port {} at {} baud", to.device.string(), to.baud);
    case Destination::Kind::kCan:
      return "CAN interface " + to.interface;
    default:
      return fmt::format("WebSocket ws://{}:{}{} {}", to.address, to.port, to.path, to.token.empty() ? "without a token" : "with a token");
  }
}

std::string InWords(const OutputParams& output) {
  switch (output.format) {
    case Format::kSignalK:
      return output.targets_as_vessels ? "Signal K, targets also as vessels" : "Signal K";
    case Format::kN2kActisense:
      return "NMEA 2000 as Actisense text";
    case Format::kN2kYden:
      return "NMEA 2000 as YDEN text";
    case Format::kN2kDevice:
      return fmt::format("NMEA 2000 as a device of unique number {} that claims address {} first{}", output.n2k.unique_number,
                         output.n2k.preferred_address, output.destination.kind == Destination::Kind::kCan ? "" : ", RAW text");
    case Format::kMavlink:
      return fmt::format("MAVLink 2 {} to {:g} m as system {} component {}{}",
                         output.mavlink.form == MavlinkForm::kPoints ? "OBSTACLE_DISTANCE_3D" : "OBSTACLE_DISTANCE", output.mavlink.max_distance_m,
                         output.mavlink.system_id, output.mavlink.component_id, output.mavlink.sends_alerts ? " and alerts" : "");
    default:
      break;
  }
  std::string words = "NMEA 0183";
  if (output.targets != SentTargets::kNone) words += output.targets == SentTargets::kTtm ? " OSD TTM" : " TLL";
  if (output.sends_own_ship) words += " RMC HDT";
  if (output.alerts != SentAlerts::kNone) words += output.alerts == SentAlerts::kAlr ? " ALR" : " ALF";
  return words;
}

LidarSightParams ToLidarSight(const config::BoatFacts& boat, const config::Segmenter& segmenter, double reach_m) {
  constexpr double kWholeCircleDeg = 360.0;
  LidarSightParams params;
  params.T_vessel_lidar = boat.T_vessel_lidar;
  params.above_water_m = boat.reference_point_above_water_m + boat.T_vessel_lidar.translation().z();
  params.min_range_m = segmenter.min_range_m();
  if (segmenter.field_of_view_width_deg() < kWholeCircleDeg)
    params.field_of_view = {DegToRad(segmenter.field_of_view_start_deg()), DegToRad(segmenter.field_of_view_width_deg())};
  params.own_vessel_box_m = boat.own_vessel_box_m;
  params.reach_m = reach_m;
  return params;
}

// nullopt: no output wants them.
std::optional<SurroundingsParams> ToSurroundings(const Params& params, const config::BoatFacts& boat, const fs::path& config_folder) {
  SurroundingsParams result;
  for (const auto& output : params.outputs) {
    if (output.format == Format::kMavlink) result.reach_m = std::max(result.reach_m, output.mavlink.max_distance_m);
  }
  if (result.reach_m <= 0.0) return std::nullopt;
  const auto segmenter = config::Load<config::Segmenter>(config_folder, "segmenter.txtpb");
  result.own_vessel_box_m = boat.own_vessel_box_m;
  result.takes_tentative = params.takes_tentative;
  result.lidars.push_back(ToLidarSight(boat, segmenter, result.reach_m));
  if (boat.lidar_2) {
    auto second = result.lidars.front();
    second.T_vessel_lidar = TransformVesselSensor(*boat.lidar_2);
    second.above_water_m = boat.reference_point_above_water_m + second.T_vessel_lidar.translation().z();
    second.field_of_view = {};
    result.lidars.push_back(second);
  }
  return result;
}

}  // namespace

Params LoadParams(const fs::path& config_folder) {
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  Params params;
  const auto message = faults.Take([&] { return config::Load<config::Plotter>(config_folder, std::string(kFile)); });
  const auto outputs =
      faults.Take([&] { return message ? OutputsReader(config_folder, *message, boat ? boat->name : "").Read() : std::vector<OutputParams>(); });
  faults.ThrowIfAny();
  params.takes_tentative = message->takes_tentative();
  params.sends_ais_targets = message->sends_ais_targets();
  params.target_period = ToMicroseconds(message->target_period_s());
  params.own_ship_period = ToMicroseconds(message->own_ship_period_s());
  params.number_quarantine = ToMicroseconds(message->number_quarantine_s());
  params.outputs = *outputs;
  params.boat = boat->name;
  params.surroundings = ToSurroundings(params, *boat, config_folder);
  return params;
}

std::string InWords(const Params& params) {
  if (params.outputs.empty()) return "# plotter.txtpb: no output: nothing is sent\n";
  std::string text;
  for (const auto& output : params.outputs)
    text += fmt::format("# plotter.txtpb: output '{}': {}, {}\n", output.name, InWords(output), InWords(output.destination));
  return text;
}

}  // namespace lookout::plotter
