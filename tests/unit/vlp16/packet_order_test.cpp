#include "services/vlp16/core/packet_order.hpp"

#include <gtest/gtest.h>

namespace lookout::vlp16 {
namespace {

using std::chrono::microseconds;

PacketPlace Place(PacketOrder& order, std::int64_t stamp_us, bool is_dual = false) {
  DataPacket packet;
  packet.stamp_us = static_cast<std::uint32_t>(stamp_us);
  packet.num_steps = is_dual ? 6 : 12;
  return order.Place(packet, packet.period());
}

TEST(PacketOrder, GoesOnOverTheHour) {
  PacketOrder order;
  EXPECT_EQ(Place(order, 3'599'999'000).kind, PacketKind::kFirst);
  const auto place = Place(order, 327);
  EXPECT_EQ(place.kind, PacketKind::kNext);
  EXPECT_EQ(place.time, microseconds(3'600'000'327));
  EXPECT_EQ(place.num_lost, 0);
  EXPECT_EQ(Place(order, 1654).time, microseconds(3'600'001'654));
}

TEST(PacketOrder, CountsLostPacketsInBothReturnModes) {
  PacketOrder single;
  Place(single, 0);
  EXPECT_EQ(Place(single, 1327).num_lost, 0);
  EXPECT_EQ(Place(single, 1327 + 2654).num_lost, 1);
  EXPECT_EQ(Place(single, 1327 + 2654 + 13271).num_lost, 9);
  PacketOrder dual;
  Place(dual, 0, true);
  EXPECT_EQ(Place(dual, 1327, true).num_lost, 1);
  EXPECT_EQ(Place(dual, 1991, true).num_lost, 0);
}

TEST(PacketOrder, CountsNoLossWhereTheHeadPassedASectorWithoutFiring) {
  PacketOrder order;
  DataPacket packet;
  packet.num_steps = 12;
  order.Place(packet, format::kPacketPeriodSingle + std::chrono::milliseconds(75));
  packet.stamp_us = 76'327;
  EXPECT_EQ(order.Place(packet, format::kPacketPeriodSingle).num_lost, 0);
}

TEST(PacketOrder, TellsDuplicateFromLateFromRestart) {
  PacketOrder order;
  Place(order, 1'000'000);
  EXPECT_EQ(Place(order, 1'000'000).kind, PacketKind::kDuplicate);
  EXPECT_EQ(Place(order, 1'000'000 - 1327).kind, PacketKind::kReordered);
  EXPECT_EQ(Place(order, 1'000'000 - 8 * 1327).kind, PacketKind::kReordered);
  EXPECT_EQ(Place(order, 1'000'000 + 1327).kind, PacketKind::kNext);  // those before left no trace
  EXPECT_EQ(Place(order, 1'001'327 - 9 * 1328).kind, PacketKind::kJump);
}

TEST(PacketOrder, TakesMoreThanASecondForAJump) {
  PacketOrder order;
  Place(order, 0);
  EXPECT_EQ(Place(order, 1'000'000).kind, PacketKind::kNext);
  const auto place = Place(order, 2'000'001);
  EXPECT_EQ(place.kind, PacketKind::kJump);
  EXPECT_EQ(place.time, microseconds(2'000'001));
  EXPECT_EQ(place.num_lost, 0);
}

TEST(PacketOrder, RefusesPacketsFasterThanTheSensorSendsThem) {
  PacketOrder order;
  Place(order, 0);
  EXPECT_EQ(Place(order, 553).kind, PacketKind::kOverlapping);
  EXPECT_EQ(Place(order, 1327).kind, PacketKind::kNext);
}

TEST(PacketOrder, KnowsTheTimeOfAnotherStampOnceAPacketCame) {
  PacketOrder order;
  EXPECT_FALSE(order.TimeOfStamp(5));
  Place(order, 3'599'999'000);
  Place(order, 327);
  EXPECT_EQ(order.TimeOfStamp(3'599'999'500), microseconds(3'599'999'500));
  EXPECT_EQ(order.TimeOfStamp(400), microseconds(3'600'000'400));
}

}  // namespace
}  // namespace lookout::vlp16
