// Figures of merit of segmentation, and summaries of distances.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace lookout::eval {

/// Which returns of a scan belong to which true object and to which segment.
class Confusion {
 public:
  /// @param object_id  true object; 0 and below are none
  /// @param label      predicted segment; 0 and below are none
  void Add(int object_id, int label);

  struct ObjectScore {
    int object_id;
    std::int64_t num_returns;
    double iou;            // with the predicted segment of largest IoU; 0 when none of its returns is in a segment
    bool has_own_segment;  // a segment of which it holds more than half
  };

  /// The paper's measure: IoU_i = max over segments j of p_ij / (all of object i + all of segment j - p_ij). By object_id.
  std::vector<ObjectScore> Scores() const;

  /// @return the object with most returns in the segment, of equals an object before a stray and then the least id; -1 for the own vessel, 0 when
  /// strays lead or the segment is unknown
  int MajorityObject(int label) const;

  /// Labels of the segments without a single return of an object or the own vessel, in their order.
  std::vector<int> ClutterSegments() const;
  int NumSegments() const { return static_cast<int>(segment_returns_.size()); }

 private:
  std::map<int, std::int64_t> object_returns_;                     // objects only
  std::map<int, std::int64_t> segment_returns_;                    // segments only
  std::map<int, std::map<int, std::int64_t>> returns_by_segment_;  // label, object_id (also none)
};

/// Median, 95th percentile (nearest rank) and greatest of some numbers.
class Summary {
 public:
  void Add(double value) { values_.push_back(value); }
  void Add(const Summary& other) { values_.insert(values_.end(), other.values_.begin(), other.values_.end()); }
  std::size_t count() const { return values_.size(); }

  /// Precondition for all: count() > 0.
  double Median() const { return Percentile(50); }
  double Percentile(int percent) const;
  double Max() const { return Percentile(100); }
  double Mean() const;
  double Rms() const;  // root mean square

 private:
  std::vector<double> values_;
};

}  // namespace lookout::eval
