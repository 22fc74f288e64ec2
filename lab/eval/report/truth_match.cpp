#include "lab/eval/report/truth_match.hpp"

#include <fmt/format.h>

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/log_time.hpp"
#include "common/messages/returns.hpp"

namespace lookout::eval {
namespace {

// A scan is cut at an azimuth, a truth begins with a packet.
constexpr std::int64_t kSlackUs = 200'000;
// The greatest error of a range beside the noise of the lidar: at an edge the two are of one return, and so of one thing.
constexpr double kAgreeingM = 0.5;
// In the run of the truth all returns are in it. A few are not: where a clock is set, and of scans at both ends.
constexpr double kLeastByTime = 0.97;
// Between shots that are not the same the boat has moved and an edge may lie.
constexpr double kLeastByDirection = 0.7;
constexpr double kSameDirectionDeg = 0.25;
constexpr std::int64_t kDirectionReachUs = 60'000;  // more than half of a revolution
// Few scans are enough; the direction is looked for among thousands of returns.
constexpr std::int64_t kMaxScansByDirection = 40;
constexpr std::int64_t kDirectionStep = 37;  // of the returns of a scan
constexpr std::int64_t kLeastReturns = 200;
// A receiver that jumps or drifts is not as far away, over half of the run.
constexpr double kMaxPoseDistanceM = 100.0;

bool IsAsFar(const Truth::Return& made, const messages::Return& seen) {
  return std::abs(static_cast<double>(made.p_lidar_m.norm()) - seen.range_m) <= kAgreeingM;
}

bool IsConsistent(const lidar_scan_t& scan) {
  const auto num_columns = static_cast<std::size_t>(scan.num_columns);
  const auto num_rings = static_cast<std::size_t>(scan.num_rings);
  return scan.num_rings > 0 && scan.num_returns > 0 && scan.time_ns.size() >= num_columns && scan.azimuth_rad.size() >= num_columns &&
         scan.time_offset_ns.size() >= num_rings && scan.azimuth_offset_rad.size() >= num_rings && scan.elevation_rad.size() >= num_rings &&
         scan.origin_height_m.size() >= num_rings && scan.reflectivity.size() == scan.range.size() &&
         scan.range.size() == num_columns * num_rings * static_cast<std::size_t>(scan.num_returns);
}

std::string TextOf(const TruthSpan& span) {
  return lookout::SpanText({Utime(std::chrono::microseconds(span.begin_us)), Utime(std::chrono::microseconds(span.end_us))});
}

double LengthOf(const TruthSpan& span) { return 1e-6 * static_cast<double>(span.end_us - span.begin_us); }

void Widen(std::optional<TruthSpan>& span, std::int64_t utime_us) {
  if (!span) span = TruthSpan{utime_us, utime_us};
  span->begin_us = std::min(span->begin_us, utime_us);
  span->end_us = std::max(span->end_us, utime_us);
}

double ShareOrNone(std::int64_t part, std::int64_t all) { return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0.0; }

}  // namespace

TruthMatch::TruthMatch(const Truth& truth) : truth_(truth), span_(truth.Span()) {}

bool TruthMatch::Holds(std::int64_t scan_utime_us) const {
  return span_ && scan_utime_us >= span_->begin_us - kSlackUs && scan_utime_us <= span_->end_us + kSlackUs;
}

void TruthMatch::Count(std::int64_t scan_utime_us) {
  if (last_utime_us_ == scan_utime_us) return;  // another part
  last_utime_us_ = scan_utime_us;
  Widen(log_span_, scan_utime_us);
  const bool is_within = Holds(scan_utime_us);
  ++(is_within ? num_scans_within_ : num_scans_outside_);
  if (is_within) Widen(scored_span_, scan_utime_us);
}

void TruthMatch::Add(const messages::ScanMessages& scan) {
  ReturnMatch by_time;
  for (const auto& [part_index, part] : scan.scans) {
    if (IsConsistent(part)) MatchByTime(part, by_time);
  }
  if (by_time.num_returns == 0) return;
  if (2 * by_time.num_found >= by_time.num_returns) {
    ++by_time_.num_scans;
    by_time_.num_returns += by_time.num_returns;
    by_time_.num_found += by_time.num_found;
    by_time_.num_agreeing += by_time.num_agreeing;
    return;
  }
  if (by_direction_.num_scans >= kMaxScansByDirection) return;
  ++by_direction_.num_scans;
  for (const auto& [part_index, part] : scan.scans) {
    if (IsConsistent(part)) MatchByDirection(part, by_direction_);
  }
}

void TruthMatch::Add(const pose_t& pose) {
  if (pose.status != pose_t::STATUS_OK && pose.status != pose_t::STATUS_COASTING) return;
  const auto found = truth_.poses().find(pose.utime_us);
  if (found == truth_.poses().end()) return;
  double distance_m = 0.0;
  GeographicLib::Geodesic::WGS84().Inverse(found->second.latitude_deg, found->second.longitude_deg, pose.latitude_deg, pose.longitude_deg,
                                           distance_m);
  pose_distance_m_.Add(distance_m);
}

void TruthMatch::MatchByTime(const lidar_scan_t& scan, ReturnMatch& match) const {
  messages::ForEachReturn(scan, nullptr, [&](const messages::Return& seen) {
    ++match.num_returns;
    const auto* const made = truth_.Find(seen.utime_us, seen.ring, seen.return_index, scan.first_column + seen.column);
    if (made == nullptr) return;
    ++match.num_found;
    const bool knows_place = made->p_lidar_m.allFinite();
    if (!knows_place || IsAsFar(*made, seen)) ++match.num_agreeing;
  });
}

void TruthMatch::MatchByDirection(const lidar_scan_t& scan, ReturnMatch& match) const {
  const double least_cosine = Cos(DegToRad(kSameDirectionDeg));
  std::int64_t index = 0;
  messages::ForEachReturn(scan, nullptr, [&](const messages::Return& seen) {
    if (index++ % kDirectionStep != 0) return;
    ++match.num_returns;
    const auto* const made = truth_.FindAlong(seen.p_lidar_m.normalized(), least_cosine,
                                              {seen.utime_us - kDirectionReachUs, seen.utime_us + kDirectionReachUs}, seen.ring, seen.return_index);
    if (made == nullptr) return;
    ++match.num_found;
    if (IsAsFar(*made, seen)) ++match.num_agreeing;
  });
}

std::string TruthMatch::Fault(const std::string& log, const std::string& truth) const {
  constexpr const char* kRemedy = "give the truth that lookout-sim --truth wrote in the run of this log";
  if (!span_) return fmt::format("{}: holds no pose and no return; {}", truth, kRemedy);
  if (log_span_ && num_scans_within_ == 0) {
    return fmt::format("{} and {} are not of one run: the scans of the log go {}, the truth {}; {}", log, truth, TextOf(*log_span_), TextOf(*span_),
                       kRemedy);
  }
  if (pose_distance_m_.count() > 0 && pose_distance_m_.Median() > kMaxPoseDistanceM) {
    return fmt::format("{} and {} are not of one run: POSE of the log is {:.0f} m from the boat of the truth (median of {} poses); {}", log, truth,
                       pose_distance_m_.Median(), pose_distance_m_.count(), kRemedy);
  }
  // The majority of the scans: where a clock was set some are of the other sort.
  const bool is_by_time = by_time_.num_scans >= by_direction_.num_scans;
  const auto& match = is_by_time ? by_time_ : by_direction_;
  if (match.num_returns < kLeastReturns || (!is_by_time && !truth_.HasPlaces())) return "";
  const double agreeing = ShareOrNone(match.num_agreeing, match.num_returns);
  if (agreeing >= (is_by_time ? kLeastByTime : kLeastByDirection)) return "";
  return fmt::format("{} and {} are not of one run: of {} returns of the log {:.1f} % are in the truth, {:.1f} % at their distance; {}", log, truth,
                     match.num_returns, 100.0 * ShareOrNone(match.num_found, match.num_returns), 100.0 * agreeing, kRemedy);
}

std::string TruthMatch::Coverage() const {
  if (!span_ || !scored_span_) return "";
  // To the next scan; the truth may begin and end within one.
  const double truth_s = LengthOf(*span_);
  const double num_periods = static_cast<double>(std::max<std::int64_t>(1, num_scans_within_ - 1));
  const double covered_s = std::min(truth_s, LengthOf(*scored_span_) * (num_periods + 1.0) / num_periods);
  const bool is_whole = truth_s - covered_s <= std::max(2e-6 * static_cast<double>(kSlackUs), 0.01 * truth_s);
  if (is_whole && num_scans_outside_ == 0) return "";
  std::string text = fmt::format("the log covers {:.1f} s of the {:.1f} s of the truth ({:.0f} %)", covered_s, truth_s,
                                 truth_s > 0.0 ? 100.0 * covered_s / truth_s : 100.0);
  if (num_scans_outside_ > 0) {
    text += fmt::format("; {} of its {} scans lie outside of the truth and are left out", num_scans_outside_, num_scans_outside_ + num_scans_within_);
  }
  return text;
}

}  // namespace lookout::eval
