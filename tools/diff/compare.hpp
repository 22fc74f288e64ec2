// Two messages of one type, field by field.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::diff {

/// Where two messages differ first, in the order of their fields.
struct Difference {
  std::string field;  // "segments[3].centroid_m[0]"; "byte 17" or "size" where the type is not known or the bytes do not decode; "type"
  std::string a;
  std::string b;
};

/// How far numbers may lie apart and still be equal, by field.
class Tolerances {
 public:
  /// @param field      "centroid_m", or more of its path: "segments.centroid_m"; without indices
  /// @param tolerance  0 or more, in the unit of the field
  void Set(const std::string& field, double tolerance) { tolerances_[field] = tolerance; }

  bool empty() const { return tolerances_.empty(); }

  /// @param path  of a field, without indices
  /// @return the tolerance of the longest name that fits; 0 = bit for bit
  double Of(std::string_view path) const;

  /// @return names that fit no number of any wire type
  std::vector<std::string> Unknown() const;

 private:
  std::map<std::string, double, std::less<>> tolerances_;
};

/// Compares two payloads.
///
/// Numbers are equal when their bits are, or, with a tolerance, when they lie no farther apart than that, or are both NaN. Lengths of arrays, strings
/// and booleans have no tolerance.
///
/// @return nullopt when they are equal
std::optional<Difference> CompareMessages(const Tolerances& tolerances, Bytes a, Bytes b);

}  // namespace lookout::diff
