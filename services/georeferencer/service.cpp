#include "services/georeferencer/service.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"

namespace lookout::georeferencer {

namespace {

// The consequence of the status of POSE for obstacles; empty where it is OK.
std::string_view PoseText(std::int32_t pose_status) {
  switch (pose_status) {
    case pose_t::STATUS_NO_HEADING:
      return "no heading: obstacles in the vessel frame only";
    case pose_t::STATUS_NO_POSITION:
      return "no position: obstacles in the vessel frame only";
    case pose_t::STATUS_UNKNOWN:
      return "no position and no heading: obstacles in the vessel frame only";
    case pose_t::STATUS_COASTING:
      return "position or heading is only propagated: obstacles drift as their covariance says, see HEALTH of navigator";
    case pose_t::STATUS_RELATIVE:
    case pose_t::STATUS_RELATIVE_COASTING:
      return "no position on the earth: obstacles are in a frame of their own, which began where the boat was";
    case pose_t::STATUS_RELATIVE_TO_BOAT:
      return "no position, and the own motion is not known: obstacles are relative to the boat";
    default:
      return {};
  }
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params)
    : bus_(bus), georeferencer_(params.placement, params.pose_timeout, params.T_vessel_lidar_2), datum_(params.datum) {
  if (params.T_vessel_lidar_2) {
    second_watch_.emplace(bus::kSegments2.name);
    bus::Subscribe<segments_t>(bus_, bus::kSegments2, [this](const segments_t& message) { OnSecond(message); });
  }
  bus::Subscribe<segments_t>(bus_, bus::kSegments, [this](const segments_t& message) { OnSegments(message); });
  bus::Subscribe<pose_t>(bus_, bus::kPose, [this](const pose_t& message) { OnPose(message); });
}

void Service::OnSegments(const segments_t& message) {
  auto part = ToSegmentPart(message, bus::kMaxMessageBytes);
  if (const auto* refusal = std::get_if<Refusal>(&part)) return segments_refused_.Add(*refusal);
  segments_watch_.Note();
  Publish(georeferencer_.AddSegments(std::get<SegmentPart>(std::move(part))));
}

void Service::OnSecond(const segments_t& message) {
  const auto part = ToSegmentPart(message, bus::kMaxMessageBytes);
  if (const auto* refusal = std::get_if<Refusal>(&part)) return segments_refused_.Add(*refusal);
  second_watch_->Note();
  Publish(georeferencer_.AddSecond(std::get<SegmentPart>(part)));
}

void Service::OnPose(const pose_t& message) {
  const auto pose = messages::ToPose(message);
  if (const auto* refusal = std::get_if<Refusal>(&pose)) return poses_refused_.Add(*refusal);
  pose_watch_.Note();
  newest_pose_status_ = message.status;
  CheckDatum(std::get<Pose>(pose));
  Publish(georeferencer_.AddPose(std::get<Pose>(pose)));
}

// A voyage may end far from its datum: the first place in it counts.
void Service::CheckDatum(const Pose& pose) {
  if (!pose.is_placed || pose.datum.IsRelative() || (checked_datum_ && checked_datum_->IsSameAs(pose.datum))) return;
  checked_datum_ = pose.datum;
  datum_complaint_.clear();
  if (!datum_ || datum_->latitude_deg != pose.datum.latitude_deg || datum_->longitude_deg != pose.datum.longitude_deg) return;
  datum_complaint_ = DatumComplaint(*datum_, pose.datum.Map().Reverse(pose.position_map_m), "the first POSE");
}

void Service::AdvanceTo(Utime host_time) {
  now_ = host_time;
  segments_watch_.AdvanceTo(host_time);
  if (second_watch_) second_watch_->AdvanceTo(host_time);
  pose_watch_.AdvanceTo(host_time);
  Publish(georeferencer_.AdvanceTo(host_time));
  untimely_.Note(georeferencer_.num_untimely(), passed_.Advance(host_time));
}

void Service::Finish() { Publish(georeferencer_.Finish()); }

void Service::Publish(const std::vector<ObstaclePart>& parts) {
  for (const auto& part : parts) {
    const auto messages = ToMessages(part, bus::kMaxMessageBytes);
    if (messages.size() > 1) ++num_split_;
    for (const auto& message : messages) bus::Publish(bus_, bus::kObstacles, message);
  }
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = georeferencer_.counters();
  report.counters.push_back({"parts_split", num_split_});
  segments_refused_.AppendTo(report.counters);
  poses_refused_.AppendTo(report.counters);

  if (const auto text = segments_watch_.Complaint(); !text.empty()) report.Degrade(text);
  if (second_watch_ && !second_watch_->Complaint().empty()) report.Degrade(second_watch_->Complaint());
  if (untimely_.HasGrown(passed_.passed()) && !segments_watch_.is_silent()) {
    report.Degrade("SEGMENTS_2 do not fit the time of SEGMENTS: the clocks of the two lidars differ, or the second's segments are late");
  }
  if (pose_watch_.is_silent()) {
    report.Degrade(pose_watch_.Complaint());
  } else {
    const auto status = newest_pose_status_.value_or(pose_t::STATUS_OK);
    if (const auto text = PoseText(status); !text.empty()) report.Degrade(text);
    const bool is_placed = status != pose_t::STATUS_NO_HEADING && status != pose_t::STATUS_NO_POSITION && status != pose_t::STATUS_UNKNOWN;
    const auto timeout = georeferencer_.last_timeout();
    const bool is_late = timeout && (!now_ || *now_ - *timeout < kInputSilence);
    if (is_placed && is_late) report.Degrade("POSE does not reach the time of SEGMENTS: the clocks of lidar and navigation differ, or POSE is late");
  }
  if (!datum_complaint_.empty()) report.Degrade(datum_complaint_);
  return report;
}

}  // namespace lookout::georeferencer
