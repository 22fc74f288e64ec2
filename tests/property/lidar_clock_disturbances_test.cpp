// The sensor's clock through the whole decoder while deliveries are late and the host's clock is set. The sensor is locked and right all the time,
// and so is the receiver; where the host stands is known.
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <vector>

#include "services/lidar/core/vlp16/decoder.hpp"
#include "tests/unit/common/late_arrivals.hpp"
#include "tests/unit/lidar/packet_maker.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

constexpr int kPacketsPerRevolution = 75;
constexpr int kPositionEvery = 5;
constexpr Utime kStart = std::chrono::sys_days(std::chrono::year(2026) / 6 / 15) + 14h + 10min;

struct Seen {
  microseconds began{0};   // true time since the start of its first shot
  microseconds delivered;  // and when it was delivered
  microseconds error{0};   // of its utime
  ClockReading clock;
};

std::vector<Seen> Play(const late::Disturbance& disturbance, TimeChoice choice) {
  std::vector<Seen> scans;
  DecoderParams params;
  params.time = choice;
  microseconds delivery(0);
  Decoder decoder(
      params,
      [&](const Scan& scan) {
        const auto began = std::chrono::floor<microseconds>(scan.number * kPacketsPerRevolution * format::kPacketPeriodSingle);
        scans.push_back({began, delivery, scan.time - (kStart + began), scan.clock});
      },
      [](const SentenceOfLidar&) {});
  test::SpinningSensor sensor;
  sensor.rpm = 60e9 / (kPacketsPerRevolution * static_cast<double>(format::kPacketPeriodSingle.count()));
  std::mt19937 random(5);
  microseconds sent(0);
  for (int i = 0; sent < disturbance.end + 12s; ++i) {
    const auto begins = std::chrono::floor<microseconds>(i * format::kPacketPeriodSingle);
    sent = std::chrono::floor<microseconds>((i + 1) * format::kPacketPeriodSingle);
    auto payload = sensor.Next();
    const auto stamp_us = static_cast<std::uint32_t>((kStart + begins - std::chrono::floor<std::chrono::hours>(kStart)).count() % 3'600'000'000);
    WriteU32LittleEndian(payload, format::kStampOffset, stamp_us);
    delivery = std::max(delivery + 5us, disturbance.Delivery(sent) + microseconds(100 + random() % 100));
    const Utime host = kStart + delivery + disturbance.HostError(delivery);
    if (i % kPositionEvery == 0) {
      const auto second = std::chrono::floor<std::chrono::seconds>(kStart + begins - 200ms);
      decoder.OnPositionPayload(host, test::MakePositionPacket(stamp_us, format::kPpsLocked, navigator::RmcLine(second, 43.0, -72.0, 0.0, 0.0)));
    }
    decoder.OnDataPayload(host, payload);
  }
  return scans;
}

int NumChanges(const std::vector<Seen>& scans) {
  int num_changes = 0;
  for (std::size_t i = 1; i < scans.size(); ++i) num_changes += scans[i].clock.source != scans[i - 1].clock.source ? 1 : 0;
  return num_changes;
}

TEST(Vlp16ClockDisturbances, LateDeliveriesChangeNeitherOffsetNorTimeSource) {
  for (const auto& disturbance : late::LateDeliveries()) {
    SCOPED_TRACE(disturbance.name);
    const auto scans = Play(disturbance, TimeChoice::kAuto);
    ASSERT_GT(scans.size(), 100U);
    EXPECT_EQ(NumChanges(scans), 0);
    double worst_ms = 0.0;
    double worst_ppm = 0.0;
    int num_unlocked = 0;
    microseconds worst(0);
    for (const auto& scan : scans) {
      worst = std::max(worst, std::chrono::abs(scan.error));
      worst_ms = std::max(worst_ms, 1e3 * std::abs(ToSeconds(*scan.clock.host_minus_sensor)));
      worst_ppm = std::max(worst_ppm, std::abs(scan.clock.drift_ppm.value_or(0.0)));
      num_unlocked += scan.clock.state == ClockState::kLocked ? 0 : 1;
    }
    EXPECT_EQ(worst, 0us);
    EXPECT_LT(worst_ms, 5.0);
    EXPECT_LT(worst_ppm, 20.0);
    EXPECT_EQ(num_unlocked, 0);
  }
}

TEST(Vlp16ClockDisturbances, LateDeliveriesDoNotMoveScansThatAreStampedByTheHost) {
  for (const auto& disturbance : {late::StoppedFor12SecondsAndDrained(), late::BusyComputer(1), late::RandomStalls(2)}) {
    SCOPED_TRACE(disturbance.name);
    microseconds worst(0);
    for (const auto& scan : Play(disturbance, TimeChoice::kHost)) worst = std::max(worst, std::chrono::abs(scan.error));
    EXPECT_LT(worst, 5ms);
  }
}

TEST(Vlp16ClockDisturbances, AStepOfTheHostIsKnownWithinFiveSecondsAndChangesTheTimeSourceOnce) {
  auto disturbances = late::ClockSteps();
  for (auto& there_and_back : late::ClockSteps()) {
    there_and_back.name += ", and back";
    there_and_back.steps.push_back({there_and_back.end + 10s, -there_and_back.steps[0].step});
    there_and_back.end += 10s;
    disturbances.push_back(there_and_back);
  }
  for (const auto& disturbance : disturbances) {
    SCOPED_TRACE(disturbance.name);
    const auto scans = Play(disturbance, TimeChoice::kAuto);
    EXPECT_EQ(NumChanges(scans), static_cast<int>(disturbance.steps.size()));
    for (const auto& scan : scans) {
      EXPECT_EQ(scan.clock.state, ClockState::kLocked);
      if (scan.began < disturbance.end + 5s) continue;
      const auto truth = disturbance.HostError(scan.began);
      EXPECT_EQ(scan.clock.source, truth == 0us ? TimeSource::kSensor : TimeSource::kHost);
      // LIDAR_CLOCK says it within the hour that the stamp is in.
      ASSERT_LT(std::chrono::abs(*scan.clock.host_minus_sensor - truth), 2ms) << scan.began.count();
      ASSERT_LT(std::chrono::abs(scan.error - truth), 2ms) << scan.began.count();
    }
  }
}

}  // namespace
}  // namespace lookout::vlp16
