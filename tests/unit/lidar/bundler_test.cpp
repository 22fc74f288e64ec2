#include "services/lidar/core/driver/bundler.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "services/lidar/core/vlp16/form.hpp"
#include "tests/support/counters.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::milliseconds;
using test::Azimuths;
using test::MakeDataPacket;

const Utime kTime = Utime(std::chrono::seconds(1000));

TEST(Bundler, ClosesWhenItHolds24Payloads) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 23; ++i) EXPECT_FALSE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(1000, 1), 0)));
    const auto bundle = bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(1000, 1), 0));
    ASSERT_TRUE(bundle);
    EXPECT_EQ(bundle->items.size(), 24U);
    EXPECT_EQ(bundle->seq, round);
    EXPECT_EQ(bundle->is_start, round == 0);
    EXPECT_FALSE(bundle->is_end);
    EXPECT_EQ(bundle->payload.size(), 24U * 1206U);
  }
}

TEST(Bundler, ClosesWithThePacketInWhichAScanEnds) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  EXPECT_FALSE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(35000, 40), 0)));
  EXPECT_FALSE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(35480, 40), 0)));
  EXPECT_TRUE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(35960, 40), 0)));
  EXPECT_FALSE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(440, 40), 0)));
}

TEST(Bundler, ClosesWhenAScanEndsBetweenTwoPackets) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  EXPECT_FALSE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(35540, 40), 0)));  // to 35980
  EXPECT_TRUE(bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(20, 40), 0)));
}

TEST(Bundler, KeepsWhatCameInOrderWithItsTimesAndPorts) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  const auto data = MakeDataPacket(Azimuths(1000, 40), 5);
  const auto position = test::MakePositionPacket(6, 2, test::kValidRmc);
  bundler.Add(kTime, 8308, position);
  bundler.Add(kTime + milliseconds(1), 2368, data);
  const auto bundle = bundler.Finish(kTime + milliseconds(2));
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->time, kTime);
  ASSERT_EQ(bundle->items.size(), 2U);
  EXPECT_TRUE(std::ranges::equal(bundle->PayloadOf(bundle->items[0]), position));
  EXPECT_TRUE(std::ranges::equal(bundle->PayloadOf(bundle->items[1]), data));
  EXPECT_EQ(bundle->items[1].udp_port, 2368);
  EXPECT_EQ(bundle->items[1].host_time, kTime + milliseconds(1));
  EXPECT_TRUE(bundle->is_start);
  EXPECT_TRUE(bundle->is_end);
}

TEST(Bundler, DoesNotLetPayloadsWait) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  EXPECT_FALSE(bundler.AdvanceTo(kTime));
  bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(1000, 40), 5));
  EXPECT_FALSE(bundler.AdvanceTo(kTime + milliseconds(99)));
  EXPECT_TRUE(bundler.AdvanceTo(kTime + milliseconds(100)));
  EXPECT_FALSE(bundler.AdvanceTo(kTime + milliseconds(300)));
}

TEST(Bundler, EndsARunWithAMarkOnlyWhenSomethingCame) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  EXPECT_FALSE(bundler.Finish(kTime));
  bundler.Add(kTime, 2368, MakeDataPacket(Azimuths(1000, 40), 5));
  bundler.AdvanceTo(kTime + milliseconds(100));
  const auto end = bundler.Finish(kTime + milliseconds(200));
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->items.empty());
  EXPECT_TRUE(end->is_end);
  EXPECT_FALSE(end->is_start);
  EXPECT_EQ(end->seq, 1);
  EXPECT_EQ(end->time, kTime + milliseconds(200));
  EXPECT_FALSE(bundler.Finish(kTime));  // the run has ended
}

TEST(Bundler, RefusesWhatIsNotOfTheLidarByReason) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  const auto data = MakeDataPacket(Azimuths(1000, 40), 5);
  bundler.Add(kTime, 10110, data);
  bundler.Add(kTime, 2368, Bytes(data).first(1205));
  bundler.Add(kTime, 2368, {});
  bundler.Add(kTime, 8308, data);
  bundler.Add(Utime(std::chrono::hours(24 * 365 * 300)), 2368, data);
  EXPECT_EQ(support::CountOf(bundler, "datagrams_other_port"), 1);
  EXPECT_EQ(support::CountOf(bundler, "data_wrong_size"), 2);
  EXPECT_EQ(support::CountOf(bundler, "position_wrong_size"), 1);
  EXPECT_EQ(support::CountOf(bundler, "datagrams_bad_host_time"), 1);
  EXPECT_FALSE(bundler.Finish(kTime));
}

TEST(Bundler, TakesPacketsWithBadContents) {
  Bundler bundler(2368, 8308, FormOf(0.0));
  const test::Payload garbage(format::kDataPacketSizeBytes, 0xFF);
  bundler.Add(kTime, 2368, garbage);
  const auto bundle = bundler.Finish(kTime);
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->payload, garbage);
}

}  // namespace
}  // namespace lookout::vlp16
