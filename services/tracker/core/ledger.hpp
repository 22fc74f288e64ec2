// Votes of earlier scans on neighbouring places: that they are of one thing, or of two, and that they are land.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/partition.hpp"
#include "services/tracker/core/vote_grid.hpp"

namespace lookout::tracker {

/// The segmenter decides anew in each scan which pieces are one thing, and its errors flicker. The ledger keeps its decisions by place: for each pair
/// of neighbouring cells the mean vote of the scans that saw both, the last scans most. Whether two pieces are one thing in a scan is then a sum of
/// evidence over all pairs of cells, one of each piece: the mean vote, which counts less with distance and more with returns. Two pieces of land
/// touch weakly, so being land counts as evidence, too.
///
/// Standing things are remembered on the earth, moving ones in a frame that moves and turns with them. Between two frames the scan alone decides; but
/// a thing that was there for a while is no part of one that moves past it.
class Ledger {
 public:
  /// One piece of the scan (segments_t), which the segmenter does not cut.
  struct Piece {
    std::int32_t segment = 0;                   // any number, the same for all pieces of a segment
    bool is_land = false;                       // as its segment is called in this scan
    std::int32_t frame = 0;                     // index of the frames
    std::span<const Eigen::Vector2d> places_m;  // its returns on the map, at least one
  };
  /// A frame in which places are remembered.
  struct Frame {
    std::int64_t id = 0;                                            // 0: the earth; each moving thing has its own, which is not used again
    Eigen::Isometry2d T_frame_map = Eigen::Isometry2d::Identity();  // now
  };
  struct Groups {
    std::vector<std::int32_t> of_piece;  // [pieces] numbered from 0 in the order of their first piece
    std::vector<double> land;            // [groups] mean vote that it is land, -1 to 1
  };

  /// Adds the votes of a scan, and decides which of its pieces are one thing. Cells that have not been seen in the last 200 scans are forgotten.
  ///
  /// @param frames  the first is the earth
  /// @return until the next call
  /// Cost: proportional to the pairs of pieces in cells that are 2.5 m apart at most; figures in the bench. Of very many pairs those with a
  /// segment of a single return are left out. Memory: VoteGrid.
  const Groups& Divide(std::span<const Piece> pieces, std::span<const Frame> frames);

  /// Evidence between two groups of the last call: 0 or below; 0 where nothing was measured between them.
  float EvidenceBetween(std::int32_t one, std::int32_t other) const { return between_.Find(one, other); }

  void Clear();

 private:
  // Evidence of pairs of pieces, in the order in which these were met first.
  class Sums {
   public:
    void Begin(std::size_t num_pieces);
    struct Met {
      float& evidence;
      bool is_first;
    };
    Met Of(std::int32_t one, std::int32_t other);
    float Find(std::int32_t one, std::int32_t other) const;  // 0: none
    std::span<const EvidencePair> pairs() const { return pairs_; }

   private:
    void Grow();
    std::size_t SlotOf(std::int32_t one, std::int32_t other) const;

    std::vector<EvidencePair> pairs_;
    std::vector<std::int32_t> slots_;  // open hash table: index of pairs_, or -1
  };

  // Where there are very many pairs: finds segments of a single return, which then have no neighbours.
  void FindLone(std::span<const Piece> pieces);
  void TakeNote(std::span<const Piece> pieces, std::span<const Frame> frames);
  void FindLand(std::span<const Piece> pieces);
  void AddEvidence(const VoteGrid& grid, double reach_m, double weight);
  void AddEvidenceAcross(std::span<const Piece> pieces);
  void AddEvidenceOfLand(std::span<const Piece> pieces);
  bool IsLand(std::int32_t piece) const;
  void Group(std::span<const Piece> pieces);

  std::vector<std::int32_t> segments_;  // [pieces]
  std::vector<std::uint8_t> is_lone_;   // [pieces] 1: without neighbours
  VoteGrid fine_{0.5, VoteGrid::Content::kAll};
  VoteGrid coarse_{2.0, VoteGrid::Content::kMostOf};
  VoteGrid across_{0.5, VoteGrid::Content::kAll};  // of this scan only, on the map
  std::vector<double> land_;                       // [pieces] mean vote of its cells, by returns
  std::vector<double> old_;                        // [pieces] share of its returns where something was seen for a while
  Sums sums_;
  Sums between_;  // groups
  Partition partition_{Linkage::kSum};
  Groups groups_;
};

}  // namespace lookout::tracker
