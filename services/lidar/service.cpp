#include "services/lidar/service.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/core/angles.hpp"
#include "common/core/printable.hpp"
#include "services/lidar/decoders.hpp"
#include "services/lidar/wire.hpp"

namespace lookout::lidar {

namespace {

// A sensor sends a packet every 1.3 ms.
constexpr std::chrono::seconds kSilence(1);
// A head that turns ends a scan in 0.2 s, the slowest in 0.4 s.
constexpr std::chrono::seconds kNoScan(2);
// A datagram may wait in the network; a clock of another second is told.
constexpr std::chrono::milliseconds kMostClockDifference(500);
constexpr std::chrono::seconds kRatePeriod(1);
// A restart and what comes with it break the stream a few times.
constexpr std::int64_t kMaxOutOfStreamPerS = 10;
// HEALTH tells of packets of others for so long after the last of them.
constexpr std::chrono::seconds kForeignTold(3);
// The journal: another sender, or the same one again.
constexpr std::chrono::seconds kLinePeriod(1);
constexpr std::chrono::seconds kSameLinePeriod(60);

const bus::Channel& PacketsOf(const Params& params) { return params.number == 1 ? bus::kLidarPackets : bus::kLidarPackets2; }

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

Service::Reading::Reading(const Params& params, Service& service)
    : bundler(params.data_port, params.position_port, FormOf(params)),
      lock(JudgeOf(params), params.sources.allowed_source_addresses),
      decoder(MakeDecoder(
          params, [&service](const Scan& scan) { service.PublishScan(scan); },
          [&service](const SentenceOfLidar& sentence) { service.PublishSentence(sentence); })) {}

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), params_(params) {
  if (!NeedsBeams()) reading_.emplace(params_, *this);
  if (params_.input != Input::kLog) return;
  bus::Subscribe<lidar_packets_t>(bus_, PacketsOf(params_), [this](const lidar_packets_t& message) { OnMessage(message); });
  if (params_.other) bus::Subscribe<lidar_beams_t>(bus_, bus::kLidarBeams, [this](const lidar_beams_t& message) { OnBeams(message); });
}

void Service::OnDatagram(Utime host_time, int udp_port, Bytes payload, const Sender& sender) {
  if (!reading_) {
    if (udp_port == params_.data_port || udp_port == params_.position_port) ++num_waited_for_beams_;
    return;
  }
  if (!IsTaken(host_time, udp_port, sender, payload)) return;
  if (const auto bundle = reading_->bundler.Add(host_time, udp_port, payload)) PublishAndConsume(*bundle);
}

// A packet that the bundler refuses by itself has no part in the lock.
bool Service::IsTaken(Utime host_time, int udp_port, const Sender& sender, Bytes payload) {
  const bool is_data = udp_port == params_.data_port && reading_->bundler.IsDataSize(payload.size());
  const bool is_position = udp_port == params_.position_port && reading_->bundler.IsPositionSize(payload.size());
  if ((!is_data && !is_position) || !UtimeFromWire(ToUtimeUs(host_time))) return true;
  const auto stream = is_data ? Stream::kData : Stream::kPosition;
  const auto before = reading_->lock.holder(stream);
  const auto outcome = reading_->lock.Check(host_time, stream, sender, payload);
  if (outcome.is_new_holder) NoteHolder(host_time, stream, before);
  if (!outcome.is_taken) NoteRefused(host_time, stream, sender, outcome.is_valid);
  return outcome.is_taken;
}

void Service::NoteHolder(Utime host_time, Stream stream, const std::optional<Sender>& before) {
  const auto& holder = *reading_->lock.holder(stream);
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
  if (!refusal_ || !reading_) return {};
  const auto& [sender, stream, is_valid, time, began] = *refusal_;
  const int port = stream == Stream::kData ? params_.data_port : params_.position_port;
  const auto& holder = reading_->lock.holder(Stream::kData) ? reading_->lock.holder(Stream::kData) : reading_->lock.holder(stream);
  const std::string refused = std::to_string(num_sender_refused_[0] + num_sender_refused_[1]) + " packets of others refused so far";
  if (!reading_->lock.IsAllowed(sender)) {
    return "packets from " + ToText(sender) + " to port " + std::to_string(port) + " are refused: allowed_source_address does not name it (" +
           refused + ")";
  }
  if (is_valid && holder && holder->address == sender.address) {
    return SameAddressComplaint(reading_->lock.holder(stream).value_or(*holder), port, refused);
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
  if (reading_->lock.heard(Stream::kData) <= began + kOverlap && reading_->lock.heard(stream) <= began + kOverlap) {
    return "the lidar at " + sender.address + " has started again: it sends to port " + std::to_string(port) + " from port " + from +
           "; it is used when nothing has come from there for 1 s (" + refused + ")";
  }
  return "two programs at " + sender.address + " send packets of a lidar to port " + std::to_string(port) + ", from ports " +
         std::to_string(holder.port) + " (used) and " + std::to_string(sender.port) + ": end one of them (" + refused + ")";
}

void Service::AdvanceTo(Utime host_time, std::optional<Utime> taken_until) {
  if (!silent_since_ || *silent_since_ > host_time) silent_since_ = host_time;
  if (scanless_since_ && *scanless_since_ > host_time) scanless_since_ = host_time;
  now_ = host_time;
  if (!second_began_ || *second_began_ > host_time) second_began_ = host_time;
  if (const auto elapsed = host_time - *second_began_; elapsed >= kRatePeriod) {
    data_packets_per_s_ = std::llround(static_cast<double>(num_data_packets_) / ToSeconds(elapsed));
    num_data_packets_ = 0;
    const auto num_out_of_stream = reading_ ? reading_->decoder->num_out_of_stream() : 0;
    out_of_stream_per_s_ = num_out_of_stream - num_out_of_stream_;
    num_out_of_stream_ = num_out_of_stream;
    second_began_ = host_time;
  }
  if (!reading_) return;
  if (const auto bundle = reading_->bundler.AdvanceTo(taken_until.value_or(host_time))) PublishAndConsume(*bundle);
}

void Service::Finish(Utime host_time) {
  if (!reading_) return;
  if (params_.input == Input::kLog) {
    reading_->decoder->Flush();
  } else if (const auto bundle = reading_->bundler.Finish(host_time)) {
    PublishAndConsume(*bundle);
  }
  reading_->lock.Reset();
}

void Service::OnMessage(const lidar_packets_t& message) {
  const auto bundle = ToBundle(message);
  if (!bundle) {
    ++num_refused_messages_;
    return;
  }
  if (!reading_) {
    num_waited_for_beams_ += static_cast<std::int64_t>(bundle->items.size());
    return;
  }
  Consume(*bundle);
}

// LIDAR_BEAMS repeat the same text again and again: only a new text changes anything.
void Service::OnBeams(const lidar_beams_t& message) {
  if (message.packets != PacketsOf(params_).name) return;
  auto& other = *params_.other;
  const bool is_of_model = message.model == ModelWord(other.model);
  auto fault = is_of_model ? std::string() : "LIDAR_BEAMS are of " + Printable(message.model) + ", lidar.txtpb says " + ModelWord(other.model);
  if (fault.empty() && message.text != other.beam_text) fault = BeamFault(other.model, message.text);
  beams_complaint_ = fault;
  if (!fault.empty()) {
    ++num_beams_refused_;
    return;
  }
  if (message.text == other.beam_text) return;
  ++num_beams_of_log_;
  if (!other.beam_text.empty() && on_notice_) {
    on_notice_("the log's beams (of " + Printable(message.origin) + ") are not those of " + other.beam_origin + ": the log's are used");
  }
  // A run that came to its end was flushed by its mark; one that was cut off was not, live.
  other.beam_text = message.text;
  other.beam_origin = message.origin;
  reading_.emplace(params_, *this);
}

std::string Service::UseBeams(Utime host_time, const std::string& text, const std::string& origin) {
  auto& other = *params_.other;
  if (text == other.beam_text) return {};
  if (auto fault = BeamFault(other.model, text); !fault.empty()) return fault;
  Finish(host_time);
  other.beam_text = text;
  other.beam_origin = origin;
  reading_.emplace(params_, *this);
  num_out_of_stream_ = 0;
  beams_sent_.reset();
  if (on_notice_) on_notice_("uses the beams of " + origin);
  return {};
}

bool Service::WantsBeams() const {
  if (!reading_) return true;
  return silent_since_ && now_ - *silent_since_ >= kSilence && !reading_->decoder->last_refusal().empty();
}

// Before the packets that they are for, and now and then, for whoever begins to record.
void Service::PublishBeams(const PacketBundle& bundle) {
  constexpr std::chrono::seconds kBeamsPeriod(10);
  if (!params_.other || params_.other->beam_text.empty()) return;
  const bool is_due = !beams_sent_ || bundle.time < *beams_sent_ || bundle.time - *beams_sent_ >= kBeamsPeriod;
  if (!bundle.is_start && !is_due) return;
  beams_sent_ = bundle.time;
  lidar_beams_t message{};
  message.utime_us = ToUtimeUs(bundle.time);
  message.seq = beams_seq_++;
  message.packets = PacketsOf(params_).name;
  message.model = ModelWord(params_.other->model);
  message.origin = params_.other->beam_origin;
  message.text = params_.other->beam_text;
  bus::Publish(bus_, bus::kLidarBeams, message);
}

void Service::PublishAndConsume(const PacketBundle& bundle) {
  PublishBeams(bundle);
  bus::Publish(bus_, PacketsOf(params_), ToMessage(bundle));
  Consume(bundle);
}

void Service::Consume(const PacketBundle& bundle) {
  raw_seq_ = bundle.seq;
  if (bundle.is_start) {
    reading_->decoder->Reset();
    sentence_seq_ = 0;
  }
  for (const auto& item : bundle.items) {
    if (item.udp_port == params_.data_port) {
      ++num_data_packets_;
      if (!reading_->decoder->OnDataPayload(item.host_time, bundle.PayloadOf(item))) continue;
      const bool was_silent = !scanless_since_ || !silent_since_ || item.host_time - *silent_since_ >= kSilence;
      if (was_silent || std::exchange(has_scan_, false)) scanless_since_ = item.host_time;
      silent_since_ = item.host_time;
    } else if (item.udp_port == params_.position_port) {
      reading_->decoder->OnPositionPayload(item.host_time, bundle.PayloadOf(item));
    } else {
      ++num_other_port_;
    }
  }
  if (bundle.is_end) reading_->decoder->Flush();
}

void Service::PublishScan(const Scan& scan) {
  if (!scan.is_partial_end) has_scan_ = true;
  NoteClock(scan.clock);
  bus::Publish(bus_, params_.number == 1 ? bus::kLidarClock : bus::kLidarClock2, ToClockMessage(scan, raw_seq_));
  for (const auto& part : ToScanMessages(scan, raw_seq_, bus::kMaxMessageBytes)) {
    bus::Publish(bus_, params_.number == 1 ? bus::kLidarScan : bus::kLidarScan2, part);
  }
}

// One receiver feeds both lidars: the navigator hears it through the first.
void Service::PublishSentence(const SentenceOfLidar& sentence) {
  if (params_.number != 1) return;
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
  if (!reading_) return "packets cannot be read yet: " + std::string(RowOf(params_.other->model).beam_file_is) + " is not there";
  if (!beams_complaint_.empty()) return beams_complaint_;
  const bool is_silent = params_.input == Input::kOutside && silent_since_ && now_ - *silent_since_ >= kSilence;
  const auto seconds_since = [this](Utime time) { return std::to_string(std::chrono::floor<std::chrono::seconds>(now_ - time).count()); };
  // Before silence, which may be of it.
  const auto telemetry = reading_->decoder->telemetry();
  if (telemetry && telemetry->is_shut_down) {
    return "the lidar has shut down for its temperature: " + std::to_string(telemetry->top_board_celsius) + " degrees C at the top board, " +
           std::to_string(telemetry->bottom_board_celsius) + " at the bottom board" +
           (is_silent ? "; no lidar packets for " + seconds_since(*silent_since_) + " s" : "");
  }
  if (is_silent) {
    std::string refusal = reading_->decoder->last_refusal();
    if (refusal.empty() && !reading_->bundler.foreign_sensor().empty())
      refusal = "a packet of another sensor: " + std::string(reading_->bundler.foreign_sensor());
    if (!refusal.empty()) return "no usable lidar packets for " + seconds_since(*silent_since_) + " s; the last was refused: " + refusal;
    return "no lidar packets for " + seconds_since(*silent_since_) + " s";
  }
  if (params_.input == Input::kOutside && scanless_since_ && now_ - *scanless_since_ >= kNoScan) {
    return "lidar packets come, but no scan has ended for " + seconds_since(*scanless_since_) + " s: the head stands, or turns too slowly";
  }
  if (out_of_stream_per_s_ > kMaxOutOfStreamPerS) {
    return "the packets do not follow one another (" + std::to_string(out_of_stream_per_s_) +
           " breaks in the last second): two lidars on one port, or one whose clock or encoder jumps";
  }
  const auto& clock = reading_->decoder->last_clock();
  if (params_.decoder.time == TimeChoice::kAuto && clock && clock->state == ClockState::kLocked && clock->source == TimeSource::kHost) {
    return "this computer's clock is " + Text(ToSeconds(clock->host_minus_sensor.value_or(std::chrono::microseconds(0))), 3) +
           " s ahead of the sensor's, which is locked to GNSS: scans carry the computer's time until it is set";
  }
  const auto host_minus_sensor = clock ? clock->host_minus_sensor.value_or(std::chrono::microseconds(0)) : std::chrono::microseconds(0);
  if (params_.decoder.time == TimeChoice::kSensor && clock && clock->state == ClockState::kLocked &&
      std::chrono::abs(host_minus_sensor) > kMostClockDifference) {
    return "scans carry the sensor's time as configured, and this computer's clock is " + Text(ToSeconds(host_minus_sensor), 3) +
           " s ahead of it: one of both is wrong";
  }
  if (params_.decoder.time == TimeChoice::kSensor && clock && clock->state != ClockState::kLocked) {
    return "scans carry the sensor's time as configured, but its clock is not locked to GNSS: " + std::string(Text(clock->state));
  }
  return {};
}

// Values now among them, not counts: their names end in a unit.
void Service::AppendReading(std::vector<Counter>& counters) const {
  const auto& decoder = *reading_->decoder;
  for (const auto& counter : reading_->bundler.counters()) counters.push_back(counter);
  for (const auto& counter : decoder.counters()) counters.push_back(counter);
  counters.push_back({"data_packets_per_s", data_packets_per_s_});
  counters.push_back({"rotation_rpm", std::llround(decoder.last_rate_radps() / kTwoPi * 60.0)});
  if (const auto phase_cdeg = decoder.phase_cdeg()) counters.push_back({"rotation_phase_cdeg", *phase_cdeg});
  if (const auto telemetry = decoder.telemetry()) {
    counters.push_back({"top_board_celsius", telemetry->top_board_celsius});
    counters.push_back({"bottom_board_celsius", telemetry->bottom_board_celsius});
    counters.push_back({"thermal_shutdown_celsius", telemetry->shutdown_celsius});
    counters.push_back({"power_up_celsius", telemetry->power_up_celsius});
    counters.push_back({"is_thermally_shut_down", telemetry->is_shut_down ? 1 : 0});
  }
}

HealthReport Service::Report() const {
  HealthReport report;
  if (reading_) AppendReading(report.counters);
  report.counters.push_back({"data_sender_refused", num_sender_refused_[static_cast<std::size_t>(Stream::kData)]});
  report.counters.push_back({"position_sender_refused", num_sender_refused_[static_cast<std::size_t>(Stream::kPosition)]});
  report.counters.push_back({"lidar_changes", num_lidar_changes_});
  report.counters.push_back({"messages_refused", num_refused_messages_});
  report.counters.push_back({"beams_refused", num_beams_refused_});
  report.counters.push_back({"beams_of_log", num_beams_of_log_});
  report.counters.push_back({"packets_before_beams", num_waited_for_beams_});
  report.counters.push_back({"packets_other_port", num_other_port_});
  report.reason = Complaint();
  if (!report.reason.empty()) report.state = HealthState::kDegraded;
  return report;
}

}  // namespace lookout::lidar
