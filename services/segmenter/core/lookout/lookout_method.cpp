#include "services/segmenter/core/lookout/lookout_method.hpp"

#include <algorithm>

namespace lookout::segmenter {

namespace {

constexpr double kLinkedColumns = 2.8;  // LookoutParams::link grows by as many columns of 0.2 degrees

}  // namespace

Reach LinkFor(Reach link, double column_step_rad) {
  link.per_range = std::max(link.per_range, kLinkedColumns * column_step_rad);
  return link;
}

void LookoutMethod::Group(const Scan& scan, std::span<const Return> returns) {
  grid_.Fill(scan, returns, R_vessel_lidar_);
  const Reach link = LinkFor(params_.link, grid_.column_step_rad());
  runs_.Find(grid_, link);
  runs_.CutJetties(grid_);
  sets_of_runs_.Reset(static_cast<std::size_t>(runs_.size()));
  linker_.Link(grid_, runs_, link, sets_of_runs_);
  pieces_.Build(grid_, runs_, sets_of_runs_);
  land_.Find(grid_, runs_, pieces_);
  thin_.Join(grid_, pieces_);
  pieces_.Settle(grid_);
  objects_.Join(grid_, thin_, link, pieces_);
  land_.FindGroves(grid_, pieces_);

  piece_groups_.count = pieces_.size();
  piece_groups_.of_return.assign(pieces_.of_returns().begin(), pieces_.of_returns().end());
  root_of_piece_.resize(static_cast<std::size_t>(pieces_.size()));
  for (std::int32_t piece = 0; piece < pieces_.size(); ++piece) root_of_piece_[static_cast<std::size_t>(piece)] = pieces_.RootOf(piece);
  Judge();
}

void LookoutMethod::Judge() {
  const auto num_pieces = static_cast<std::size_t>(pieces_.size());
  facts_.assign(num_pieces, {});
  spans_.assign(num_pieces, {});
  const auto close = [](Span& span) {
    if (span.line >= 0) span.num_beams += span.last - span.first + 1;
  };
  // Beams between the ends of each group in each line; those of a dock stand apart, so its posts count by themselves. Runs come line by line.
  for (std::int32_t run = 0; run < runs_.size(); ++run) {
    const std::int32_t piece = pieces_.OfRun(run);
    const std::int32_t root = root_of_piece_[static_cast<std::size_t>(piece)];
    const bool is_post = pieces_.FactsOf(root).is_dock;
    Span& span = spans_[static_cast<std::size_t>(is_post ? piece : root)];
    int first = runs_[run].first - (is_post ? pieces_.ArcOf(piece) : pieces_.FactsOf(root).arc).first;
    if (first < 0) first += grid_.num_columns();
    const int last = first + runs_[run].length - 1;
    span.num_returns += runs_[run].length;
    if (span.line != runs_[run].line) {
      close(span);
      span.line = runs_[run].line;
      span.first = first;
      span.last = last;
    } else {
      span.first = std::min(span.first, first);
      span.last = std::max(span.last, last);
    }
  }
  // Columns of a group, each once however many of its pieces are in it.
  num_seen_.assign(num_pieces, 0);
  for (int column = 0; column < grid_.num_columns(); ++column) {
    const auto seen = pieces_.InColumn(column);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const std::int32_t root = root_of_piece_[static_cast<std::size_t>(seen[i].piece)];
      bool is_first = true;
      for (std::size_t j = 0; j < i && is_first; ++j) is_first = root_of_piece_[static_cast<std::size_t>(seen[j].piece)] != root;
      if (is_first) ++num_seen_[static_cast<std::size_t>(root)];
    }
  }
  for (const std::int32_t root : pieces_.roots()) {
    const auto at = static_cast<std::size_t>(root);
    const PieceFacts& piece = pieces_.FactsOf(root);
    // Of a dock, posts that are seen twice at least: four drops may stand in a rectangle too.
    const std::int32_t least = piece.is_dock ? 2 : 1;
    std::int32_t num_returns = 0;
    std::int32_t num_beams = 0;
    for (std::int32_t member = root; member != PieceTable::kNone; member = pieces_.NextMember(member)) {
      Span& span = spans_[static_cast<std::size_t>(member)];
      close(span);
      if (span.num_returns < least) continue;
      num_returns += span.num_returns;
      num_beams += span.num_beams;
    }
    GroupFacts& facts = facts_[at];
    facts.is_land = piece.is_land;
    facts.seen_share = static_cast<float>(num_seen_[at]) / static_cast<float>(std::max(1, piece.arc.num));
    if (piece.is_land) continue;
    if (num_returns < params_.sure_returns) facts.grounds |= kFewReturns;
    if (num_returns < params_.sure_fill * num_beams) facts.grounds |= kScattered;
    if (piece.min_range_m < params_.surface_range_m && piece.max_height_m + params_.lidar_above_water_m < params_.sure_height_m) {
      facts.grounds |= kAtSurface;
    }
  }
}

std::span<const std::int32_t> LookoutMethod::NearestOf(std::int32_t root) {
  nearest_.clear();
  const Arc arc = pieces_.FactsOf(root).arc;
  for (int step = 0; step < arc.num; ++step) {
    std::int32_t nearest = ScanGrid::kNone;
    for (const OutlineEntry& entry : pieces_.InColumn(grid_.Wrap(arc.first + step))) {
      if (root_of_piece_[static_cast<std::size_t>(entry.piece)] != root) continue;
      if (nearest == ScanGrid::kNone || grid_.PointOf(entry.nearest).range_m < grid_.PointOf(nearest).range_m) nearest = entry.nearest;
    }
    if (nearest != ScanGrid::kNone) nearest_.push_back(nearest);
  }
  return nearest_;
}

}  // namespace lookout::segmenter
