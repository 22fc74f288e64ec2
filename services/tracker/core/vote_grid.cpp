#include "services/tracker/core/vote_grid.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace lookout::tracker {

namespace {

constexpr std::size_t kNoOffset = 255;
// Of a key.
constexpr unsigned kBits = 16;
constexpr std::uint64_t kMask = 0xFFFF;
constexpr std::int32_t kMostCellsOff = 32'767;

// From -kReach on.
constexpr std::size_t RowOf(std::int32_t dy) {
  const std::int32_t row = dy + VoteGrid::kReach;
  return static_cast<std::size_t>(row);
}

// The number of an offset of the half disc: (0, 0), and later ones by x, then y.
struct OffsetTable {
  std::array<std::array<std::uint8_t, static_cast<std::size_t>(2) * VoteGrid::kReach + 1>, VoteGrid::kReach + 1> number{};
  std::size_t count = 0;

  constexpr OffsetTable() {
    for (int dx = 0; dx <= VoteGrid::kReach; ++dx) {
      for (int dy = -VoteGrid::kReach; dy <= VoteGrid::kReach; ++dy) {
        const bool is_in = (dx > 0 || dy >= 0) && dx * dx + dy * dy <= VoteGrid::kReach * VoteGrid::kReach;
        number.at(static_cast<std::size_t>(dx)).at(RowOf(dy)) = is_in ? static_cast<std::uint8_t>(count++) : static_cast<std::uint8_t>(kNoOffset);
      }
    }
  }
};
constexpr OffsetTable kOffsetTable;

}  // namespace

std::size_t VoteGrid::HashOf::operator()(const Key& key) const {
  constexpr std::uint64_t kGolden = 0x9E37'79B9'7F4A'7C15U;
  const auto place = static_cast<std::uint64_t>(static_cast<std::uint32_t>(key.x)) << 32U | static_cast<std::uint32_t>(key.y);
  const std::uint64_t mixed = (place ^ (static_cast<std::uint64_t>(key.frame) * kGolden)) * kGolden;
  return static_cast<std::size_t>(mixed ^ (mixed >> 32U));
}

void VoteGrid::Begin(std::span<const std::int64_t> frame_ids, std::span<const std::int32_t> segment_of_piece, std::int64_t num_scans) {
  static_assert(kOffsetTable.count == kOffsets);
  ++scan_;
  frames_.assign(frame_ids.begin(), frame_ids.end());
  first_.assign(frame_ids.size(), std::nullopt);
  segment_of_piece_ = segment_of_piece;
  returns_.clear();
  // All at once, now and then.
  if (scan_ % std::max<std::int64_t>(1, num_scans / 4) != 0 && slot_of_.size() < kMostCells) return;
  std::int64_t oldest = scan_ - num_scans;
  if (slot_of_.size() >= kMostCells) oldest = std::max(oldest, scan_ - std::max<std::int64_t>(1, num_scans / 8));
  for (std::size_t slot = 0; slot < cells_.size(); ++slot) {
    auto& cell = cells_[slot];
    if (cell.seen == 0 || cell.seen >= oldest) continue;
    slot_of_.erase(cell.key);
    cell = {};
    free_.push_back(static_cast<std::int32_t>(slot));
  }
  if (slot_of_.size() < 4 * kMostCells) return;
  slot_of_.clear();
  cells_.clear();
  free_.clear();
}

void VoteGrid::Add(std::int32_t frame, const Eigen::Vector2d& place_m, std::int32_t piece) {
  const Eigen::Vector2d cells = place_m / cell_m_;
  const CellNumber cell{static_cast<std::int32_t>(std::floor(cells.x())), static_cast<std::int32_t>(std::floor(cells.y()))};
  auto& first = first_[static_cast<std::size_t>(frame)];
  if (!first) first = cell;
  const auto off = [](std::int32_t number, std::int32_t from) {
    return static_cast<std::uint64_t>(std::clamp(number - from, -kMostCellsOff, kMostCellsOff) + kMostCellsOff);
  };
  const std::uint64_t key = static_cast<std::uint64_t>(frame) << (3 * kBits) | off(cell.x, first->x) << (2 * kBits) | off(cell.y, first->y) << kBits |
                            static_cast<std::uint64_t>(piece);
  if (returns_.empty() || returns_.back().key != key) returns_.push_back({key, 0});
  ++returns_.back().count;
}

void VoteGrid::FindHeld() {
  held_.clear();
  entries_.clear();
  std::ranges::sort(returns_, {}, &Returns::key);
  std::uint64_t last = 0;  // frame and cell
  for (const auto& [key, count] : returns_) {
    const std::uint64_t cell_key = key >> kBits;
    const auto piece = static_cast<std::int32_t>(key & kMask);
    if (held_.empty() || cell_key != last) {
      const auto number = static_cast<std::int32_t>(entries_.size());
      const auto frame = static_cast<std::int32_t>(key >> (3 * kBits));
      const auto& first = *first_[static_cast<std::size_t>(frame)];
      held_.push_back({.frame = frame,
                       .x = first.x + static_cast<std::int32_t>(key >> (2 * kBits) & kMask) - kMostCellsOff,
                       .y = first.y + static_cast<std::int32_t>(key >> kBits & kMask) - kMostCellsOff,
                       .first = number,
                       .end = number});
      last = cell_key;
    }
    auto& cell = held_.back();
    if (cell.first == cell.end || entries_.back().piece != piece) {
      entries_.push_back({piece, segment_of_piece_[static_cast<std::size_t>(piece)], 0});
      ++cell.end;
    }
    entries_.back().count += count;
    cell.count += count;
  }
  if (content_ == Content::kMostOf) KeepMajority();
}

// The cells' memory.
void VoteGrid::RememberHeld() {
  for (auto& cell : held_) {
    const Key key{frames_[static_cast<std::size_t>(cell.frame)], cell.x, cell.y};
    const auto [found, is_new] = slot_of_.try_emplace(key, 0);
    if (is_new) {
      if (free_.empty()) {
        found->second = static_cast<std::int32_t>(cells_.size());
        cells_.emplace_back();
      } else {
        found->second = free_.back();
        free_.pop_back();
      }
      cells_[static_cast<std::size_t>(found->second)].key = key;
    }
    cell.slot = found->second;
    auto& known = cells_[static_cast<std::size_t>(cell.slot)];
    known.seen = scan_;
    cell.age = known.age++;
  }
}

// A piece that shares a cell with more of another piece says nothing of that cell.
void VoteGrid::KeepMajority() {
  for (auto& cell : held_) {
    std::map<std::int32_t, int> count_of;
    for (const auto& entry : EntriesOf(cell)) count_of[entry.segment] += entry.count;
    if (count_of.size() < 2) continue;
    int most = 0;
    for (const auto& [segment, count] : count_of) most = std::max(most, count);
    const auto first = entries_.begin() + cell.first;
    const auto end = std::stable_partition(first, entries_.begin() + cell.end, [&](const Entry& entry) { return count_of[entry.segment] == most; });
    cell.end = static_cast<std::int32_t>(end - entries_.begin());
    cell.count = 0;
    for (const auto& entry : EntriesOf(cell)) cell.count += entry.count;
  }
}

// How likely a return of one piece and a return of the other are of one segment, from -1 to 1.
float VoteGrid::VoteOf(const Held& one, const Held& other) const {
  const auto ones = EntriesOf(one);
  const auto others = EntriesOf(other);
  if (ones.size() == 1 && others.size() == 1) return ones[0].segment == others[0].segment ? 1.0F : -1.0F;
  double num_same = 0.0;
  for (const auto& a : ones) {
    for (const auto& b : others) num_same += a.segment == b.segment ? static_cast<double>(a.count) * b.count : 0.0;
  }
  return static_cast<float>(2.0 * num_same / (static_cast<double>(one.count) * other.count) - 1.0);
}

template <typename Take>
void VoteGrid::ForPairs(const Take& take) {
  pairs_.clear();
  std::array<std::size_t, kReach + 1> begin{};
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const Held& one = held_[i];
    for (int dx = 0; dx <= kReach; ++dx) {
      auto& from = begin.at(static_cast<std::size_t>(dx));
      const auto is_before = [&](const Held& other) {
        return std::tuple(other.frame, other.x, other.y) < std::tuple(one.frame, one.x + dx, one.y - kReach);
      };
      while (from < held_.size() && is_before(held_[from])) ++from;
      for (std::size_t j = std::max(from, i); j < held_.size(); ++j) {
        const Held& other = held_[j];
        if (other.frame != one.frame || other.x != one.x + dx || other.y > one.y + kReach) break;
        const int dy = other.y - one.y;
        const std::size_t offset = kOffsetTable.number.at(static_cast<std::size_t>(dx)).at(RowOf(dy));
        if (offset != kNoOffset)
          pairs_.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), dx * dx + dy * dy, take(one, other, offset)});
      }
    }
  }
}

void VoteGrid::Vote(float fade, Weight weight) {
  constexpr int kMostReturns = 10;
  FindHeld();
  RememberHeld();
  ForPairs([&](const Held& one, const Held& other, std::size_t offset) {
    const float by_returns = std::sqrt(static_cast<float>(std::min(one.count, kMostReturns) * std::min(other.count, kMostReturns))) / kMostReturns;
    auto& vote = cells_[static_cast<std::size_t>(one.slot)].votes.at(offset);
    vote.Add(VoteOf(one, other), weight == Weight::kByReturns ? by_returns : 1.0F, fade);
    return vote.mean();
  });
}

void VoteGrid::FindPairs() {
  FindHeld();
  ForPairs([](const Held&, const Held&, std::size_t) { return 0.0F; });
}

void VoteGrid::Clear() {
  slot_of_.clear();
  cells_.clear();
  free_.clear();
  scan_ = 0;
}

}  // namespace lookout::tracker
