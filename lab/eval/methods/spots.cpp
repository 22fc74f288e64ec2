#include "lab/eval/methods/spots.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lookout::eval {

std::vector<Spot> SpotsOf(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  const auto& scan = truth.scan;
  std::vector<Spot> spots;
  std::size_t cell = 0;
  for (const float column_azimuth_rad : scan.columns.azimuth_rad) {
    for (const auto& ring : scan.head.rings) {
      const double azimuth_rad = double{column_azimuth_rad} + double{ring.azimuth_offset_rad};
      for (int i = 0; i < scan.head.num_returns; ++i, ++cell) {
        if (scan.columns.range[cell] == 0) continue;
        const double distance_m = scan.columns.range[cell] * scan.head.range_unit_m * std::cos(double{ring.elevation_rad});
        const std::int32_t object = label[cell] == kNotScored ? 0 : std::max(0, truth.object[cell]);
        spots.push_back({object, std::max(0, label[cell]), distance_m * std::sin(azimuth_rad), distance_m * std::cos(azimuth_rad)});
      }
    }
  }
  return spots;
}

}  // namespace lookout::eval
