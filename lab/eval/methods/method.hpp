// A way from a scan to a label for every return. Ours, the paper's and the peers' stand behind one interface.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/data/labelled_scan.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::eval {

using data::kNoTrueObject;
using data::kOwnVesselObject;
using data::LabelledScan;
using data::ScanObject;

/// Label of a return that the method was told not to look at, outside of its field of view: it does not count for its score.
inline constexpr std::int32_t kNotScored = -1;

/// Where a scan comes from.
struct ScanPlace {
  std::string scene;
  std::uint64_t seed = 0;
  int index = 0;  // of the scene and seed, from 0
};

/// The labels of a method for one scan.
struct Labelling {
  std::vector<std::int32_t> label;  // [cells of the scan] id of a segment from 1; 0 = no return, or in no segment; or kNotScored
  std::vector<bool> is_sure;        // [segments] by id - 1; false = the method itself takes the segment for tentative
  /// [segments] by id - 1: that the segment is of an object and not clutter, 0 to 1; nullopt = the method states none.
  std::optional<std::vector<double>> probability = std::nullopt;
  /// Components before they were clustered into segments; nullopt = the method has no such step.
  std::optional<std::int64_t> num_components = std::nullopt;
  /// Stages in their order, as the method measured them; empty when it does not.
  std::vector<std::pair<std::string, std::chrono::nanoseconds>> stages{};
  /// Spent on measuring the stages once more, not on the method: taken off its time.
  std::chrono::nanoseconds untimed{0};
  /// false: the labels were made elsewhere, and the time that it took to give them says nothing.
  bool is_timed = true;
};

class Method {
 public:
  Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;
  virtual ~Method() = default;

  /// "paper W=512", "Euclidean 0.5 m (tuned)". In tables the name of a method that knows doubt is followed by the operating point.
  virtual std::string name() const = 0;

  /// The method rates some segments as tentative: it is scored at two operating points, all segments and the sure ones alone.
  virtual bool knows_doubt() const { return false; }

  /// Announces that the next scan is the one of this place: for methods that must not know anything of its scene, or that know the scans before.
  /// @return false: the method does not label such scans, and has no score there
  virtual bool BeginScan(const ScanPlace& /*place*/) { return true; }

  /// Pure but for the measured time: the same scan of the same place gives the same labels.
  virtual Labelling Segment(const segmenter::Scan& scan) = 0;
};

using Methods = std::vector<std::unique_ptr<Method>>;

}  // namespace lookout::eval
