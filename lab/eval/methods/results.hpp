// The results of a comparison of methods: the numbers behind every table and plot of the report.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lab/eval/methods/confidence.hpp"
#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/outcome.hpp"
#include "lab/eval/metrics.hpp"

namespace lookout::eval {

/// Figures of one method at one operating point, over scans: which of its segments count. Nothing in here is of another. All are additive: scans of
/// one scene, scenes of one run. A share has 0 or 1 for each.
struct Score {
  Mean iou;                                 // of the scans with a return of an object: mean over true objects with a return (the paper's mIoU)
  Mean water_iou;                           // the same over objects in the water alone
  std::map<std::string, Mean> iou_by_kind;  // of object-scans
  static constexpr double kRangeBinM = 10.0;
  std::map<int, Mean> recall_by_range;  // by bin of nearest return: share of object-scans with IoU >= 0.5
  std::map<int, Mean> iou_by_range;     // of object-scans, by the same bins
  /// Objects whose nearest return is nearer than this: where a small boat has to see a small thing. At 25 m the rings of a VLP-16 are 0.87 m apart
  /// (2 degrees), so that a buoy of half a metre gives one to three returns.
  static constexpr double kNearM = 25.0;
  std::map<std::string, Mean> near_recall_by_kind;  // share of object-scans with IoU >= 0.5
  Mean segments;                                    // a scan
  Mean false_segments;                              // a scan: without a return of any object
  /// Objects with at least so many returns in a scan: fewer may be an accident.
  static constexpr std::int64_t kMinReturnsOfThing = 5;
  Mean with_segment;  // share of object-scans with kMinReturnsOfThing or more: more than half of the returns of some segment are its
  std::map<std::string, Outcomes> outcomes_by_kind;  // of things (not land) with kMinReturnsOfThing or more
  /// A boat nearer to land than this is at its shore: berths and slips leave 0.3 to 3 m of free water.
  static constexpr double kNearLandM = 3.0;
  Mean near_land_found;             // share of things in the water with kMinReturnsOfThing or more, nearer to land: IoU >= 0.5
  Mean land_segments;               // a scan with a return of land: segments more than half of land
  Mean segments_of_land_object;     // of the same segments, for each object of land with a return
  Confidence confidence;            // where the method states probabilities
  Mean over_segmented;              // share of object-scans: two or more segments hold a tenth each
  Mean under_segmented;             // share of segments: hold a tenth each of two or more objects
  Mean over_entropy;                // a scan with a return of an object (EntropyOf)
  Mean under_entropy;               // the same
  Mean panoptic_quality;            // PanopticQualityOf
  Mean segmentation_quality;        // the same
  Mean recognition_quality;         // the same
  Mean true_positives;              // share of returns of objects: in a segment that belongs (by majority) to their object, the paper's TPR
  Mean components;                  // a scan, before clustering; of methods that say how many
  std::int64_t num_not_scored = 0;  // returns that the method was told not to look at
  std::vector<double> time_ms;      // of each scan

  std::int64_t num_scans() const { return segments.count; }
  void Add(const Score& other);
};

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

/// Whether the method sees only a part of each scan: its figures are then of another task than the others'.
bool HasPartialView(const MethodResult& method);

/// Mean of a figure over the scenes in which it is known, each with equal weight; NaN when there is none.
double MeanOverScenes(const Results& results, const MethodResult& method, Mean Score::*figure);

/// Over all scans.
Score Total(const MethodResult& method);

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
  std::string value_of_boat = {};  // of a sweep: the value of its field in the boat's config
  std::string scans_from = {};     // of a sweep: seeds and seconds
};

struct Results {
  std::string world;    // maker of the scenes; empty = our own simulator
  bool is_here = true;  // false: the captures of this world are not on this computer, and nothing below is known
  std::string command;  // command that made the results
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
  /// Results of the same methods, in the same order, on scenes of other simulators.
  std::vector<Results> other_worlds;
};

/// Calls handle(method, scene, score) for each method and each scene in which it is known, in the order of the tables.
template <typename Handler>
void ForEachScore(const Results& results, Handler handle) {
  for (const auto& method : results.methods) {
    for (const auto& scene : results.scenes) {
      if (const auto found = method.by_scene.find(scene); found != method.by_scene.end()) handle(method.method, scene, found->second);
    }
  }
}

}  // namespace lookout::eval
