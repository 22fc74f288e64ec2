#include "lab/eval/tracks/track_labels.hpp"

#include <gtest/gtest.h>

namespace lookout::eval {
namespace {

using Land = TrackLabels::Land;

tracks_t SlicesOfPieces(int first, std::vector<std::int64_t> tracks) {
  tracks_t part{};
  part.first_piece = first;
  part.num_pieces = static_cast<std::int32_t>(tracks.size());
  part.track_of_piece = std::move(tracks);
  return part;
}

// Pieces 1 to 5: of track 70, land, nothing, track 70 again, track 9.
std::vector<tracks_t> TwoSlices() { return {SlicesOfPieces(1, {70, tracks_t::PIECE_LAND, tracks_t::PIECE_NO_TRACK}), SlicesOfPieces(4, {70, 9})}; }

TEST(TrackLabels, PiecesOfOneTrackHaveOneLabel) {
  const TrackLabels labels(TwoSlices(), Land::kOne);
  EXPECT_EQ(labels.Of(1, 1), labels.Of(8, 4));
  EXPECT_NE(labels.Of(1, 1), labels.Of(1, 5));
  EXPECT_EQ(labels.Of(3, 2), TrackLabels::kLandLabel);
  EXPECT_GT(labels.Of(1, 1), TrackLabels::kLandLabel);
}

TEST(TrackLabels, WhatIsOfNoTrackKeepsItsSegment) {
  const TrackLabels labels(TwoSlices(), Land::kOne);
  EXPECT_EQ(labels.Of(6, 3), labels.Of(6, 20)) << "behind the last slice";
  EXPECT_NE(labels.Of(6, 3), labels.Of(7, 3));
  for (const int piece : {1, 2, 4, 5}) EXPECT_NE(labels.Of(6, 3), labels.Of(6, piece));
}

TEST(TrackLabels, LandKeepsItsSegmentWhereItIsNotOne) {
  const TrackLabels labels(TwoSlices(), Land::kBySegment);
  EXPECT_EQ(labels.Of(6, 2), labels.Of(6, 3));
  EXPECT_NE(labels.Of(6, 2), labels.Of(7, 2));
  EXPECT_EQ(labels.Of(1, 1), labels.Of(8, 4));
}

TEST(TrackLabels, WithoutPiecesSegmentsCount) {
  TrackState track;
  track.id = 70;
  track.segment_ids = {2, 4};
  TrackState lost = track;
  lost.status = TrackStatus::kLost;
  lost.segment_ids = {5};
  const std::vector<TrackState> tracks{track, lost};
  const TrackLabels labels(tracks, {3});
  EXPECT_EQ(labels.Of(2, 0), labels.Of(4, 0));
  EXPECT_EQ(labels.Of(3, 0), TrackLabels::kLandLabel);
  EXPECT_NE(labels.Of(5, 0), labels.Of(2, 0));
  EXPECT_NE(labels.Of(5, 0), labels.Of(6, 0));
  EXPECT_NE(TrackLabels(tracks, {3}, Land::kBySegment).Of(3, 0), TrackLabels::kLandLabel);
}

}  // namespace
}  // namespace lookout::eval
