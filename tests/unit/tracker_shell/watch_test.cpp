// Whether anybody looks: scans drive message time, AdvanceTo the host's clock.
#include "services/tracker/watch.hpp"

#include <chrono>
#include <gtest/gtest.h>

namespace lookout::tracker {
namespace {

using std::chrono::milliseconds;

class TheWatch : public ::testing::Test {
 protected:
  // Host time alone goes on, as live: every 10 ms.
  void Wait(milliseconds duration) {
    for (auto waited = milliseconds(0); waited < duration; waited += milliseconds(10)) {
      watch_.AdvanceTo(host_ += milliseconds(10));
      watch_.TakeTurn();
    }
  }
  void Scans(int count, bool is_whole, milliseconds period = milliseconds(100)) {
    for (int i = 0; i < count; ++i) {
      Wait(period);
      watch_.NoteScan(time_ += period, is_whole);
    }
    Wait(milliseconds(10));
  }

  Watch watch_;
  Utime time_{std::chrono::seconds(1'700'000'000)};
  Utime host_{std::chrono::seconds(1'700'000'500)};
};

TEST_F(TheWatch, SaysAtTheStartThatNobodyLooksYet) {
  EXPECT_EQ(watch_.Complaint(), "") << "a replay has no clock";
  Wait(milliseconds(2000));
  EXPECT_EQ(watch_.Complaint(), "no whole scan yet");
  EXPECT_FALSE(watch_.is_failing()) << "there is nothing to repeat in ALERTS";
  Scans(2, true);
  EXPECT_EQ(watch_.Complaint(), "less than 3 whole scans within 1.0 s");
  Scans(1, true);
  EXPECT_EQ(watch_.Complaint(), "");
  EXPECT_EQ(watch_.num_failures(), 0);
}

TEST_F(TheWatch, FailsAfterHalfASecondWithoutScans) {
  Scans(10, true);
  Wait(milliseconds(480));
  EXPECT_FALSE(watch_.is_failing());
  Wait(milliseconds(20));
  EXPECT_TRUE(watch_.is_failing());
  EXPECT_EQ(watch_.Complaint(), "no whole scan for 0.5 s");
  ASSERT_TRUE(watch_.alert());
  EXPECT_EQ(watch_.alert()->cause, AlertCause::kWatch);
}

// A sender that is not the lidar cuts its scans into pieces, at 60 packets a second.
TEST_F(TheWatch, FailsWhereNoScanIsWhole) {
  Scans(480, false, milliseconds(20));
  EXPECT_TRUE(watch_.is_failing()) << "from the first on";
  Scans(3, true);
  EXPECT_FALSE(watch_.is_failing());
  Scans(60, false, milliseconds(20));
  EXPECT_TRUE(watch_.is_failing());
  EXPECT_EQ(watch_.num_failures(), 2);
}

// Fewer than two whole scans a second can raise no alert.
TEST_F(TheWatch, FailsWhereWholeScansAreTooFew) {
  Scans(5, true);
  for (int i = 0; i < 5; ++i) {
    Scans(5, false);
    Scans(1, true);
  }
  EXPECT_TRUE(watch_.is_failing());
  EXPECT_EQ(watch_.Complaint(), "less than 3 whole scans within 1.0 s");
}

// Each scan is of another run than the one before: no three belong together.
TEST_F(TheWatch, FailsWhileTwoRunsAlternate) {
  Scans(5, true);
  for (int i = 0; i < 20; ++i) {
    time_ += std::chrono::seconds(i % 2 == 0 ? 3600 : -3600);
    Scans(1, true);
  }
  EXPECT_TRUE(watch_.is_failing());
}

TEST_F(TheWatch, HoldsAtThreeHundredRpm) {
  Scans(20, true, milliseconds(200));
  EXPECT_EQ(watch_.Complaint(), "");
  EXPECT_EQ(watch_.num_failures(), 0);
}

TEST_F(TheWatch, HoldsWhenTheHostsClockIsSet) {
  Scans(10, true);
  for (const auto step : {std::chrono::seconds(3600), std::chrono::seconds(-7200)}) {
    host_ += step;
    Scans(5, true);
    EXPECT_EQ(watch_.num_failures(), 0);
  }
}

// Everything that came in 2 s in which this process did not run, at once.
TEST_F(TheWatch, HoldsAfterAPauseOfThisProcessAlone) {
  Scans(10, true);
  host_ += milliseconds(2000);
  for (int i = 0; i < 20; ++i) watch_.NoteScan(time_ += milliseconds(100), true);
  Scans(5, true);
  EXPECT_EQ(watch_.num_failures(), 0);
}

}  // namespace
}  // namespace lookout::tracker
