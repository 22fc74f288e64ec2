// Returns in groups: what every method of segmentation gives.
#pragma once

#include <cstdint>
#include <vector>

namespace lookout::segmenter {

/// Groups of returns, numbered from 0.
struct Groups {
  static constexpr std::int32_t kNone = -1;

  std::vector<std::int32_t> of_return;  // [returns] kNone = in no group
  std::int32_t count = 0;
};

}  // namespace lookout::segmenter
