// Any bytes as data and position packets, at any host times, through the whole decoder: what comes out is sound.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/core/vlp16/foreign_sensor.hpp"
#include "services/lidar/survey.hpp"
#include "services/lidar/wire.hpp"
#include "tests/fuzz/packet_script.hpp"

namespace {

using namespace lookout;
using namespace lookout::vlp16;
using namespace lookout::lidar;

constexpr int kMaxMessageBytes = 120'000;

// The optimiser makes one abort() of all, so that a stack trace does not tell which.
void Expect(bool is_true, int line = __builtin_LINE()) {
  if (is_true) return;
  std::fprintf(stderr, "line %d does not hold\n", line);
  std::abort();
}

bool IsPrintable(std::string_view text) {
  return std::ranges::all_of(text, [](char character) { return character >= 0x20 && character <= 0x7E; });
}

void CheckTurn(const Scan& turn, std::int64_t& last_number) {
  // A turn ends after two seconds at the latest; then its last column and packet may still be on their way.
  constexpr auto kMaxDuration = std::chrono::milliseconds(2147);
  constexpr auto kCircle = static_cast<float>(kTwoPi);
  const std::size_t num_columns = turn.azimuth_rad.size();
  Expect(num_columns > 0 && turn.time_ns.size() == num_columns);
  Expect(turn.range.size() == num_columns * format::kNumLasers * static_cast<std::size_t>(turn.num_returns()));
  Expect(turn.reflectivity.size() == turn.range.size());
  Expect(turn.number > last_number);
  last_number = turn.number;
  Expect(turn.time <= turn.end_time && turn.end_time - turn.time <= kMaxDuration);
  Expect(turn.time_ns.front() >= 0 && turn.time_ns.front() < 1000 && std::ranges::is_sorted(turn.time_ns));
  Expect(std::ranges::all_of(turn.azimuth_rad, [](float angle_rad) { return angle_rad >= 0.0F && angle_rad <= kCircle; }));
  for (std::size_t cell = 0; cell < turn.range.size(); ++cell) Expect(turn.range[cell] != 0 || turn.reflectivity[cell] == 0);
  Expect(std::isfinite(turn.rate_radps));
  for (const auto& part : ToScanMessages(turn, 0, kMaxMessageBytes)) Expect(part.getEncodedSize() <= kMaxMessageBytes);
}

DecoderParams ParamsOf(Bytes head) {
  DecoderParams params;
  params.model = static_cast<ModelChoice>(head[0] % script::kNumModels);
  params.time = static_cast<TimeChoice>(head[1] % script::kNumTimes);
  params.cut_azimuth_rad = head[2] % script::kNumCuts * kTwoPi / script::kNumCuts;
  return params;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < script::kHeadSizeBytes) return 0;
  std::int64_t last_number = -1;
  Survey survey;
  lookout::vlp16::Decoder decoder(
      ParamsOf({data, size}), [&](const Scan& turn) { CheckTurn(turn, last_number); },
      [](const SentenceOfLidar& sentence) { Expect(IsPrintable(sentence.text)); });
  Bytes rest = Bytes(data, size).subspan(script::kHeadSizeBytes);
  // Shortly before the hour, so that stamps go over it.
  Utime host_time = std::chrono::sys_days(std::chrono::year(2026) / 6 / 1) + std::chrono::minutes(12 * 60) - std::chrono::milliseconds(5);
  while (!rest.empty()) {
    const std::uint8_t control = rest[0];
    rest = rest.subspan(1);
    host_time += script::HostStepOf(control);
    const auto kind = script::KindOf(control);
    const auto payload = rest.first(std::min(rest.size(), script::PayloadSizeBytes(kind)));
    rest = rest.subspan(payload.size());
    survey.Add(host_time, "192.168.1.201", "", 2368 + control % 4, payload);
    switch (kind) {
      case script::Kind::kData:
        decoder.OnDataPayload(host_time, payload);
        Expect(IsPrintable(NameOfForeignPayload(payload)));
        break;
      case script::Kind::kPosition:
        decoder.OnPositionPayload(host_time, payload);
        break;
      case script::Kind::kFlush:
        decoder.Flush();
        break;
      case script::Kind::kReset:
        decoder.Reset();
        last_number = -1;
        break;
    }
  }
  decoder.Flush();
  for (const auto& speaker : survey.Speakers()) {
    Expect(!speaker.name.empty() && IsPrintable(speaker.name) && speaker.num_packets > 0);
    if (speaker.stamp) ClockDifferenceText(*speaker.host_minus_stamp, *speaker.stamp, "");
    ConfigLines(speaker);
  }
  for (const auto& counter : decoder.counters()) Expect(counter.count >= 0);
  return 0;
}
