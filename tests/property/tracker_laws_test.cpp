// Laws of the tracker on seeded scenes of which the segmenter says something else in each scan.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "services/tracker/core/ledger.hpp"
#include "services/tracker/core/sight.hpp"
#include "services/tracker/core/sightings.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/walls.hpp"

namespace lookout::tracker {
namespace {

using test::Box;
using test::kColumns;
using test::kRings;

constexpr int kScans = 120;
constexpr int kShorePieces = 8;

// Things, which are pieces: a shore in some, then a dock, a moored boat in two, one that sails past in two, another boat, a buoy.
constexpr int kFirstNoLand = kShorePieces + 1;
enum : int { kDock = kFirstNoLand, kMooredBow, kMooredStern, kBow, kStern, kOther, kBuoy };

// Where boats lie at the dock, or each thing by itself: of two that come up beside each other in one scan the first is confirmed first.
enum class Room { kNarrow, kWide };

test::Walls SceneAt(int scan, Room room, std::mt19937_64 random) {
  std::uniform_real_distribution<double> off_m(-1.0, 1.0);
  test::Walls walls;
  for (int i = 0; i < kShorePieces; ++i) {
    const double from_m = -32.0 + 8.0 * i;
    walls.push_back({{from_m, 26.0 + off_m(random)}, {from_m + 7.0, 26.0 + off_m(random)}, 2.0, i + 1});
  }
  const double way_m = test::kScanS * scan;
  const Eigen::Vector2d at_m(off_m(random), off_m(random));
  const Eigen::Vector2d bow_m = Eigen::Vector2d(-16.0 + 2.0 * way_m, -9.0) + at_m;
  const Eigen::Vector2d other_m = Eigen::Vector2d(14.0 - 1.5 * way_m, 8.0) - at_m;
  const Eigen::Vector2d dock_m = at_m + Eigen::Vector2d(room == Room::kNarrow ? 14.0 : 24.0, 1.0);
  return walls + Box(dock_m, 4.0, 14.0, 1.2, kDock) + Box(Eigen::Vector2d(10.4, 2.0) + at_m, 2.4, 4.0, 1.0, kMooredBow) +
         Box(Eigen::Vector2d(10.4, -1.5) + at_m, 2.4, 3.0, 1.7, kMooredStern) + Box(bow_m, 4.0, 2.0, 1.0, kBow) +
         Box(bow_m - Eigen::Vector2d(3.5, 0.0), 3.0, 2.0, 1.7, kStern) + Box(other_m, 3.5, 1.6, 1.3, kOther) +
         Box(Eigen::Vector2d(-9.0, 5.0) + at_m, 0.5, 0.5, 1.1, kBuoy);
}

// Segments by thing: pieces that may be one are so in most scans, or in some.
std::vector<int> SegmentsOf(std::mt19937_64& random, bool is_sure) {
  std::vector<int> segment_of(kBuoy + 1);
  for (int thing = 0; thing <= kBuoy; ++thing) segment_of[static_cast<std::size_t>(thing)] = thing;
  const auto joins = [&](int thing, int to, unsigned of_ten) {
    if (random() % 10 < of_ten || (is_sure && of_ten > 6)) segment_of[static_cast<std::size_t>(thing)] = segment_of[static_cast<std::size_t>(to)];
  };
  for (int thing = 2; thing <= kShorePieces; ++thing) joins(thing, thing - 1, 6);
  joins(kMooredBow, kDock, 2);
  joins(kMooredStern, kMooredBow, 8);
  joins(kStern, kBow, 7);
  return segment_of;
}

std::vector<ScanInput> Scans(Room room, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<ScanInput> scans;
  scans.reserve(kScans);
  for (int scan = 0; scan < kScans; ++scan) {
    const auto segment_of = SegmentsOf(random, room == Room::kWide && scan < 10);
    const bool is_land = room == Room::kWide || random() % 10 < 8;
    const auto segmenter = [&](int thing, const Eigen::Vector2d&) {
      return test::Called{segment_of[static_cast<std::size_t>(thing)], is_land && thing <= kShorePieces, thing, thing == kBuoy ? 0.7 : 0.95};
    };
    scans.push_back(test::Look(scan, {0.0, 0.05 * scan}, SceneAt(scan, room, std::mt19937_64(seed)), segmenter, random));
  }
  return scans;
}

std::vector<Picture> PicturesOf(const std::vector<ScanInput>& scans) {
  Tracker tracker(test::WallParams());
  std::vector<Picture> pictures;
  pictures.reserve(scans.size());
  for (const auto& scan : scans) pictures.push_back(tracker.Update(scan));
  return pictures;
}

// All of it, to the bit.
std::string TextOf(const Picture& picture) {
  std::string text = fmt::format("{}", picture.is_sight_known);
  const auto add = [&text](const auto& values) {
    for (const auto& value : values) text += fmt::format(" {}", value);
    text += ';';
  };
  const auto add_real = [&text](double value) { text += fmt::format(" {:a}", value); };
  const auto add_places = [&](const std::vector<Eigen::Vector2d>& places_m) {
    for (const auto& place_m : places_m) {
      add_real(place_m.x());
      add_real(place_m.y());
    }
    text += ';';
  };
  for (const auto& track : picture.tracks) {
    text += fmt::format("\n{} {} {} {} {} {} {}:", track.id, static_cast<int>(track.status), static_cast<int>(track.kind),
                        track.first.time_since_epoch().count(), track.seen.time_since_epoch().count(), track.num_seen, track.num_looks);
    for (const double value : track.covariance.reshaped()) add_real(value);
    for (const double value : track.covariance_relative_m2.reshaped()) add_real(value);
    for (const double value : {track.turn_rate_radps, track.existence_probability, track.moving_probability, track.top_above_water_m,
                               track.seen_share, track.mean_returns, track.range_m, track.bearing_rad, track.rectangle.length_m,
                               track.rectangle.width_m, track.rectangle.length_angle_rad, track.approach.tcpa_s})
      add_real(value);
    add_places({track.position_m, track.velocity_mps, track.rectangle.center_m});
    add_places(track.outline_m);
    add(track.segment_ids);
    add(track.parents);
    add(track.children);
  }
  add(picture.land_segment_ids);
  add(picture.track_of_piece);
  add_places(picture.waterline_m);
  for (const auto& [from, to] : picture.merged) text += fmt::format(" {}>{}", from, to);
  return text;
}

void ExpectSameToTheBit(const std::vector<Picture>& pictures, const std::vector<Picture>& others, std::uint64_t seed) {
  for (std::size_t scan = 0; scan < pictures.size(); ++scan) {
    ASSERT_EQ(TextOf(pictures[scan]), TextOf(others[scan])) << "seed " << seed << ", scan " << scan;
  }
}

// Two runs whose tracks have other ids: the same all the time.
class Names {
 public:
  bool Agree(std::int64_t one, std::int64_t other) {
    if (one == 0 || one == kNoTrack || other == 0 || other == kNoTrack) return one == other;  // land, or nothing
    return forth_.try_emplace(one, other).first->second == other && back_.try_emplace(other, one).first->second == one;
  }
  // Of two that become one the older name stays, of two as old the lower: by numbers.
  void Forget(const Picture& one, const Picture& other) {
    for (const auto& [from, to] : one.merged) {
      if (const auto found = forth_.find(to); found != forth_.end()) {
        back_.erase(found->second);
        forth_.erase(found);
      }
    }
    for (const auto& [from, to] : other.merged) {
      if (const auto found = back_.find(to); found != back_.end()) {
        forth_.erase(found->second);
        back_.erase(found);
      }
    }
  }

 private:
  std::map<std::int64_t, std::int64_t> forth_;
  std::map<std::int64_t, std::int64_t> back_;
};

// Up to ids and rounding. It decides now and then how many columns show a thing, and so when it is confirmed and how large it is at first.
// @param east  -1 where the others are mirrored
void ExpectSame(const std::vector<Picture>& pictures, const std::vector<Picture>& others, double east, std::uint64_t seed) {
  constexpr double kNearM = 0.5;
  constexpr std::size_t kSettled = 20;  // scans
  Names names;
  for (std::size_t scan = 0; scan < pictures.size(); ++scan) {
    SCOPED_TRACE(fmt::format("seed {}, scan {}", seed, scan));
    names.Forget(pictures[scan], others[scan]);
    const auto& tracks = pictures[scan].tracks;
    ASSERT_EQ(tracks.size(), others[scan].tracks.size());
    for (const auto& track : tracks) {
      const auto off_m = [&](const Track& other) {
        return Eigen::Vector2d(track.position_m.x() - east * other.position_m.x(), track.position_m.y() - other.position_m.y()).norm();
      };
      const auto other = std::ranges::min_element(others[scan].tracks, {}, off_m);
      ASSERT_LT(off_m(*other), kNearM) << "track " << track.id;
      if (scan < kSettled) continue;
      ASSERT_TRUE(names.Agree(track.id, other->id)) << "track " << track.id;
      ASSERT_EQ(test::IsReported(track), test::IsReported(*other)) << "track " << track.id;
    }
    const auto& labels = pictures[scan].track_of_piece;
    ASSERT_EQ(labels.size(), others[scan].track_of_piece.size());
    for (std::size_t piece = 0; scan >= kSettled && piece < labels.size(); ++piece) {
      ASSERT_TRUE(names.Agree(labels[piece], others[scan].track_of_piece[piece])) << "piece " << piece + 1;
    }
  }
}

// The boat heads elsewhere, and nothing else is another: the lidar's columns begin elsewhere.
ScanInput Turned(const ScanInput& scan, int columns) {
  ScanInput turned = scan;
  const double heading_rad = kTwoPi * columns / kColumns;
  turned.own->heading_rad = turned.own_at_start->heading_rad = heading_rad;
  const auto rotate = [columns](auto& cells) {
    std::rotate(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(columns) * kRings, cells.end());
  };
  rotate(turned.sweep->range_m);
  rotate(turned.sweep->label);
  rotate(turned.sweep->piece);
  return turned;
}

// West is east.
ScanInput Mirrored(const ScanInput& scan) {
  ScanInput mirrored = scan;
  const auto mirror = [](Eigen::Vector2d& place_m) { place_m.x() = -place_m.x(); };
  for (auto* pose : {&*mirrored.own, &*mirrored.own_at_start}) {
    pose->position_map_m.x() = -pose->position_map_m.x();
    pose->velocity_map_mps.x() = -pose->velocity_map_mps.x();
  }
  for (auto& seen : mirrored.seen) {
    mirror(seen.position_m);
    std::ranges::for_each(seen.outline_m, mirror);
    std::ranges::reverse(seen.outline_m);
  }
  const auto mirror_columns = [](auto& cells) {
    const auto before = cells;
    for (int column = 0; column < kColumns; ++column) {
      const auto from = before.begin() + static_cast<std::ptrdiff_t>((kColumns - column) % kColumns) * kRings;
      std::copy(from, from + kRings, cells.begin() + static_cast<std::ptrdiff_t>(column) * kRings);
    }
  };
  mirror_columns(mirrored.sweep->range_m);
  mirror_columns(mirrored.sweep->label);
  mirror_columns(mirrored.sweep->piece);
  return mirrored;
}

template <typename Change>
std::vector<ScanInput> Changed(std::vector<ScanInput> scans, const Change& change) {
  for (auto& scan : scans) scan = change(scan);
  return scans;
}

constexpr std::uint64_t kSeeds = 4;

TEST(TrackerLaw, ScansThatComeAgainGiveTheSamePictures) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto scans = Scans(Room::kNarrow, seed);
    ExpectSameToTheBit(PicturesOf(scans), PicturesOf(scans), seed);
  }
}

TEST(TrackerLaw, TheOrderOfObstaclesDecidesNothing) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto scans = Scans(Room::kNarrow, seed);
    std::mt19937_64 random(seed);
    const auto shuffled = Changed(scans, [&random](ScanInput scan) {
      std::ranges::shuffle(scan.seen, random);
      return scan;
    });
    ExpectSameToTheBit(PicturesOf(scans), PicturesOf(shuffled), seed);
  }
}

// Without tracks: all is remembered on the earth. [scans] of each piece the number of what it is of.
std::vector<std::vector<std::int32_t>> PartitionsOf(const std::vector<ScanInput>& scans) {
  Ledger ledger;
  Sight sight(Eigen::Isometry3d::Identity(), test::kLidarM, test::WallParams().max_range_m);
  std::vector<std::vector<std::int32_t>> partitions;
  partitions.reserve(scans.size());
  for (const auto& scan : scans) {
    sight.Begin(scan);
    partitions.push_back(SightingsOf(scan, sight, {}, &ledger).of_piece);
  }
  return partitions;
}

// Of things: how land falls into groups is of no account, and it does depend on the order of its pieces.
void ExpectSamePartition(const std::vector<ScanInput>& scans, const std::vector<ScanInput>& others, std::uint64_t seed) {
  const auto partitions = PartitionsOf(scans);
  const auto other_partitions = PartitionsOf(others);
  for (std::size_t scan = 0; scan < scans.size(); ++scan) {
    const auto& of_piece = partitions[scan];
    ASSERT_EQ(of_piece.size(), other_partitions[scan].size());
    for (std::size_t a = kFirstNoLand - 1; a < of_piece.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        ASSERT_EQ(of_piece[a] == of_piece[b], other_partitions[scan][a] == other_partitions[scan][b])
            << "seed " << seed << ", scan " << scan << ", pieces " << a + 1 << " and " << b + 1;
      }
    }
  }
}

TEST(TrackerLaw, WhatIsOneThingDoesNotDependOnWhereTheScanBeginsOrOnWhichSideIsWest) {
  for (const auto room : {Room::kNarrow, Room::kWide}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const auto scans = Scans(room, seed);
      ExpectSamePartition(scans, Changed(scans, Mirrored), seed);
      for (const int columns : {75, 450, 123}) {
        ExpectSamePartition(scans, Changed(scans, [columns](const ScanInput& scan) { return Turned(scan, columns); }), seed);
      }
    }
  }
}

TEST(TrackerLaw, TracksDoNotTurnWithTheBoat) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto scans = Scans(Room::kWide, seed);
    const auto pictures = PicturesOf(scans);
    for (const int columns : {75, 450, 123}) {
      ExpectSame(pictures, PicturesOf(Changed(scans, [columns](const ScanInput& scan) { return Turned(scan, columns); })), 1.0, seed);
    }
  }
}

TEST(TrackerLaw, AMirrorMirrorsTracks) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto scans = Scans(Room::kWide, seed);
    ExpectSame(PicturesOf(scans), PicturesOf(Changed(scans, Mirrored)), -1.0, seed);
  }
}

}  // namespace
}  // namespace lookout::tracker
