#include "services/lidar/core/vlp16/packet_sequencer.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::Payload;
using test::SpinningSensor;

const Utime kStart = Utime(std::chrono::hours(24 * 20000));

// Packets in, given packets out. The host's clock is the sensor's, unless told otherwise.
struct SequencerBench {
  struct Given {
    std::uint32_t stamp_us;
    SensorTime time;
    int num_lost;
    bool is_restart;
  };
  std::vector<Given> given;
  PacketSequencer sequencer{[this](const PlacedPacket& placed) {
    given.push_back({placed.packet.stamp_us, placed.time, placed.num_lost, placed.is_restart});
  }};

  PacketVerdict Add(const Payload& payload, std::optional<Utime> host_time = std::nullopt) {
    const auto packet = ParseDataPacket(payload).packet;
    return sequencer.Add(host_time.value_or(kStart + microseconds(packet.stamp_us)), packet, Model::kVlp16);
  }
  void Add(SpinningSensor& sensor, int num_packets) {
    for (int i = 0; i < num_packets; ++i) Add(sensor.Next());
  }
  std::vector<std::uint32_t> Stamps() const {
    std::vector<std::uint32_t> stamps;
    for (const auto& packet : given) stamps.push_back(packet.stamp_us);
    return stamps;
  }
  const SequenceCounts& counts() const { return sequencer.counts(); }
};

std::vector<Payload> Make(SpinningSensor& sensor, int num_packets) {
  std::vector<Payload> packets;
  for (int i = 0; i < num_packets; ++i) packets.push_back(sensor.Next());
  return packets;
}

std::uint32_t StampOf(const Payload& payload) { return ReadU32LittleEndian(payload, format::kStampOffset); }

TEST(PacketSequencer, GivesWhatComesInOrderAtOnce) {
  for (const auto mode : {format::kModeStrongest, format::kModeDual}) {
    for (const double rpm : {300.0, 600.0, 1200.0}) {
      SequencerBench bench;
      SpinningSensor sensor;
      sensor.mode = mode;
      sensor.rpm = rpm;
      for (int i = 1; i <= 300; ++i) {
        bench.Add(sensor, 1);
        ASSERT_EQ(bench.given.size(), static_cast<std::size_t>(i));
      }
      EXPECT_EQ(bench.counts().num_lost, 0);
      EXPECT_EQ(bench.counts().num_disagreements, 0);
      EXPECT_EQ(std::ranges::count_if(bench.given, &SequencerBench::Given::is_restart), 1);
    }
  }
}

TEST(PacketSequencer, GoesOnOverTheHour) {
  SequencerBench bench;
  SpinningSensor sensor;
  sensor.time_ns = 3'599'999'000'000;
  bench.Add(sensor, 3);
  ASSERT_EQ(bench.given.size(), 3U);
  EXPECT_EQ(bench.given[1].stamp_us, 327U);
  EXPECT_EQ(bench.given[1].time, microseconds(3'600'000'327));
  EXPECT_EQ(bench.given[2].time, microseconds(3'600'001'654));
  EXPECT_EQ(bench.counts().num_clock_steps, 0);
}

TEST(PacketSequencer, PutsRightWhatIsUpToEightPacketsLate) {
  for (std::size_t late = 1; late <= 8; ++late) {
    SequencerBench bench;
    SpinningSensor sensor;
    auto packets = Make(sensor, 14);
    std::vector<std::uint32_t> expected;
    for (const auto& packet : packets) expected.push_back(StampOf(packet));
    std::rotate(packets.begin() + 2, packets.begin() + 3, packets.begin() + 3 + static_cast<std::ptrdiff_t>(late));
    for (const auto& packet : packets) bench.Add(packet);
    EXPECT_EQ(bench.Stamps(), expected) << late;
    EXPECT_EQ(bench.counts().num_reordered, 1) << late;
    EXPECT_EQ(bench.counts().num_lost, 0) << late;
  }
}

TEST(PacketSequencer, DropsWhatIsLaterAndHasCountedItAsLost) {
  SequencerBench bench;
  SpinningSensor sensor;
  auto packets = Make(sensor, 14);
  std::rotate(packets.begin() + 2, packets.begin() + 3, packets.begin() + 3 + 9);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const bool is_late = i == 2 + 9;
    EXPECT_EQ(bench.Add(packets[i]), is_late ? PacketVerdict::kLate : PacketVerdict::kTaken) << i;
  }
  EXPECT_EQ(bench.given.size(), 13U);
  EXPECT_TRUE(std::ranges::is_sorted(bench.Stamps()));
  EXPECT_EQ(bench.counts().num_reordered, 1);
  EXPECT_EQ(bench.counts().num_late, 1);
  EXPECT_EQ(bench.counts().num_lost, 1);
}

TEST(PacketSequencer, DropsCopiesAlsoOfWhatItHolds) {
  SequencerBench bench;
  SpinningSensor sensor;
  const auto packets = Make(sensor, 5);
  EXPECT_EQ(bench.Add(packets[0]), PacketVerdict::kTaken);
  EXPECT_EQ(bench.Add(packets[0]), PacketVerdict::kDuplicate);
  EXPECT_EQ(bench.Add(packets[3]), PacketVerdict::kTaken);
  EXPECT_EQ(bench.Add(packets[3]), PacketVerdict::kDuplicate);
  EXPECT_EQ(bench.Add(packets[1]), PacketVerdict::kTaken);
  EXPECT_EQ(bench.Add(packets[2]), PacketVerdict::kTaken);
  EXPECT_EQ(bench.Add(packets[1]), PacketVerdict::kDuplicate);  // not late: it was here
  EXPECT_EQ(bench.Add(packets[4]), PacketVerdict::kTaken);
  EXPECT_EQ(bench.given.size(), 5U);
  EXPECT_EQ(bench.counts().num_duplicates, 3);
  EXPECT_EQ(bench.counts().num_reordered, 2);
  EXPECT_EQ(bench.counts().num_lost, 0);
}

TEST(PacketSequencer, CountsLossesOnceTheyAreSure) {
  SequencerBench bench;
  SpinningSensor sensor;
  bench.Add(sensor, 3);
  sensor.Skip(5);
  bench.Add(sensor, 8);
  EXPECT_EQ(bench.given.size(), 3U);  // may still come
  bench.Add(sensor, 1);
  EXPECT_EQ(bench.given.size(), 12U);
  EXPECT_EQ(bench.given[3].num_lost, 5);
  EXPECT_EQ(bench.counts().num_lost, 5);
  sensor.Skip(1);
  bench.Add(sensor, 2);
  bench.sequencer.Flush();
  EXPECT_EQ(bench.given.size(), 14U);
  EXPECT_EQ(bench.counts().num_lost, 6);
  EXPECT_EQ(bench.counts().num_disagreements, 0);
}

TEST(PacketSequencer, CountsLossesOfWholeRevolutionsToo) {
  for (const int lost : {74, 75, 76, 77, 200, 700}) {
    SequencerBench bench;
    SpinningSensor sensor;
    bench.Add(sensor, 3);
    sensor.Skip(lost);
    bench.Add(sensor, 3);
    bench.sequencer.Flush();
    EXPECT_EQ(bench.counts().num_lost, lost);
    EXPECT_EQ(bench.counts().num_clock_steps, 0) << lost;
  }
}

TEST(PacketSequencer, TellsAClockThatIsSetFromALoss) {
  // By PPS, forwards and backwards, by little and by much; the head rotates on, and the host sees no gap.
  for (const std::int64_t step_us :
       {-1'800'000'000LL, -1'000'000LL, -20'000LL, -5'000LL, -900LL, 5'000LL, 100'000LL, 999'000LL, 2'000'000LL, 700'000'000LL}) {
    SequencerBench bench;
    SpinningSensor sensor;
    sensor.time_ns = 1'900'000'000'000;
    Utime host = kStart;
    const auto send = [&](int num_packets) {
      for (int i = 0; i < num_packets; ++i) bench.Add(sensor.Next(), host += microseconds(1327));
    };
    send(5);
    sensor.time_ns += step_us * 1000;
    send(5);
    bench.sequencer.Flush();
    ASSERT_EQ(bench.given.size(), 10U) << step_us;
    EXPECT_EQ(bench.counts().num_lost, 0) << step_us;
    EXPECT_EQ(bench.counts().num_clock_steps, 1) << step_us;
    EXPECT_EQ(bench.counts().num_restarts, 0) << step_us;
    for (std::size_t i = 1; i < 10; ++i)
      EXPECT_NEAR(static_cast<double>((bench.given[i].time - bench.given[i - 1].time).count()), 1327, 1) << step_us;
  }
}

TEST(PacketSequencer, ToleratesTheSmallCorrectionsOfADisciplinedClock) {
  for (const std::int64_t step_us : {-600, -50, 50, 600}) {
    SequencerBench bench;
    SpinningSensor sensor;
    sensor.time_ns = 1'000'000'000;
    bench.Add(sensor, 3);
    sensor.time_ns += step_us * 1000;
    bench.Add(sensor, 3);
    EXPECT_EQ(bench.given.size(), 6U);
    EXPECT_EQ(bench.counts().num_lost, 0);
    EXPECT_EQ(bench.counts().num_clock_steps, 0);
  }
}

TEST(PacketSequencer, TakesAPauseOrAnotherAzimuthForARestart) {
  SequencerBench bench;
  SpinningSensor sensor;
  sensor.time_ns = 100'000'000'000;
  bench.Add(sensor, 3);
  sensor.time_ns += 1'100'000'000;  // and the head went round eleven times, which nobody saw
  bench.Add(sensor, 3);
  EXPECT_EQ(bench.counts().num_restarts, 1);
  sensor.time_ns = 0;
  sensor.azimuth_deg += 100.0;
  bench.Add(sensor, 3);
  EXPECT_EQ(bench.counts().num_restarts, 2);
  ASSERT_EQ(bench.given.size(), 9U);
  EXPECT_TRUE(bench.given[6].is_restart);
  EXPECT_EQ(bench.given[6].time, microseconds(0));
  EXPECT_EQ(bench.counts().num_lost, 0);
}

TEST(PacketSequencer, AsksTheHostBeforeItTakesALossForAClockThatWasSet) {
  SequencerBench bench;
  SpinningSensor sensor;
  bench.Add(sensor, 100);
  const double azimuth_deg = sensor.azimuth_deg;
  sensor.Skip(340);
  sensor.azimuth_deg = azimuth_deg;  // the head slowed down on the way, and is by chance where it was
  bench.Add(sensor, 100);
  EXPECT_EQ(bench.counts().num_lost, 340);
  EXPECT_EQ(bench.counts().num_clock_steps, 0);
}

TEST(PacketSequencer, CountsLossesOfAHeadThatStandsOrTrembles) {
  SequencerBench bench;
  SpinningSensor sensor;
  bench.Add(sensor, 200);
  sensor.rpm = 0.0;
  bench.Add(sensor, 400);
  int num_dropped = 0;
  for (int i = 0; i < 600; ++i) {
    auto payload = sensor.Next();
    // A tremble of 0.01 deg, forwards and back.
    WriteU16LittleEndian(payload, format::kBlockAzimuthOffset, static_cast<std::uint16_t>(sensor.azimuth_deg * 100.0) + i % 2);
    if (i % 20 == 7) {
      ++num_dropped;
    } else {
      bench.Add(payload);
    }
  }
  sensor.Skip(300);
  sensor.rpm = 600.0;
  bench.Add(sensor, 200);
  bench.sequencer.Flush();
  EXPECT_EQ(bench.counts().num_lost, num_dropped + 300);
  EXPECT_EQ(bench.counts().num_clock_steps, 0);
}

TEST(PacketSequencer, TakesWhatIsLateWithoutEndForAnotherStream) {
  SequencerBench bench;
  SpinningSensor sensor;
  sensor.rpm = 60e9 / (75.0 * 1327104.0);  // a revolution is 75 packets
  sensor.time_ns = 100'000'000'000;
  bench.Add(sensor, 100);
  sensor.time_ns -= 10 * 75 * 1'327'104LL;  // set back by ten revolutions, and a packet was lost: it looks like packets of a second ago
  sensor.Skip(1);
  bench.Add(sensor, 100);
  EXPECT_EQ(bench.counts().num_late, 8);
  EXPECT_EQ(bench.counts().num_restarts, 1);
  EXPECT_EQ(bench.given.size(), 192U);
}

TEST(PacketSequencer, DropsACopyThatIsARevolutionOld) {
  SequencerBench bench;
  SpinningSensor sensor;
  sensor.rpm = 60e9 / (75.0 * 1327104.0);
  const auto packets = Make(sensor, 200);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    bench.Add(packets[i]);
    if (i == 150) {
      EXPECT_EQ(bench.Add(packets[i - 74]), PacketVerdict::kDuplicate);
    }
  }
  EXPECT_EQ(bench.counts().num_clock_steps, 0);
  EXPECT_EQ(bench.given.size(), packets.size());
}

TEST(PacketSequencer, SaysWhenAzimuthAndTimeTellOfDifferentLosses) {
  SequencerBench bench;
  SpinningSensor sensor;
  bench.Add(sensor, 3);
  sensor.Skip(4);
  sensor.azimuth_deg += 30.0;  // six packets more
  bench.Add(sensor, 9);
  EXPECT_EQ(bench.counts().num_lost, 4);
  EXPECT_EQ(bench.counts().num_disagreements, 1);
}

TEST(PacketSequencer, RefusesASecondSensorOnTheSamePort) {
  SequencerBench bench;
  SpinningSensor one;
  SpinningSensor other;
  other.azimuth_deg = 180.0;
  other.time_ns = 400'000;
  for (int i = 0; i < 100; ++i) {
    bench.Add(one, 1);
    bench.Add(other, 1);
  }
  EXPECT_EQ(bench.given.size(), 100U);
  EXPECT_EQ(bench.counts().num_overlapping, 100);
}

TEST(PacketSequencer, KnowsTheTimeOfAnotherStampOnceAPacketCame) {
  SequencerBench bench;
  EXPECT_FALSE(bench.sequencer.TimeOfStamp(kStart, 5));
  SpinningSensor sensor;
  sensor.time_ns = 3'599'999'000'000;
  bench.Add(sensor, 2);
  const Utime host = kStart + microseconds(327);  // of the last packet
  EXPECT_EQ(bench.sequencer.TimeOfStamp(host, 3'599'999'500), microseconds(3'599'999'500));
  EXPECT_EQ(bench.sequencer.TimeOfStamp(host, 400), microseconds(3'600'000'400));
  EXPECT_FALSE(bench.sequencer.TimeOfStamp(host + std::chrono::minutes(31), 400));
}

TEST(PacketSequencer, GoesOnWithAClockThatStandsOrCountsBeyondTheHour) {
  SequencerBench standing;
  SpinningSensor sensor;
  for (int i = 0; i < 10; ++i) {
    auto payload = sensor.Next();
    WriteU32LittleEndian(payload, format::kStampOffset, 77);
    EXPECT_EQ(standing.Add(payload, kStart + i * microseconds(1327)), PacketVerdict::kTaken);
  }
  EXPECT_EQ(standing.given.size(), 10U);
  SequencerBench beyond;
  for (int i = 0; i < 10; ++i) {
    auto payload = sensor.Next();
    WriteU32LittleEndian(payload, format::kStampOffset, static_cast<std::uint32_t>(3'599'995'000 + i * 1327));
    EXPECT_EQ(beyond.Add(payload, kStart + i * microseconds(1327)), PacketVerdict::kTaken);
  }
  EXPECT_EQ(beyond.counts().num_clock_steps, 0);
  EXPECT_EQ(beyond.given.back().time, microseconds(3'599'995'000 + 9 * 1327));
}

// The stamps are those of the hour, and go on as if nothing had been.
TEST(PacketSequencer, TellsAPauseOfAnHourByTheHostsClock) {
  SequencerBench bench;
  SpinningSensor sensor;
  bench.Add(sensor, 50);
  sensor.azimuth_deg += 90.0;
  bench.Add(sensor.Next(), kStart + std::chrono::hours(1) + microseconds(sensor.time_ns / 1000));
  EXPECT_EQ(bench.counts().num_restarts, 1);
  EXPECT_TRUE(bench.given.back().is_restart);
}

// A head that fires only from `first_deg` to `last_deg`; packets hold shots of that sector alone.
class LimitedSensor {
 public:
  LimitedSensor(double first_deg, double last_deg) : first_deg_(first_deg), last_deg_(last_deg), azimuth_deg_(first_deg) {}

  double rpm = 600.0;

  void Skip(int num_steps) {
    for (int i = 0; i < num_steps; ++i) Advance();
  }
  Payload Next() {
    std::array<int, format::kNumBlocks> azimuth_cdeg{};
    const double stamp_us = time_us_;
    for (auto& azimuth : azimuth_cdeg) {
      azimuth = static_cast<int>(azimuth_deg_ * 100.0) % format::kAzimuthsPerRevolution;
      Advance();
    }
    return test::MakeDataPacket(azimuth_cdeg, static_cast<std::uint32_t>(stamp_us));
  }

 private:
  void Advance() {
    const double rate_deg_per_us = rpm * 360.0 / 60e6;
    const double period_us = 110.592;
    azimuth_deg_ += period_us * rate_deg_per_us;
    time_us_ += period_us;
    if (azimuth_deg_ > last_deg_) {
      const double dark_deg = first_deg_ + 360.0 - azimuth_deg_;
      time_us_ += dark_deg / rate_deg_per_us;
      azimuth_deg_ = first_deg_;
    }
  }
  double first_deg_;
  double last_deg_;
  double azimuth_deg_;
  double time_us_ = 0.0;
};

TEST(PacketSequencer, CountsNoLossForALimitedFieldOfView) {
  // The second of each makes the jump fall between packets in every scan, the hardest case: a multiple of a packet's sweep at 600 rpm.
  const double sweep_deg = 12 * 110.592e-6 * 3600.0;
  for (const auto& [first_deg, last_deg] : {std::pair(0.0, 180.0), std::pair(30.0, 30.0 + 20.0 * sweep_deg - 0.2), std::pair(300.0, 420.0),
                                            std::pair(10.0, 340.0), std::pair(90.0, 120.0)}) {
    for (const double rpm : {600.0, 300.0, 1200.0}) {
      SequencerBench bench;
      LimitedSensor sensor(first_deg, last_deg);
      sensor.rpm = rpm;
      for (int i = 0; i < 1500; ++i) bench.Add(sensor.Next());
      bench.sequencer.Flush();
      EXPECT_EQ(bench.given.size(), 1500U);
      EXPECT_EQ(bench.counts().num_lost, 0) << first_deg << " to " << last_deg << " at " << rpm;
      EXPECT_EQ(bench.counts().num_clock_steps, 0) << first_deg << " to " << last_deg << " at " << rpm;
      EXPECT_EQ(bench.counts().num_restarts, 0);
    }
  }
}

TEST(PacketSequencer, FollowsAHeadOfALimitedFieldOfViewThatSpinsUp) {
  for (const double last_deg : {290.0, 200.0}) {
    SequencerBench bench;
    LimitedSensor sensor(20.0, last_deg);
    // It turns, stands, and takes three seconds to its speed.
    for (int i = 0; i < 8000; ++i) {
      sensor.rpm = i < 1500 ? 600.0 : i < 2500 ? 0.0 : std::min(600.0, 0.25 * (i - 2500));
      bench.Add(sensor.Next());
    }
    const auto num_lost = bench.counts().num_lost;
    for (int i = 0; i < 5000; ++i) bench.Add(sensor.Next());
    EXPECT_EQ(bench.counts().num_lost, num_lost) << last_deg;
  }
}

TEST(PacketSequencer, CountsAJumpBetweenPacketsAsALossUntilItsThirdTime) {
  const double step_deg = 110.592e-6 * 3600.0;
  SequencerBench bench;
  LimitedSensor sensor(30.0, 30.0 + 239.5 * step_deg);  // 20 packets
  for (int i = 0; i < 55; ++i) bench.Add(sensor.Next());
  EXPECT_GT(bench.counts().num_lost, 100);
  for (int i = 0; i < 20; ++i) bench.Add(sensor.Next());
  EXPECT_EQ(bench.counts().num_lost, 0);
}

TEST(PacketSequencer, TakesBackALossThatAJumpInsideOfAPacketExplains) {
  // The first jump is between packets, the second, 20.5 packets later, inside of one.
  const double step_deg = 110.592e-6 * 3600.0;
  SequencerBench bench;
  LimitedSensor sensor(30.0, 30.0 + 245.5 * step_deg);
  sensor.Skip(6);
  for (int i = 0; i < 35; ++i) bench.Add(sensor.Next());
  EXPECT_GT(bench.counts().num_lost, 50);
  for (int i = 0; i < 10; ++i) bench.Add(sensor.Next());
  EXPECT_EQ(bench.counts().num_lost, 0);
}

TEST(PacketSequencer, CountsLossesBesideALimitedFieldOfView) {
  SequencerBench bench;
  LimitedSensor sensor(20.0, 200.0);
  int num_dropped = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto payload = sensor.Next();
    const bool is_dropped = i > 400 && i < 2900 && i % 23 == 0;
    num_dropped += is_dropped ? 1 : 0;
    if (!is_dropped) bench.Add(payload);
  }
  bench.sequencer.Flush();
  EXPECT_EQ(bench.counts().num_lost, num_dropped);
}

TEST(PacketSequencer, CountsLossesOfRevolutionsOfALimitedFieldOfView) {
  for (const int lost : {30, 38, 75, 100, 200}) {
    for (int phase = 0; phase < 38; phase += 3) {
      SequencerBench bench;
      LimitedSensor sensor(20.0, 200.0);
      for (int i = 0; i < 400 + phase; ++i) bench.Add(sensor.Next());
      for (int i = 0; i < lost; ++i) sensor.Next();
      for (int i = 0; i < 100; ++i) bench.Add(sensor.Next());
      EXPECT_NEAR(static_cast<double>(bench.counts().num_lost), lost, 1.0) << phase;
    }
  }
}

TEST(PacketSequencer, CountsEveryLossOfASectorThatWasSeenBefore) {
  SequencerBench bench;
  SpinningSensor sensor;
  sensor.rpm = 60e9 / (75.0 * 1327104.0);  // a revolution is 75 packets: the same place each time
  bench.Add(sensor, 150);
  for (int scan = 0; scan < 10; ++scan) {
    sensor.Skip(10);
    bench.Add(sensor, 65);
  }
  bench.sequencer.Flush();
  EXPECT_EQ(bench.counts().num_lost, 100);
}

}  // namespace
}  // namespace lookout::vlp16
