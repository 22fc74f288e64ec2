#include "services/navigator/service.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "common/core/angles.hpp"
#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

namespace {

// Host time comes from a clock or a capture, and may be anything.
bool IsUsable(Utime host_time) { return UtimeFromWire(ToUtimeUs(host_time)).has_value(); }

// "-3.2 s"
std::string InSeconds(std::chrono::microseconds duration) {
  const auto tenths = (std::chrono::abs(duration).count() + 50'000) / 100'000;
  return (duration < std::chrono::microseconds(0) && tenths > 0 ? "-" : "") + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), params_(params), navigator_(params.navigator) {
  for (const auto& source : params_.navigator.sources) {
    if (source.protocol == Protocol::kMavlink) autopilots_.emplace(source.name, MavlinkCutter(source.mavlink_system_id));
  }
  if (params_.reads_nav_raw) {
    bus::Subscribe<nav_raw_t>(bus_, bus::kNavRaw, [this](const nav_raw_t& message) { OnNavRaw(message); });
    return;
  }
  if (params_.use_lidar_nmea) {
    bus::Subscribe<lidar_nmea_t>(bus_, bus::kLidarNmea, [this](const lidar_nmea_t& message) { OnLidarNmea(message); });
  }
  if (params_.navigator.use_lidar_odometry) {
    bus::Subscribe<lidar_odometry_t>(bus_, bus::kLidarOdometry, [this](const lidar_odometry_t& message) { OnLidarOdometry(message); });
  }
}

void Service::OnDatagram(Utime arrival, Bytes payload, const std::string& source, const std::string& sender) {
  if (const auto autopilot = autopilots_.find(source); autopilot != autopilots_.end()) {
    return OnMavlink(arrival, autopilot->second.Add(arrival, payload, sender), source);
  }
  if (sender.empty()) return OnLines(arrival, SplitDatagram(payload), source);
  const auto settings = std::ranges::find(params_.navigator.sources, source, &SourceParams::name);
  const bool requires_checksum = settings == params_.navigator.sources.end() || settings->requires_checksum;
  OnLines(arrival, joiners_[source].Add(arrival, payload, sender, requires_checksum), source);
}

void Service::OnStream(Utime arrival, Bytes bytes, const std::string& source) {
  if (const auto autopilot = autopilots_.find(source); autopilot != autopilots_.end()) {
    return OnMavlink(arrival, autopilot->second.Add(arrival, bytes), source);
  }
  OnLines(arrival, assemblers_[source].Add(bytes), source);
}

void Service::OnStreamEnd(const std::string& source) {
  if (const auto autopilot = autopilots_.find(source); autopilot != autopilots_.end()) return autopilot->second.Clear();
  assemblers_[source].Clear();
}

void Service::OnLines(Utime arrival, const DatagramLines& lines, const std::string& source) {
  if (params_.reads_nav_raw) return;
  if (!IsUsable(arrival)) {
    ++counts_["bad_host_time"];
    return;
  }
  counts_["no_start"] += lines.num_no_start;
  counts_["too_long"] += lines.num_too_long;
  counts_["not_printable"] += lines.num_not_printable;
  counts_["cut_off"] += lines.num_cut_off;
  PublishAndConsume(sequencer_.OnLines(arrival, lines.lines, source));
}

void Service::OnMavlink(Utime arrival, const MavlinkLines& found, const std::string& source) {
  counts_["mavlink_bad_checksum"] += found.num_bad_checksum;
  counts_["mavlink_other_sender"] += found.num_other_sender;
  counts_["mavlink_skipped_bytes"] += found.num_skipped_bytes;
  OnLines(arrival, {.lines = found.lines}, source);
}

void Service::AdvanceTo(Utime host_time) {
  if (params_.reads_nav_raw) return;
  if (!IsUsable(host_time)) {
    ++counts_["bad_host_time"];
    return;
  }
  PublishAndConsume(sequencer_.AdvanceTo(host_time));
  for (auto& [source, joiner] : joiners_) {
    if (!joiner.is_empty()) OnLines(host_time, joiner.AdvanceTo(host_time), source);
  }
}

void Service::Finish(Utime host_time) {
  if (params_.reads_nav_raw) {
    PublishOutput(navigator_.Flush());
  } else if (IsUsable(host_time)) {
    for (auto& [source, joiner] : joiners_) {
      if (!joiner.is_empty()) OnLines(host_time, joiner.Finish(), source);
    }
    PublishAndConsume(sequencer_.Finish(host_time));
  } else {
    ++counts_["bad_host_time"];
  }
}

void Service::OnLidarNmea(const lidar_nmea_t& message) {
  const auto arrival = UtimeFromWire(message.host_utime_us);
  if (!arrival || !IsLine(message.sentence)) {
    ++counts_["lidar_nmea_bad"];
    return;
  }
  PublishAndConsume(sequencer_.OnLidarSentence(*arrival, message.sentence));
}

void Service::OnLidarOdometry(const lidar_odometry_t& message) {
  const auto motion = ToMotion(message);
  if (!motion) {
    ++counts_["lidar_odometry_bad"];
    return;
  }
  if (navigator_.WantsOdometry()) PublishAndConsume(sequencer_.OnOdometry(motion->end, ToSentence(*motion)));
}

void Service::OnNavRaw(const nav_raw_t& message) {
  const auto result = ToItem(message);
  if (const auto* refusal = std::get_if<Refusal>(&result)) return counts_.Add(*refusal);
  const auto& item = std::get<Item>(result);
  if (item.kind != ItemKind::kStart && navigator_.time() && item.time < *navigator_.time()) {
    ++counts_["nav_raw_backwards"];
    return;
  }
  Consume(item);
}

void Service::PublishAndConsume(const std::vector<Item>& items) {
  for (const auto& item : items) {
    bus::Publish(bus_, bus::kNavRaw, ToMessage(item));
    Consume(item);
  }
}

void Service::Consume(const Item& item) {
  if (item.kind == ItemKind::kStart) fix_seq_ = attitude_seq_ = pose_seq_ = 0;
  raw_seq_ = item.seq;
  PublishOutput(navigator_.Consume(item));
}

void Service::PublishOutput(const NavigatorOutput& output) {
  if (output.fix) bus::Publish(bus_, bus::kGnssFix, ToMessage(*output.fix, fix_seq_++, raw_seq_));
  if (output.attitude) bus::Publish(bus_, bus::kAttitude, ToMessage(*output.attitude, attitude_seq_++, raw_seq_));
  for (const auto& pose : output.poses) bus::Publish(bus_, bus::kPose, ToMessage(pose, pose_seq_++, raw_seq_));
}

HealthReport Service::Report() const {
  HealthReport report;
  counts_.AppendTo(report.counters);
  for (const auto& counter : sequencer_.counters()) report.counters.push_back(counter);
  for (const auto& counter : navigator_.counters()) report.counters.push_back(counter);

  // Inputs that never came, then inputs that have stopped.
  const auto& pose = navigator_.last_pose();
  const auto add = [&report](const std::string& reason) { report.Degrade(reason, ", "); };
  const auto& filter = navigator_.filter();
  if (!filter.stopped().empty()) add(filter.stopped());
  if (filter.is_carried_by_lidar()) add("carried on by the lidar's own motion meanwhile");
  if (filter.contradicts_lidar()) add("own motion by the lidar is not used: it contradicts the other sensors");
  if (const auto apart_rad = filter.heading_apart_rad(); apart_rad != 0.0) {
    add("compass and own motion by the lidar have turned apart by " + std::to_string(std::llround(RadToDeg(std::abs(apart_rad)))) +
        " deg within minutes: the compass is disturbed, or what the lidar sees turns");
  }
  if (navigator_.IsOdometryAhead()) add("the lidar's motions are ahead of this computer's clock, and not used");
  if (!filter.doubted().empty()) add(filter.doubted());
  if (!filter.last_fix_arrival()) add("no position fix yet");
  if (!pose || (pose->heading_source == HeadingSource::kNone && !filter.has_had_heading())) add("no heading");
  if (pose && pose->heading_source == HeadingSource::kCourse) add("heading is only the course over ground: no compass or attitude sensor");
  if (pose && pose->status == PoseStatus::kRelativeToBoat) {
    add(navigator_.HasOdometry() ? "POSE is relative to the boat: no position or no heading, and the lidar does not tell the own motion"
                                 : "POSE is relative to the boat: no position or no heading, and no LIDAR_ODOMETRY comes");
  } else if (pose && (pose->status == PoseStatus::kRelative || pose->status == PoseStatus::kRelativeCoasting)) {
    add("POSE is relative: it began where the boat was, and its way is by the lidar");
  }
  if (!filter.datum_complaint().empty()) add(filter.datum_complaint());
  if (const auto off = navigator_.host_minus_utc(); off != std::chrono::microseconds(0)) {
    add("clock of this computer is off UTC by " + InSeconds(off));
  }
  return report;
}

}  // namespace lookout::navigator
