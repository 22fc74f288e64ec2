// The standard normal distribution.
#pragma once

#include <cmath>

#include "common/core/elementary.hpp"

namespace lookout::tracker {

/// Density and distribution at z. Source: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions", 26.2.17. Error: below 1e-7.
struct NormalAt {
  explicit NormalAt(double z) : density(0.0), below(z < 0.0 ? 0.0 : 1.0) {
    if (std::fabs(z) > 6.0) return;
    density = 0.3989422804014327 * Exp(-0.5 * z * z);
    const double t = 1.0 / (1.0 + 0.2316419 * std::fabs(z));
    const double tail = density * t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
    below = z < 0.0 ? tail : 1.0 - tail;
  }
  double density;
  double below;
};

}  // namespace lookout::tracker
