// Labels of returns by tracks: the tracker's answer for the pieces, or else for the segments, of a scan.
#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "lab/eval/tracks/track_scan.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::eval {

class TrackLabels {
 public:
  /// Land has no number of its own in TRACKS: all of it has one label, or each return of it keeps that of its segment.
  enum class Land { kOne, kBySegment };
  /// Label of all land that is one; all other labels are above it.
  static constexpr int kLandLabel = 1;

  /// @param parts  TRACKS of one scan, well-formed. Where they say nothing of pieces, segments count, as for a tracker that knows of none
  TrackLabels(std::span<const tracks_t> parts, Land land);
  /// @param land_segments  in any case land, as SEGMENTS or the tracker call them
  TrackLabels(std::span<const TrackState> tracks, const std::set<int>& land_segments, Land land = Land::kOne);

  /// @param segment  label of SEGMENTS, above 0
  /// @param piece    of SEGMENTS
  /// @return label from 1 on. A return that no track explains has one of its segment's own.
  int Of(int segment, int piece) const;

 private:
  void SetSegments(std::span<const TrackState> tracks, const std::set<int>& land_segments, Land land);

  std::vector<int> of_piece_;  // by number; 0 = that of the segment; empty: segments count
  std::map<int, int> of_segment_;
  int last_ = kLandLabel;
};

}  // namespace lookout::eval
