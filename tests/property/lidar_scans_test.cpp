// Laws of the way from packets to scans, on sensors that rotate evenly at random rates, with random losses.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/wire.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

const Utime kTime = Utime(std::chrono::hours(24 * 20000));

// The rings by laser id, as an obvious table: odd lasers are the upper half.
int RingOf(int laser) { return laser % 2 == 0 ? laser / 2 : 8 + laser / 2; }

double Apart(double a_deg, double b_deg) { return std::abs(std::remainder(a_deg - b_deg, 360.0)); }

// Each return tells its own truth: the range is the azimuth of the shot in 0.01 deg plus 1, the reflectivity laser and return.
test::ReturnValue Truth(double azimuth_deg, int laser, int return_index) {
  return {static_cast<std::uint16_t>(1 + std::lround(azimuth_deg * 100.0)), static_cast<std::uint8_t>(1 + laser + 16 * return_index)};
}

struct Worst {
  double azimuth_deg = 0.0;
  double time_as_azimuth_deg = 0.0;
  int num_wrong_places = 0;
  std::int64_t num_returns = 0;
};

// Compares every return of a part with what it tells.
void Compare(const lidar_scan_t& part, double azimuth_at_time_zero_deg, double rpm, Worst& worst) {
  std::size_t cell = 0;
  for (std::size_t column = 0; column < part.azimuth_rad.size(); ++column) {
    for (std::size_t ring = 0; ring < 16; ++ring) {
      for (int return_index = 0; return_index < part.num_returns; ++return_index, ++cell) {
        const double truth_deg = (static_cast<std::uint16_t>(part.range[cell]) - 1) / 100.0;
        const int laser = (part.reflectivity[cell] - 1) % 16;
        if (RingOf(laser) != static_cast<int>(ring) || (part.reflectivity[cell] - 1) / 16 != return_index) ++worst.num_wrong_places;
        const double azimuth_deg = RadToDeg(static_cast<double>(part.azimuth_rad[column]) + static_cast<double>(part.azimuth_offset_rad[ring]));
        worst.azimuth_deg = std::max(worst.azimuth_deg, Apart(azimuth_deg, truth_deg));
        const double time_s =
            static_cast<double>(part.utime_us - ToUtimeUs(kTime)) * 1e-6 + (part.time_ns[column] + part.time_offset_ns[ring]) * 1e-9;
        const double by_time_deg = azimuth_at_time_zero_deg + time_s * rpm * 6.0;
        worst.time_as_azimuth_deg = std::max(worst.time_as_azimuth_deg, Apart(by_time_deg, truth_deg));
        ++worst.num_returns;
      }
    }
  }
}

TEST(Scans, HoldEveryReturnOnceAtItsAzimuthAndTime) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    test::SpinningSensor sensor;
    sensor.rpm = uniform(300.0, 1200.0);
    sensor.azimuth_deg = uniform(0.0, 360.0);
    sensor.time_ns = static_cast<std::int64_t>(uniform(0.0, 3600e9));
    sensor.mode = seed % 3 == 0 ? format::kModeDual : format::kModeStrongest;
    sensor.scene = Truth;
    DecoderParams params;
    params.cut_azimuth_rad = DegToRad(uniform(0.0, 360.0));
    params.time = TimeChoice::kHost;
    const double loss = seed % 2 == 0 ? 0.05 : 0.0;
    const std::int64_t begin_ns = sensor.time_ns;
    const double begin_deg = sensor.azimuth_deg;

    Worst worst;
    std::int64_t num_scans = 0;
    Utime last_end;
    int num_disorders = 0;
    Decoder decoder(
        params,
        [&](const Scan& scan) {
          if (scan.number != num_scans || scan.is_partial_start != (num_scans == 0)) ++num_disorders;
          if (num_scans > 0 && scan.time <= last_end) ++num_disorders;
          if (loss == 0.0 && scan.has_hole) ++num_disorders;
          ++num_scans;
          last_end = scan.end_time;
          int num_columns = 0;
          for (const auto& part : ToScanMessages(scan, 0, 120'000)) {
            if (part.first_column != num_columns) ++num_disorders;
            num_columns += part.num_columns;
            Compare(part, begin_deg, sensor.rpm, worst);
          }
          if (num_columns != scan.num_columns()) ++num_disorders;
        },
        [](const SentenceOfLidar&) {});
    std::int64_t num_packets = 0;
    std::int64_t num_skipped = 0;
    for (int i = 0; i < 200; ++i) {
      if (i > 0 && i < 199 && uniform(0.0, 1.0) < loss) {
        sensor.Skip(1);
        ++num_skipped;
        continue;
      }
      const auto payload = sensor.Next();
      ++num_packets;
      decoder.OnDataPayload(kTime + std::chrono::microseconds((sensor.time_ns - begin_ns) / 1000), payload);
    }
    decoder.Flush();
    EXPECT_EQ(worst.num_returns, num_packets * 12 * 32);
    EXPECT_EQ(worst.num_wrong_places, 0);
    EXPECT_EQ(num_disorders, 0);
    // 0.01 deg of the counter, 0.005 deg of its gap, 0.005 deg of the truth as it is written here.
    EXPECT_LT(worst.azimuth_deg, 0.02);
    // Two stamps in microseconds at 1200 rpm, and the truth as it is written here.
    EXPECT_LT(worst.time_as_azimuth_deg, 3e-6 * sensor.rpm * 6.0 + 0.006);
    const auto counters = decoder.counters();
    EXPECT_EQ(std::ranges::find(counters, "data_lost", &Counter::name)->count, num_skipped);
  }
}

}  // namespace
}  // namespace lookout::vlp16
