#include "services/lidar/service.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/core/angles.hpp"
#include "services/lidar/decoders.hpp"
#include "services/lidar/wire.hpp"

namespace lookout::lidar {

namespace {

// A sensor sends a packet every 1.3 ms.
constexpr std::chrono::seconds kSilence(1);
constexpr std::chrono::seconds kRatePeriod(1);
// A restart and what comes with it break the stream a few times.
constexpr std::int64_t kMaxOutOfStreamPerS = 10;
// HEALTH tells of packets of others for so long after the last of them.
constexpr std::chrono::seconds kForeignTold(3);
// The journal: another sender, or the same one again.
constexpr std::chrono::seconds kLinePeriod(1);
constexpr std::chrono::seconds kSameLinePeriod(60);

std::string_view Text(ClockState state) {
  constexpr std::array<std::string_view, 7> kTexts{
      "unknown (no position packets)", "no PPS", "acquiring", "locked without time", "locked", "free-running", "PPS error"};
  return kTexts[static_cast<std::size_t>(state)];
}

std::string Text(double value, int num_decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", num_decimals, value);
  return text.data();
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params)
    : bus_(bus),
      params_(params),
      bundler_(params.data_port, params.position_port, FormOf(params)),
      lock_(JudgeOf(params), params.sources.allowed_source_addresses),
      decoder_(MakeDecoder(
          params, [this](const Scan& scan) { PublishScan(scan); }, [this](const SentenceOfLidar& sentence) { PublishSentence(sentence); })) {
  if (params_.input == Input::kLog) {
    bus::Subscribe<lidar_packets_t>(bus_, bus::kLidarPackets, [this](const lidar_packets_t& message) { OnMessage(message); });
  }
}

void Service::OnDatagram(Utime host_time, int udp_port, Bytes payload, const Sender& sender) {
  if (!IsTaken(host_time, udp_port, sender, payload)) return;
  if (const auto bundle = bundler_.Add(host_time, udp_port, payload)) PublishAndConsume(*bundle);
}

// A packet that the bundler refuses by itself has no part in the lock.
bool Service::IsTaken(Utime host_time, int udp_port, const Sender& sender, Bytes payload) {
  const bool is_data = udp_port == params_.data_port && bundler_.IsDataSize(payload.size());
  const bool is_position = udp_port == params_.position_port && bundler_.IsPositionSize(payload.size());
  if ((!is_data && !is_position) || !UtimeFromWire(ToUtimeUs(host_time))) return true;
  const auto stream = is_data ? Stream::kData : Stream::kPosition;
  const auto before = lock_.holder(stream);
  const auto outcome = lock_.Check(host_time, stream, sender, payload);
  if (outcome.is_new_holder) NoteHolder(host_time, stream, before);
  if (!outcome.is_taken) NoteRefused(host_time, stream, sender, outcome.is_valid);
  return outcome.is_taken;
}

void Service::NoteHolder(Utime host_time, Stream stream, const std::optional<Sender>& before) {
  const auto& holder = *lock_.holder(stream);
  if (before && stream == Stream::kData) ++num_lidar_changes_;
  // The refused sender has become the lidar.
  if (refusal_ && refusal_->sender == holder) refusal_.reset();
  if (holder.address.empty() || stream != Stream::kData || !on_notice_) return;
  std::string line = "uses the lidar at " + ToText(holder);
  if (before && before->address == holder.address) {
    line += "; it started again, before it sent from port " + std::to_string(before->port);
  } else if (before) {
    line += "; the one at " + ToText(*before) + " is silent";
  }
  told_refusal_ = Refusal{.sender = holder, .time = host_time};
  on_notice_(line);
}

void Service::NoteRefused(Utime host_time, Stream stream, const Sender& sender, bool is_valid) {
  ++num_sender_refused_[static_cast<std::size_t>(stream)];
  const bool goes_on =
      refusal_ && refusal_->sender.address == sender.address && host_time >= refusal_->time && host_time - refusal_->time < SenderLock::kPortSilence;
  refusal_ = Refusal{sender, stream, is_valid, host_time, goes_on ? refusal_->began : host_time};
  const auto since_told = told_refusal_ && host_time >= told_refusal_->time ? std::optional(host_time - told_refusal_->time) : std::nullopt;
  const bool is_same = told_refusal_ && told_refusal_->sender.address == sender.address;
  if (since_told && *since_told < (is_same ? kSameLinePeriod : kLinePeriod)) return;
  told_refusal_ = refusal_;
  if (on_notice_) on_notice_(ForeignComplaint());
}

// The sender besides the lidar, for people; empty when there is none.
std::string Service::ForeignComplaint() const {
  if (!refusal_) return {};
  const auto& [sender, stream, is_valid, time, began] = *refusal_;
  const int port = stream == Stream::kData ? params_.data_port : params_.position_port;
  const auto& holder = lock_.holder(Stream::kData) ? lock_.holder(Stream::kData) : lock_.holder(stream);
  const std::string refused = std::to_string(num_sender_refused_[0] + num_sender_refused_[1]) + " packets of others refused so far";
  if (!lock_.IsAllowed(sender)) {
    return "packets from " + ToText(sender) + " to port " + std::to_string(port) + " are refused: allowed_source_address does not name it (" +
           refused + ")";
  }
  if (is_valid && holder && holder->address == sender.address) {
    return SameAddressComplaint(lock_.holder(stream).value_or(*holder), port, refused);
  }
  return (is_valid ? "two lidars on one port: " : "packets that are not the lidar's: ") + ToText(sender) + " sends to port " + std::to_string(port) +
         " besides the lidar at " + (holder ? ToText(*holder) : "another address") + " (" + refused +
         "); set allowed_source_address in lidar.txtpb to the lidar to use";
}

// A sensor, simulator or forwarder that starts again sends from another port: that is no second lidar, unless the old one goes on beside it.
std::string Service::SameAddressComplaint(const Sender& holder, int port, const std::string& refused) const {
  const auto& [sender, stream, is_valid, time, began] = *refusal_;
  constexpr std::chrono::milliseconds kOverlap(100);
  const auto from = std::to_string(sender.port) + (holder.port == sender.port ? "" : ", before from " + std::to_string(holder.port));
  if (lock_.heard(Stream::kData) <= began + kOverlap && lock_.heard(stream) <= began + kOverlap) {
    return "the lidar at " + sender.address + " has started again: it sends to port " + std::to_string(port) + " from port " + from +
           "; it is used when nothing has come from there for 1 s (" + refused + ")";
  }
  return "two programs at " + sender.address + " send packets of a lidar to port " + std::to_string(port) + ", from ports " +
         std::to_string(holder.port) + " (used) and " + std::to_string(sender.port) + ": end one of them (" + refused + ")";
}

void Service::AdvanceTo(Utime host_time, std::optional<Utime> taken_until) {
  if (!silent_since_ || *silent_since_ > host_time) silent_since_ = host_time;
  now_ = host_time;
  if (!second_began_ || *second_began_ > host_time) second_began_ = host_time;
  if (const auto elapsed = host_time - *second_began_; elapsed >= kRatePeriod) {
    data_packets_per_s_ = std::llround(static_cast<double>(num_data_packets_) / ToSeconds(elapsed));
    num_data_packets_ = 0;
    out_of_stream_per_s_ = decoder_->num_out_of_stream() - num_out_of_stream_;
    num_out_of_stream_ = decoder_->num_out_of_stream();
    second_began_ = host_time;
  }
  if (const auto bundle = bundler_.AdvanceTo(taken_until.value_or(host_time))) PublishAndConsume(*bundle);
}

void Service::Finish(Utime host_time) {
  if (params_.input == Input::kLog) {
    decoder_->Flush();
  } else if (const auto bundle = bundler_.Finish(host_time)) {
    PublishAndConsume(*bundle);
  }
  lock_.Reset();
}

void Service::OnMessage(const lidar_packets_t& message) {
  const auto bundle = ToBundle(message);
  if (!bundle) {
    ++num_refused_messages_;
    return;
  }
  Consume(*bundle);
}

void Service::PublishAndConsume(const PacketBundle& bundle) {
  bus::Publish(bus_, bus::kLidarPackets, ToMessage(bundle));
  Consume(bundle);
}

void Service::Consume(const PacketBundle& bundle) {
  raw_seq_ = bundle.seq;
  if (bundle.is_start) {
    decoder_->Reset();
    sentence_seq_ = 0;
  }
  for (const auto& item : bundle.items) {
    if (item.udp_port == params_.data_port) {
      ++num_data_packets_;
      if (decoder_->OnDataPayload(item.host_time, bundle.PayloadOf(item))) silent_since_ = item.host_time;
    } else if (item.udp_port == params_.position_port) {
      decoder_->OnPositionPayload(item.host_time, bundle.PayloadOf(item));
    } else {
      ++num_other_port_;
    }
  }
  if (bundle.is_end) decoder_->Flush();
}

void Service::PublishScan(const Scan& scan) {
  NoteClock(scan.clock);
  bus::Publish(bus_, bus::kLidarClock, ToClockMessage(scan, raw_seq_));
  for (const auto& part : ToScanMessages(scan, raw_seq_, bus::kMaxMessageBytes)) {
    bus::Publish(bus_, bus::kLidarScan, part);
  }
}

void Service::PublishSentence(const SentenceOfLidar& sentence) {
  bus::Publish(bus_, bus::kLidarNmea, ToMessage(sentence, sentence_seq_++, raw_seq_));
}

void Service::NoteClock(const ClockReading& clock) {
  if (noted_state_ == clock.state && noted_source_ == clock.source) return;
  std::string line = "sensor clock: ";
  if (noted_state_ && noted_state_ != clock.state) line += std::string(Text(*noted_state_)) + " -> ";
  line += Text(clock.state);
  line += clock.source == TimeSource::kSensor ? "; scans carry the sensor's time" : "; scans carry this computer's time";
  if (clock.host_minus_sensor) line += "; it is " + Text(ToSeconds(*clock.host_minus_sensor), 6) + " s ahead of the sensor's";
  noted_state_ = clock.state;
  noted_source_ = clock.source;
  if (on_notice_) on_notice_(line);
}

// The fault, for people; empty when there is none.
std::string Service::Complaint() const {
  auto own = OwnComplaint();
  // A clock that was set back must not keep an old refusal alive.
  const bool is_foreign_now = refusal_ && now_ - refusal_->time < kForeignTold && refusal_->time - now_ < kForeignTold;
  if (!is_foreign_now) return own;
  return own.empty() ? ForeignComplaint() : own + "; " + ForeignComplaint();
}

// The fault of the lidar in use.
std::string Service::OwnComplaint() const {
  if (params_.input == Input::kOutside && silent_since_ && now_ - *silent_since_ >= kSilence) {
    const auto seconds = std::to_string(std::chrono::floor<std::chrono::seconds>(now_ - *silent_since_).count());
    std::string refusal = decoder_->last_refusal();
    if (refusal.empty() && !bundler_.foreign_sensor().empty()) refusal = "a packet of another sensor: " + std::string(bundler_.foreign_sensor());
    if (!refusal.empty()) return "no usable lidar packets for " + seconds + " s; the last was refused: " + refusal;
    return "no lidar packets for " + seconds + " s";
  }
  if (out_of_stream_per_s_ > kMaxOutOfStreamPerS) {
    return "the packets do not follow one another (" + std::to_string(out_of_stream_per_s_) +
           " breaks in the last second): two lidars on one port, or one whose clock or encoder jumps";
  }
  const auto telemetry = decoder_->telemetry();
  if (telemetry && telemetry->is_shut_down) {
    return "the lidar has shut down for its temperature: " + std::to_string(telemetry->top_board_celsius) + " degrees C at the top board, " +
           std::to_string(telemetry->bottom_board_celsius) + " at the bottom board";
  }
  const auto& clock = decoder_->last_clock();
  if (params_.decoder.time == TimeChoice::kAuto && clock && clock->state == ClockState::kLocked && clock->source == TimeSource::kHost) {
    return "this computer's clock is " + Text(ToSeconds(clock->host_minus_sensor.value_or(std::chrono::microseconds(0))), 3) +
           " s ahead of the sensor's, which is locked to GNSS: scans carry the computer's time until it is set";
  }
  if (params_.decoder.time == TimeChoice::kSensor && clock && clock->state != ClockState::kLocked) {
    return "scans carry the sensor's time as configured, but its clock is not locked to GNSS: " + std::string(Text(clock->state));
  }
  return {};
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = bundler_.counters();
  const auto decoder_counters = decoder_->counters();
  report.counters.insert(report.counters.end(), decoder_counters.begin(), decoder_counters.end());
  report.counters.push_back({"data_sender_refused", num_sender_refused_[static_cast<std::size_t>(Stream::kData)]});
  report.counters.push_back({"position_sender_refused", num_sender_refused_[static_cast<std::size_t>(Stream::kPosition)]});
  report.counters.push_back({"lidar_changes", num_lidar_changes_});
  report.counters.push_back({"messages_refused", num_refused_messages_});
  report.counters.push_back({"packets_other_port", num_other_port_});
  // Values now, not counts: their names end in a unit.
  report.counters.push_back({"data_packets_per_s", data_packets_per_s_});
  report.counters.push_back({"rotation_rpm", std::llround(decoder_->last_rate_radps() / kTwoPi * 60.0)});
  if (const auto phase_cdeg = decoder_->phase_cdeg()) report.counters.push_back({"rotation_phase_cdeg", *phase_cdeg});
  if (const auto telemetry = decoder_->telemetry()) {
    report.counters.push_back({"top_board_celsius", telemetry->top_board_celsius});
    report.counters.push_back({"bottom_board_celsius", telemetry->bottom_board_celsius});
    report.counters.push_back({"thermal_shutdown_celsius", telemetry->shutdown_celsius});
    report.counters.push_back({"power_up_celsius", telemetry->power_up_celsius});
    report.counters.push_back({"is_thermally_shut_down", telemetry->is_shut_down ? 1 : 0});
  }
  report.reason = Complaint();
  if (!report.reason.empty()) report.state = HealthState::kDegraded;
  return report;
}

}  // namespace lookout::lidar
