// Two publishers on one channel: one of them is refused, and the other goes on.
#include "tests/unit/common/guarded_stream.hpp"

namespace lookout::bus {
namespace {

TEST_F(Stream, ASecondPublisherIsRefusedAndTheFirstGoesOn) {
  Run('a', 1000, 20);
  for (std::int64_t i = 0; i < 50; ++i) {
    Send('b', 5 + i, 30'000);
    Pass(milliseconds(50));
    Send('a', 1020 + i);
    Pass(milliseconds(50));
  }
  EXPECT_EQ(NumTaken('a'), 70);
  EXPECT_EQ(NumTaken('b'), 0);
  EXPECT_EQ(guard_.num_refused(), 50);
  EXPECT_TRUE(HasSecond());
  ASSERT_TRUE(guard_.first_interleaving());
  EXPECT_EQ(guard_.first_interleaving()->mark, 20);
  EXPECT_EQ(num_lost_, 0);
}

TEST_F(Stream, ASecondPublisherWithGreaterNumbersIsRefused) {
  Run('a', 5, 20);
  for (std::int64_t i = 0; i < 50; ++i) {
    SendAt('b', 100'000 + i, (25 + i) * kPeriodUs + 30'000);
    Pass(milliseconds(50));
    Send('a', 25 + i);
    Pass(milliseconds(50));
  }
  EXPECT_EQ(NumTaken('a'), 70);
  EXPECT_EQ(NumTaken('b'), 0);
  EXPECT_EQ(num_lost_, 0);
}

class StreamOfNearNumbers : public Stream {
 protected:
  void Begin(const StreamGuard& guard) {
    guard_ = guard;
    taken_.clear();
    held_.clear();
  }
  // By turns of two publishers, whose numbers and clocks are so far ahead.
  void ExpectFirstAlone(std::int64_t ahead, std::int64_t clock_us) {
    Begin(StreamGuard(40.0));
    Run('a', 100, 20);
    for (std::int64_t i = 0; i < 50; ++i) {
      Send('a', 120 + i);
      Pass(milliseconds(50));
      SendAt('b', 120 + i + ahead, (120 + i) * kPeriodUs + clock_us);
      Pass(milliseconds(50));
    }
    EXPECT_EQ(NumTaken('a'), 70);
    EXPECT_EQ(NumTaken('b'), 0);
    EXPECT_TRUE(HasSecond());
  }
};

// Two computers switched on at the same time: numbers a few apart.
TEST_F(StreamOfNearNumbers, ASecondPublisherWithNearNumbersIsRefused) {
  for (const std::int64_t ahead : {-3, -2, -1, 0, 2, 3, 5, 10, 30}) {
    SCOPED_TRACE(ahead);
    ExpectFirstAlone(ahead, 30'000);
  }
}

// Two computers of one switch, without a common clock. The second was taken for good, and the first refused.
TEST_F(StreamOfNearNumbers, ASecondPublisherWithNearNumbersWhoseClockIsFarAheadIsRefused) {
  for (const std::int64_t ahead : {2, 3, 6, 10, 20}) {
    for (const std::int64_t clock_us : {3'000'000, 3'900'000, 100'000'000}) {
      SCOPED_TRACE(std::to_string(ahead) + " " + std::to_string(clock_us));
      ExpectFirstAlone(ahead, clock_us);
    }
  }
}

// Two navigators switched on within a tenth of a second: POSE of both comes for the same instants, five at once.
TEST_F(StreamOfNearNumbers, ASecondPublisherOfTheSameInstantsWithNearNumbersIsRefused) {
  for (const std::int64_t ahead : {-7, -5, -4, -2, -1, 1, 2, 3, 4, 5, 6, 8}) {
    for (const bool is_first : {false, true}) {
      SCOPED_TRACE(std::to_string(ahead) + (is_first ? " second first" : ""));
      Begin(StreamGuard(50.0, true));
      for (std::int64_t seq = 100; seq < 150; ++seq) {
        SendAt('a', seq, seq * 20'000);
        if (seq % 5 == 4) Pass(milliseconds(100));
      }
      for (std::int64_t i = 150; i < 400; i += 5) {
        const auto send_five = [&](char maker, std::int64_t more) {
          for (std::int64_t seq = i; seq < i + 5; ++seq) SendAt(maker, seq + more, seq * 20'000);
        };
        if (is_first) send_five('b', ahead);
        send_five('a', 0);
        if (!is_first) send_five('b', ahead);
        Pass(milliseconds(100));
      }
      EXPECT_EQ(NumTaken('a'), 300);
      EXPECT_EQ(NumTaken('b'), 0);
      EXPECT_TRUE(HasSecond());
    }
  }
}

// ATTITUDE of two sensors: their times are shared, and go back by a little.
TEST_F(Stream, AnEvenStreamWhoseTimesStandStillIsOne) {
  for (std::int64_t seq = 100; seq < 300; ++seq) {
    SendAt('a', seq, seq / 2 * 20'000 - (seq % 14 == 1 ? 5'000 : 0));
    Pass(milliseconds(10));
  }
  EXPECT_EQ(NumTaken('a'), 200);
  EXPECT_FALSE(HasSecond());
}

// The slower one is overtaken: for a while both have the same numbers.
TEST_F(Stream, ASecondPublisherThatOvertakesIsRefusedOnItsWay) {
  Run('a', 1000, 20);
  std::int64_t seq_b = 1000;
  std::int64_t next_a_us = 1020 * kPeriodUs;
  std::int64_t next_b_us = 1020 * kPeriodUs + 37'000;
  std::int64_t seq_a = 1020;
  while (seq_a < 1600) {
    if (next_a_us <= next_b_us) {
      SendAt('a', seq_a++, next_a_us);
      next_a_us += kPeriodUs;
    } else {
      SendAt('b', seq_b++, next_b_us);
      next_b_us += kPeriodUs * 9 / 10;
    }
    now_ += milliseconds(47);
  }
  EXPECT_EQ(NumTaken('b'), 0);
  EXPECT_GE(NumTaken('a'), 598);  // where number and time are those of both, neither is taken
  EXPECT_TRUE(HasSecond());
}

TEST_F(Stream, BurstsOfTwoPublishersAreKeptApart) {
  Run('a', 1000, 20);
  for (std::int64_t i = 0; i < 200; i += 5) {
    for (std::int64_t k = 0; k < 5; ++k) Send('b', 20 + i + k);
    for (std::int64_t k = 0; k < 5; ++k) Send('a', 1020 + i + k);
    Pass(milliseconds(100));
  }
  EXPECT_EQ(NumTaken('a'), 220);
  EXPECT_EQ(NumTaken('b'), 0);
}

TEST_F(Stream, WhenTheFirstPublisherEndsTheSecondIsTaken) {
  Run('a', 1000, 20);
  for (std::int64_t i = 0; i < 20; ++i) {
    Send('b', 5 + i, 30'000);
    Pass(milliseconds(50));
    Send('a', 1020 + i);
    Pass(milliseconds(50));
  }
  const auto num_refused = guard_.num_refused();
  Run('b', 25, 30);
  EXPECT_EQ(NumTaken('b'), 30);  // from the end of the first on, none is lost
  EXPECT_EQ(guard_.num_refused(), num_refused);
  EXPECT_EQ(num_lost_, 0);
  Pass(milliseconds(60'000));
  EXPECT_FALSE(HasSecond());
}

// A second segmenter with the same config gives the same bytes.
TEST_F(Stream, TwoPublishersOfTheSameBytesAreTakenOnce) {
  for (std::int64_t seq = 0; seq < 50; ++seq) {
    Send('a', seq);
    Send('a', seq);
    Pass(milliseconds(100));
  }
  EXPECT_EQ(NumTaken('a'), 50);
  EXPECT_TRUE(HasSecond());
}

// What nothing tells apart is not mixed: neither is taken.
TEST_F(Stream, TwoPublishersOfEqualNumbersAndTimesAreNotMixed) {
  Run('a', 0, 20);
  for (std::int64_t seq = 20; seq < 60; ++seq) {
    Send('a', seq);
    Send('b', seq);
    Pass(milliseconds(100));
  }
  EXPECT_EQ(NumTaken('b'), 0);
  EXPECT_LE(NumTaken('a'), 21);
  EXPECT_TRUE(HasSecond());
  Run('a', 60, 40);  // one of them has ended
  EXPECT_GE(NumTaken('a'), 45);
  EXPECT_EQ(NumTaken('b'), 0);
}

}  // namespace
}  // namespace lookout::bus
