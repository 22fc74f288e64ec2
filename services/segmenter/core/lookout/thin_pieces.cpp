#include "services/segmenter/core/lookout/thin_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/elementary.hpp"

namespace lookout::segmenter {

namespace {

constexpr double kThinM = 0.7;  // thicker is no post
constexpr float kLeastThinRangeM = 4.0F;
// A boat that heels by 3 degrees sees a post so much higher a metre away.
constexpr double kTilt = 0.05;

// Docks, in metres. Widths: a walkway of 1.2 m to a ferry landing.
constexpr double kNarrowestDockM = 1.0;
constexpr double kWidestDockM = 3.5;
constexpr double kLeastSpacingM = 1.2;
constexpr double kSquareCosine = 0.12;  // 7 degrees off a right angle
constexpr Reach kCornerOff{0.2, 0.005};
constexpr double kSideOffM = 0.35;
constexpr double kPastCornerM = 0.3;

constexpr double kCrowdM = 8.0;  // within which more than kMostInCrowd thin things are a crowd
constexpr std::size_t kMostInCrowd = 8;
constexpr std::size_t kCells = 64;  // across the grid
constexpr double kMiddleCell = 32.0;

// FarReachM.
constexpr double kFarFromM = 15.0;
constexpr double kFarPerRange = 0.1;
constexpr double kMostFarM = 2.0;

}  // namespace

double FarReachM(double range_m) { return std::clamp(kFarPerRange * (range_m - kFarFromM), 0.0, kMostFarM); }

void ThinPieces::Join(const ScanGrid& grid, PieceTable& pieces) {
  thin_.clear();
  is_clear_.assign(static_cast<std::size_t>(pieces.size()), 0);
  for (const std::int32_t root : pieces.roots()) {
    const PieceFacts& facts = pieces.FactsOf(root);
    if (facts.is_land || facts.length_m >= kThinM || facts.min_range_m <= kLeastThinRangeM) continue;
    if (facts.max_height_m + params_.lidar_above_water_m > params_.tall_m + kTilt * facts.min_range_m) continue;  // a mast
    const std::size_t cell = CellOf(facts.mean_m.x(), facts.mean_m.y());
    thin_.push_back({root, facts.mean_m.x(), facts.mean_m.y(), facts.min_range_m, cell});
  }
  SortByCell();
  stands_.assign(static_cast<std::size_t>(pieces.size()), Stands::kUnknown);
  for (const Thin& thin : thin_) {
    if (!FindNeighbours(thin)) continue;
    is_clear_[static_cast<std::size_t>(thin.root)] = 1;
    if (params_.post_spacing_m > 0.0) JoinRectangles(grid, thin, pieces);
    JoinFar(thin, pieces);
  }
}

// Of all that is joined: the longest diagonal of a dock's rectangle.
double ThinPieces::ReachM() const { return std::max(kMostFarM, Hypot(params_.post_spacing_m, kWidestDockM)); }

// Square cells half as wide as the reach, so that neighbours are at most two cells away. What is farther off than the grid is in its rim.
std::size_t ThinPieces::CellOf(double x_m, double y_m) const {
  const double cell_m = std::max(ReachM(), kCrowdM) / 2.0;
  const auto index = [cell_m](double place_m) {
    return static_cast<std::size_t>(std::clamp(std::floor(place_m / cell_m) + kMiddleCell, 0.0, static_cast<double>(kCells - 1)));
  };
  return index(y_m) * kCells + index(x_m);
}

void ThinPieces::SortByCell() {
  begin_of_cell_.assign(kCells * kCells + 1, 0);
  for (const Thin& thin : thin_) ++begin_of_cell_[thin.cell + 1];
  for (std::size_t cell = 1; cell < begin_of_cell_.size(); ++cell) begin_of_cell_[cell] += begin_of_cell_[cell - 1];
  sorted_.resize(thin_.size());
  for (const Thin& thin : thin_) sorted_[begin_of_cell_[thin.cell]++] = thin;
  for (std::size_t cell = begin_of_cell_.size() - 1; cell > 0; --cell) begin_of_cell_[cell] = begin_of_cell_[cell - 1];
  begin_of_cell_[0] = 0;
  thin_.swap(sorted_);
}

bool ThinPieces::StandsFree(const ScanGrid& grid, const PieceTable& pieces, const Thin& thin) {
  Stands& stands = stands_[static_cast<std::size_t>(thin.root)];
  if (stands == Stands::kUnknown) stands = StandsAtAThing(grid, pieces, thin) ? Stands::kAtAThing : Stands::kFree;
  return stands == Stands::kFree;
}

// Whether something that is not thin, and no land, is within the reach of its parts: the side of a hull that is seen along shows in
// single columns, as posts do.
bool ThinPieces::StandsAtAThing(const ScanGrid& grid, const PieceTable& pieces, const Thin& thin) const {
  const double reach_m = params_.attach.At(thin.range_m);
  const auto reach_m2 = static_cast<float>(reach_m * reach_m);
  const int window = grid.ColumnsOf(reach_m, thin.range_m);
  for (std::int32_t piece = thin.root; piece != PieceTable::kNone; piece = pieces.NextMember(piece)) {
    for (const std::int32_t index : pieces.OutlineOf(piece)) {
      const OutlineEntry& entry = pieces.Entry(index);
      for (int step = -window; step <= window; ++step) {
        for (const OutlineEntry& other : pieces.InColumn(grid.Wrap(entry.column + step))) {
          const PieceFacts& facts = pieces.FactsOf(pieces.RootOf(other.piece));
          if (facts.length_m < kThinM || facts.is_land) continue;
          if (std::min(SquaredPlanDistance(entry.near_point, other.near_point), SquaredPlanDistance(entry.near_point, other.far_point)) <= reach_m2) {
            return true;
          }
        }
      }
    }
  }
  return false;
}

// Those within reach. @return false where it stands in a crowd
bool ThinPieces::FindNeighbours(const Thin& thin) {
  neighbours_.clear();
  const double reach_m2 = ReachM() * ReachM();
  const auto near = [](std::size_t index) { return std::pair(index > 1 ? index - 2 : 0, std::min(index + 2, kCells - 1)); };
  const auto [first_row, last_row] = near(thin.cell / kCells);
  const auto [first, last] = near(thin.cell % kCells);
  std::size_t num_in_crowd = 0;
  // Its own cell first: what is crowded there is crowded.
  for (std::size_t i = begin_of_cell_[thin.cell]; i < begin_of_cell_[thin.cell + 1]; ++i) {
    const double x_m = thin_[i].x_m - thin.x_m;
    const double y_m = thin_[i].y_m - thin.y_m;
    if (x_m * x_m + y_m * y_m <= kCrowdM * kCrowdM && ++num_in_crowd > kMostInCrowd + 1) return false;  // itself is one of them
  }
  num_in_crowd = 0;
  for (std::size_t row = first_row; row <= last_row; ++row) {
    for (std::size_t i = begin_of_cell_[row * kCells + first]; i < begin_of_cell_[row * kCells + last + 1]; ++i) {
      const Thin& other = thin_[i];
      if (other.root == thin.root) continue;
      const double x_m = other.x_m - thin.x_m;
      const double y_m = other.y_m - thin.y_m;
      const double distance_m2 = x_m * x_m + y_m * y_m;
      if (distance_m2 <= kCrowdM * kCrowdM && ++num_in_crowd > kMostInCrowd) return false;
      if (distance_m2 <= reach_m2) neighbours_.push_back(other);
    }
  }
  return true;
}

// With `post` at one corner: u along the width, v along the length.
void ThinPieces::JoinRectangles(const ScanGrid& grid, const Thin& post, PieceTable& pieces) {
  const auto is_post = [&](const Thin& thin) { return StandsFree(grid, pieces, thin); };
  const double off_m = kCornerOff.At(post.range_m);
  for (const Thin& across : neighbours_) {
    const double u_x_m = across.x_m - post.x_m;
    const double u_y_m = across.y_m - post.y_m;
    const double u_m = Hypot(u_x_m, u_y_m);
    if (u_m < kNarrowestDockM || u_m > kWidestDockM) continue;
    for (const Thin& along : neighbours_) {
      const double v_x_m = along.x_m - post.x_m;
      const double v_y_m = along.y_m - post.y_m;
      const double v_m = Hypot(v_x_m, v_y_m);
      if (v_m < kLeastSpacingM || v_m < u_m || v_m > params_.post_spacing_m) continue;
      if (std::abs(u_x_m * v_x_m + u_y_m * v_y_m) > kSquareCosine * u_m * v_m) continue;
      const bool has_fourth = std::ranges::any_of(neighbours_, [&](const Thin& fourth) {
        return Hypot(fourth.x_m - post.x_m - u_x_m - v_x_m, fourth.y_m - post.y_m - u_y_m - v_y_m) <= off_m && is_post(fourth);
      });
      if (!has_fourth || !is_post(post) || !is_post(across) || !is_post(along)) continue;
      pieces.MarkDock(post.root);
      const double width_m = (u_x_m * v_y_m - u_y_m * v_x_m) / v_m;  // with its sign
      for (const Thin& other : neighbours_) {
        const double x_m = other.x_m - post.x_m;
        const double y_m = other.y_m - post.y_m;
        const double along_m = (x_m * v_x_m + y_m * v_y_m) / v_m;
        const double across_m = (x_m * v_y_m - y_m * v_x_m) / v_m;
        const bool is_at_side = std::abs(across_m) < kSideOffM || std::abs(across_m - width_m) < kSideOffM;
        if (is_at_side && along_m > -kPastCornerM && along_m < v_m + kPastCornerM && is_post(other)) pieces.Join(post.root, other.root);
      }
    }
  }
}

void ThinPieces::JoinFar(const Thin& thin, PieceTable& pieces) const {
  const bool is_solid = pieces.FactsOf(thin.root).num_returns >= kSolidReturns;
  for (const Thin& other : neighbours_) {
    if (is_solid && pieces.FactsOf(other.root).num_returns >= kSolidReturns) continue;
    const double reach_m = FarReachM(std::min(thin.range_m, other.range_m));
    if (Hypot(other.x_m - thin.x_m, other.y_m - thin.y_m) <= reach_m) pieces.Join(thin.root, other.root);
  }
}

}  // namespace lookout::segmenter
