// Figures of merit of segmentation, and summaries of distances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace lookout::eval {

/// A sum and the number of its terms.
struct Mean {
  std::int64_t count = 0;
  double sum = 0.0;

  void Add(double value) { Add({1, value}); }
  void Add(const Mean& other) {
    count += other.count;
    sum += other.sum;
  }
  /// NaN when nothing was counted.
  double value() const { return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN(); }

  bool operator==(const Mean&) const = default;
};

/// Adds counts, sums, types with an Add of their own, and arrays and maps of these.
template <typename Sum>
void AddMember(Sum& sum, const Sum& other) {
  if constexpr (std::is_arithmetic_v<Sum>) {
    sum += other;
  } else if constexpr (requires { sum.Add(other); }) {
    sum.Add(other);
  } else if constexpr (requires { typename Sum::mapped_type; }) {
    for (const auto& [key, value] : other) AddMember(sum[key], value);
  } else {
    for (std::size_t i = 0; i < sum.size(); ++i) AddMember(sum[i], other[i]);
  }
}

/// AddMember for each member. @param sums, others  of the same members, by std::tie
template <typename... Member>
void AddEach(const std::tuple<Member&...>& sums, const std::tuple<const Member&...>& others) {
  [&]<std::size_t... kPlace>(std::index_sequence<kPlace...>) { (AddMember(std::get<kPlace>(sums), std::get<kPlace>(others)), ...); }
  (std::index_sequence_for<Member...>());
}

/// A segment or an object counts as cut, or as merged, by parts of at least this share of an object's returns.
inline constexpr int kLeastPartsOfObject = 10;  // a tenth

/// Which returns of a scan belong to which true object and to which segment.
class Confusion {
 public:
  struct Object {
    std::int64_t num_returns = 0;
    /// The paper's measure: max over segments j of p_ij / (all of object i + all of segment j - p_ij); 0 when none of its returns is in a segment.
    double iou = 0.0;
    bool has_own_segment = false;     // the object holds more than half of the returns of some segment
    int num_segments = 0;             // segments with a return of the object
    int num_parts = 0;                // segments with a tenth of the object's returns or more
    std::int64_t num_in_largest = 0;  // returns of the object in the segment that holds most of them
  };
  struct Segment {
    std::int64_t num_returns = 0;
    int majority_object = 0;           // with most of the returns; of equals an object before a stray (0) and the own vessel (-1), then the least id
    std::int64_t num_of_majority = 0;  // returns
    int num_parts = 0;                 // objects of which the segment holds a tenth or more
    std::map<int, std::int64_t> returns_by_object;  // 0: of none, -1: of the own vessel
    bool has_object = false;
    bool has_own_vessel = false;
  };
  struct Matches {
    std::map<int, Object> objects;    // by id; objects with a return
    std::map<int, Segment> segments;  // by label; segments with a return
  };

  /// @param object_id  true object; 0 a stray, -1 the own vessel
  /// @param label      predicted segment; 0 and below are none
  void Add(int object_id, int label);

  Matches Match() const;

 private:
  std::map<int, std::int64_t> object_returns_;                     // objects only
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
