// The sensor's clock through the whole decoder while deliveries are late and the host's clock is set. The sensor is locked and right all the time,
// and so is the receiver; where the host stands is known.
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <vector>

#include "services/vlp16/core/decoder.hpp"
#include "tests/unit/common/late_arrivals.hpp"
#include "tests/unit/navigator/nmea_text.hpp"
#include "tests/unit/vlp16/packet_maker.hpp"

namespace lookout::vlp16 {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

constexpr int kPacketsPerTurn = 75;
constexpr int kPositionEvery = 5;
constexpr Utime kStart = std::chrono::sys_days(std::chrono::year(2026) / 6 / 15) + 14h + 10min;

struct Seen {
  microseconds began{0};   // true time since the start of its first shot
  microseconds delivered;  // and when it was delivered
  microseconds error{0};   // of its utime
  ClockReading clock;
};

std::vector<Seen> Play(const late::Disturbance& disturbance, TimeChoice choice) {
  std::vector<Seen> turns;
  DecoderParams params;
  params.time = choice;
  microseconds delivery(0);
  Decoder decoder(
      params,
      [&](const Turn& turn) {
        const auto began = std::chrono::floor<microseconds>(turn.number * kPacketsPerTurn * format::kPacketPeriodSingle);
        turns.push_back({began, delivery, turn.time - (kStart + began), turn.clock});
      },
      [](const SentenceOfLidar&) {});
  test::SpinningSensor sensor;
  sensor.rpm = 60e9 / (kPacketsPerTurn * static_cast<double>(format::kPacketPeriodSingle.count()));
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
  return turns;
}

int NumChanges(const std::vector<Seen>& turns) {
  int num_changes = 0;
  for (std::size_t i = 1; i < turns.size(); ++i) num_changes += turns[i].clock.source != turns[i - 1].clock.source ? 1 : 0;
  return num_changes;
}

TEST(Vlp16ClockDisturbances, LateDeliveriesChangeNeitherOffsetNorTimeSource) {
  for (const auto& disturbance : late::LateDeliveries()) {
    SCOPED_TRACE(disturbance.name);
    const auto turns = Play(disturbance, TimeChoice::kAuto);
    ASSERT_GT(turns.size(), 100U);
    EXPECT_EQ(NumChanges(turns), 0);
    double worst_ms = 0.0;
    double worst_ppm = 0.0;
    int num_unlocked = 0;
    microseconds worst(0);
    for (const auto& turn : turns) {
      worst = std::max(worst, std::chrono::abs(turn.error));
      worst_ms = std::max(worst_ms, 1e3 * std::abs(ToSeconds(*turn.clock.host_minus_sensor)));
      worst_ppm = std::max(worst_ppm, std::abs(turn.clock.drift_ppm.value_or(0.0)));
      num_unlocked += turn.clock.state == ClockState::kLocked ? 0 : 1;
    }
    EXPECT_EQ(worst, 0us);
    EXPECT_LT(worst_ms, 5.0);
    EXPECT_LT(worst_ppm, 20.0);
    EXPECT_EQ(num_unlocked, 0);
  }
}

TEST(Vlp16ClockDisturbances, LateDeliveriesDoNotMoveTurnsThatAreStampedByTheHost) {
  for (const auto& disturbance : {late::StoppedFor12SecondsAndDrained(), late::BusyComputer(1), late::RandomStalls(2)}) {
    SCOPED_TRACE(disturbance.name);
    microseconds worst(0);
    for (const auto& turn : Play(disturbance, TimeChoice::kHost)) worst = std::max(worst, std::chrono::abs(turn.error));
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
    const auto turns = Play(disturbance, TimeChoice::kAuto);
    EXPECT_EQ(NumChanges(turns), static_cast<int>(disturbance.steps.size()));
    for (const auto& turn : turns) {
      EXPECT_EQ(turn.clock.state, ClockState::kLocked);
      if (turn.began < disturbance.end + 5s) continue;
      const auto truth = disturbance.HostError(turn.began);
      EXPECT_EQ(turn.clock.source, truth == 0us ? TimeSource::kSensor : TimeSource::kHost);
      // LIDAR_CLOCK says it within the hour that the stamp is in.
      ASSERT_LT(std::chrono::abs(*turn.clock.host_minus_sensor - truth), 2ms) << turn.began.count();
      ASSERT_LT(std::chrono::abs(turn.error - truth), 2ms) << turn.began.count();
    }
  }
}

}  // namespace
}  // namespace lookout::vlp16
