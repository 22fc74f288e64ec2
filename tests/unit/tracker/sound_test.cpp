// Which alert sounds.
#include "services/tracker/core/sound.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

namespace lookout::tracker {
namespace {

class SoundTest : public ::testing::Test {
 protected:
  static Alert Of(std::int64_t id, AlertLevel level, AlertState state = AlertState::kActive) { return {.id = id, .level = level, .state = state}; }
  std::int64_t Scan(const std::vector<Alert>& alerts) { return sound_.Update(time_ += std::chrono::milliseconds(100), alerts); }
  // Whether it sounds in the last of so many scans.
  std::int64_t Scans(int num, const std::vector<Alert>& alerts) {
    std::int64_t sounding = 0;
    for (int i = 0; i < num; ++i) sounding = Scan(alerts);
    return sounding;
  }

  Utime time_{std::chrono::seconds(1'700'000'000)};
  Sound sound_;
};

constexpr auto kCaution = AlertLevel::kCaution;
constexpr auto kWarning = AlertLevel::kWarning;

TEST_F(SoundTest, IsOfACautionOnceAndOfAWarningUntilItIsAcknowledged) {
  EXPECT_EQ(Scan({}), 0);
  EXPECT_EQ(Scan({Of(1, kCaution)}), 1);
  EXPECT_EQ(Scans(9, {Of(1, kCaution)}), 1);
  EXPECT_EQ(Scans(2, {Of(1, kCaution)}), 0);
  EXPECT_EQ(Scans(500, {Of(2, kWarning), Of(1, kCaution)}), 2);
  EXPECT_EQ(Scan({Of(2, kWarning, AlertState::kAcknowledged), Of(1, kCaution)}), 0);
}

TEST_F(SoundTest, RisesWithEscalationAndNeverWithSoftening) {
  Scans(50, {Of(1, kCaution)});
  EXPECT_EQ(Scans(50, {Of(1, kWarning)}), 1);
  EXPECT_EQ(Scan({Of(1, kCaution)}), 0);
  EXPECT_EQ(Scan({Of(1, kWarning)}), 1);
}

TEST_F(SoundTest, IsOneOfTheGravestThatIsNotAcknowledged) {
  EXPECT_EQ(Scan({Of(3, kWarning, AlertState::kAcknowledged), Of(2, kWarning), Of(1, kCaution)}), 2);
  EXPECT_EQ(Scan({Of(3, kWarning, AlertState::kAcknowledged), Of(2, kWarning, AlertState::kRectified), Of(1, kCaution)}), 1);
}

TEST_F(SoundTest, OfAnAcknowledgedOneComesWhenItIsActiveAgain) {
  Scans(20, {Of(1, kCaution)});
  Scan({Of(1, kCaution, AlertState::kAcknowledged)});
  EXPECT_EQ(Scan({Of(1, kCaution)}), 1) << "another place of land";
}

TEST_F(SoundTest, IsNotMadeTwiceByWhatComesAgainSoon) {
  Scans(20, {Of(1, kCaution)});
  Scan({Of(1, kCaution, AlertState::kCleared)});
  Scans(50, {});
  EXPECT_EQ(Scan({Of(1, kCaution)}), 0);
}

TEST_F(SoundTest, IsSilencedForThirtySecondsButForWhatIsGraverMeanwhile) {
  Scans(5, {Of(1, kWarning), Of(2, kCaution)});
  sound_.Silence(time_);
  ASSERT_TRUE(sound_.silenced_until());
  EXPECT_EQ(Scans(100, {Of(1, kWarning), Of(2, kCaution), Of(3, kCaution)}), 0);
  EXPECT_EQ(Scan({Of(1, kWarning), Of(2, kWarning), Of(3, kCaution)}), 2) << "escalated";
  EXPECT_EQ(Scan({Of(4, kWarning), Of(1, kWarning)}), 4) << "new";
  Scans(200, {Of(1, kWarning)});
  EXPECT_FALSE(sound_.silenced_until());
  EXPECT_EQ(Scan({Of(1, kWarning)}), 1) << "nobody took note of it";
}

// Whatever was raised, acknowledged, silenced and cleared before, a further boat rings.
TEST_F(SoundTest, IsOfAFurtherAlertAfterThousandsOfOthers) {
  for (std::int64_t id = 1; id <= 3000; ++id) {
    ASSERT_EQ(Scan({Of(id, kWarning)}), id);
    if (id % 3 == 0) sound_.Silence(time_);
    const auto state = id % 3 == 1 ? AlertState::kAcknowledged : AlertState::kActive;
    ASSERT_EQ(Scan({Of(id, kWarning, state)}), id % 3 == 2 ? id : 0);
    ASSERT_EQ(Scan({Of(id, kWarning, id % 2 == 0 ? AlertState::kCleared : AlertState::kRectified)}), 0);
  }
  EXPECT_EQ(Scan({Of(3001, kWarning), Of(3000, kWarning, AlertState::kRectified)}), 3001);
  EXPECT_EQ(Scans(200, {Of(3001, kWarning)}), 3001);
}

}  // namespace
}  // namespace lookout::tracker
