#include "common/bus/sequence.hpp"

#include <cstdint>
#include <gtest/gtest.h>

namespace lookout::bus {
namespace {

TEST(SequenceWatch, FindsNoLossInARunThatBeginsAnywhere) {
  SequenceWatch watch;
  EXPECT_EQ(watch.NumLostBefore(17), 0);
  EXPECT_EQ(watch.NumLostBefore(18), 0);
}

TEST(SequenceWatch, CountsWhatIsMissing) {
  SequenceWatch watch;
  watch.NumLostBefore(0);
  EXPECT_EQ(watch.NumLostBefore(5), 4);
}

TEST(SequenceWatch, TakesASmallerOrEqualNumberAsANewStart) {
  SequenceWatch watch;
  watch.NumLostBefore(100);
  EXPECT_EQ(watch.NumLostBefore(0), 0);
  EXPECT_EQ(watch.NumLostBefore(1), 0);
}

TEST(SequenceWatch, CountsMissingPartsOfATurn) {
  SequenceWatch watch;
  EXPECT_EQ(watch.NumLostBefore(0, 0, 3), 0);
  EXPECT_EQ(watch.NumLostBefore(0, 2, 3), 1);  // part 1
  EXPECT_EQ(watch.NumLostBefore(1, 0, 3), 0);
  EXPECT_EQ(watch.NumLostBefore(2, 1, 3), 3);  // two of turn 1, one of turn 2
}

TEST(SequenceWatch, SurvivesTheEndsOfTheRange) {
  SequenceWatch watch;
  watch.NumLostBefore(INT64_MIN);
  EXPECT_EQ(watch.NumLostBefore(INT64_MAX), 0);
}

}  // namespace
}  // namespace lookout::bus
