#include "services/plotter/n2k_device_output.hpp"

#include <utility>

namespace lookout::plotter {

N2kDeviceOutput::N2kDeviceOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period,
                                 N2kIdentity identity)
    : N2kOutput(params, std::move(link), target_period),
      name_(identity.name),
      device_(std::move(identity)),
      is_gateway_(params.destination.kind != Destination::Kind::kCan),
      address_name_("output_" + params.name + "_address"),
      lost_name_("output_" + params.name + "_addresses_lost"),
      unanswered_name_("output_" + params.name + "_unanswered") {}

std::string N2kDeviceOutput::TextFrom(const N2kMessage& message, std::uint8_t source) {
  std::string lines;
  for (const auto& frame : FramesOf(message, source, message.is_fast_packet ? NextSequence() : 0)) lines += RawLine(frame);
  return lines;
}

std::string N2kDeviceOutput::Text(const N2kMessage& message, Utime /*time*/) { return TextFrom(message, device_.address()); }

void N2kDeviceOutput::SendAnew() {
  N2kOutput::SendAnew();
  owes_begin_ = true;
}

void N2kDeviceOutput::SendNotices(const Told& told) {
  now_ = told.passed;
  if (owes_begin_) {
    owes_begin_ = false;
    heard_ = now_;
    given_address_ = -1;
    device_.Begin(now_);
  }
  device_.Advance(now_);
  // Under another address the targets are new ones.
  if (device_.is_claimed() && !was_claimed_) N2kOutput::SendAnew();
  was_claimed_ = device_.is_claimed();
  SendOwed();
}

void N2kDeviceOutput::SendOwed() {
  for (const auto& [message, source] : device_.TakeSendings()) SendSurely(TextFrom(message, source));
}

// As the network has it: a gateway may send everything under its own address.
void N2kDeviceOutput::NoteOwnClaim(const N2kFrame& frame) {
  const auto header = HeaderOf(frame.id);
  if (ClaimedNameOf(frame) != name_ || header.source == kN2kNoAddress) return;
  given_address_ = header.source == device_.address() ? -1 : header.source;
}

Commands N2kDeviceOutput::Read(const std::string& message, const Told& told) {
  const auto heard = ReadHeardLine(message);
  if (!heard) {
    CountRefused();
    return {};
  }
  heard_ = told.passed;
  if (owes_begin_) return {};
  if (heard->is_echo) NoteOwnClaim(heard->frame);
  // Among frames that programs sent through this gateway only claims are read: another program may be a device, too. Our own request must not be
  // answered by us.
  if ((!heard->is_echo || ClaimedNameOf(heard->frame)) && !device_.Take(heard->frame, told.passed)) CountRefused();
  SendOwed();  // at once: other devices wait for a claim no longer than this one does
  return {};
}

std::string N2kDeviceOutput::fault() const {
  if (auto fault = link().fault(); !fault.empty()) return fault;
  if (owes_begin_) return {};
  if (is_gateway_ && now_ - heard_ > kMostSilence) {
    return "no RAW line has come from the gateway for " + std::to_string(std::chrono::floor<std::chrono::seconds>(now_ - heard_).count()) +
           " s: its server must speak RAW, in both directions";
  }
  if (device_.state() == N2kDevice::State::kNoAddress) return "no address of the NMEA 2000 network is free: nothing is sent there";
  if (given_address_ >= 0) {
    return "the gateway sends under its own address " + std::to_string(given_address_) + " in place of ours: others take our messages for its own";
  }
  return {};
}

std::vector<Counter> N2kDeviceOutput::counters() const {
  auto counters = link().counters();
  counters.push_back({address_name_, device_.is_claimed() ? device_.address() : -1});
  counters.push_back({lost_name_, device_.num_addresses_lost()});
  counters.push_back({unanswered_name_, device_.num_unanswered()});
  return counters;
}

}  // namespace lookout::plotter
