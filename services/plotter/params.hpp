// Config of the plotter process (boat.txtpb, plotter.txtpb; of segmenter.txtpb what it takes) as checked values.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/plotter/core/lidar_sight.hpp"
#include "services/plotter/core/nmea0183.hpp"

namespace lookout::plotter {

enum class Format { kNmea0183, kSignalK, kN2kActisense, kN2kYden, kN2kDevice, kMavlink };
enum class SentTargets { kTtm, kTll, kNone };
enum class SentAlerts { kNone, kAlr, kAlf };

enum class MavlinkForm { kSectors, kPoints };

struct MavlinkParams {
  int system_id = 1;
  int component_id = 196;
  MavlinkForm form = MavlinkForm::kSectors;
  double max_distance_m = 40.0;
  bool sends_alerts = true;
};

struct N2kParams {
  int preferred_address = 35;
  std::uint32_t unique_number = 0;  // 21 bits of the NAME
};

/// The receiver of an output. Members that its kind does not use are empty.
struct Destination {
  enum class Kind { kUdp, kTcpServer, kTcpClient, kSerial, kWebSocket, kCan };
  Kind kind = Kind::kUdp;
  std::string address = {};  // numeric
  int port = 0;
  std::string interface = {};         // UDP, CAN
  int max_clients = 0;                // TCP server
  std::filesystem::path device = {};  // serial
  int baud = 0;
  std::string path = {};  // WebSocket
  std::string token = {};
};

struct OutputParams {
  std::string name;
  Format format = Format::kNmea0183;
  Destination destination = {};
  bool sends_own_ship = true;
  SentTargets targets = SentTargets::kTtm;
  SentAlerts alerts = SentAlerts::kNone;
  Unit unit = Unit::kKilometres;
  std::string target_talker = "RA";
  std::string own_ship_talker = "II";
  bool takes_acknowledgements = false;
  bool targets_as_vessels = false;  // Signal K
  MavlinkParams mavlink = {};
  N2kParams n2k = {};
};

struct Params {
  std::string boat;          // the boat's name, as in boat.txtpb
  std::string version = {};  // of this program
  bool takes_tentative = false;
  bool sends_ais_targets = true;  // also tells targets that the receiver has by AIS
  std::chrono::microseconds target_period{2'500'000};
  std::chrono::microseconds own_ship_period{1'000'000};
  std::chrono::microseconds number_quarantine{60'000'000};
  std::vector<OutputParams> outputs = {};
  std::optional<SurroundingsParams> surroundings = std::nullopt;  // where an output is of MAVLink
};

/// @param config_folder  the boat's folder, holding boat.txtpb and plotter.txtpb; segmenter.txtpb is read where an output is of MAVLink
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

/// The words of --check besides the values: the messages of each output, and their receiver.
std::string InWords(const Params& params);

}  // namespace lookout::plotter
