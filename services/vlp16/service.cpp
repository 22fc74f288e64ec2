#include "services/vlp16/service.hpp"

#include <algorithm>
#include <string>

#include "services/vlp16/wire.hpp"

namespace lookout::vlp16 {

namespace {

// A sensor sends a packet every 1.3 ms.
constexpr std::chrono::seconds kSilence(1);

}  // namespace

Service::Service(bus::Bus& bus, const Params& params)
    : bus_(bus),
      params_(params),
      bundler_(params.data_port, params.position_port, params.decoder.cut_azimuth_rad),
      decoder_(
          params.decoder, [this](const Turn& turn) { PublishTurn(turn); }, [this](const SentenceOfLidar& sentence) { PublishSentence(sentence); }) {
  if (params_.input == Input::kLog) {
    bus::Subscribe<lidar_packets_t>(bus_, bus::kLidarPackets, [this](const lidar_packets_t& message) { OnMessage(message); });
  }
}

void Service::OnDatagram(Utime host_time, int udp_port, Bytes payload) {
  if (const auto bundle = bundler_.Add(host_time, udp_port, payload)) PublishAndConsume(*bundle);
}

void Service::AdvanceTo(Utime host_time) {
  if (!silent_since_ || *silent_since_ > host_time) silent_since_ = host_time;
  now_ = host_time;
  if (const auto bundle = bundler_.AdvanceTo(host_time)) PublishAndConsume(*bundle);
}

void Service::Finish(Utime host_time) {
  if (params_.input == Input::kLog) {
    decoder_.Flush();
  } else if (const auto bundle = bundler_.Finish(host_time)) {
    PublishAndConsume(*bundle);
  }
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
    decoder_.Reset();
    sentence_seq_ = 0;
  }
  for (const auto& item : bundle.items) {
    if (item.udp_port == params_.data_port) {
      if (decoder_.OnDataPayload(item.host_time, bundle.PayloadOf(item))) silent_since_ = item.host_time;
    } else if (item.udp_port == params_.position_port) {
      decoder_.OnPositionPayload(item.host_time, bundle.PayloadOf(item));
    } else {
      ++num_other_port_;
    }
  }
  if (bundle.is_end) decoder_.Flush();
}

void Service::PublishTurn(const Turn& turn) {
  is_locked_sensor_unused_ = turn.clock.state == ClockState::kLocked && turn.clock.source == TimeSource::kHost;
  last_host_minus_sensor_ = turn.clock.host_minus_sensor.value_or(std::chrono::microseconds(0));
  bus::Publish(bus_, bus::kLidarClock, ToClockMessage(turn, raw_seq_));
  for (const auto& part : ToScanMessages(turn, raw_seq_, params_.use_vertical_origin_offsets, bus::kMaxMessageBytes)) {
    bus::Publish(bus_, bus::kLidarScan, part);
  }
}

void Service::PublishSentence(const SentenceOfLidar& sentence) {
  bus::Publish(bus_, bus::kLidarNmea, ToMessage(sentence, sentence_seq_++, raw_seq_));
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = bundler_.counters();
  const auto decoder_counters = decoder_.counters();
  report.counters.insert(report.counters.end(), decoder_counters.begin(), decoder_counters.end());
  report.counters.push_back({"messages_refused", num_refused_messages_});
  report.counters.push_back({"packets_other_port", num_other_port_});
  if (params_.input == Input::kOutside && silent_since_ && now_ - *silent_since_ >= kSilence) {
    const auto seconds = std::chrono::floor<std::chrono::seconds>(now_ - *silent_since_).count();
    report.state = HealthState::kDegraded;
    report.reason = decoder_.last_refusal().empty() ? "no lidar packets for " + std::to_string(seconds) + " s"
                                                    : "no usable lidar packets for " + std::to_string(seconds) +
                                                          " s; the last was refused: " + std::string(decoder_.last_refusal());
  }
  if (report.state == HealthState::kOk && params_.decoder.time == TimeChoice::kAuto && is_locked_sensor_unused_) {
    report.state = HealthState::kDegraded;
    report.reason = "this computer's clock is " + std::to_string(ToSeconds(last_host_minus_sensor_)) +
                    " s off the sensor's, which is locked to GNSS: turns carry the computer's time until it is set";
  }
  return report;
}

}  // namespace lookout::vlp16
