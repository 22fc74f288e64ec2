#include "services/page/service.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "lookout/ais_t.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/order_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::page {

namespace {

using namespace std::chrono_literals;

// An order takes effect with the next scan: the same order before that is a repetition.
constexpr auto kAcknowledgedFor = 1s;
constexpr auto kOrderedFor = 1s;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

float ToWire(const std::optional<double>& value, double factor = 1.0) {
  return value ? static_cast<float>(*value * factor) : std::numeric_limits<float>::quiet_NaN();
}

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

Service::Service(bus::Bus& bus, ServiceParts parts) : bus_(bus), parts_(std::move(parts)) {
  Forward<lidar_scan_t>(bus::kLidarScan);
  Forward<lidar_clock_t>(bus::kLidarClock);
  Forward<segments_t>(bus::kSegments);
  Forward<lidar_scan_t>(bus::kLidarScan2);
  Forward<segments_t>(bus::kSegments2);
  Forward<gnss_fix_t>(bus::kGnssFix);
  Forward<attitude_t>(bus::kAttitude);
  Forward<pose_t>(bus::kPose);
  Forward<obstacles_t>(bus::kObstacles);
  Forward<tracks_t>(bus::kTracks);
  Forward<alerts_t>(bus::kAlerts);
  Forward<alert_ack_t>(bus::kAlertAck);
  Forward<ais_t>(bus::kAis);
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
    if (parts_.draw) parts_.draw(time, name, bytes);
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
  for (const auto& order : parts_.orders.TakeAll()) SendOrder(order, host_time);
}

bool Service::HasFreshAlerts(Utime host_time) const { return alerts_time_ && std::chrono::abs(host_time - *alerts_time_) < kFresh; }

void Service::Acknowledge(const Acknowledgement& acknowledgement, Utime host_time) {
  const AlertKey key{acknowledgement.alert_id, ToUtimeUs(acknowledgement.raised)};
  if (!HasFreshAlerts(host_time) || !alerts_.contains(key)) {
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

void Service::SendOrder(const Order& order, Utime host_time) {
  if (!HasFreshAlerts(host_time)) {
    ++counts_["orders_unheard"];
    return;
  }
  if (ordered_ && ordered_->first == order && std::chrono::abs(host_time - ordered_->second) < kOrderedFor) {
    ++counts_["orders_repeated"];
    return;
  }
  ordered_ = {order, host_time};
  order_t message{};
  message.utime_us = ToUtimeUs(host_time);
  message.seq = order_seq_++;
  message.source = "page";
  message.kind = order_t::KIND_SILENCE;
  if (order.kind == Order::Kind::kSettings) {
    message.kind = order_t::KIND_SETTINGS;
    message.mode = order_t::MODE_OPEN_WATER;
    if (order.mode == Order::Mode::kHarbour) message.mode = order_t::MODE_HARBOUR;
  }
  if (order.kind == Order::Kind::kName) message.kind = order_t::KIND_NAME;
  message.track_id = order.track_id;
  message.name = order.name;
  message.guard_zone_range_m = ToWire(order.guard_zone_range_m);
  message.guard_zone_from_rad = ToWire(order.guard_zone_from_deg, kRadPerDeg);
  message.guard_zone_to_rad = ToWire(order.guard_zone_to_deg, kRadPerDeg);
  message.cpa_limit_m = ToWire(order.cpa_limit_m);
  bus::Publish(bus_, bus::kOrders, message);
  ++counts_["orders_sent"];
}

HealthReport Service::Report() {
  HealthReport report;
  server_counts_ = parts_.server.Counts();
  for (const auto& [name, count] : server_counts_) report.counters.push_back({name, count});
  counts_.AppendTo(report.counters);
  report.counters.push_back({"acks_dropped", parts_.acknowledgements.num_dropped()});
  report.counters.push_back({"orders_dropped", parts_.orders.num_dropped()});
  if (const auto text = InputWatch::Complaint(watches_); !text.empty()) report.Degrade(text);
  if (parts_.add_to_report) parts_.add_to_report(report);
  return report;
}

}  // namespace lookout::page
