#include "services/vlp16/sources.hpp"

#include <exception>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "services/vlp16/io/capture_reader.hpp"

namespace lookout::vlp16 {

namespace {

// What is text in the params and must be right before anything starts.
void CheckSources(const std::filesystem::path& config_folder, const Sources& sources, std::vector<std::string>& faults) {
  const auto file = config_folder / "vlp16.txtpb";
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
    if (!sources.capture_files[i].has_filename()) continue;  // an empty name, told by LoadParams
    try {
      const CaptureReader reader(sources.capture_files[i]);
    } catch (const std::exception& error) {
      require(false, "capture_file", error.what(), i);
    }
  }
}

}  // namespace

std::optional<io::IpAddress> BoundAddress(const Sources& sources) {
  return io::ParseIpAddress(sources.bind_address.substr(0, sources.bind_address.find('%')));
}

Params LoadChecked(const std::filesystem::path& config_folder) {
  std::vector<std::string> faults;
  auto params = LoadParams(config_folder, faults);
  CheckSources(config_folder, params.sources, faults);
  if (!faults.empty()) throw config::ConfigError(faults);
  WriteAllowedAlike(params.sources);
  return params;
}

void WriteAllowedAlike(Sources& sources) {
  for (auto& text : sources.allowed_source_addresses) {
    if (const auto address = io::ParseIpAddress(text)) text = io::ToText(*address);
  }
}

io::UdpOptions ToUdpOptions(const Sources& sources, int port) {
  return {.bind_address = sources.bind_address,
          .port = port,
          .receive_buffer_bytes = sources.receive_buffer_bytes,
          .interface = sources.interface,
          .multicast_group = sources.multicast_group,
          .allowed_source_addresses = sources.allowed_source_addresses};
}

LiveOptions ToLiveOptions(const Params& params) {
  LiveOptions options;
  options.interface = params.sources.interface;
  options.filter = params.sources.bpf_filter;
  options.data_port = params.data_port;
  options.position_port = params.position_port;
  options.receive_buffer_bytes = params.sources.receive_buffer_bytes;
  for (const auto& text : params.sources.allowed_source_addresses) {
    options.allowed_source_addresses.push_back(io::ToText(*io::ParseIpAddress(text)));
  }
  return options;
}

}  // namespace lookout::vlp16
