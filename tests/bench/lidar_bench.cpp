// From packets to an organised scan: 28 800 shots with every return, and with 5 000 returns. Limit: 0.15 ms and 0.06 ms on one core.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <vector>

#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/wire.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace {

using namespace lookout;
using namespace lookout::vlp16;
using namespace lookout::lidar;

// 75 packets of 384 returns are 28 800: a scan at 602.8 rpm, so that one scan comes per 75 packets.
constexpr int kPacketsPerRevolution = 75;
constexpr int kNumScans = 10;

std::vector<test::Payload> MakePackets(int num_returns_of_turn, bool is_dual) {
  test::SpinningSensor sensor;
  sensor.rpm = 60e9 / (kPacketsPerRevolution * static_cast<double>(format::kPacketPeriodSingle.count()));
  if (is_dual) sensor.mode = format::kModeDual;
  // Objects stand in one part of the circle, as on open water.
  const double seen_deg = 360.0 * num_returns_of_turn / 28800.0;
  sensor.scene = [seen_deg](double azimuth_deg, int, int) { return azimuth_deg < seen_deg ? test::ReturnValue{5000, 40} : test::ReturnValue{}; };
  std::vector<test::Payload> packets;
  for (int i = 0; i < kNumScans * kPacketsPerRevolution * (is_dual ? 2 : 1); ++i) packets.push_back(sensor.Next());
  return packets;
}

void RunDecode(benchmark::State& state, bool is_dual, bool with_wire) {
  const auto packets = MakePackets(static_cast<int>(state.range(0)), is_dual);
  std::int64_t num_scans = 0;
  std::int64_t num_cells = 0;
  lookout::vlp16::Decoder decoder(
      DecoderParams{},
      [&](const Scan& scan) {
        ++num_scans;
        num_cells += static_cast<std::int64_t>(scan.range.size());
        if (with_wire) benchmark::DoNotOptimize(ToScanMessages(scan, 0, 120'000));
      },
      [](const SentenceOfLidar&) {});
  for (auto _ : state) {
    decoder.Reset();
    Utime host_time{};
    for (const auto& packet : packets) {
      host_time += std::chrono::microseconds(1327);
      decoder.OnDataPayload(host_time, packet);
    }
    decoder.Flush();
  }
  // Time of one scan.
  state.SetItemsProcessed(num_scans);
  state.counters["turn_s"] = benchmark::Counter(static_cast<double>(num_scans), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["cells"] = static_cast<double>(num_cells) / static_cast<double>(std::max<std::int64_t>(1, num_scans));
}

void PacketsToScan(benchmark::State& state) { RunDecode(state, false, false); }
BENCHMARK(PacketsToScan)->Arg(28800)->Arg(5000)->Unit(benchmark::kMillisecond);

void PacketsToScanDual(benchmark::State& state) { RunDecode(state, true, false); }
BENCHMARK(PacketsToScanDual)->Arg(28800)->Unit(benchmark::kMillisecond);

void PacketsToMessage(benchmark::State& state) { RunDecode(state, false, true); }
BENCHMARK(PacketsToMessage)->Arg(28800)->Arg(5000)->Unit(benchmark::kMillisecond);

}  // namespace
