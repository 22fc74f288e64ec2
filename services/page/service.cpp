#include "services/page/service.hpp"

#include <algorithm>

#include "lookout/alert_ack_t.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/map_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::page {

namespace {

using namespace std::chrono_literals;

// An acknowledgement that was sent takes effect with the next scan: the same one again is none.
constexpr auto kAcknowledgedFor = 1s;

ChannelIndex IndexOf(const bus::Channel& channel) {
  const auto& names = ChannelNames();
  return static_cast<ChannelIndex>(std::ranges::find(names, channel.name) - names.begin());
}

// Messages of one slot replace each other.
template <typename T>
std::string SlotOf(const T& /*message*/) {
  return {};
}
std::string SlotOf(const health_t& message) { return message.process + " " + message.host + " " + std::to_string(message.pid); }

template <typename T>
int PartOf(const T& message) {
  if constexpr (requires { message.part_index; }) return message.part_index;
  return 0;
}

}  // namespace

void AcknowledgementQueue::Push(const Acknowledgement& acknowledgement) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() < kMost) {
    waiting_.push_back(acknowledgement);
  } else {
    ++num_dropped_;
  }
}

std::vector<Acknowledgement> AcknowledgementQueue::TakeAll() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

std::int64_t AcknowledgementQueue::num_dropped() const {
  const std::lock_guard lock(mutex_);
  return num_dropped_;
}

Service::Service(bus::Bus& bus, ServiceParts parts) : bus_(bus), parts_(std::move(parts)) {
  Forward<lidar_scan_t>(bus::kLidarScan);
  Forward<lidar_clock_t>(bus::kLidarClock);
  Forward<segments_t>(bus::kSegments);
  Forward<gnss_fix_t>(bus::kGnssFix);
  Forward<attitude_t>(bus::kAttitude);
  Forward<pose_t>(bus::kPose);
  Forward<obstacles_t>(bus::kObstacles);
  Forward<tracks_t>(bus::kTracks);
  Forward<alerts_t>(bus::kAlerts);
  Forward<map_t>(bus::kMap);
  Forward<alert_ack_t>(bus::kAlertAck);
  Forward<health_t>(bus::kHealth);
  Forward<run_info_t>(bus::kRunInfo);
}

template <typename T>
void Service::Forward(const bus::Channel& channel) {
  const auto found = std::ranges::find(watches_, channel.name, &InputWatch::name);
  auto* watch = found == watches_.end() ? nullptr : &*found;
  bus::Subscribe<T>(bus_, channel, [this, watch, name = channel.name, index = IndexOf(channel)](const T& message, Bytes bytes) {
    const auto time = parts_.now();
    if (watch != nullptr) watch->Note();
    if constexpr (std::is_same_v<T, alerts_t>) OnAlerts(message, time);
    if (parts_.keep) parts_.keep(time, name, bytes);
    if (parts_.server.IsWatched(index)) parts_.server.Publish(index, SlotOf(message), message.utime_us, PartOf(message), time, bytes);
  });
}

void Service::OnAlerts(const alerts_t& message, Utime time) {
  alerts_time_ = time;
  alerts_.clear();
  for (const auto& alert : message.alerts) {
    if (alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_RECTIFIED) alerts_.emplace(alert.id, alert.raised_utime_us);
  }
}

void Service::AdvanceTo(Utime host_time) {
  for (auto& watch : watches_) watch.AdvanceTo(host_time);
  std::erase_if(acknowledged_, [host_time](const auto& one) { return std::chrono::abs(host_time - one.second) >= kAcknowledgedFor; });
  for (const auto& acknowledgement : parts_.acknowledgements.TakeAll()) Acknowledge(acknowledgement, host_time);
}

void Service::Acknowledge(const Acknowledgement& acknowledgement, Utime host_time) {
  const AlertKey key{acknowledgement.alert_id, ToUtimeUs(acknowledgement.raised)};
  const bool is_fresh = alerts_time_ && std::chrono::abs(host_time - *alerts_time_) < kFresh;
  if (!is_fresh || !alerts_.contains(key)) {
    ++counts_["acks_of_no_alert"];
    return;
  }
  if (!acknowledged_.emplace(key, host_time).second) {
    ++counts_["acks_repeated"];
    return;
  }
  alert_ack_t message{};
  message.utime_us = ToUtimeUs(host_time);
  message.seq = ack_seq_++;
  message.source = "page";
  message.alert_id = key.first;
  message.alert_raised_utime_us = key.second;
  bus::Publish(bus_, bus::kAlertAck, message);
  ++counts_["acks_sent"];
}

HealthReport Service::Report() {
  HealthReport report;
  server_counts_ = parts_.server.Counts();
  for (const auto& [name, count] : server_counts_) report.counters.push_back({name, count});
  counts_.AppendTo(report.counters);
  report.counters.push_back({"acks_dropped", parts_.acknowledgements.num_dropped()});
  if (const auto text = InputWatch::Complaint(watches_); !text.empty()) report.Degrade(text);
  if (parts_.add_to_report) parts_.add_to_report(report);
  return report;
}

}  // namespace lookout::page
