// Any bytes as those of an autopilot, cut anywhere, and any payloads of the messages that are read with a right checksum, all the way to poses: no
// crash, no hang, no more held than one frame for each sender, each line one that NAV_RAW takes and that holds its frame again.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "services/navigator/core/item_sequencer.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "tests/fuzz/pose_check.hpp"
#include "tests/unit/navigator/filter_params.hpp"

namespace {

using namespace std::chrono_literals;
using namespace lookout::navigator;

NavigatorParams FuzzParams() {
  NavigatorParams params;
  params.max_sentence_latency = 500ms;
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  SourceParams pilot;
  pilot.name = "pilot";
  pilot.protocol = Protocol::kMavlink;
  params.sources.push_back(pilot);
  return params;
}

void Check(const NavigatorOutput& output) {
  if (output.fix && output.fix->quality != FixQuality::kNone && !(output.fix->horizontal_sd_m > 0.0)) std::abort();
  CheckPoses(output.poses);
}

// The bytes in pieces of the size that the first of them says, as messages of a right checksum.
std::string AsFrames(lookout::Bytes bytes) {
  std::string frames;
  while (bytes.size() > 2) {
    const auto& kind = kMavlinkKinds.at(bytes[0] % kMavlinkKinds.size());
    const bool is_second = bytes[0] < 200;
    std::string payload(is_second ? std::clamp<std::size_t>(bytes[1] % 64, 1, 63) : kind.num_bytes, '\0');
    const auto size = std::min(payload.size(), bytes.size() - 2);
    std::copy_n(bytes.begin() + 2, size, payload.begin());
    bytes = bytes.subspan(2 + size);
    std::string frame(1, static_cast<char>(payload.size()));
    if (is_second) frame += std::string(2, '\0');
    frame += std::string("\0\x01\x01", 3) + static_cast<char>(kind.id) + (is_second ? std::string(2, '\0') : std::string()) + payload;
    const auto crc = lookout::MavlinkCrc(frame, kind.crc_extra);
    frames += (is_second ? '\xFD' : '\xFE') + frame + static_cast<char>(crc & 0xFF) + static_cast<char>(crc >> 8);
  }
  return frames;
}

// The first byte says how the rest is cut.
void Run(lookout::Bytes bytes) {
  if (bytes.empty()) return;
  const std::size_t piece = 1 + bytes[0];
  MavlinkCutter cutter(1);
  ItemSequencer sequencer;
  Navigator navigator(FuzzParams());
  lookout::Utime time = std::chrono::sys_days(std::chrono::year(2026) / 6 / 1) + 12h;
  const auto consume = [&](const std::vector<Item>& items) {
    for (const auto& item : items) Check(navigator.Consume(item));
  };
  for (std::size_t begin = 1; begin < bytes.size(); begin += piece) {
    const auto part = bytes.subspan(begin, std::min(piece, bytes.size() - begin));
    time += part[0] == 0xFF ? 400ms : std::chrono::milliseconds(part[0] % 32);  // a begin of a frame becomes too old, or not
    const auto found = cutter.Add(time, part, part[0] % 16 == 0 ? "a" : "b");
    if (found.num_skipped_bytes < 0 || found.num_skipped_bytes > static_cast<std::int64_t>(part.size() + 300)) std::abort();
    for (const auto& line : found.lines) {
      const auto frame = MavlinkBytesOf(line);
      if (!IsLine(line) || !frame || ToMavlinkLine(*frame) != line) std::abort();
    }
    consume(sequencer.OnLines(time, found.lines, "pilot"));
  }
  consume(sequencer.Finish(time));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Run({data, size});
  const auto frames = "\x7F" + AsFrames({data, size});
  Run({reinterpret_cast<const std::uint8_t*>(frames.data()), frames.size()});
  return 0;
}
