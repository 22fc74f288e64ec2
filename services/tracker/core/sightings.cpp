#include "services/tracker/core/sightings.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace lookout::tracker {

namespace {

constexpr std::int32_t kNothing = -1;
constexpr std::int32_t kMostNumber = 65'535;  // labels have 16 bits: a segment with a greater number has no returns

struct PieceReturns {
  std::int32_t number = 0;
  std::size_t segment = 0;  // of scan.seen, by index
  std::vector<Eigen::Vector2d> places_m;
  std::vector<double> heights_m;
};

// [numbers] by number, from `list`; kNothing where there is none.
void SetAt(std::vector<std::int32_t>& list, std::int32_t number, std::int32_t value) {
  if (number <= 0 || number > kMostNumber) return;
  const auto at = static_cast<std::size_t>(number - 1);
  if (list.size() <= at) list.resize(at + 1, kNothing);
  list[at] = value;
}
std::int32_t At(const std::vector<std::int32_t>& list, std::int32_t number) {
  const auto at = static_cast<std::size_t>(number - 1);
  return number > 0 && at < list.size() ? list[at] : kNothing;
}

// Pieces of the segments of OBSTACLES, in the order of their first return.
std::vector<PieceReturns> PiecesOf(const ScanInput& scan, const Sight& sight) {
  std::vector<std::int32_t> segment_of;
  for (std::size_t i = 0; i < scan.seen.size(); ++i) SetAt(segment_of, scan.seen[i].segment_id, static_cast<std::int32_t>(i));
  std::vector<std::int32_t> index_of;
  std::vector<PieceReturns> pieces;
  for (const auto& one : sight.Returns()) {
    const std::int32_t segment = At(segment_of, one.label);
    if (segment == kNothing || one.piece <= 0) continue;
    std::int32_t index = At(index_of, one.piece);
    if (index == kNothing) {
      index = static_cast<std::int32_t>(pieces.size());
      SetAt(index_of, one.piece, index);
      pieces.push_back({.number = one.piece, .segment = static_cast<std::size_t>(segment), .places_m = {}, .heights_m = {}});
    }
    auto& piece = pieces[static_cast<std::size_t>(index)];
    piece.places_m.push_back(one.place_m);
    piece.heights_m.push_back(one.height_m);
  }
  return pieces;
}

// A segment by itself, without known returns.
void AddSegment(const Seen& segment, Sightings& sightings) {
  SetAt(sightings.of_segment, segment.segment_id, static_cast<std::int32_t>(sightings.all.size()));
  sightings.all.push_back({.seen = segment, .places_m = segment.waterline_m.empty() ? segment.outline_m : segment.waterline_m});
}

// Frames of the votes: that of the earth, and those of moving things.
std::vector<Ledger::Frame> FramesOf(const std::deque<Followed>& tracks, std::vector<const Followed*>& owners) {
  std::vector<Ledger::Frame> frames(1);
  for (const auto& track : tracks) {
    if (track.frame == 0 || !track.body) continue;
    frames.push_back({track.frame, track.body->Frame().inverse()});
    owners.push_back(&track);
  }
  return frames;
}

// The frame of the moving thing in whose outline most of a piece lies.
std::int32_t FrameOf(const PieceReturns& piece, const std::vector<const Followed*>& owners) {
  constexpr double kBesideOutlineM = 0.3;
  for (std::size_t k = 0; k < owners.size(); ++k) {
    const auto& track = *owners[k];
    std::size_t num_in = 0;
    for (const auto& place_m : piece.places_m) {
      if ((place_m - track.middle_m).norm() > track.radius_m + kBesideOutlineM) continue;
      if (Contains(track.outline_m, place_m) || GapOf(track.outline_m, std::array{place_m}).distance_m < kBesideOutlineM) ++num_in;
    }
    if (2 * num_in > piece.places_m.size()) return static_cast<std::int32_t>(k) + 1;
  }
  return 0;
}

// The groups of the scan itself: a group for each segment.
Ledger::Groups GroupsOfSegments(const std::vector<Ledger::Piece>& pieces) {
  Ledger::Groups groups;
  std::map<std::int32_t, std::int32_t> group_of;
  for (const auto& piece : pieces) {
    const auto [group, is_new] = group_of.try_emplace(piece.segment, static_cast<std::int32_t>(group_of.size()));
    if (is_new) groups.land.push_back(piece.is_land ? 1.0 : -1.0);
    groups.of_piece.push_back(group->second);
  }
  return groups;
}

// The pieces of a sighting, of several segments or of a part of one, as one segment.
Seen Together(const ScanInput& scan, const std::map<std::size_t, std::size_t>& returns_of, const Sighting& sighting) {
  const auto most = std::ranges::max_element(returns_of, {}, [](const auto& one) { return one.second; })->first;
  Seen whole = scan.seen[most];
  whole.outline_m = ConvexHull(sighting.places_m);
  whole.waterline_m.clear();
  whole.num_returns = static_cast<int>(sighting.places_m.size());
  whole.top_above_water_m = std::ranges::max(sighting.heights_m);
  double time_us = 0.0;
  double thing = 0.0;
  double sure = 0.0;
  for (const auto& [segment, count] : returns_of) {
    const double share = static_cast<double>(count) / static_cast<double>(sighting.places_m.size());
    time_us += share * static_cast<double>((scan.seen[segment].time - scan.time).count());
    thing += share * Logit(scan.seen[segment].thing_probability);
    sure += share * (scan.seen[segment].is_sure ? 1.0 : 0.0);
  }
  whole.time = scan.time + std::chrono::microseconds(std::llround(time_us));
  whole.thing_probability = Sigmoid(thing);
  whole.is_sure = sure > 0.5;
  return whole;
}

void AddGroups(const ScanInput& scan, const std::vector<PieceReturns>& pieces, const Ledger::Groups& groups, Sightings& sightings) {
  std::vector<std::vector<std::size_t>> pieces_of(groups.land.size());
  std::vector<std::size_t> returns_of_segment(scan.seen.size(), 0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    pieces_of[static_cast<std::size_t>(groups.of_piece[i])].push_back(i);
    returns_of_segment[pieces[i].segment] += pieces[i].places_m.size();
  }
  std::vector<std::size_t> most_of_segment(scan.seen.size(), 0);
  for (std::size_t group = 0; group < pieces_of.size(); ++group) {
    const auto number = static_cast<std::int32_t>(sightings.all.size());
    std::map<std::size_t, std::size_t> returns_of;  // by segment
    Sighting sighting;
    for (const auto i : pieces_of[group]) {
      const auto& piece = pieces[i];
      returns_of[piece.segment] += piece.places_m.size();
      sighting.places_m.insert(sighting.places_m.end(), piece.places_m.begin(), piece.places_m.end());
      sighting.heights_m.insert(sighting.heights_m.end(), piece.heights_m.begin(), piece.heights_m.end());
      SetAt(sightings.of_piece, piece.number, number);
    }
    const auto& [segment, count] = *returns_of.begin();
    const bool is_one_segment = returns_of.size() == 1 && count == returns_of_segment[segment];
    sighting.seen = is_one_segment ? scan.seen[segment] : Together(scan, returns_of, sighting);
    sighting.seen.is_land = groups.land[group] > 0.0 && sighting.seen.is_sure;
    for (const auto& [one, num_returns] : returns_of) {
      if (num_returns <= most_of_segment[one]) continue;
      most_of_segment[one] = num_returns;
      SetAt(sightings.of_segment, scan.seen[one].segment_id, number);
    }
    sightings.all.push_back(std::move(sighting));
  }
  sightings.num_groups = static_cast<std::int32_t>(sightings.all.size());
  for (std::size_t i = 0; i < scan.seen.size(); ++i) {
    if (returns_of_segment[i] == 0) AddSegment(scan.seen[i], sightings);
  }
}

// Where it is, and how large.
void Measure(const Sight& sight, Sighting& sighting) {
  const auto& outline_m = sighting.seen.outline_m;
  for (const auto& corner : outline_m) sighting.middle_m += corner / static_cast<double>(outline_m.size());
  for (const auto& corner : outline_m) sighting.radius_m = std::max(sighting.radius_m, (corner - sighting.middle_m).norm());
  sighting.range_m = (sighting.middle_m - sight.from_m()).norm();
}

}  // namespace

Sightings SightingsOf(const ScanInput& scan, const Sight& sight, const std::deque<Followed>& tracks, Ledger* ledger) {
  Sightings sightings;
  const auto pieces = PiecesOf(scan, sight);
  if (pieces.empty()) {
    for (const auto& segment : scan.seen) AddSegment(segment, sightings);
  } else {
    std::vector<const Followed*> owners;
    const auto frames = FramesOf(tracks, owners);
    std::vector<Ledger::Piece> asked;
    asked.reserve(pieces.size());
    for (const auto& piece : pieces) {
      const auto& segment = scan.seen[piece.segment];
      asked.push_back({static_cast<std::int32_t>(piece.segment), segment.is_land && segment.is_sure, FrameOf(piece, owners), piece.places_m});
    }
    AddGroups(scan, pieces, ledger != nullptr ? ledger->Divide(asked, frames) : GroupsOfSegments(asked), sightings);
  }
  for (std::size_t i = 0; i < sightings.all.size(); ++i) {
    sightings.all[i].seen.segment_id = static_cast<std::int32_t>(i) + 1;
    Measure(sight, sightings.all[i]);
  }
  return sightings;
}

}  // namespace lookout::tracker
