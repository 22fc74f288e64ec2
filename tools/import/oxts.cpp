#include "tools/import/oxts.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/ros_sentences.hpp"

namespace lookout::importer {

namespace {

constexpr std::size_t kNumOxtsValues = 30;
constexpr std::size_t kLeastOxtsValues = 25;  // to the accuracies
constexpr double kMaxOxtsImuValue = 1000.0;   // rad/s and m/s2: what NAV_RAW takes

enum OxtsPlace : std::size_t {
  kLatitude = 0,
  kLongitude = 1,
  kAltitude = 2,
  kRoll = 3,
  kPitch = 4,
  kYaw = 5,
  kNorth = 6,
  kEast = 7,
  kAcceleration = 11,
  kRate = 17,
  kPositionAccuracy = 23
};

using OxtsValues = std::array<double, kNumOxtsValues>;

std::optional<OxtsValues> ValuesOf(std::string_view text) {
  OxtsValues values{};
  std::size_t count = 0;
  constexpr std::string_view kBlanks = " \t\r\n";
  for (auto begin = text.find_first_not_of(kBlanks); begin != std::string_view::npos && count < values.size(); ++count) {
    const auto end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const auto [stop, fault] = std::from_chars(text.data() + begin, text.data() + end, values.at(count));
    if (fault != std::errc() || stop != text.data() + end) return std::nullopt;
    begin = text.find_first_not_of(kBlanks, end);
  }
  return count < kLeastOxtsValues ? std::nullopt : std::optional(values);
}

// Empty where an angle is none.
std::string PashrOf(const OxtsValues& values, Utime time) {
  const bool are_angles = std::abs(values[kRoll]) <= kPi && std::abs(values[kPitch]) <= kPi / 2.0 && std::abs(values[kYaw]) <= kTwoPi;
  return are_angles ? PashrSentence(WrapTo2Pi(kPi / 2.0 - values[kYaw]), values[kRoll], -values[kPitch], time) : std::string();
}

std::optional<navigator::StrapdownSample> SampleOf(const OxtsValues& values) {
  for (const auto first : {kAcceleration, kRate}) {
    for (std::size_t i = first; i < first + 3; ++i) {
      if (!(std::abs(values.at(i)) <= kMaxOxtsImuValue)) return std::nullopt;
    }
  }
  // From forward, left, up to the axes of the boat: to starboard and down.
  navigator::StrapdownSample sample{};
  sample.angular_velocity_radps = {values[kRate], -values[kRate + 1], -values[kRate + 2]};
  sample.specific_force_mps2 = {values[kAcceleration], -values[kAcceleration + 1], -values[kAcceleration + 2]};
  return sample;
}

}  // namespace

std::optional<OxtsItems> ParseOxts(std::string_view text, Utime time) {
  const auto values = ValuesOf(text);
  if (!values) return std::nullopt;
  RosNavSatFix fix;
  fix.status = RosNavSatFix::kFix;
  fix.latitude_deg = (*values)[kLatitude];
  fix.longitude_deg = (*values)[kLongitude];
  fix.ellipsoid_height_m = (*values)[kAltitude];
  const double variance_m2 = (*values)[kPositionAccuracy] * (*values)[kPositionAccuracy];
  fix.variance_m2 = {variance_m2, variance_m2, variance_m2};
  fix.has_variance = true;
  OxtsItems items;
  const auto add = [&items](std::string sentence) {
    if (!sentence.empty()) items.sentences.push_back(std::move(sentence));
  };
  // The accuracy (GST) comes first, as it holds for the fixes behind it.
  add(GstOf(fix, time));
  add(GgaOf(fix, time));
  RosTwist twist;
  twist.linear_mps = {(*values)[kEast], (*values)[kNorth], 0.0};
  add(VtgOf(twist));
  add(PashrOf(*values, time));
  items.imu = SampleOf(*values);
  return items;
}

}  // namespace lookout::importer
