// Pairs of neighbouring pieces, and the features of each pair that say whether the two are one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "services/segmenter/core/lookout/pieces.hpp"
#include "services/segmenter/core/lookout/reach.hpp"
#include "services/segmenter/core/lookout/scan_grid.hpp"

namespace lookout::segmenter {

/// Features of a pair. "Small" and "large" are the pieces of less and of greater width, "front" and "back" the nearer and the farther one where they
/// come closest. Heights are over the water at rest. None depends on which piece is named first.
enum class PairFeature : std::uint8_t {
  kRange,           // m, where the two come closest
  kGap,             // m, seen from above
  kFreeGap,         // m, the part of the gap that nothing nearer hides
  kGapAngle,        // deg, between their columns there; 0 where they share columns
  kRadialGap,       // m, how much farther the back is there
  kRadialGapRings,  // kRadialGap over the distance at which the next ring would meet calm water
  kRiseGap,         // deg, between their rings there; 0 where they share rings
  kStepUp,          // m, from the top of the front to the bottom of the back, there
  kOverlap,         // columns that their arcs share, over those of the lesser arc
  kFaced,           // columns in which one stands within a metre of the other, over those of the lesser arc
  kSeenThrough,     // share of the beams between them that met something farther than both
  kHidden,          // share of the beams between them that met something nearer than both
  kSmallAngle,      // deg^2, the part of the sphere that its beams see
  kLargeAngle,      // deg^2
  kSmallWidth,      // m, across the line of sight
  kLargeWidth,      // m
  kSmallDepth,      // m, along the line of sight
  kLargeDepth,      // m
  kUnionLength,     // m, at most: distance of the means and both radii
  kSmallTop,        // m
  kLargeTop,        // m
  kSmallBottom,     // m
  kLargeBottom,     // m
  kSmallFill,       // returns over beams between its ends
  kLargeFill,
  kOffLine,      // m, from the mean of the small to the line through the large
  kLargeOff,     // m, root mean square of the large off that line
  kLargeLength,  // m, along that line
  kSmallLength,  // m, along the line through the small
  kParallel,     // cosine of the angle between the two lines
  kTopStep,      // m, between their tops
  kBottomStep,   // m, between their bottoms
  kNum
};
inline constexpr std::size_t kNumPairFeatures = static_cast<std::size_t>(PairFeature::kNum);
/// As they stand in the file of weights.
inline constexpr std::array<std::string_view, kNumPairFeatures> kPairFeatureNames{
    "range_m",       "gap_m",         "free_gap_m",     "gap_deg",        "radial_gap_m",   "radial_gap_rings", "rise_gap_deg",   "step_up_m",
    "overlap",       "faced",         "seen_through",   "hidden",         "small_deg2",     "large_deg2",       "small_width_m",  "large_width_m",
    "small_depth_m", "large_depth_m", "union_length_m", "small_top_m",    "large_top_m",    "small_bottom_m",   "large_bottom_m", "small_fill",
    "large_fill",    "off_line_m",    "large_off_m",    "large_length_m", "small_length_m", "parallel",         "top_step_m",     "bottom_step_m"};

struct PiecePair {
  std::int32_t one = 0;  // below other
  std::int32_t other = 0;
  float gap_m = 0.0F;
  std::array<float, kNumPairFeatures> features{};
};

class PairFinder {
 public:
  /// A round finds at most kMostPairs pairs, with at most kMostLooks looks at columns and at pieces behind and beside. A scan that needs more gets a
  /// shorter reach, in this round and its later ones. Normal scans do not: rain and fog take 2600 pairs and 180 000 looks.
  static constexpr std::size_t kMostPairs = 6000;
  static constexpr std::int64_t kMostLooks = 400'000;

  explicit PairFinder(double lidar_above_water_m) : lidar_above_water_m_(lidar_above_water_m) {}

  /// Before the first round of a scan.
  void BeginScan() { share_ = 0; }

  /// Pairs that come within `reach` of each other: in a column one behind the other, or beside each other.
  /// Cost: about proportional to the columns of all pieces, and bounded. Allocates nothing once it has seen a scan of that size.
  ///
  /// @param reaches_behind  the part of a gap that something nearer hides does not count for the reach
  std::span<const PiecePair> Find(const ScanGrid& grid, const PieceTable& pieces, const Reach& reach, bool reaches_behind);

 private:
  // Reach of any two pieces; of two pieces of few returns; of a larger piece and a piece of few returns.
  struct Reaches {
    Reach any;
    Reach of_few;
    Reach to_few;
  };

  // An entry of an outline, as far as distances go by it.
  struct Shown {
    LevelPoint near;
    LevelPoint far;
    std::int32_t piece = 0;
    std::int32_t entry = 0;  // index into PieceTable::entries()
    std::int32_t column = 0;
    bool is_few = false;    // of a piece of few returns
    bool is_point = false;  // near and far are one return
  };

  // Where two pieces come closest.
  struct Contact {
    std::int32_t one = -1;  // below other
    std::int32_t other = -1;
    float squared_gap_m2 = 0.0F;
    float lesser_range_m = 0.0F;
    float greater_range_m = 0.0F;
    std::int32_t front = -1;  // index into PieceTable::entries()
    std::int32_t back = -1;
    std::int32_t num_faced = 0;
  };

  // Where pieces beside a piece may be within reach.
  struct Window {
    float nearest_m;
    float farthest_m;
    float most_m2;    // squared gap
    double hidden_m;  // does not count for the reach
  };

  // From a column on to those beside it.
  struct Walk {
    int first_step;
    int last_step;
    int direction;  // 1 or -1
  };
  struct Paired {
    int num = 0;
    int last_step = 0;  // the last column that was looked at
  };

  // Entries of one kind, by column, the nearest first.
  struct Columns {
    std::vector<std::int32_t> entry;
    std::vector<float> near_m;  // their ranges
    std::vector<float> far_m;
    std::vector<std::size_t> begin_of_column;

    void Clear() {
      entry.clear();
      near_m.clear();
      far_m.clear();
      begin_of_column.assign(1, 0);
    }
    void Add(const Shown& one) {
      entry.push_back(one.entry);
      near_m.push_back(one.near.range_m);
      far_m.push_back(one.far.range_m);
    }
    void EndColumn() { begin_of_column.push_back(entry.size()); }
    int num_columns() const { return static_cast<int>(begin_of_column.size()) - 1; }
  };

  // Columns to the last and to the next entry of the same piece; round the whole circle for a piece of one entry.
  struct Steps {
    std::int32_t before = 0;
    std::int32_t after = 0;
  };

  void SortByKind(const PieceTable& pieces, int num_columns);
  bool FindContacts(const ScanGrid& grid, const PieceTable& pieces, const Reaches& reaches);
  void LookBehind(const Reaches& reaches, const Shown& front, std::span<const Shown> behind);
  bool IsHidden(const ScanGrid& grid, const OutlineEntry& entry, int column) const;
  void LookBeside(const ScanGrid& grid, const PieceTable& pieces, const Reaches& reaches, const Shown& from);
  Paired PairBeside(const Columns& columns, const Window& window, const Shown& from, const Walk& walk, const Reach& reach, const Reach& narrower,
                    int most);
  int PairInColumn(const Columns& columns, int column, const Window& window, const Shown& from, const Reach& reach, const Reach& narrower);
  bool PairOne(const Window& window, const Shown& from, const Shown& beside, const Reach& reach, const Reach& narrower);
  Contact& At(std::int32_t one, std::int32_t other);
  Contact& RecordContact(const Shown& front, const LevelPoint& front_point, const Shown& back, const LevelPoint& back_point, float squared_gap_m2);
  void Measure(const ScanGrid& grid, const PieceTable& pieces, const Contact& contact, PiecePair& pair) const;

  double lidar_above_water_m_;
  bool reaches_behind_ = false;
  std::vector<Shown> shown_;                                           // [entries]
  std::vector<float> nearest_m_;                                       // [columns] range of the nearest that is shown
  Columns few_;                                                        // of pieces of few returns
  Columns larger_;                                                     // of the others
  std::vector<Steps> steps_;                                           // [entries]
  std::vector<std::pair<std::int32_t, std::int32_t>> first_and_last_;  // [pieces] entries
  std::vector<std::int32_t> near_;                                     // scratch: entries that may be within reach
  std::size_t share_ = 0;                                              // of the reach: an index into kShares
  bool is_counting_ = false;                                           // looks, and nothing else
  std::int64_t num_looks_ = 0;
  std::vector<Contact> contacts_;
  std::vector<std::int32_t> slots_;  // an open hash table: index into contacts_, or -1
  std::vector<PiecePair> pairs_;
};

}  // namespace lookout::segmenter
