#include "services/tracker/core/step.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lookout::tracker {

void Step::Run() {
  Predict();
  is_sight_known_ = known_.sight.Begin(scan_);
  known_.had_sight = known_.had_sight || is_sight_known_;
  if (!scan_.own) {
    EndUnseen();
    return;
  }
  auto sightings = SightingsOf(scan_, known_.sight, known_.tracks, params_.without.ledger ? nullptr : &known_.ledger);
  sightings_ = std::move(sightings.all);
  num_groups_ = sightings.num_groups;
  sighting_of_piece_ = std::move(sightings.of_piece);
  sighting_of_segment_ = std::move(sightings.of_segment);
  LeaveOutdated();
  Settle();
  FindLand();
  Look();
  known_.clutter.Begin();
  AssignBodies();
  AssignRest();
  FindInside();
  for (auto& track : known_.tracks) {
    if (!track.is_seen_now && !track.is_inside_now && !has_left_out_) Miss(track);
  }
  Begin();
  known_.clutter.End(dt_s_);
  FeedLand();
  EndLand();
  Merge();
  EndUnseen();
  RememberGround();
  LookAtGround();
  if (is_sight_known_) known_.watched.Add(known_.sight, scan_.end_time);
  Label();
}

Picture Step::TakePicture() {
  Picture picture;
  picture.is_sight_known = is_sight_known_;
  picture.land_segment_ids = std::move(land_ids_);
  picture.track_of_piece = std::move(track_of_piece_);
  picture.merged = std::move(merged_);
  return picture;
}

void Step::Predict() {
  known_.land_pieces.Predict(dt_s_);
  for (auto& track : known_.tracks) {
    track.segment_ids.clear();
    track.is_seen_now = track.is_inside_now = false;
    track.detection = 0.0;
    if (!track.body) continue;
    track.body->Predict(dt_s_);
    Place(track);
  }
}

void Step::Hit(Followed& track, std::size_t i, const Seen& seen, const Sides& sides) {
  const Eigen::Vector2d expected_m = track.middle_m;
  Move(track, i, seen, sides);
  Believe(track, i, seen, expected_m);
  sightings_[i].use = Sighting::Use::kTaken;
  track.is_seen_now = true;
  track.sighting = i;
  track.sum_returns += seen.num_returns;
  track.top_m = std::max(seen.top_above_water_m, track.top_m + 0.05 * (seen.top_above_water_m - track.top_m));
  track.seen = track.seen_alone = scan_.end_time;
  track.own_covariance_m2 = seen.covariance_m2 - seen.covariance_relative_m2;
  track.relative_covariance_m2 = seen.covariance_relative_m2;
  track.segment_ids.push_back(seen.segment_id);
  ChooseFrame(track);
  if (!track.body && track.Existence() > 0.5) {
    track.body.emplace(seen.outline_m, sides, seen.covariance_relative_m2, sightings_[i].range_m);
    Place(track);
  }
  ConfirmWhereLikely(track, i);
}

// From a sighting to the segments and pieces that it consists of.
void Step::Label() {
  std::vector<std::int64_t> track_of(sightings_.size(), kNoTrack);
  for (const std::int32_t number : land_ids_) track_of[static_cast<std::size_t>(number - 1)] = 0;
  for (auto& track : known_.tracks) {
    for (const std::int32_t number : track.segment_ids) track_of[static_cast<std::size_t>(number - 1)] = track.PublicId();
    track.segment_ids.clear();
  }
  const auto of = [&track_of](std::int32_t seen) { return seen < 0 ? kNoTrack : track_of[static_cast<std::size_t>(seen)]; };
  for (const std::int32_t seen : sighting_of_piece_) track_of_piece_.push_back(of(seen));
  land_ids_.clear();
  std::map<std::int64_t, std::vector<std::int32_t>> segments_of;
  for (std::size_t i = 0; i < sighting_of_segment_.size(); ++i) {
    const std::int64_t id = of(sighting_of_segment_[i]);
    const auto segment = static_cast<std::int32_t>(i) + 1;
    if (id == 0) land_ids_.push_back(segment);
    if (id != 0 && id != kNoTrack) segments_of[id].push_back(segment);
  }
  for (auto& track : known_.tracks) {
    if (const auto found = segments_of.find(track.PublicId()); found != segments_of.end()) track.segment_ids = std::move(found->second);
  }
}

}  // namespace lookout::tracker
