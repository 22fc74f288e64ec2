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

// 3 % of datagrams lost cost 15 to 18 % of the scans, and nobody said how many.
TEST(WholeCount, CountsScansOfWhichSomethingIsMissing) {
  WholeCount count;
  SequenceWatch sequence;
  const auto send = [&](std::int64_t seq, std::int64_t part_index) { count.Note(seq, part_index, 3, sequence.NumLostBefore(seq, part_index, 3)); };
  const auto send_all = [&](std::int64_t seq) {
    for (int part_index = 0; part_index < 3; ++part_index) send(seq, part_index);
  };
  send(6, 2);  // in the middle of a run: no loss
  send_all(7);
  EXPECT_EQ(count.num_whole(), 1);
  EXPECT_EQ(count.num_lost(), 0);
  send(8, 0);
  send(8, 2);  // one in the middle
  EXPECT_EQ(count.num_lost(), 1);
  send(9, 1);  // the first
  send(9, 2);
  EXPECT_EQ(count.num_lost(), 2);
  send(10, 0);  // the last two
  send_all(11);
  EXPECT_EQ(count.num_lost(), 3);
  send_all(15);  // 12, 13 and 14 whole
  EXPECT_EQ(count.num_lost(), 6);
  send(16, 0);
  send(19, 1);  // the rest of 16, 17, 18 and the first of 19
  send(19, 2);
  EXPECT_EQ(count.num_lost(), 10);
  EXPECT_EQ(count.num_whole(), 3);
  send_all(0);  // a new start
  EXPECT_EQ(count.num_lost(), 10);
  EXPECT_EQ(count.num_whole(), 4);
}

// As of ALERTS, and for the recorder, which does not decode.
TEST(WholeCount, CountsNumbersWherePartsAreNotKnown) {
  WholeCount count;
  for (const std::int64_t seq : {0, 0, 1, 1, 1, 2}) count.Note(seq, -1, 1, 0);
  EXPECT_EQ(count.num_whole(), 3);
  count.Note(5, -1, 1, 2);
  count.Note(5, -1, 1, 0);
  EXPECT_EQ(count.num_whole(), 4);
  EXPECT_EQ(count.num_lost(), 2);
}

TEST(WholeCount, CountsMessagesWhereThereAreNoParts) {
  WholeCount count;
  SequenceWatch sequence;
  for (const std::int64_t seq : {0, 1, 4, 5}) count.Note(seq, 0, 1, sequence.NumLostBefore(seq));
  EXPECT_EQ(count.num_whole(), 4);
  EXPECT_EQ(count.num_lost(), 2);
}

}  // namespace
}  // namespace lookout::bus
