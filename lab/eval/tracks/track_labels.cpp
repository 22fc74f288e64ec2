#include "lab/eval/tracks/track_labels.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "lab/eval/tracks/track_run.hpp"

namespace lookout::eval {

TrackLabels::TrackLabels(std::span<const tracks_t> parts, Land land) {
  std::map<std::int64_t, int> label_of_track;
  for (const auto& part : parts) {
    if (part.num_pieces == 0) continue;
    const auto first = static_cast<std::size_t>(part.first_piece);
    of_piece_.resize(std::max(of_piece_.size(), first + part.track_of_piece.size()), 0);
    for (std::size_t i = 0; i < part.track_of_piece.size(); ++i) {
      const auto track = part.track_of_piece[i];
      const bool has_label = track == tracks_t::PIECE_LAND ? land == Land::kOne : track > tracks_t::PIECE_LAND;
      if (!has_label) continue;
      const int next = kLandLabel + 1 + static_cast<int>(label_of_track.size());
      const int label = track == tracks_t::PIECE_LAND ? kLandLabel : label_of_track.try_emplace(track, next).first->second;
      of_piece_[first + i] = label;
      last_ = std::max(last_, label);
    }
  }
  if (!of_piece_.empty()) return;
  std::vector<TrackState> tracks;
  std::set<int> land_segments;
  for (const auto& part : parts) {
    for (const auto& track : part.tracks) tracks.push_back(ToTrackState(track));
    land_segments.insert(part.land_segment_ids.begin(), part.land_segment_ids.end());
  }
  SetSegments(tracks, land_segments, land);
}

TrackLabels::TrackLabels(std::span<const TrackState> tracks, const std::set<int>& land_segments, Land land) {
  SetSegments(tracks, land_segments, land);
}

void TrackLabels::SetSegments(std::span<const TrackState> tracks, const std::set<int>& land_segments, Land land) {
  for (const auto& track : tracks) {
    if (track.status == TrackStatus::kLost) continue;
    ++last_;
    for (const auto segment : track.segment_ids) of_segment_[segment] = last_;
  }
  for (const int segment : land_segments) {
    if (land == Land::kOne) {
      of_segment_[segment] = kLandLabel;
    } else {
      of_segment_.erase(segment);
    }
  }
}

int TrackLabels::Of(int segment, int piece) const {
  int label = 0;
  if (of_piece_.empty()) {
    const auto found = of_segment_.find(segment);
    label = found == of_segment_.end() ? 0 : found->second;
  } else if (static_cast<std::size_t>(piece) < of_piece_.size()) {
    label = of_piece_[static_cast<std::size_t>(piece)];
  }
  return label > 0 ? label : last_ + segment;
}

}  // namespace lookout::eval
