// Votes of scans on pairs of neighbouring cells, remembered.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace lookout::tracker {

/// A mean of votes from -1 to 1, in which the last votes count most.
class MeanVote {
 public:
  /// @param fade  weight of an earlier vote when one more comes
  void Add(float vote, float weight, float fade) {
    weight_ = fade * weight_ + weight;
    if (weight_ > 0.0F) mean_ += weight / weight_ * (vote - mean_);
  }
  float mean() const { return mean_; }
  float weight() const { return weight_; }

 private:
  float mean_ = 0.0F;
  float weight_ = 0.0F;
};

/// Square cells of a plane, or of several (frames), with a mean vote for each pair of cells at most kReach cells apart.
///
/// Memory: 400 bytes a cell. A cell that is not seen for num_scans scans is forgotten; with more than kMostCells cells, after an eighth of that; with
/// more than four times as many (32 MB), all cells are.
class VoteGrid {
 public:
  static constexpr std::int32_t kReach = 5;  // cells
  static constexpr std::size_t kMostCells = 20'000;

  /// The segments that a cell stands for: all that have returns in it, or the one with most returns (all of these, where several have as many).
  enum class Content { kAll, kMostOf };
  /// The weight of a vote: one, or more with the returns of both cells.
  enum class Weight { kOne, kByReturns };

  VoteGrid(double cell_m, Content content) : cell_m_(cell_m), content_(content) {}

  /// Returns of one piece in one cell.
  struct Entry {
    std::int32_t piece = 0;
    std::int32_t segment = 0;
    std::int32_t count = 0;
  };
  /// A cell that holds returns in this scan.
  struct Held {
    std::int32_t frame = 0;
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t first = 0;  // of the entries
    std::int32_t end = 0;
    std::int32_t count = 0;  // returns
    std::int32_t slot = 0;
    std::int32_t age = 0;  // number of earlier scans that saw the cell
  };
  /// Two held cells at most kReach apart, the first before the second, or a cell with itself.
  struct Pair {
    std::int32_t one = 0;
    std::int32_t other = 0;
    std::int32_t distance2 = 0;  // cells, squared
    float mean = 0.0F;           // of the votes, with that of this scan
  };

  /// Begins a scan. Cells that were not seen in the last num_scans are forgotten.
  /// @param frame_ids         frames of this scan, at most 65 536
  /// @param segment_of_piece  at most 65 536 pieces
  void Begin(std::span<const std::int64_t> frame_ids, std::span<const std::int32_t> segment_of_piece, std::int64_t num_scans);
  /// @param frame, piece  indices of those of Begin
  /// @param place_m       at most 32 767 cells from the frame's first place in this scan; a farther place counts as that far
  void Add(std::int32_t frame, const Eigen::Vector2d& place_m, std::int32_t piece);
  /// Ends the scan: each pair votes, 1 for one segment, -1 for two, between them where a cell holds several segments.
  /// @param fade  weight of earlier votes
  void Vote(float fade, Weight weight);
  /// In place of Vote: pairs of this scan, without votes or memory.
  void FindPairs();

  std::span<const Held> held() const { return held_; }
  std::span<const Pair> pairs() const { return pairs_; }
  std::span<const Entry> EntriesOf(const Held& cell) const {
    return std::span(entries_).subspan(static_cast<std::size_t>(cell.first), static_cast<std::size_t>(cell.end - cell.first));
  }
  /// A further vote of a cell, of itself alone: the ledger's vote that it is land.
  MeanVote& OwnVote(const Held& cell) { return cells_[static_cast<std::size_t>(cell.slot)].own; }

  void Clear();
  std::size_t num_cells() const { return slot_of_.size(); }
  double cell_m() const { return cell_m_; }

 private:
  static constexpr std::size_t kOffsets = 41;  // of half a disc of radius kReach, with its middle
  struct Key {
    std::int64_t frame = 0;
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const Key&) const = default;
  };
  struct HashOf {
    std::size_t operator()(const Key& key) const;
  };
  struct Cell {
    Key key;
    std::int64_t seen = 0;  // scan
    std::int32_t age = 0;
    MeanVote own;
    std::array<MeanVote, kOffsets> votes{};
  };
  struct CellNumber {
    std::int32_t x = 0;
    std::int32_t y = 0;
  };
  // Returns of one piece in one cell that follow each other.
  struct Returns {
    std::uint64_t key = 0;  // frame, x, y from that of the frame's first return, piece: 16 bits each
    std::int32_t count = 0;
  };

  void FindHeld();
  void KeepMajority();
  void RememberHeld();
  template <typename Take>
  void ForPairs(const Take& take);
  float VoteOf(const Held& one, const Held& other) const;

  double cell_m_;
  Content content_;
  std::int64_t scan_ = 0;
  std::vector<std::int64_t> frames_;
  std::vector<std::optional<CellNumber>> first_;  // [frames] cell of the first return
  std::span<const std::int32_t> segment_of_piece_;
  std::unordered_map<Key, std::int32_t, HashOf> slot_of_;  // looked up only: its order decides nothing
  std::vector<Cell> cells_;
  std::vector<std::int32_t> free_;
  std::vector<Returns> returns_;
  std::vector<Entry> entries_;
  std::vector<Held> held_;
  std::vector<Pair> pairs_;
};

}  // namespace lookout::tracker
