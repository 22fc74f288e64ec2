#include "services/tracker/core/ledger.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

// Chosen on families of scenes; all of them are flat (DECISIONS.md).
constexpr float kFade = 0.98F;         // of a vote, from scan to scan
constexpr double kFineReachM = 0.8;    // over which evidence falls to 1/e
constexpr double kCoarseReachM = 3.0;  // the same, of cells of 2 m
constexpr double kCoarseWeight = 0.3;  // as cells of 0.5 m count 1
// Of so many, as in rain, only those with some returns count in coarse cells, where each has hundreds of neighbours.
constexpr std::size_t kManyPieces = 1000;
constexpr std::size_t kReturnsOfMany = 3;
// Drops meet each other by the square of their number: 16 rings see 120 000 pairs in heavy rain, 128 rings millions. Beyond so many, segments of a
// single return have no neighbours at all.
constexpr std::size_t kMostPairs = 500'000;
constexpr double kLandVote = 0.3;       // above it a piece is land
constexpr float kLandEvidence = 2.0F;   // that two pieces of land beside each other are one
constexpr std::int32_t kOldScans = 10;  // a thing seen there for so long is no part of one that moves past it
constexpr std::int64_t kMemoryScans = 200;

std::size_t IndexOf(std::int32_t number) { return static_cast<std::size_t>(number); }

}  // namespace

void Ledger::Sums::Begin(std::size_t num_pieces) {
  constexpr std::size_t kSlotsPerPiece = 16;
  pairs_.clear();
  slots_.assign(std::bit_ceil(kSlotsPerPiece * (num_pieces + 1)), -1);
}

std::size_t Ledger::Sums::SlotOf(std::int32_t one, std::int32_t other) const {
  // Fibonacci hashing, as neighbours have numbers that follow each other.
  constexpr std::uint64_t kGolden = 0x9E37'79B9'7F4A'7C15U;
  const std::uint64_t key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(one)) << 32U | static_cast<std::uint32_t>(other);
  std::size_t slot = static_cast<std::size_t>((key * kGolden) >> 32U) & (slots_.size() - 1);
  for (; slots_[slot] >= 0; slot = (slot + 1) & (slots_.size() - 1)) {
    const auto& pair = pairs_[IndexOf(slots_[slot])];
    if (pair.one == one && pair.other == other) break;
  }
  return slot;
}

Ledger::Sums::Met Ledger::Sums::Of(std::int32_t one, std::int32_t other) {
  if (one > other) std::swap(one, other);
  if (2 * pairs_.size() >= slots_.size()) Grow();
  const std::size_t slot = SlotOf(one, other);
  const bool is_first = slots_[slot] < 0;
  if (is_first) {
    slots_[slot] = static_cast<std::int32_t>(pairs_.size());
    pairs_.push_back({one, other, 0.0F, 0.0F});
  }
  return {pairs_[IndexOf(slots_[slot])].log_odds, is_first};
}

float Ledger::Sums::Find(std::int32_t one, std::int32_t other) const {
  if (slots_.empty()) return 0.0F;
  const std::int32_t at = slots_[SlotOf(std::min(one, other), std::max(one, other))];
  return at < 0 ? 0.0F : pairs_[IndexOf(at)].log_odds;
}

void Ledger::Sums::Grow() {
  slots_.assign(2 * slots_.size(), -1);
  for (std::size_t i = 0; i < pairs_.size(); ++i) slots_[SlotOf(pairs_[i].one, pairs_[i].other)] = static_cast<std::int32_t>(i);
}

const Ledger::Groups& Ledger::Divide(std::span<const Piece> pieces, std::span<const Frame> frames) {
  TakeNote(pieces, frames);
  FindLone(pieces);
  FindLand(pieces);
  sums_.Begin(pieces.size());
  AddEvidence(fine_, kFineReachM, 1.0);
  AddEvidence(coarse_, kCoarseReachM, kCoarseWeight);
  if (frames.size() > 1) AddEvidenceAcross(pieces);
  AddEvidenceOfLand(pieces);
  partition_.Find(static_cast<std::int32_t>(pieces.size()), sums_.pairs(), 0.0F);
  Group(pieces);
  return groups_;
}

void Ledger::FindLone(std::span<const Piece> pieces) {
  is_lone_.assign(pieces.size(), 0);
  std::size_t num_pairs = 0;
  for (const auto& pair : fine_.pairs()) {
    num_pairs += fine_.EntriesOf(fine_.held()[IndexOf(pair.one)]).size() * fine_.EntriesOf(fine_.held()[IndexOf(pair.other)]).size();
  }
  if (num_pairs <= kMostPairs) return;
  std::vector<std::int32_t> segments = segments_;
  std::ranges::sort(segments);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].places_m.size() > 1) continue;
    const auto [first, last] = std::equal_range(segments.begin(), segments.end(), pieces[i].segment);
    is_lone_[i] = last - first == 1 ? 1 : 0;
  }
}

void Ledger::TakeNote(std::span<const Piece> pieces, std::span<const Frame> frames) {
  std::vector<std::int64_t> ids;
  ids.reserve(frames.size());
  for (const auto& frame : frames) ids.push_back(frame.id);
  segments_.clear();
  for (const auto& piece : pieces) segments_.push_back(piece.segment);
  fine_.Begin(ids, segments_, kMemoryScans);
  coarse_.Begin(ids, segments_, kMemoryScans);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto frame = pieces[i].frame;
    const bool is_coarse = pieces.size() <= kManyPieces || pieces[i].places_m.size() >= kReturnsOfMany;
    for (const auto& place_m : pieces[i].places_m) {
      const Eigen::Vector2d here_m = frames[IndexOf(frame)].T_frame_map * place_m;
      fine_.Add(frame, here_m, static_cast<std::int32_t>(i));
      if (is_coarse) coarse_.Add(frame, here_m, static_cast<std::int32_t>(i));
    }
  }
  fine_.Vote(kFade, VoteGrid::Weight::kOne);
  coarse_.Vote(kFade, VoteGrid::Weight::kByReturns);
}

void Ledger::FindLand(std::span<const Piece> pieces) {
  land_.assign(pieces.size(), 0.0);
  old_.assign(pieces.size(), 0.0);
  for (const auto& cell : fine_.held()) {
    double vote = 0.0;
    for (const auto& entry : fine_.EntriesOf(cell)) vote += pieces[IndexOf(entry.piece)].is_land ? entry.count : -entry.count;
    auto& own = fine_.OwnVote(cell);
    own.Add(static_cast<float>(vote / cell.count), 1.0F, kFade);
    for (const auto& entry : fine_.EntriesOf(cell)) {
      const auto piece = IndexOf(entry.piece);
      const double share = entry.count / static_cast<double>(pieces[piece].places_m.size());
      land_[piece] += share * static_cast<double>(own.mean());
      if (cell.age >= kOldScans) old_[piece] += share;
    }
  }
}

bool Ledger::IsLand(std::int32_t piece) const { return land_[IndexOf(piece)] > kLandVote; }

void Ledger::AddEvidence(const VoteGrid& grid, double reach_m, double weight) {
  // By the square of the distance in cells.
  std::array<float, static_cast<std::size_t>(VoteGrid::kReach) * VoteGrid::kReach + 1> nearness{};
  for (std::size_t i = 0; i < nearness.size(); ++i) {
    nearness.at(i) = static_cast<float>(weight * Exp(-grid.cell_m() * std::sqrt(static_cast<double>(i)) / reach_m));
  }
  for (const auto& pair : grid.pairs()) {
    const auto& one = grid.held()[IndexOf(pair.one)];
    const auto& other = grid.held()[IndexOf(pair.other)];
    const auto ones = grid.EntriesOf(one);
    const auto others = grid.EntriesOf(other);
    if (ones.size() == 1 && others.size() == 1 && ones[0].piece == others[0].piece) continue;
    // Of two cells the evidence is mean x sqrt(n1 n2), shared out by the returns of each piece.
    const float evidence =
        pair.mean * nearness.at(IndexOf(pair.distance2)) / std::sqrt(static_cast<float>(one.count) * static_cast<float>(other.count));
    for (const auto& a : ones) {
      if (is_lone_[IndexOf(a.piece)] != 0) continue;
      for (const auto& b : others) {
        if (is_lone_[IndexOf(b.piece)] != 0) continue;
        if (a.piece == b.piece || (pair.one == pair.other && a.piece > b.piece)) continue;
        auto met = sums_.Of(a.piece, b.piece);
        if (met.is_first && IsLand(a.piece) && IsLand(b.piece)) met.evidence += kLandEvidence;
        met.evidence += evidence * static_cast<float>(a.count) * static_cast<float>(b.count);
      }
    }
  }
}

void Ledger::AddEvidenceAcross(std::span<const Piece> pieces) {
  constexpr std::array<std::int64_t, 1> kMap{0};
  across_.Begin(kMap, segments_, 1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (is_lone_[i] != 0) continue;
    for (const auto& place_m : pieces[i].places_m) across_.Add(0, place_m, static_cast<std::int32_t>(i));
  }
  across_.FindPairs();
  for (const auto& pair : across_.pairs()) {
    const auto& one = across_.held()[IndexOf(pair.one)];
    const auto& other = across_.held()[IndexOf(pair.other)];
    const double near = Exp(-across_.cell_m() * std::sqrt(static_cast<double>(pair.distance2)) / kFineReachM);
    const double evidence = near / std::sqrt(static_cast<double>(one.count) * other.count);
    for (const auto& a : across_.EntriesOf(one)) {
      for (const auto& b : across_.EntriesOf(other)) {
        const auto& first = pieces[IndexOf(a.piece)];
        const auto& second = pieces[IndexOf(b.piece)];
        if (a.piece == b.piece || first.frame == second.frame || (pair.one == pair.other && a.piece > b.piece)) continue;
        const bool both_move = first.frame != 0 && second.frame != 0;
        const double old_first = both_move || first.frame == 0 ? old_[IndexOf(a.piece)] : 0.0;
        const double old_second = both_move || second.frame == 0 ? old_[IndexOf(b.piece)] : 0.0;
        const double vote = first.segment == second.segment ? 1.0 - 2.0 * std::max(old_first, old_second) : -1.0;
        sums_.Of(a.piece, b.piece).evidence += static_cast<float>(vote * evidence * a.count * b.count);
      }
    }
  }
}

// Pieces of one segment of land are neighbours at any distance.
void Ledger::AddEvidenceOfLand(std::span<const Piece> pieces) {
  std::map<std::int32_t, std::int32_t> last_of;  // by segment
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto piece = static_cast<std::int32_t>(i);
    if (!pieces[i].is_land || !IsLand(piece)) continue;
    const auto [last, is_first] = last_of.try_emplace(pieces[i].segment, piece);
    if (!is_first) {
      auto met = sums_.Of(last->second, piece);
      if (met.is_first) met.evidence += kLandEvidence;
    }
    last->second = piece;
  }
}

void Ledger::Group(std::span<const Piece> pieces) {
  groups_.of_piece.assign(partition_.group_of_piece().begin(), partition_.group_of_piece().end());
  groups_.land.assign(IndexOf(partition_.count()), 0.0);
  std::vector<double> num_returns(groups_.land.size(), 0.0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto group = IndexOf(groups_.of_piece[i]);
    const auto count = static_cast<double>(pieces[i].places_m.size());
    groups_.land[group] += count * land_[i];
    num_returns[group] += count;
  }
  for (std::size_t group = 0; group < num_returns.size(); ++group) groups_.land[group] /= num_returns[group];
  between_.Begin(groups_.land.size());
  for (const auto& pair : sums_.pairs()) {
    const std::int32_t one = groups_.of_piece[IndexOf(pair.one)];
    const std::int32_t other = groups_.of_piece[IndexOf(pair.other)];
    if (one != other) between_.Of(one, other).evidence += pair.log_odds;
  }
}

void Ledger::Clear() {
  fine_.Clear();
  coarse_.Clear();
  between_.Begin(0);
}

}  // namespace lookout::tracker
