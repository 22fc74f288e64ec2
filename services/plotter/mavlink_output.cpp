#include "services/plotter/mavlink_output.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lookout::plotter {

namespace {

constexpr double kCmPerM = 100.0;
// Receivers ignore 0, and what is nearer than min_distance.
constexpr double kMinDistanceM = 0.01;
constexpr std::chrono::seconds kPatience(3);
// A scan's points that a serial port cannot carry before the next scan are old when they leave it.
constexpr std::chrono::milliseconds kMostDelay(100);

bool IsAnywhereLooked(const Look& look) { return std::ranges::find(look.is_looked, true) != look.is_looked.end(); }

std::vector<std::size_t> NearestFirst(const Look& look, double max_distance_m) {
  std::vector<std::size_t> sectors;
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    if (look.sectors.distance_m(i) <= max_distance_m) sectors.push_back(i);
  }
  std::ranges::stable_sort(sectors, {}, [&look](std::size_t i) { return look.sectors.distance_m(i); });
  return sectors;
}

}  // namespace

MavSectors ToMavSectors(const Look& look, Utime time, double max_distance_m) {
  MavSectors message;
  message.time_us = static_cast<std::uint64_t>(ToUtimeUs(time));
  message.max_distance_cm = static_cast<std::uint16_t>(std::lround(max_distance_m * kCmPerM));
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    const double distance_cm = std::floor(look.sectors.distance_m(i) * kCmPerM);
    if (distance_cm <= message.max_distance_cm) {
      message.distance_cm[i] = std::max(static_cast<std::uint16_t>(distance_cm), message.min_distance_cm);
    } else {
      message.distance_cm[i] = look.is_looked[i] ? static_cast<std::uint16_t>(message.max_distance_cm + 1) : MavSectors::kUnknown;
    }
  }
  return message;
}

std::vector<MavPoint> ToMavPoints(const Look& look, Utime time, double max_distance_m) {
  const MavPoint head{
      .time_ms = static_cast<std::uint32_t>(ToUtimeUs(time) / 1000), .min_distance_m = kMinDistanceM, .max_distance_m = max_distance_m};
  const auto sectors = NearestFirst(look, max_distance_m);
  std::vector<MavPoint> points;
  if (sectors.empty()) {
    points.push_back(head);
    points.back().x_m = max_distance_m + 1.0;
  }
  points.reserve(std::max<std::size_t>(sectors.size(), 1));
  for (const auto sector : sectors) {
    auto place_m = look.sectors.nearest_m(sector);
    if (look.sectors.distance_m(sector) <= 2.0 * kMinDistanceM) place_m = {2.0 * kMinDistanceM, 0.0};
    auto& point = points.emplace_back(head);
    point.x_m = place_m.x();
    point.y_m = -place_m.y();
  }
  return points;
}

void MavlinkOutput::SendLook(const Told& told) {
  if (told.look == nullptr) return;
  const auto& look = *told.look;
  // An autopilot may take an unknown sector for a clear one, and a point says nothing of the sectors beside it: without a direction into which
  // somebody looked the outlines alone would hide all else. Silence it takes for "no data".
  if (!IsAnywhereLooked(look)) return;
  TellWhetherSomebodyLooks(told);
  const double max_distance_m = params().mavlink.max_distance_m;
  if (params().mavlink.form == MavlinkForm::kPoints) {
    for (const auto& point : ToMavPoints(look, told.look_time, max_distance_m)) {
      if (delay() > kMostDelay || room_bytes() < MavlinkWriter::kPointFrameBytes) return;
      Send(writer_.ObstacleDistance3d(point));
    }
    return;
  }
  Send(writer_.ObstacleDistance(ToMavSectors(look, told.look_time, max_distance_m)));
}

void MavlinkOutput::SendText(MavSeverity severity, std::string_view text) {
  for (auto& frame : writer_.StatusText(severity, text)) SendSurely(std::move(frame));
}

void MavlinkOutput::TellWhetherSomebodyLooks(const Told& told) {
  if (told_looks_ == told.somebody_looks) return;
  // That somebody looks is told by a look, not by nothing that speaks against it.
  if (told.somebody_looks && told.look == nullptr) return;
  // The chain may begin with this process.
  if (!told.somebody_looks && !told_looks_ && told.passed < kPatience) return;
  if (told.somebody_looks) {
    SendText(MavSeverity::kNotice, told_looks_ ? "Lookout: the look-out is back" : "Lookout: the look-out begins");
  } else {
    SendText(MavSeverity::kCritical, "Lookout: no look-out, no distances are sent");
  }
  told_looks_ = told.somebody_looks;
}

void MavlinkOutput::SendNotices(const Told& told) {
  if (!heartbeat_sent_ || told.passed - *heartbeat_sent_ >= kHeartbeatPeriod) {
    // In step, so that a late call delays no later one.
    const bool is_late = !heartbeat_sent_ || told.passed - *heartbeat_sent_ >= 2 * kHeartbeatPeriod;
    heartbeat_sent_ = is_late ? told.passed : *heartbeat_sent_ + kHeartbeatPeriod;
    SendSurely(writer_.Heartbeat(told.somebody_looks && told_looks_ == true ? MavState::kActive : MavState::kCritical), "heartbeat");
  }
  TellWhetherSomebodyLooks(told);
  if (!params().mavlink.sends_alerts) return;
  std::vector<Notice> notices;
  for (const auto& notice : told.notices) {
    // Whether anybody looks was said, and distances need no position.
    if (notice.id <= 0) continue;
    notices.push_back(notice);
    notices.back().sound = Sound::kQuiet;
  }
  for (const auto& [notice, revision, is_repeat] : notices_.Take(notices, told.passed)) {
    if (is_repeat || notice.state != NoticeState::kActive) continue;
    SendText(notice.level == Level::kWarning ? MavSeverity::kWarning : MavSeverity::kNotice, "Lookout: " + notice.text);
  }
}

Commands MavlinkOutput::Read(const std::string& message, const Told& /*told*/) {
  num_heartbeats_ += reader_.CountHeartbeats(message);
  return {};
}

std::vector<Counter> MavlinkOutput::counters() const {
  auto counters = link().counters();
  counters.push_back({heartbeats_name_, num_heartbeats_});
  return counters;
}

void MavlinkOutput::SendAnew() {
  heartbeat_sent_.reset();
  told_looks_.reset();
  notices_.SendAnew();
}

}  // namespace lookout::plotter
