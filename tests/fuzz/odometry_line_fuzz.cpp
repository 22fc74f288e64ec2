// Any lines as motions of the lidar, with a right checksum too, beside fixes and headings, all the way to poses: no crash, no hang, no pose that is
// not a number but unknown. A line that is read is written and read again as the same.
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/core/angles.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "tests/unit/navigator/filter_measurements.hpp"

namespace {

using namespace std::chrono_literals;
using namespace lookout::navigator;

std::string WithRightChecksum(const std::string& line) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  unsigned checksum = 0;
  for (const char character : line.substr(1)) checksum ^= static_cast<unsigned char>(character);
  return line + '*' + kDigits[checksum >> 4] + kDigits[checksum & 15U];
}

void CheckPose(const Pose& pose) {
  const bool is_on_earth = pose.status == PoseStatus::kOk || pose.status == PoseStatus::kCoasting;
  if (is_on_earth && !(pose.p_map_m.allFinite() && std::isfinite(pose.heading_rad) && std::isfinite(pose.covariance(0, 0)))) std::abort();
  if (is_on_earth && (pose.covariance(0, 0) < 0.0 || pose.covariance(8, 8) < 0.0)) std::abort();
}

void CheckText(const std::string& line) {
  const auto motion = ParseOdometry(line);
  if (!motion) return;
  const auto written = ToSentence(*motion);
  const auto again = ParseOdometry(written);
  if (again && ToSentence(*again) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  NavigatorParams params;
  params.filter = TestFilterParams();
  Navigator navigator(params);
  PoseFilter filter(params.filter);
  double time_s = 0.0;
  navigator.Consume({NoonPlus(0.0), 0, ItemKind::kStart, {}, {}});
  std::int64_t seq = 1;
  for (const auto& line : SplitDatagram({data, size}).lines) {
    time_s += 0.1;
    if (seq % 3 == 0) filter.Add(MovingFix(time_s, 2.0, 30.0));
    if (seq < 40) filter.Add(HeadingSample(time_s, 30.0));
    for (const auto& text : {line, WithRightChecksum(line)}) {
      CheckText(text);
      navigator.Consume({NoonPlus(time_s), seq++, ItemKind::kSentence, kOdometerSource, text});
      auto motion = ParseOdometry(text);
      if (!motion) continue;
      filter.Add(*motion, motion->end);
      // As one that follows the one before it.
      motion->begin = NoonPlus(time_s - 0.1);
      motion->end = NoonPlus(time_s);
      filter.Add(*motion, motion->end);
    }
    CheckPose(filter.At(NoonPlus(time_s)));
  }
  return 0;
}
