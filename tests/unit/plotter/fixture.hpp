// The plotter's service on a bus of its own, with links that keep what was sent.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/n2k_output.hpp"
#include "services/plotter/nmea_output.hpp"
#include "services/plotter/service.hpp"
#include "services/plotter/signal_k_output.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/support/messages.hpp"

namespace lookout::plotter::test {

class KeepingLink : public Link {
 public:
  std::vector<std::string> sent;
  std::deque<std::string> received;
  std::size_t room = 1'000'000;
  double bytes_per_s = 0.0;  // of a port that has room for half a second; 0: of one without a speed
  double unsent_bytes = 0.0;
  bool is_there = true;
  std::int64_t openings = 1;
  std::string wrong;

  void Send(std::string_view message) override {
    EXPECT_LE(message.size(), room_bytes());
    room -= std::min(room, message.size());
    unsent_bytes += static_cast<double>(message.size());
    sent.emplace_back(message);
  }
  std::optional<std::string> Receive() override {
    if (received.empty()) return std::nullopt;
    auto message = received.front();
    received.pop_front();
    return message;
  }
  std::size_t room_bytes() const override {
    return bytes_per_s > 0.0 ? static_cast<std::size_t>(std::max(bytes_per_s / 2.0 - unsent_bytes, 0.0)) : room;
  }
  std::chrono::microseconds delay() const override {
    return std::chrono::microseconds(bytes_per_s > 0.0 ? static_cast<std::int64_t>(1e6 * unsent_bytes / bytes_per_s) : 0);
  }
  void Pass(double duration_s) { unsent_bytes = std::max(unsent_bytes - duration_s * bytes_per_s, 0.0); }
  bool is_open() const override { return is_there; }
  std::int64_t num_openings() const override { return openings; }
  std::string fault() const override { return wrong; }
  std::vector<Counter> counters() const override { return {}; }

  /// Those that hold `text`; of what was sent since the last Clear.
  std::vector<std::string> With(std::string_view text) const {
    std::vector<std::string> found;
    for (const auto& message : sent) {
      if (message.find(text) != std::string::npos) found.push_back(message);
    }
    return found;
  }
};

inline constexpr std::int64_t kStartUs = 1'782'901'200'000'000;
inline constexpr GeodeticPlace kPlace{53.3, -6.1, 0.0};

class ServiceFixture : public ::testing::Test {
 protected:
  std::unique_ptr<bus::MemoryBus> bus_;  // a service leaves its bus only with it
  Params params_{.boat = "gannet"};
  KeepingLink* nmea_ = nullptr;
  KeepingLink* signal_k_ = nullptr;
  KeepingLink* n2k_ = nullptr;
  std::unique_ptr<Service> service_;
  std::vector<alert_ack_t> acknowledged_;
  std::int64_t host_us_ = kStartUs;
  std::int64_t pose_seq_ = 0;
  std::int64_t scan_seq_ = 0;
  std::vector<track_t> tracks_{};
  std::vector<alert_t> alerts_{};
  std::vector<std::pair<std::int64_t, std::string>> names_{};
  std::int64_t sounding_alert_id_ = 0;
  std::int64_t silenced_until_us_ = 0;
  std::int64_t begin_us_ = kStartUs;
  std::int32_t pose_status_ = pose_t::STATUS_OK;
  std::int32_t heading_source_ = pose_t::HEADING_HDT;

  void SetUp() override { Start(); }

  void NewBus() {
    service_.reset();
    bus_ = std::make_unique<bus::MemoryBus>();
    bus::Subscribe<alert_ack_t>(*bus_, bus::kAlertAck, [this](const alert_ack_t& message) { acknowledged_.push_back(message); });
  }

  void Start() {
    auto nmea = std::make_unique<KeepingLink>();
    auto signal_k = std::make_unique<KeepingLink>();
    auto n2k = std::make_unique<KeepingLink>();
    nmea_ = nmea.get();
    signal_k_ = signal_k.get();
    n2k_ = n2k.get();
    std::vector<std::unique_ptr<Output>> outputs;
    outputs.push_back(std::make_unique<NmeaOutput>(OutputParams{.name = "nmea", .alerts = SentAlerts::kAlr, .takes_acknowledgements = true},
                                                   std::move(nmea), params_.target_period));
    outputs.push_back(std::make_unique<SignalKOutput>(
        OutputParams{
            .name = "signalk", .format = Format::kSignalK, .destination = {.kind = Destination::Kind::kWebSocket}, .takes_acknowledgements = true},
        std::move(signal_k), params_.boat));
    outputs.push_back(
        std::make_unique<N2kOutput>(OutputParams{.name = "n2k", .format = Format::kN2kActisense}, std::move(n2k), params_.target_period));
    NewBus();
    service_ = std::make_unique<Service>(*bus_, params_, std::move(outputs));
    service_->AdvanceTo(Now());
  }

  Utime Now() const { return Utime(std::chrono::microseconds(host_us_)); }
  void HandleAll() { support::HandleAll(*bus_); }
  void Clear() {
    for (auto* link : {nmea_, signal_k_, n2k_}) link->sent.clear();
  }

  // Only host time passes.
  void Wait(std::int64_t duration_us) {
    for (const auto end_us = host_us_ + duration_us; host_us_ < end_us;) {
      host_us_ += 20'000;
      service_->AdvanceTo(Now());
      HandleAll();
    }
  }

  void SendPose() {
    pose_t pose{};
    pose.utime_us = host_us_ / 20'000 * 20'000;
    pose.seq = pose_seq_++;
    pose.status = pose_status_;
    pose.heading_source = heading_source_;
    support::SetDatum(pose, kPlace);
    pose.latitude_deg = kPlace.latitude_deg;
    pose.longitude_deg = kPlace.longitude_deg;
    pose.heading_rad = 0.5;
    pose.velocity_map_mps[0] = 2.0;
    if (pose_status_ == pose_t::STATUS_UNKNOWN) pose.latitude_deg = pose.longitude_deg = pose.heading_rad = kNan;
    support::Send(*bus_, bus::kPose, pose);
  }

  tracks_t Tracks() {
    auto message = support::OfScan<tracks_t>(host_us_ - 100'000, scan_seq_, 100'000);
    message.begin_utime_us = begin_us_;
    support::SetDatum(message, kPlace);
    support::Fill(message, tracks_);
    return message;
  }
  void SendTracks(const tracks_t& message) {
    for (const auto& part : support::InParts(message, 300)) support::Send(*bus_, bus::kTracks, part);
  }
  void SendAlerts() {
    auto message = support::OfScan<alerts_t>(host_us_ - 100'000, scan_seq_, 100'000);
    support::Fill(message, alerts_);
    message.sounding_alert_id = sounding_alert_id_;
    message.silenced_until_utime_us = silenced_until_us_;
    for (const auto& [id, name] : names_) {
      message.named_track_id.push_back(id);
      message.given_name.push_back(name);
    }
    message.num_names = static_cast<std::int32_t>(message.given_name.size());
    support::Send(*bus_, bus::kAlerts, message);
  }

  // Everything comes, ten times a second.
  void Run(std::int64_t duration_us) {
    for (const auto end_us = host_us_ + duration_us; host_us_ < end_us;) {
      Wait(100'000);
      SendPose();
      SendTracks(Tracks());
      SendAlerts();
      ++scan_seq_;
      Wait(0);
    }
  }

  static track_t MakeTrack(std::int64_t id, std::int32_t status = track_t::STATUS_CONFIRMED) {
    track_t track{};
    track.id = id;
    track.status = status;
    track.kind = track_t::KIND_BOAT;
    track.first_utime_us = kStartUs;
    track.seen_utime_us = kStartUs;
    track.latitude_deg = 53.3009;
    track.longitude_deg = -6.1;
    track.length_m = 6.0F;
    track.width_m = 2.0F;
    track.distance_m = 97.0F;
    track.cpa_m = 40.0F;
    track.tcpa_s = 0.0F;
    return track;
  }
  static alert_t MakeAlert(std::int64_t id, std::int32_t state = alert_t::STATE_ACTIVE) {
    alert_t alert{};
    alert.id = id;
    alert.cause = alert_t::CAUSE_CLOSEST_APPROACH;
    alert.level = alert_t::LEVEL_WARNING;
    alert.state = state;
    alert.track_id = 17;
    alert.raised_utime_us = kStartUs;
    alert.changed_utime_us = kStartUs;
    alert.text = "boat 17: closest approach 3 m in 21 s";
    return alert;
  }

  std::int64_t Count(std::string_view name) const { return support::CountOf(*service_, name); }
};

}  // namespace lookout::plotter::test
