#include "services/plotter/outputs.hpp"

#include <stdexcept>
#include <utility>

#include "services/plotter/mavlink_output.hpp"
#include "services/plotter/n2k_device_output.hpp"
#include "services/plotter/n2k_output.hpp"
#include "services/plotter/nmea_output.hpp"
#include "services/plotter/signal_k_output.hpp"

namespace lookout::plotter {

namespace {

// `name`: of its counters, which so have none of the names of the service's.
std::unique_ptr<Link> Open(const std::string& name, const OutputParams& output, Links& links) {
  const Destination& to = output.destination;
  const bool is_mavlink = output.format == Format::kMavlink;
  switch (to.kind) {
    case Destination::Kind::kUdp:
      return links.Udp({.name = name, .address = to.address, .port = to.port, .interface = to.interface, .receives = is_mavlink});
    case Destination::Kind::kTcpServer:
      return links.TcpServer({.name = name, .bind_address = to.address, .port = to.port, .max_clients = to.max_clients});
    case Destination::Kind::kTcpClient:
      return links.TcpClient({.name = name, .address = to.address, .port = to.port});
    case Destination::Kind::kSerial:
      return links.Serial({.name = name, .device = to.device.string(), .baud = to.baud, .is_binary = is_mavlink});
    case Destination::Kind::kCan:
      return links.Can({.name = name, .interface = to.interface});
    default:
      return links.WebSocket({.name = name, .address = to.address, .port = to.port, .path = to.path, .token = to.token});
  }
}

N2kIdentity IdentityOf(const Params& params, const OutputParams& output) {
  return {.name = N2kName(output.n2k.unique_number),
          .preferred_address = static_cast<std::uint8_t>(output.n2k.preferred_address),
          .model = "Lookout lidar look-out",
          .software_version = params.version,
          .serial_number = std::to_string(output.n2k.unique_number),
          .sent_pgns = output.sends_own_ship ? std::vector<std::uint32_t>{129025, 129026, 128520} : std::vector<std::uint32_t>{128520}};
}

}  // namespace

std::unique_ptr<Output> MakeOutput(const Params& params, const OutputParams& output, std::unique_ptr<Link> link) {
  switch (output.format) {
    case Format::kNmea0183:
      return std::make_unique<NmeaOutput>(output, std::move(link), params.target_period, RevisionFile::Of(output.name));
    case Format::kSignalK:
      return std::make_unique<SignalKOutput>(output, std::move(link), params.boat);
    case Format::kMavlink:
      return std::make_unique<MavlinkOutput>(output, std::move(link));
    case Format::kN2kDevice:
      return std::make_unique<N2kDeviceOutput>(output, std::move(link), params.target_period, IdentityOf(params, output));
    default:
      return std::make_unique<N2kOutput>(output, std::move(link), params.target_period);
  }
}

std::vector<std::unique_ptr<Output>> OpenOutputs(const Params& params, Links& links) {
  std::vector<std::unique_ptr<Output>> outputs;
  for (const auto& output : params.outputs) {
    try {
      outputs.push_back(MakeOutput(params, output, Open("output_" + output.name, output, links)));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("output '" + output.name + "': " + error.what());
    }
  }
  return outputs;
}

}  // namespace lookout::plotter
