// Whether a datum out of config can be meant for the place where the boat is.
#pragma once

#include <string>
#include <string_view>

#include "common/core/geodesy.hpp"

namespace lookout {

/// A datum farther than this from the first fix is rather a mistake in config than a voyage.
inline constexpr double kMaxDatumDistanceM = 50e3;

/// "datum 72.15000 S 43.63000 E of boat.txtpb is 11910 km from the first fix at 43.63000 N 72.15000 W: swapped latitude and longitude?"
///
/// @param what  the place in words: "the first fix"
/// @return empty when the datum is not farther than kMaxDatumDistanceM from the place, in a straight line, heights left out
std::string DatumComplaint(const GeodeticPlace& datum, const GeodeticPlace& place, std::string_view what);

/// "43.63000 N 72.15000 W"
std::string PlaceInWords(const GeodeticPlace& place);

}  // namespace lookout
