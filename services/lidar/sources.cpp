#include "services/lidar/sources.hpp"

#include <chrono>
#include <exception>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>
#include <vector>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/io/network.hpp"
#include "services/lidar/io/capture_player.hpp"
#include "services/lidar/io/capture_reader.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::milliseconds;

// Sources are read at this period, not at each datagram: the kernel has stamped them, so this costs latency and no accuracy, and saves wake-ups.
constexpr milliseconds kReadPeriod(5);
constexpr milliseconds kCapturePeriod(10);
constexpr milliseconds kMaxReadTime(20);

// One of the lidar's two UDP ports.
class LidarPort final : public io::UdpReceiver {
 public:
  LidarPort(const Sources& sources, const std::string& name, int port)
      : UdpReceiver(ToUdpOptions(sources, port, name)), refused_name_(name + "_source_refused") {
    if (receive_buffer_bytes() >= sources.receive_buffer_bytes) return;
    spdlog::warn("port {}: the kernel grants a receive buffer of {} bytes, {} were asked for (sysctl net.core.rmem_max)", this->port(),
                 receive_buffer_bytes(), sources.receive_buffer_bytes);
  }
  std::vector<Counter> counters() override {
    return {UdpReceiver::counters().front(), {refused_name_, num_source_refused()}, {"sockets_reopened", num_reopened()}};
  }

 private:
  std::string refused_name_;
};

class CaptureSource final : public runtime::SourceReader {
 public:
  CaptureSource(const Sources& sources, Service& service)
      : SourceReader(kCapturePeriod), service_(service), player_(sources.capture_files, sources.capture_speed) {}
  ~CaptureSource() override {
    for (const auto& warning : player_.Warnings()) spdlog::warn("{}", warning);
  }

  bool Read() override {
    const auto end = runtime::SteadyNow() + kMaxReadTime;
    while (runtime::SteadyNow() < end) {
      if (const auto datagram = player_.NextDue(Elapsed())) {
        service_.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port});
      } else if (player_.is_empty()) {
        break;
      }
    }
    if (player_.has_begun()) service_.AdvanceTo(Now());
    return !player_.is_finished();
  }
  Utime Now() const override { return player_.CaptureTime(Elapsed()); }
  std::string fault() const override { return {}; }
  std::vector<Counter> counters() const override { return player_.counters(); }

 private:
  std::chrono::microseconds Elapsed() const { return std::chrono::duration_cast<std::chrono::microseconds>(runtime::SteadyNow() - start_); }

  Service& service_;
  CapturePlayer player_;
  std::chrono::steady_clock::time_point start_ = runtime::SteadyNow();
};

// bind_address without a zone ("%eth0"); nullopt when it is no numeric address.
std::optional<io::IpAddress> BoundAddress(const Sources& sources) {
  return io::ParseIpAddress(sources.bind_address.substr(0, sources.bind_address.find('%')));
}

// Texts of the params that must be right before anything starts.
void CheckSources(const std::filesystem::path& file, const Sources& sources, std::vector<std::string>& faults) {
  const auto require = [&](bool is_fine, const char* field, const std::string& reason, std::size_t index = 0) {
    if (!is_fine) faults.push_back(config::FaultLine(file, field, reason, index));
  };
  for (std::size_t i = 0; i < sources.allowed_source_addresses.size(); ++i) {
    const auto& text = sources.allowed_source_addresses[i];
    const auto address = io::ParseIpAddress(text);
    require(address && !address->is_multicast(), "allowed_source_address", "'" + text + "' is no numeric address of a sensor", i);
  }
  const bool is_udp = sources.kind == Sources::Kind::kUdp;
  const auto bound = BoundAddress(sources);
  if (is_udp && !sources.bind_address.empty()) require(bound.has_value(), "bind_address", "'" + sources.bind_address + "' is no numeric address");
  if (!sources.multicast_group.empty()) {
    const auto group = io::ParseIpAddress(sources.multicast_group);
    require(group && group->is_multicast(), "multicast_group", "'" + sources.multicast_group + "' is no multicast address (224.0.0.0/4, ff00::/8)");
    require(!group || !bound || group->is_ipv4() == bound->is_ipv4(), "multicast_group", "must be of the same family as bind_address");
    require(!is_udp || !group || !bound || bound->is_any() || bound == group, "bind_address",
            "must be 0.0.0.0, :: or the group itself when multicast_group is set: a socket that is bound to another address hears no group");
  }
  if (!sources.bpf_filter.empty()) {
    const auto fault = FilterFault(sources.bpf_filter);
    require(fault.empty(), "bpf_filter", fault);
  }
  if (sources.kind != Sources::Kind::kCapture) return;
  for (std::size_t i = 0; i < sources.capture_files.size(); ++i) {
    if (!sources.capture_files[i].has_filename()) continue;  // an empty name, reported by LoadParams
    try {
      const CaptureReader reader(sources.capture_files[i]);
    } catch (const std::exception& error) {
      require(false, "capture_file", error.what(), i);
    }
  }
}

}  // namespace

Params LoadChecked(const std::filesystem::path& config_folder, int number) {
  std::vector<std::string> faults;
  auto params = LoadParams(config_folder, number, faults);
  CheckSources(config_folder / ConfigFileName(number), params.sources, faults);
  if (number == 2 && !config::LoadBoat(config_folder).lidar_2) {
    faults.push_back(config::FaultLine(config_folder / "boat.txtpb", "lidar_2", "must be set: where the second lidar sits", 0));
  }
  if (!faults.empty()) throw config::ConfigError(faults);
  return params;
}

io::UdpOptions ToUdpOptions(const Sources& sources, int port, const std::string& name) {
  return {.name = name,
          .bind_address = sources.bind_address,
          .port = port,
          .receive_buffer_bytes = sources.receive_buffer_bytes,
          .interface = sources.interface,
          .multicast_group = sources.multicast_group,
          .allowed_source_addresses = sources.allowed_source_addresses};
}

LiveOptions ToLiveOptions(const Params& params) {
  return {.interface = params.sources.interface,
          .filter = params.sources.bpf_filter,
          .data_port = params.data_port,
          .position_port = params.position_port,
          .has_large_packets = params.other && params.other->model == OtherModel::kOuster,
          .receive_buffer_bytes = params.sources.receive_buffer_bytes,
          .allowed_source_addresses = params.sources.allowed_source_addresses};
}

std::unique_ptr<runtime::SourceReader> OpenSources(const Params& params, Service& service) {
  const auto& sources = params.sources;
  std::vector<runtime::LiveReader::NamedSource> opened;
  const auto add = [&opened](auto source) { opened.push_back({"", std::move(source)}); };
  switch (sources.kind) {
    case Sources::Kind::kLog:
      return nullptr;
    case Sources::Kind::kCapture:
      return std::make_unique<CaptureSource>(sources, service);
    case Sources::Kind::kUdp:
      add(std::make_unique<LidarPort>(sources, "data", params.data_port));
      add(std::make_unique<LidarPort>(sources, "position", params.position_port));
      if (const auto bound = BoundAddress(sources); bound && !bound->is_any() && !bound->is_multicast()) {
        spdlog::info("hears only what is sent to {}; the sensor as delivered sends to 255.255.255.255, which needs bind_address \"0.0.0.0\"",
                     sources.bind_address);
      }
      break;
    case Sources::Kind::kInterface:
      auto capture = std::make_unique<LiveCapture>(ToLiveOptions(params));
      if (capture->fault().empty()) {
        spdlog::info("captures on interface '{}', filter: {}", sources.interface, capture->filter());
      } else {
        spdlog::warn("{}; waiting for it", capture->fault());
      }
      add(std::move(capture));
  }
  return std::make_unique<runtime::LiveReader>(
      std::move(opened), runtime::LiveReader::Limits{.period = kReadPeriod, .max_time = kMaxReadTime},
      runtime::LiveReader::Handlers{.on_piece =
                                        [&service](const std::string&, const io::Source::Piece& piece) {
                                          service.OnDatagram(piece.host_time, piece.port, piece.bytes, {piece.source_address, piece.source_port});
                                        },
                                    .on_round = [&service](const auto& round) { service.AdvanceTo(round.start, round.read_before); }});
}

void TrySources(const Params& next, const Params& running) {
  const auto& sources = next.sources;
  if (sources.kind == Sources::Kind::kUdp) {
    for (const int port : {next.data_port, next.position_port}) {
      // A port that this process holds is tried without it.
      const bool is_held = running.sources.kind == Sources::Kind::kUdp && (port == running.data_port || port == running.position_port);
      const io::UdpReceiver receiver(ToUdpOptions(sources, is_held ? 0 : port));
    }
  } else if (sources.kind == Sources::Kind::kInterface) {
    const LiveCapture capture(ToLiveOptions(next));
  }
}

}  // namespace lookout::lidar
