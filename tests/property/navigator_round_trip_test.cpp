// Sentences that are written from random values are read as these values.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "common/core/angles.hpp"
#include "services/navigator/core/nmea.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

constexpr unsigned kSeed = 20261121;
constexpr int kNumTrials = 20000;

class RoundTrip : public ::testing::Test {
 protected:
  double Uniform(double min, double max) { return std::uniform_real_distribution<double>(min, max)(random_); }
  Utime RandomTime() {
    return NoonPlus(0) + std::chrono::microseconds(std::uniform_int_distribution<std::int64_t>(0, 86'400'000'000LL * 3000)(random_));
  }
  static Sentence Parsed(SentenceType type, const std::string& line) {
    const auto result = ParseSentence(line);
    EXPECT_EQ(result.fault, SentenceFault::kNone) << line << ", seed " << kSeed;
    EXPECT_EQ(result.sentence.type, type) << line;
    return result.sentence;
  }
  static double AngleBetweenRad(double a_rad, double b_rad) { return std::abs(WrapToPi(a_rad - b_rad)); }

  std::mt19937 random_{kSeed};
};

TEST_F(RoundTrip, OfRmc) {
  for (int i = 0; i < kNumTrials; ++i) {
    const auto time = RandomTime();
    const double latitude_deg = Uniform(-90, 90);
    const double longitude_deg = Uniform(-180, 180);
    const double speed_mps = Uniform(0, 50);
    const double course_deg = Uniform(0, 360);
    const auto line = RmcLine(time, latitude_deg, longitude_deg, speed_mps, course_deg);
    const auto rmc = Parsed(SentenceType::kRmc, line);
    ASSERT_TRUE(rmc.position && rmc.date && rmc.time_of_day) << line;
    EXPECT_EQ(*rmc.date + *rmc.time_of_day, time) << line;
    EXPECT_NEAR(rmc.position->latitude_deg, latitude_deg, 1e-10) << line;
    EXPECT_NEAR(rmc.position->longitude_deg, longitude_deg, 1e-10) << line;
    EXPECT_NEAR(rmc.speed_mps, speed_mps, 1e-6) << line;
    EXPECT_LT(AngleBetweenRad(rmc.course_rad, DegToRad(course_deg)), 1e-6) << line;
  }
}

TEST_F(RoundTrip, OfGga) {
  for (int i = 0; i < kNumTrials; ++i) {
    const double height_m = Uniform(-400, 9000);
    const double separation_m = Uniform(-107, 86);
    const int quality = static_cast<int>(random_() % 9);
    const auto line = GgaLine(RandomTime(), Uniform(-90, 90), Uniform(-180, 180), quality, Uniform(0, 99), height_m, separation_m);
    const auto gga = Parsed(SentenceType::kGga, line);
    EXPECT_EQ(static_cast<int>(gga.quality), quality) << line;
    EXPECT_NEAR(gga.msl_height_m, height_m, 1e-4) << line;
    EXPECT_NEAR(gga.geoid_separation_m, separation_m, 1e-4) << line;
  }
}

TEST_F(RoundTrip, OfHdtAndPashr) {
  for (int i = 0; i < kNumTrials; ++i) {
    const double heading_deg = Uniform(0, 360);
    EXPECT_LT(AngleBetweenRad(Parsed(SentenceType::kHdt, HdtLine(heading_deg)).heading_rad, DegToRad(heading_deg)), 1e-6);
    const double roll_deg = Uniform(-180, 180);
    const double pitch_deg = Uniform(-90, 90);
    const double heave_m = Uniform(-9, 9);
    const auto time = RandomTime();
    const auto line = PashrLine(time, heading_deg, roll_deg, pitch_deg, heave_m);
    const auto pashr = Parsed(SentenceType::kPashr, line);
    EXPECT_EQ(std::chrono::floor<std::chrono::days>(time) + *pashr.time_of_day, time) << line;
    EXPECT_LT(AngleBetweenRad(pashr.heading_rad, DegToRad(heading_deg)), 1e-6) << line;
    EXPECT_NEAR(pashr.roll_rad, DegToRad(roll_deg), 1e-6) << line;
    EXPECT_NEAR(pashr.pitch_rad, DegToRad(pitch_deg), 1e-6) << line;
    EXPECT_NEAR(pashr.heave_m, heave_m, 1e-4) << line;
  }
}

TEST_F(RoundTrip, NeverTakesALineWithOneCharacterChanged) {
  const auto line = RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0);
  for (std::size_t place = 0; place < line.size(); ++place) {
    for (char character = 0x20; character < 0x7F; ++character) {
      if (character == line[place]) continue;
      auto changed = line;
      changed[place] = character;
      const auto result = ParseSentence(changed);
      const bool is_taken = result.fault == SentenceFault::kNone && result.sentence.type != SentenceType::kOther;
      // Small hexadecimal digits mean the same.
      EXPECT_FALSE(is_taken && std::tolower(character) != std::tolower(line[place])) << changed;
    }
  }
}

}  // namespace
}  // namespace lookout::navigator
