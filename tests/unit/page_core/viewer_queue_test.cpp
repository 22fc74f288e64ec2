#include "services/page/core/viewer_queue.hpp"

#include <gtest/gtest.h>
#include <memory>
#include <string>

namespace lookout::page {
namespace {

ViewerMessage MessageOf(std::size_t channel, int number, std::size_t size = 10) {
  return {channel, Utime(std::chrono::microseconds(number)), std::make_shared<const std::string>(size, 'x')};
}

std::string TakenFrom(ViewerQueue& queue) {
  std::string text;
  while (const auto message = queue.Take()) text += std::to_string(message->channel) + ":" + std::to_string(ToUtimeUs(message->time)) + " ";
  return text;
}

TEST(ViewerQueue, GivesMessagesInTheirOrder) {
  ViewerQueue queue;
  EXPECT_FALSE(queue.Take());
  for (int i = 0; i < 3; ++i) queue.Put(MessageOf(static_cast<std::size_t>(i % 2), i));
  EXPECT_EQ(queue.num_bytes(), 30U);
  EXPECT_EQ(TakenFrom(queue), "0:0 1:1 0:2 ");
  EXPECT_EQ(queue.num_bytes(), 0U);
  EXPECT_EQ(queue.num_dropped(), 0);
}

TEST(ViewerQueue, DropsTheOldestOfAChannelThatHasTooMany) {
  ViewerQueue queue;
  queue.Put(MessageOf(1, 1000));
  for (int i = 0; i < 66; ++i) queue.Put(MessageOf(0, i));
  EXPECT_EQ(queue.num_dropped(), 2);
  EXPECT_TRUE(TakenFrom(queue).starts_with("1:1000 0:2 0:3 "));
}

// A cloud has half a megabyte: a viewer that is too slow sees clouds of the last half second.
TEST(ViewerQueue, DropsTheOldestOfAChannelThatIsTooLarge) {
  ViewerQueue queue;
  for (int i = 0; i < 10; ++i) queue.Put(MessageOf(0, i, 500'000));
  EXPECT_EQ(queue.num_dropped(), 6);
  EXPECT_EQ(queue.num_bytes(), 2'000'000U);
  queue.Put(MessageOf(0, 10, 5'000'000));
  EXPECT_EQ(TakenFrom(queue), "0:10 ");
}

TEST(ViewerQueue, DropsTheOldestOfAllWhereAllAreTooLarge) {
  ViewerQueue queue;
  for (int i = 0; i < 10; ++i) queue.Put(MessageOf(static_cast<std::size_t>(i), i, 2'000'000));
  EXPECT_EQ(queue.num_dropped(), 2);
  EXPECT_LE(queue.num_bytes(), ViewerQueue::kMaxBytes);
  queue.Put(MessageOf(20, 20, ViewerQueue::kMaxBytes + 1));
  EXPECT_EQ(queue.num_dropped(), 3);
  EXPECT_TRUE(TakenFrom(queue).starts_with("2:2 "));
}

TEST(ViewerQueue, ForgetsAChannel) {
  ViewerQueue queue;
  for (int i = 0; i < 4; ++i) queue.Put(MessageOf(static_cast<std::size_t>(i % 2), i));
  queue.Forget(0);
  EXPECT_EQ(queue.num_bytes(), 20U);
  EXPECT_EQ(queue.num_dropped(), 0);
  EXPECT_EQ(TakenFrom(queue), "1:1 1:3 ");
}

}  // namespace
}  // namespace lookout::page
