#include "services/navigator/core/utc_clock.hpp"

#include <gtest/gtest.h>
#include <random>

#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;
using std::chrono::days;
using std::chrono::microseconds;

constexpr auto kMaxClockLatency = 500ms;
// A computer that begins in 1971, at another time of day.
constexpr microseconds kNoBattery = -days(20000) - 5h;

microseconds OfDay(Utime time) { return time - std::chrono::floor<days>(time); }

class UtcClockTest : public ::testing::Test {
 protected:
  // A sentence measured at `utc`, on a computer whose clock is `off`, that took `delay`.
  std::optional<MeasurementTime> Sentence(Utime utc, microseconds off, microseconds delay = 50ms, std::optional<microseconds> latency = {},
                                          std::optional<days> date_error = days(0)) {
    std::optional<std::chrono::sys_days> date;
    if (date_error) date = std::chrono::floor<days>(utc) + *date_error;
    return clock_.OfSentence(source_, utc + off + delay, OfDay(utc), date, latency);
  }

  UtcClock clock_{kMaxClockLatency};
  SourceClock source_;
};

TEST_F(UtcClockTest, UsesTheComputersClockForUtcWhileADelayCanExplainTheDifference) {
  for (int i = 0; i < 20; ++i) {
    const auto when = Sentence(NoonPlus(i), -200ms);
    ASSERT_TRUE(when);
    EXPECT_EQ(when->time, NoonPlus(i));
    EXPECT_EQ(when->utc, NoonPlus(i));
    EXPECT_TRUE(when->is_from_sentence);
  }
  EXPECT_EQ(clock_.host_minus_utc(), 0us);
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(20), std::nullopt).time, NoonPlus(20));
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(20), 30ms).time, NoonPlus(19.97)) << "less the delay of its source";
}

TEST_F(UtcClockTest, KnowsASmallOffsetFromASourceWhoseDelayIsKnown) {
  for (int i = 0; i < 20; ++i) Sentence(NoonPlus(i), -200ms, 80ms, 80ms);
  // 0.2 s behind UTC; HDT takes 20 ms.
  const auto when = clock_.OfArrival(source_, NoonPlus(20) - 200ms + 20ms, 20ms);
  EXPECT_EQ(when.time, NoonPlus(20));
  EXPECT_EQ(when.utc, NoonPlus(20));
}

TEST_F(UtcClockTest, GoesOnByAClockThatIsOffAndStillSaysUtc) {
  for (int i = 0; i < 5; ++i) {
    const auto when = Sentence(NoonPlus(i), 1h);
    EXPECT_EQ(when->time, NoonPlus(i) + 1h + 50ms) << "not sure yet: the arrival";
    EXPECT_EQ(when->utc, NoonPlus(i));
    EXPECT_FALSE(when->is_from_sentence);
  }
  // Now delays that change do no harm: the least counts.
  Sentence(NoonPlus(10), 1h, 30ms);
  const auto when = Sentence(NoonPlus(11), 1h, 300ms);
  EXPECT_TRUE(when->is_from_sentence);
  EXPECT_EQ(when->utc, NoonPlus(11));
  EXPECT_EQ(when->time, NoonPlus(11) + 1h + 30ms);
  const auto untimed = clock_.OfArrival(source_, NoonPlus(12) + 1h, 20ms);
  EXPECT_EQ(untimed.time, NoonPlus(12) + 1h - 20ms);
  EXPECT_EQ(untimed.utc, NoonPlus(12) - 30ms - 20ms);
}

TEST_F(UtcClockTest, UsesWhatCameWithALateSentenceForAsLate) {
  for (int i = 0; i < 20; ++i) Sentence(NoonPlus(i), 0s, 80ms, 80ms);
  Sentence(NoonPlus(20), 0s, 12s, 80ms);
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(32) + 10ms, 80ms).time, NoonPlus(20) + 10ms);
  EXPECT_EQ(clock_.OfArrival({}, NoonPlus(32), 80ms).time, NoonPlus(32) - 80ms) << "of another source";
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(33), 80ms).time, NoonPlus(33) - 80ms) << "long after it";
  // Of two receivers on one line one is late all the time.
  Sentence(NoonPlus(34), 0s, 80ms, 80ms);
  Sentence(NoonPlus(33), 0s, 1200ms, 80ms);
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(34) + 200ms, 80ms).time, NoonPlus(34) + 120ms);
  Sentence(NoonPlus(35), 0s, 200ms, 80ms);
  EXPECT_EQ(clock_.OfArrival(source_, NoonPlus(35) + 200ms, 80ms).time, NoonPlus(35) + 120ms) << "sentences differ by as much";
}

TEST_F(UtcClockTest, SeesThatTheClockWasSetRight) {
  for (int i = 0; i < 10; ++i) Sentence(NoonPlus(i), -3s);
  EXPECT_EQ(clock_.host_minus_utc(), -2950ms);
  for (int i = 10; i < 30; ++i) Sentence(NoonPlus(i), 0s);
  EXPECT_EQ(clock_.host_minus_utc(), 0us);
  EXPECT_EQ(Sentence(NoonPlus(30), 0s)->time, NoonPlus(30));
}

TEST_F(UtcClockTest, DoesNotBelieveOneSourceAgainstAnother) {
  SourceClock late;
  for (int i = 0; i < 30; ++i) {
    Sentence(NoonPlus(i), 0s);
    const auto when = clock_.OfSentence(late, NoonPlus(i + 1.05), OfDay(NoonPlus(i)), std::nullopt, std::nullopt);
    EXPECT_FALSE(when->is_from_sentence);
  }
  EXPECT_EQ(clock_.host_minus_utc(), 0us);
}

TEST_F(UtcClockTest, MendsAWeekThatRolledOver) {
  for (const auto error : {days(-7168), days(-14336), days(7168)}) {
    clock_ = UtcClock(kMaxClockLatency);
    source_ = {};
    // Near the computer's time, and far from it: a clock that is off besides.
    EXPECT_EQ(Sentence(NoonPlus(0), 0s, 50ms, {}, error)->utc, NoonPlus(0));
    EXPECT_TRUE(Sentence(NoonPlus(1), 0s, 50ms, {}, error)->is_date_refused);
    EXPECT_EQ(Sentence(NoonPlus(2), 1h, 50ms, {}, error)->utc, NoonPlus(2));
  }
  EXPECT_EQ(Sentence(NoonPlus(3), 0s, 50ms, {}, days(0))->utc, NoonPlus(3));
}

TEST_F(UtcClockTest, KeepsADateThatIsFarFromTheComputers) {
  // A computer without a battery begins in 1970; a log of another year is played.
  const auto when = Sentence(NoonPlus(0), kNoBattery);
  EXPECT_EQ(when->utc, NoonPlus(0));
  EXPECT_FALSE(when->is_date_refused);
  EXPECT_EQ(Sentence(NoonPlus(0.5), kNoBattery, 50ms, {}, std::nullopt)->utc, NoonPlus(0.5)) << "the day of the sentence before it";
}

TEST_F(UtcClockTest, CarriesTheDayOverMidnight) {
  const auto midnight = std::chrono::floor<days>(NoonPlus(0)) + days(1);
  Sentence(midnight - 1s, kNoBattery);
  EXPECT_EQ(Sentence(midnight + 1s, kNoBattery, 50ms, {}, std::nullopt)->utc, midnight + 1s);
}

TEST_F(UtcClockTest, UsesTheDateOfAZdaThatRunsAhead) {
  // gpsd's tcp-torture: ZDA is two seconds ahead of the fixes.
  clock_.OnDate(source_, NoonPlus(0) + kNoBattery, NoonPlus(2));
  EXPECT_EQ(Sentence(NoonPlus(0), kNoBattery, 50ms, {}, std::nullopt)->utc, NoonPlus(0));
}

TEST_F(UtcClockTest, LetsTheFirstDateCorrectTheGuessOfSentencesBeforeIt) {
  // GGA, then RMC, of a log of years ago: the day of the first GGA can only be that of the computer.
  const auto old = [](double time_s) { return NoonPlus(time_s) - days(4000); };
  ASSERT_TRUE(Sentence(old(0), days(4000) - 5h, 50ms, {}, std::nullopt));
  for (int i = 0; i < 20; ++i) {
    const auto rmc = Sentence(old(i), days(4000) - 5h);
    ASSERT_TRUE(rmc) << i;
    EXPECT_EQ(rmc->utc, old(i));
    const auto gga = Sentence(old(i + 1), days(4000) - 5h, 50ms, {}, std::nullopt);
    ASSERT_TRUE(gga) << i;
    EXPECT_EQ(gga->utc, old(i + 1));
  }
}

TEST_F(UtcClockTest, UsesADateThatIsSetBackAlthoughSentencesWithoutADateGoOn) {
  // All at once, so that the computer's clock cannot be told.
  const Utime arrival = NoonPlus(0) - 5h;
  const auto take = [&](int i, std::optional<std::chrono::sys_days> date) {
    return clock_.OfSentence(source_, arrival, OfDay(NoonPlus(2 * i)), date, std::nullopt).has_value();
  };
  const auto day = std::chrono::floor<days>(NoonPlus(0));
  ASSERT_TRUE(take(0, day));
  int num_refused = 0;
  for (int i = 1; i < 30; ++i) {
    EXPECT_TRUE(num_refused >= UtcClock::kMinForward - 1 || take(i, std::nullopt)) << i;
    num_refused += take(i, day - days(30)) ? 0 : 1;
  }
  EXPECT_EQ(num_refused, UtcClock::kMinForward - 1);
}

TEST_F(UtcClockTest, RefusesTimeThatRunsBackwardsUntilItRunsForward) {
  ASSERT_TRUE(Sentence(NoonPlus(100), 0s));
  EXPECT_TRUE(Sentence(NoonPlus(99.2), 0s, 850ms)) << "a datagram that was overtaken";
  Sentence(NoonPlus(101), 0s);
  EXPECT_FALSE(clock_.OfSentence(source_, NoonPlus(101.1), OfDay(NoonPlus(50)), std::nullopt, std::nullopt));
  EXPECT_TRUE(Sentence(NoonPlus(102), 0s));
  // A receiver that was set back by a minute.
  for (int i = 0; i < UtcClock::kMinForward - 1; ++i) {
    EXPECT_FALSE(clock_.OfSentence(source_, NoonPlus(103 + i), OfDay(NoonPlus(43 + i)), std::nullopt, std::nullopt)) << i;
  }
  EXPECT_TRUE(clock_.OfSentence(source_, NoonPlus(113), OfDay(NoonPlus(53)), std::nullopt, std::nullopt));
}

// A TCP source that was stopped and drained: the clock was called off by 11 s, then by 0.0 s for ever.
TEST_F(UtcClockTest, IsToldNothingByAQueueThatIsDrained) {
  for (int i = 0; i < 300; ++i) Sentence(NoonPlus(0.1 * i), 0s);
  for (int i = 0; i < 120; ++i) {
    const auto utc = NoonPlus(30 + 0.1 * i);
    const auto when = Sentence(utc, 0s, NoonPlus(42) + 50ms - utc);
    ASSERT_TRUE(when);
    EXPECT_EQ(when->time, utc) << "it was measured when it says";
    EXPECT_EQ(clock_.host_minus_utc(), 0us) << i;
  }
  for (int i = 420; i < 600; ++i) Sentence(NoonPlus(0.1 * i), 0s);
  EXPECT_EQ(clock_.host_minus_utc(), 0us);
}

TEST_F(UtcClockTest, IsToldNothingByAQueueOfAReceiverWhoseDelayVaries) {
  std::mt19937 random(3);
  for (int run = 0; run < 200; ++run) {
    clock_ = UtcClock(kMaxClockLatency);
    source_ = {};
    const int num_before = 100 + static_cast<int>(random() % 100);
    const auto delay = [&] { return microseconds(20'000 + random() % 100'000); };
    for (int i = 0; i < num_before; ++i) Sentence(NoonPlus(0.1 * i), 0s, delay());
    for (int i = num_before; i < num_before + 120; ++i) {
      const auto utc = NoonPlus(0.1 * i);
      ASSERT_EQ(Sentence(utc, 0s, NoonPlus(0.1 * (num_before + 120)) + 50ms - utc)->time, utc) << run << ", " << i - num_before;
      ASSERT_EQ(clock_.host_minus_utc(), 0us);
    }
  }
}

// 4800 baud: GGA comes half a second behind RMC, of the same instant. That is no leap second.
TEST_F(UtcClockTest, GoesThroughANewMonthWithAReceiverThatIsSlow) {
  const auto midnight = std::chrono::sys_days(std::chrono::year(2026) / 7 / 1);
  for (int i = -20; i < 20; ++i) {
    const Utime utc = midnight + std::chrono::seconds(i);
    for (const auto delay : {100ms, 650ms}) EXPECT_EQ(Sentence(utc, 0s, delay)->time, utc) << i;
  }
  EXPECT_EQ(clock_.host_minus_utc(), 0us);
}

// Between 0.4 and 0.5 s it stays what it was called.
TEST_F(UtcClockTest, CallsAClockOffWithHysteresis) {
  const auto run = [this](int from_s, microseconds off) {
    for (int i = from_s; i < from_s + 15; ++i) Sentence(NoonPlus(i), off, 0ms);
    return clock_.host_minus_utc();
  };
  EXPECT_EQ(run(0, 450ms), 0us);
  EXPECT_EQ(run(20, 520ms), 520ms);
  EXPECT_EQ(run(40, 450ms), 450ms);
  EXPECT_EQ(run(60, 350ms), 0us);
  EXPECT_EQ(run(80, -450ms), 0us);
  EXPECT_EQ(run(100, -520ms), -520ms);
}

}  // namespace
}  // namespace lookout::navigator
