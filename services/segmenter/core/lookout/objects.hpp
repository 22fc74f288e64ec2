// The sixth step of the lookout method: pieces that are of one object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"
#include "services/segmenter/core/lookout/thin_pieces.hpp"

namespace lookout::segmenter {

/// Joins pieces that are not of land, in two rounds:
/// 1. Pieces side by side, at most `join` apart: nothing passes between them.
/// 2. Parts, each attached to the nearest thing that it may be a part of, and to nothing else, so that no part becomes a bridge between two boats:
///    what is at most `attach_length_m` long, at most `attach` off: a paddler, a transom; and what is seen over a nearer thing, within its columns,
///    at most `over_m` behind: the cabin over the hull, the mast behind the rail.
/// Pieces of fewer than kSolidReturns returns join nothing together, and are attached far away alone (FarReachM) where no others stand about: a drop
/// of spray beside a hull is of the hull only where it touches it.
class ObjectJoiner {
 public:
  explicit ObjectJoiner(const LookoutParams& params) : params_(params) {}

  /// @param thin  as found in the same pieces
  void Join(const ScanGrid& grid, const ThinPieces& thin, const Reach& link, PieceTable& pieces);

 private:
  struct Link {
    std::int32_t one = 0;  // single pieces
    std::int32_t other = 0;
    double gap_m = 0.0;
    bool has_tiny = false;  // one of them has fewer than kSolidReturns: joined to something, it joins no more
  };

  // A piece of kSolidReturns or more, as far as it takes to pass over pairs that are far apart.
  struct Solid {
    double x_m = 0.0;  // its middle
    double y_m = 0.0;
    double radius_m = 0.0;
    double reach_m = 0.0;  // the farthest it may be joined over
    std::int32_t piece = 0;
    std::int32_t root = 0;
    bool is_crowded = false;
  };

  // To what a part may be attached.
  struct Nearest {
    double gap_m = std::numeric_limits<double>::infinity();
    std::int32_t whole = PieceTable::kNone;
    bool is_tied = false;
  };

  // What a piece of fewer returns shows in one column.
  struct Tiny {
    float nearest_m = 0.0F;
    float farthest_m = 0.0F;
    std::int32_t piece = 0;
  };

  void FindLinks(const ScanGrid& grid, const ThinPieces& thin, const PieceTable& pieces);
  void ListTiny(const ScanGrid& grid, const PieceTable& pieces);
  void FindCrowds();
  void LinkPairs(const ScanGrid& grid, const PieceTable& pieces);
  void LinkSolid(const ScanGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other);
  void LinkTiny(const ScanGrid& grid, const ThinPieces& thin, const PieceTable& pieces, std::int32_t piece);
  double ReachM(const PieceFacts& facts) const;
  void JoinSideBySide(PieceTable& pieces) const;
  template <typename IsAttached>
  void Attach(PieceTable& pieces, IsAttached is_attached);
  bool Touches(const PieceFacts& part, const PieceFacts& whole, double gap_m) const;
  bool IsPart(const ScanGrid& grid, const PieceFacts& part, bool is_part_clear, const PieceFacts& whole, double gap_m) const;

  LookoutParams params_;
  Reach link_;
  std::vector<Link> links_;
  std::vector<Solid> solid_;                // by the x of their middle
  std::vector<std::size_t> large_;          // of solid_
  std::vector<Tiny> tiny_;                  // by column
  std::vector<std::size_t> begin_of_tiny_;  // [columns + 1]
  std::vector<std::uint8_t> is_tiny_;       // [pieces]
  std::vector<std::int32_t> seen_by_;       // [pieces] the last piece that has looked at it
  std::vector<Nearest> nearest_;            // [pieces] of roots
};

}  // namespace lookout::segmenter
