// Any bytes as datagrams, and as sentences with a right checksum, all the way to poses: no crash, no hang, nothing that is not a number but unknown.
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "services/navigator/core/item_sequencer.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "tests/unit/navigator/filter_params.hpp"

namespace {

using namespace std::chrono_literals;
using namespace lookout::navigator;

std::string WithChecksum(const std::string& line) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  unsigned checksum = 0;
  for (const char character : line.substr(1)) checksum ^= static_cast<unsigned char>(character);
  return line + '*' + kDigits[checksum >> 4] + kDigits[checksum & 15U];
}

NavigatorParams FuzzParams() {
  NavigatorParams params;
  params.max_sentence_latency = 24h;  // so that times in sentences matter
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  params.filter.p_vessel_antenna_m = {-0.8, 0.4, 0.9};
  return params;
}

void Check(const NavigatorOutput& output) {
  for (const auto& pose : output.poses) {
    const bool has_position = pose.status != PoseStatus::kNoPosition && pose.status != PoseStatus::kUnknown;
    if (std::isfinite(pose.latitude_deg) != has_position || std::isinf(pose.p_map_m.sum())) std::abort();
    if (std::isfinite(pose.heading_rad) != (pose.heading_source != HeadingSource::kNone)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto lines = SplitDatagram({data, size});
  ItemSequencer sequencer;
  Navigator navigator(FuzzParams());
  lookout::Utime time = std::chrono::sys_days(std::chrono::year(2026) / 6 / 1) + 12h;
  const auto consume = [&](const std::vector<Item>& items) {
    for (const auto& item : items) Check(navigator.Consume(item));
  };
  for (const auto& line : lines.lines) {
    if (!IsLine(line)) std::abort();
    // The first character behind the start moves time.
    time += std::chrono::milliseconds(line.size() > 1 ? line[1] : 0);
    consume(sequencer.OnLines(time, {line, WithChecksum(line)}));
    consume(sequencer.OnLidarSentence(time, line));
  }
  consume(sequencer.Finish(time));
  return 0;
}
