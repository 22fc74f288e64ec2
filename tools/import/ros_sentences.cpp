#include "tools/import/ros_sentences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/sentence.hpp"

namespace lookout::importer {

namespace {

std::string SentenceTime(Utime time) {
  const auto of_day = time - std::chrono::floor<std::chrono::days>(time);
  const std::chrono::hh_mm_ss clock(of_day);
  return fmt::format("{:02}{:02}{:02}.{:06}", clock.hours().count(), clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

// dddmm.mmmmmmmm,N
std::string SentenceAngle(double angle_deg, int num_degree_digits, std::string_view sides) {
  constexpr std::int64_t kPerMinute = 100'000'000;
  const auto count = std::llround(std::abs(angle_deg) * 60.0 * static_cast<double>(kPerMinute));
  const auto degrees = count / (60 * kPerMinute);
  const auto minutes = count % (60 * kPerMinute);
  return fmt::format("{:0{}}{:02}.{:08},{}", degrees, num_degree_digits, minutes / kPerMinute, minutes % kPerMinute, sides[angle_deg < 0.0 ? 1 : 0]);
}

bool IsSentencePlace(const RosNavSatFix& fix) { return std::abs(fix.latitude_deg) <= 90.0 && std::abs(fix.longitude_deg) <= 180.0; }

}  // namespace

std::string GgaOf(const RosNavSatFix& fix, Utime time) {
  constexpr double kMaxSentenceHeightM = 20'000.0;
  constexpr double kMinSentenceHeightM = -1000.0;
  const bool has_fix = fix.status >= RosNavSatFix::kFix && IsSentencePlace(fix);
  if (!has_fix) return WithChecksum("GPGGA," + SentenceTime(time) + ",,,,,0,,,,M,,M,,");
  const int quality = fix.status == RosNavSatFix::kFix ? 1 : 2;
  const bool has_height = fix.ellipsoid_height_m >= kMinSentenceHeightM && fix.ellipsoid_height_m <= kMaxSentenceHeightM;
  const auto height = has_height ? fmt::format("{:.4f},M,0.0,M", fix.ellipsoid_height_m) : std::string(",M,,M");
  return WithChecksum(fmt::format("GPGGA,{},{},{},{},,,{},,", SentenceTime(time), SentenceAngle(fix.latitude_deg, 2, "NS"),
                                  SentenceAngle(fix.longitude_deg, 3, "EW"), quality, height));
}

std::string GstOf(const RosNavSatFix& fix, Utime time) {
  constexpr double kMaxVarianceM2 = 1e10;
  const auto is_variance = [](double variance_m2) { return variance_m2 > 0.0 && variance_m2 < kMaxVarianceM2; };
  const auto& [east_m2, north_m2, up_m2] = fix.variance_m2;
  if (!fix.has_variance || !is_variance(east_m2) || !is_variance(north_m2)) return "";
  const auto up = is_variance(up_m2) ? fmt::format("{:.4f}", std::sqrt(up_m2)) : std::string();
  return WithChecksum(fmt::format("GPGST,{},,,,,{:.4f},{:.4f},{}", SentenceTime(time), std::sqrt(north_m2), std::sqrt(east_m2), up));
}

std::string VtgOf(const RosTwist& twist) {
  constexpr double kMaxSentenceSpeedMps = 100.0;
  const double east_mps = twist.linear_mps[0];
  const double north_mps = twist.linear_mps[1];
  const double speed_mps = Hypot(east_mps, north_mps);
  if (!(speed_mps <= kMaxSentenceSpeedMps)) return "";
  // At rest there is no course.
  const auto course = speed_mps > 0.0 ? fmt::format("{:.4f}", std::min(RadToDeg(WrapTo2Pi(Atan2(east_mps, north_mps))), 359.9999)) : std::string();
  return WithChecksum(fmt::format("GPVTG,{},T,,M,{:.5f},N,{:.5f},K,A", course, speed_mps * 3600.0 / 1852.0, speed_mps * 3.6));
}

std::string PashrSentence(double heading_rad, double roll_rad, double pitch_rad, Utime time) {
  return WithChecksum(fmt::format("PASHR,{},{:.4f},T,{:+.4f},{:+.4f},,,,,", SentenceTime(time), std::min(RadToDeg(heading_rad), 359.9999),
                                  RadToDeg(roll_rad), RadToDeg(pitch_rad)));
}

}  // namespace lookout::importer
