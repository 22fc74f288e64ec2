// The fifth step of the lookout method: pieces that are of one object.
#pragma once

#include <cstdint>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/turn_grid.hpp"

namespace lookout::segmenter {

/// Joins pieces that are not of land:
/// 1. Posts that stand at the corners of a rectangle are of one dock, with those along its sides. What is higher than LookoutParams::tall_m is a
/// mast,
///    and where more than eight thin things stand about, as in rain, nothing is taken for a post.
/// 2. Two rounds: pieces side by side, at most `join` apart; and a piece that is seen over a nearer one, within its columns: the cabin over the hull,
///    the mast behind the rail.
/// Pieces of fewer than kSolidReturns returns join nothing together: a drop of spray beside a hull is of the hull only where it touches it.
class ObjectJoiner {
 public:
  explicit ObjectJoiner(const LookoutParams& params) : params_(params) {}

  void JoinDocks(PieceTable& pieces);
  void JoinObjects(const TurnGrid& grid, PieceTable& pieces, const Reach& link);

  static constexpr std::int32_t kSolidReturns = 4;

 private:
  struct Link {
    std::int32_t one = 0;  // single pieces
    std::int32_t other = 0;
    double gap_m = 0.0;
  };
  struct Post {
    std::int32_t root = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    double range_m = 0.0;
    std::size_t cell = 0;
  };

  // A piece of kSolidReturns or more, as far as it takes to pass over pairs that are far apart.
  struct Solid {
    double x_m = 0.0;  // its middle
    double y_m = 0.0;
    double radius_m = 0.0;
    double reach_m = 0.0;  // the farthest it may be joined over
    std::int32_t piece = 0;
    bool is_crowded = false;
  };

  // What a piece of fewer returns shows in one column.
  struct Tiny {
    float nearest_m = 0.0F;
    float farthest_m = 0.0F;
    std::int32_t piece = 0;
  };

  void FindLinks(const TurnGrid& grid, const PieceTable& pieces);
  void ListTiny(const TurnGrid& grid, const PieceTable& pieces);
  void FindCrowds();
  void LinkPairs(const TurnGrid& grid, const PieceTable& pieces);
  void LinkSolid(const TurnGrid& grid, const PieceTable& pieces, std::int32_t one, std::int32_t other);
  void LinkTiny(const TurnGrid& grid, const PieceTable& pieces, std::int32_t piece);
  double OverReachM(const PieceFacts& facts) const;
  bool AreOfOneObject(const TurnGrid& grid, const PieceFacts& one, const PieceFacts& other, double gap_m) const;
  void SortPosts();
  std::size_t CellOf(double x_m, double y_m) const;
  double ReachM() const;
  void FindNeighbours(const Post& post);
  void JoinRectangles(const Post& post, PieceTable& pieces) const;

  LookoutParams params_;
  Reach link_;
  std::vector<Link> links_;
  std::vector<Solid> solid_;                // by the x of their middle
  std::vector<std::size_t> large_;          // of solid_
  std::vector<Tiny> tiny_;                  // by column
  std::vector<std::size_t> begin_of_tiny_;  // [columns + 1]
  std::vector<std::uint8_t> is_tiny_;       // [pieces]
  std::vector<std::int32_t> seen_by_;       // [pieces] the last piece that has looked at it
  std::vector<Post> posts_;                 // by cell
  std::vector<Post> sorted_;
  std::vector<std::size_t> begin_of_cell_;
  std::vector<Post> neighbours_;
};

}  // namespace lookout::segmenter
