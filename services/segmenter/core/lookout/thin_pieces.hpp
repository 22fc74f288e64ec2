// The fifth step of the lookout method: what is thin, as the posts of docks are, and what is so far away that few returns are left of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/segmenter/core/lookout/lookout_params.hpp"
#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// How far apart few returns may lie and be of one thing, where nothing else stands about: nothing up to 15 m, then a metre for every 10 m of range,
/// at most 2 m. Chance seldom puts two drops of spray so near each other so far away; near the lidar it does, and small things stand by themselves.
double FarReachM(double range_m);

/// Joins thin pieces that are not of land:
/// 1. Posts that stand at the corners of a rectangle are of one dock, with those along its sides. What is higher than LookoutParams::tall_m, and
///    a boat's heel of 3 degrees more, is a mast; what has something larger beside it, within `attach`, is of that.
/// 2. Pieces at most FarReachM apart, from middle to middle, of which one has fewer than kSolidReturns.
/// Where more than eight thin things stand about, as in rain, nothing is joined.
class ThinPieces {
 public:
  static constexpr std::int32_t kSolidReturns = 4;

  explicit ThinPieces(const LookoutParams& params) : params_(params) {}

  void Join(const ScanGrid& grid, PieceTable& pieces);

  /// Whether a piece is thin and no crowd of others stands about it. As found by Join.
  bool IsClear(std::int32_t piece) const { return is_clear_[static_cast<std::size_t>(piece)] != 0; }

 private:
  struct Thin {
    std::int32_t root = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    double range_m = 0.0;
    std::size_t cell = 0;
  };

  enum class Stands : std::uint8_t { kUnknown, kFree, kAtAThing };

  double ReachM() const;
  std::size_t CellOf(double x_m, double y_m) const;
  void SortByCell();
  bool StandsFree(const ScanGrid& grid, const PieceTable& pieces, const Thin& thin);
  bool StandsAtAThing(const ScanGrid& grid, const PieceTable& pieces, const Thin& thin) const;
  bool FindNeighbours(const Thin& thin);
  void JoinRectangles(const ScanGrid& grid, const Thin& post, PieceTable& pieces);
  void JoinFar(const Thin& thin, PieceTable& pieces) const;

  LookoutParams params_;
  std::vector<Thin> thin_;  // by cell
  std::vector<Thin> sorted_;
  std::vector<std::size_t> begin_of_cell_;
  std::vector<Thin> neighbours_;
  std::vector<std::uint8_t> is_clear_;  // [pieces]
  std::vector<Stands> stands_;          // [pieces] as far as it has been asked for
};

}  // namespace lookout::segmenter
