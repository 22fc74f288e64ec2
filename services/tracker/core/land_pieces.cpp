#include "services/tracker/core/land_pieces.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace lookout::tracker {

namespace {

constexpr double kPieceUnseenS = 1.5;
constexpr double kAnchorS = 30.0;  // the own position wanders
constexpr std::size_t kMostPlaces = 24;
constexpr double kBeforeM = 1.5;
constexpr double kReachM = 1.0;  // of a place that was free, and is not now
constexpr double kPieceMoving = 0.95;
constexpr double kPieceSpeedMps = 0.3;
constexpr double kLeastWayM = 1.0;
constexpr int kLeastPlaces = 4;
constexpr double kAboveM = 0.1;  // a beam as high as that return would meet it
constexpr double kLeastShare = 0.7;
constexpr int kProofs = 8;  // scans in a row
constexpr double kGateM = 1.5;
constexpr double kMostRadiusRatio = 1.6;

}  // namespace

void LandPieces::Predict(double dt_s) {
  for (auto& piece : pieces_) piece.body.Predict(dt_s);
}

void LandPieces::Anchor(Piece& piece, const Seen& seen, const Eigen::Vector2d& from_m, Utime time) {
  piece.anchored = time;
  piece.first_m = piece.body.center_m();
  piece.stood_m.clear();
  piece.free_m.clear();
  // Of its returns those that the lidar sees first, in so many sectors.
  struct Near {
    double along;  // across the line of sight, for the order
    double range_m;
    Eigen::Vector2d place_m;
    double height_m;
  };
  const Eigen::Vector2d sight = (seen.middle_m - from_m).normalized();
  std::vector<Near> places;
  for (std::size_t i = 0; i < std::min(seen.places_m.size(), seen.heights_m.size()); ++i) {
    const Eigen::Vector2d off_m = seen.places_m[i] - from_m;
    places.push_back({Cross(sight, off_m.normalized()), off_m.norm(), seen.places_m[i], seen.heights_m[i]});
  }
  if (places.empty()) return;
  const auto [least, most] = std::ranges::minmax(places, {}, &Near::along);
  const double width = std::max(1e-9, most.along - least.along);
  std::array<const Near*, kMostPlaces> nearest{};
  for (const auto& place : places) {
    auto& of_sector = nearest[std::min(kMostPlaces - 1, static_cast<std::size_t>((place.along - least.along) / width * kMostPlaces))];
    if (of_sector == nullptr || place.range_m < of_sector->range_m) of_sector = &place;
  }
  for (const auto* place : nearest) {
    if (place == nullptr) continue;
    piece.stood_m.emplace_back(place->place_m.x(), place->place_m.y(), place->height_m);
    const Eigen::Vector2d before_m = place->place_m + kBeforeM * (from_m - place->place_m).normalized();
    if (place->range_m > 2.0 * kBeforeM) piece.free_m.emplace_back(before_m.x(), before_m.y(), place->height_m);
  }
}

bool LandPieces::HasMoved(const Piece& piece, const Seen& seen, bool is_whole, const Sight& sight) {
  if (piece.body.velocity_mps().norm() < kPieceSpeedMps) return false;
  if ((piece.body.center_m() - piece.first_m).norm() < kLeastWayM) return false;
  const auto is_now_at = [&seen](const Eigen::Vector2d& place_m, double reach_m) {
    return std::ranges::any_of(seen.places_m, [&](const Eigen::Vector2d& one) { return (one - place_m).norm() < reach_m; });
  };
  int num_left = 0;
  int num_kept = 0;
  for (const auto& stood_m : piece.stood_m) {
    const Eigen::Vector2d place_m = stood_m.head<2>();
    const double top_m = stood_m.z() + kAboveM;
    if (Contains(seen.outline_m, place_m)) continue;
    if (sight.IsFree(place_m, top_m)) {
      ++num_left;
    } else if (sight.At(std::array{place_m}, top_m).num_met > 0.0) {
      ++num_kept;
    }
  }
  if (num_left >= kLeastPlaces && num_left >= kLeastShare * (num_left + num_kept)) return true;
  // At a slant a wall is near to the water before it: that proof counts only for a piece that moves by itself, as a whole.
  if (!is_whole || !piece.body.IsMoving(kPieceMoving)) return false;
  int num_come = 0;
  int num_free = 0;
  for (const auto& before_m : piece.free_m) {
    const Eigen::Vector2d place_m = before_m.head<2>();
    if (is_now_at(place_m, kReachM)) {
      ++num_come;
    } else if (sight.IsFree(place_m, before_m.z() + kAboveM)) {
      ++num_free;
    }
  }
  return num_come >= 2 * kLeastPlaces && num_come >= kLeastShare * (num_come + num_free);
}

std::vector<LandPieces::Proven> LandPieces::Update(std::span<const Seen> seen, const Sight& sight, Utime time, std::vector<bool>& seems_moving) {
  seems_moving.assign(seen.size(), false);
  struct Pair {
    double cost;
    std::size_t piece;
    std::size_t seen;
  };
  std::vector<Pair> pairs;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const double ratio = std::max(pieces_[p].radius_m, seen[s].radius_m) / std::max(0.1, std::min(pieces_[p].radius_m, seen[s].radius_m));
      const double off_m = (seen[s].middle_m - pieces_[p].body.center_m()).norm();
      if (ratio > kMostRadiusRatio || off_m > kGateM + 0.5 * seen[s].radius_m) continue;
      pairs.push_back({off_m + 0.5 * seen[s].radius_m * (ratio - 1.0), p, s});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& pair) { return std::tuple(pair.cost, pair.piece, pair.seen); });
  std::vector<bool> is_used(seen.size(), false);
  std::vector<bool> is_proven(pieces_.size(), false);
  std::vector<Proven> proven;
  for (const auto& pair : pairs) {
    auto& piece = pieces_[pair.piece];
    const auto& one = seen[pair.seen];
    if (is_used[pair.seen] || piece.seen == time) continue;
    is_used[pair.seen] = true;
    piece.seen = time;
    ++piece.num_hits;
    piece.radius_m = one.radius_m;
    const bool is_whole = !piece.body.ShiftOf(one.outline_m, one.sides, one.noise_m2, one.range_m).is_part;
    piece.body.Update(one.outline_m, one.sides, one.noise_m2, one.range_m, true);
    piece.num_proofs = HasMoved(piece, one, is_whole, sight) ? piece.num_proofs + 1 : 0;
    seems_moving[pair.seen] = piece.num_proofs > 0;
    if (piece.num_proofs >= kProofs) {
      proven.push_back({one.index, piece.first, piece.num_hits, piece.first_m, piece.body});
      is_proven[pair.piece] = true;
    } else if (ToSeconds(time - piece.anchored) > kAnchorS && piece.num_proofs == 0) {
      Anchor(piece, one, sight.from_m(), time);
    }
  }
  std::deque<Piece> kept;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (!is_proven[p] && ToSeconds(time - pieces_[p].seen) < kPieceUnseenS) kept.push_back(std::move(pieces_[p]));
  }
  pieces_ = std::move(kept);
  for (std::size_t s = 0; s < seen.size() && pieces_.size() < kMostPieces; ++s) {
    const auto& one = seen[s];
    if (is_used[s]) continue;
    Piece piece{time, time, time, 1, 0, {}, one.radius_m, {}, {}, Body(one.outline_m, one.sides, one.noise_m2, one.range_m)};
    Anchor(piece, one, sight.from_m(), time);
    pieces_.push_back(std::move(piece));
  }
  return proven;
}

}  // namespace lookout::tracker
