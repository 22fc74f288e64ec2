// What a comparison of methods found: the numbers behind every table and plot of the report.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/eval/method.hpp"

namespace lookout::eval {

/// Sums over scans of one method at one operating point: which of its segments count. Nothing in here is of another. Figures are made of them by the
/// functions below. All are additive: scans of one scene, scenes of one run.
struct Score {
  std::int64_t num_scans = 0;
  std::int64_t num_scans_with_object = 0;  // with a return of an object; over open water there is none
  double sum_iou = 0.0;                    // of these: mean over true objects with a return (the paper's mIoU)
  std::int64_t num_scans_with_water_object = 0;
  double sum_water_iou = 0.0;                                          // the same over objects in the water alone
  std::map<std::string, std::pair<std::int64_t, double>> iou_by_kind;  // number of object-scans, sum of IoU
  static constexpr double kRangeBinM = 10.0;
  std::map<int, std::pair<std::int64_t, std::int64_t>> recall_by_range;  // bin of nearest return: object-scans, of these IoU >= 0.5
  std::map<int, std::pair<std::int64_t, double>> iou_by_range;           // bin: object-scans, sum of IoU
  /// Objects whose nearest return is nearer than this: where a small boat has to see a small thing. At 25 m the rings of a VLP-16 are 0.87 m apart
  /// (2 degrees), so that a buoy of half a metre gives one to three returns.
  static constexpr double kNearM = 25.0;
  struct Recall {
    std::int64_t num_object_scans = 0;
    std::int64_t num_found = 0;  // IoU >= 0.5
  };
  std::map<std::string, Recall> near_recall_by_kind;
  std::int64_t num_segments = 0;
  std::int64_t num_false_segments = 0;  // without a return of any object
  std::int64_t num_object_scans = 0;
  /// Objects with at least so many returns in a scan: fewer may be an accident.
  static constexpr std::int64_t kMinReturnsOfThing = 5;
  std::int64_t num_things = 0;                 // object-scans with kMinReturnsOfThing or more
  std::int64_t num_things_with_segment = 0;    // of these: more than half of the returns of some segment are its
  std::int64_t num_over_segmented = 0;         // objects of which two or more segments hold a tenth each
  std::int64_t num_under_segmented = 0;        // segments that hold a tenth each of two or more objects
  std::int64_t num_returns = 0;                // of objects
  std::int64_t num_labelled_returns = 0;       // of these, in a segment that belongs (by majority) to their object: the paper's true positives
  std::int64_t num_not_scored = 0;             // returns that the method was told not to look at
  std::int64_t num_scans_with_components = 0;  // of methods that say how many components they had before they clustered them
  std::int64_t num_components = 0;             // of these scans
  std::vector<double> time_ms;                 // of each scan

  void Add(const Score& other);
};

// 0 to 1; NaN without scans in which there was an object.
double MeanIou(const Score& score);
double MeanWaterIou(const Score& score);

double FalseSegmentsPerScan(const Score& score);  // NaN without scans, and so below
double ThingsWithSegment(const Score& score);     // share of the object-scans with kMinReturnsOfThing or more
double SegmentsPerScan(const Score& score);
double OverSegmentedShare(const Score& score);   // of object-scans
double UnderSegmentedShare(const Score& score);  // of segments
double TruePositiveRatio(const Score& score);    // of returns of objects
double ComponentsPerScan(const Score& score);    // before clustering; NaN for a method that has none

/// One scan, kept because it went worst: drawn from above with truth and prediction side by side.
struct WorstScan {
  std::string scene;
  std::uint64_t seed = 0;
  int index = 0;
  double iou = 0.0;
  LabelledScan truth;
  std::vector<std::int32_t> label;
};

struct Results;

/// Rows of a method that knows doubt, after its name.
inline constexpr std::string_view kAllSegments = " (all segments)";
inline constexpr std::string_view kSureOnly = " (sure only)";

/// A row of the tables: a method at one operating point.
struct MethodResult {
  std::string method;
  std::map<std::string, Score> by_scene;
  std::map<std::string, std::vector<double>> stage_ms;  // by stage, of each scan
  std::vector<WorstScan> worst;                         // of the whole run, worst first; few
};

/// A peer's name begins with neither "ours" nor "paper"; a tuned one's holds "(tuned".
bool IsPeer(const MethodResult& method);
bool IsTunedPeer(const MethodResult& method);

/// It looks at a part of each scan alone: its figures are not those of the same task as others'.
bool HasPartialView(const MethodResult& method);

/// A figure of one score; NaN = not known.
using Figure = std::function<double(const Score&)>;

/// Of the scenes in which it is known, each counting the same; NaN when there is none.
double MeanOverScenes(const Results& results, const MethodResult& method, const Figure& figure);

/// A curve of one of the paper's tests or of a sweep.
struct Curve {
  std::string title;
  std::string x_label;
  std::string y_label;
  struct Line {
    std::string name;
    std::vector<std::pair<double, double>> points;
  };
  std::vector<Line> lines;
  std::string note;                // a finding in words: "own object from 6.3 m"
  std::string value_of_boat = {};  // of a sweep: what the boat's config has of its field
  std::string scans_from = {};     // of a sweep: seeds and seconds
};

struct Results {
  std::string world;    // whose scenes these are: empty = our own simulator's
  bool is_here = true;  // false: the captures of this world are not on this computer, and nothing below is known
  std::string command;  // that made it
  std::string version;
  std::string computer;
  std::vector<std::string> scenes;  // in the order of the tables
  std::uint64_t first_seed = 1;
  int num_seeds = 0;
  double seconds = 0.0;  // of each scene and seed
  std::vector<MethodResult> methods;
  std::vector<Curve> curves;
  /// Table II: by image width, in the paper's words.
  struct Projection {
    int image_columns = 0;
    double true_positive_ratio = 0.0;
    double num_ground_points = 0.0;  // returns that the image keeps, per scan
    double num_points = 0.0;         // returns of the scan
    double nearest_mean_m = 0.0;     // from a pixel's point to the nearest raw return
    double nearest_sd_m = 0.0;
  };
  std::vector<Projection> projections;
  std::vector<std::string> notes;  // on the input, for people
  /// The same methods, in the same order, on scenes of others.
  std::vector<Results> other_worlds;
};

}  // namespace lookout::eval
