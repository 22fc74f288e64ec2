#include "tools/doctor/own_sources.hpp"

#include <algorithm>
#include <exception>

#include "common/io/udp_receiver.hpp"
#include "common/runtime/process.hpp"
#include "services/navigator/sources.hpp"
#include "services/vlp16/sources.hpp"

namespace lookout::doctor {

namespace {

// Taken from one source before the others get their turn: 100 ms of packets in dual return.
constexpr int kMaxDatagramsPerPoll = 150;

}  // namespace

OwnLidar::OwnLidar(bus::Bus& bus, const vlp16::Params& params) : params_(params), service_(bus, params) {
  if (params.sources.kind == vlp16::Sources::Kind::kInterface) {
    sources_.push_back(std::make_unique<vlp16::LiveCapture>(vlp16::ToLiveOptions(params)));
    return;
  }
  for (const int port : {params.data_port, params.position_port}) {
    auto options = vlp16::ToUdpOptions(params.sources, port);
    options.allowed_source_addresses.clear();  // whoever sends is to be seen; who may is decided here
    sources_.push_back(std::make_unique<io::UdpReceiver>(options));
  }
}

void OwnLidar::Poll(Utime now, LidarSeen& seen) {
  const auto& allowed = params_.sources.allowed_source_addresses;
  for (auto& source : sources_) {
    source->Poll(now);
    for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
      const auto datagram = source->Receive(now);
      if (!datagram) break;
      const auto& sender = datagram->source_address;
      const bool is_udp = params_.sources.kind == vlp16::Sources::Kind::kUdp;
      if (is_udp && datagram->port == params_.data_port) ++seen.num_by_sender[sender];
      if (is_udp && !allowed.empty() && std::ranges::find(allowed, sender) == allowed.end()) continue;
      service_.OnDatagram(datagram->host_time, datagram->port, datagram->bytes, {sender, datagram->source_port});
    }
    if (!source->fault().empty()) seen.fault = source->fault();
  }
  service_.AdvanceTo(now);
  seen.complaint = service_.Report().reason;
}

OwnNavigator::OwnNavigator(bus::Bus& bus, const navigator::Params& params, NavigationSeen& seen) : service_(bus, params) {
  for (const auto& connection : params.connections) {
    if (connection.kind == navigator::Connection::Kind::kTextLog) continue;
    try {
      inputs_.push_back({connection.name, navigator::OpenSource(connection)});
    } catch (const std::exception& error) {
      seen.input_faults.emplace_back(connection.name, error.what());
    }
  }
}

void OwnNavigator::Poll(Utime now, NavigationSeen& seen) {
  for (auto& input : inputs_) {
    input.source->Poll(now);
    for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
      const auto piece = input.source->Receive(runtime::HostNow());
      if (!piece) break;
      navigator::Pass(input.name, *piece, service_);
    }
  }
  service_.AdvanceTo(now);
  seen.complaint = service_.Report().reason;
}

void OwnNavigator::Finish(NavigationSeen& seen) const {
  for (const auto& input : inputs_) {
    if (const auto fault = input.source->fault(); !fault.empty()) seen.input_faults.emplace_back(input.name, fault);
  }
}

}  // namespace lookout::doctor
