#include "tools/log/payloads.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <ostream>
#include <utility>
#include <variant>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/log_time.hpp"
#include "common/core/sentence.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/pose_message.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "services/lidar/core/vlp16/position_packet.hpp"
#include "services/lidar/wire.hpp"
#include "services/navigator/wire.hpp"
#include "tools/log/channel_types.hpp"
#include "tools/log/other_type.hpp"

namespace lookout::log {

namespace {

constexpr std::string_view kOtherType = "of another type than the channel's";
constexpr std::string_view kUndecodable = "do not decode";
constexpr std::string_view kContradicts = "contradict themselves";
constexpr std::string_view kBadTime = "have a time that cannot be";
constexpr std::string_view kBadBundle = "hold packets of the lidar that do not fill them";
constexpr std::string_view kBadChecksum = "hold a sentence with a wrong checksum";

std::string_view FaultOf(const lidar_scan_t& message) { return messages::FaultOf(message, bus::kMaxMessageBytes).value_or(""); }
std::string_view FaultOf(const segments_t& message) { return messages::FaultOf(message, bus::kMaxMessageBytes).value_or(""); }
std::string_view FaultOf(const obstacles_t& message) { return messages::FaultOf(message, bus::kMaxMessageBytes).value_or(""); }
std::string_view FaultOf(const alert_ack_t& message) { return messages::FaultOf(message).value_or(""); }
std::string_view FaultOf(const order_t& message) { return messages::FaultOf(message).value_or(""); }
std::string_view FaultOf(const tracks_t& message) { return messages::IsWellFormed(message) ? "" : kContradicts; }

std::string_view FaultOf(const pose_t& message) {
  const auto pose = messages::ToPose(message);
  const auto* fault = std::get_if<messages::Fault>(&pose);
  return fault != nullptr ? *fault : "";
}

std::string_view FaultOf(const nav_raw_t& message) {
  const auto item = navigator::ToItem(message);
  if (const auto* refusal = std::get_if<navigator::Refusal>(&item)) return *refusal;
  const bool is_sentence = message.kind == nav_raw_t::KIND_SENTENCE;
  return is_sentence && Frame(message.sentence, false).fault == SentenceFault::kBadChecksum ? kBadChecksum : "";
}

std::string_view FaultOf(const lidar_packets_t& message) {
  const auto bundle = lidar::ToBundle(message);
  if (!bundle) return kBadBundle;
  for (const auto& item : bundle->items) {
    const auto payload = bundle->PayloadOf(item);
    if (payload.size() == vlp16::format::kDataPacketSizeBytes) {
      const auto fault = vlp16::ParseDataPacket(payload).fault;
      if (fault != vlp16::DataFault::kNone) return vlp16::kDataFaultNames.at(static_cast<std::size_t>(fault));
    } else {
      const auto fault = vlp16::ParsePositionPacket(payload).fault;
      // A sentence that is of no use is as the sensor sent it.
      if (fault != vlp16::PositionFault::kNone && fault != vlp16::PositionFault::kSentence) {
        return vlp16::kPositionFaultNames.at(static_cast<std::size_t>(fault));
      }
    }
  }
  return "";
}

template <typename Message>
std::string_view FaultOf(const Message& message) {
  return UtimeFromWire(message.utime_us) ? "" : kBadTime;
}

template <typename Message>
std::string_view Check(Bytes bytes) {
  constexpr std::size_t kFingerprintBytes = 8;
  if (bytes.size() < kFingerprintBytes) return kUndecodable;
  if (bus::ReadU64BigEndian(bytes, 0) != static_cast<std::uint64_t>(Message::getHash())) return kOtherType;
  const auto message = bus::Decode<Message>(bytes);
  return message ? FaultOf(*message) : kUndecodable;
}

struct Checker {
  std::string_view channel;
  std::string_view (*check)(Bytes bytes);
};

constexpr auto kCheckers = OfEachChannel([](std::string_view name, auto type) { return Checker{name, &Check<typename decltype(type)::type>}; });
static_assert(kCheckers.size() == bus::kChannels.size());

const Checker* CheckerOf(std::string_view channel) {
  for (const auto& checker : kCheckers) {
    if (checker.channel == channel) return &checker;
  }
  return nullptr;
}

}  // namespace

std::string_view PayloadFault(std::string_view channel, Bytes bytes) {
  const auto* checker = CheckerOf(channel);
  return checker == nullptr ? "" : checker->check(bytes);
}

void Payloads::Add(std::int64_t event, const bus::LogEvent& message) {
  const auto* checker = CheckerOf(message.channel);
  if (checker == nullptr) {
    ++num_of_others_;
    return;
  }
  ++num_checked_;
  const auto fault = checker->check(message.bytes);
  if (fault.empty()) return;
  ++num_faulty_;
  const auto [found, is_new] = found_.try_emplace({message.channel, fault}, Found{.first_event = event, .first_time = message.time});
  ++found->second.count;
}

void Payloads::Print(std::ostream& out) const {
  const auto others = num_of_others_ > 0 ? fmt::format("; {} of other channels are not looked into", num_of_others_) : "";
  if (num_faulty_ == 0) {
    out << fmt::format("{:<9} {} messages of known channels checked, nothing wrong{}\n", "payloads", num_checked_, others);
    return;
  }
  out << fmt::format("{:<9} {} messages of known channels checked, {} are wrong{}\n", "payloads", num_checked_, num_faulty_, others);
  for (const auto& [place, found] : found_) {
    out << fmt::format("{:<9} {} {}: {}; the first is event {}, {}\n", "", found.count, place.first, place.second, found.first_event,
                       TimeText(found.first_time));
  }
  std::string made_anew;
  for (const auto& [place, found] : found_) {
    const auto* channel = bus::FindChannel(place.first);
    if (place.second != kOtherType || channel == nullptr || !IsMadeAnew(*channel)) continue;
    made_anew += (made_anew.empty() ? "" : ", ") + std::string(place.first);
  }
  if (!made_anew.empty())
    out << fmt::format("{:<9} of another version of Lookout, or damaged: lookout-replay makes {} anew of the log\n", "", made_anew);
}

}  // namespace lookout::log
