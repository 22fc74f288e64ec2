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

// Whoever sends is to be seen; who may is judged here.
io::UdpOptions WithoutAllowance(io::UdpOptions options) {
  options.allowed_source_addresses.clear();
  return options;
}

}  // namespace

struct OwnLidar::Inputs {
  std::optional<io::UdpReceiver> data;
  std::optional<io::UdpReceiver> position;
  std::optional<vlp16::LiveCapture> capture;
  std::vector<io::IpAddress> allowed;

  bool IsAllowed(const std::string& sender) const {
    const auto address = io::ParseIpAddress(sender);
    return allowed.empty() || (address && std::ranges::find(allowed, *address) != allowed.end());
  }
};

OwnLidar::OwnLidar(bus::Bus& bus, const vlp16::Params& params) : params_(params), service_(bus, params), inputs_(std::make_unique<Inputs>()) {
  if (params.sources.kind == vlp16::Sources::Kind::kInterface) {
    inputs_->capture.emplace(vlp16::ToLiveOptions(params));
    return;
  }
  inputs_->data.emplace(WithoutAllowance(vlp16::ToUdpOptions(params.sources, params.data_port)));
  inputs_->position.emplace(WithoutAllowance(vlp16::ToUdpOptions(params.sources, params.position_port)));
  for (const auto& text : params.sources.allowed_source_addresses) inputs_->allowed.push_back(*io::ParseIpAddress(text));
}

OwnLidar::~OwnLidar() = default;

void OwnLidar::Poll(Utime now, LidarSeen& seen) {
  if (inputs_->capture) {
    for (int i = 0; i < kMaxDatagramsPerPoll; ++i) {
      const auto datagram = inputs_->capture->Next();
      if (!datagram) break;
      service_.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port});
    }
    if (!inputs_->capture->fault().empty()) seen.fault = inputs_->capture->fault();
  }
  for (auto* receiver : {&inputs_->data, &inputs_->position}) {
    for (int i = 0; *receiver && i < kMaxDatagramsPerPoll; ++i) {
      const auto datagram = (*receiver)->Receive();
      if (!datagram) break;
      const auto sender = (*receiver)->SourceAddress();
      if (receiver == &inputs_->data) ++seen.num_by_sender[sender];
      if (inputs_->IsAllowed(sender)) {
        service_.OnDatagram(datagram->host_time, datagram->port, datagram->payload, {io::ToText(datagram->source), datagram->source_port});
      }
    }
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
      if (input.source->num_lost() != input.num_lost) service_.OnStreamEnd(input.name);
      input.num_lost = input.source->num_lost();
      if (!piece) break;
      if (piece->is_datagram) {
        service_.OnDatagram(piece->host_time, piece->bytes, input.name);
      } else {
        service_.OnStream(piece->host_time, piece->bytes, input.name);
      }
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
