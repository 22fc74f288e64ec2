// Projection and search together: a component for every return, also for those that lose their pixel to a nearer one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/paper/breadth_first_search.hpp"
#include "services/segmenter/core/paper/range_image.hpp"

namespace lookout::segmenter {

struct LabellingParams {
  int image_columns = 0;  // 0 = the scan's own
  bool label_shadowed_returns = true;
  SearchParams search;
};

/// Gives shadowed returns the component of the nearest return in their own pixel or its four neighbours, if it is close (SearchParams::distance_m).
struct ShadowedReturns {
  Groups components;                    // as before, with those that found one
  std::vector<std::int32_t> remaining;  // the others, increasing
};
ShadowedReturns JoinShadowed(const RangeImage& image, std::span<const Return> returns, std::span<const std::int32_t> indices, Groups components,
                             const SearchParams& params);

/// Components of a scan, each return in one; without `label_shadowed_returns` the shadowed ones are in none (the paper).
///
/// A shadowed return with nothing close to it in the image is behind another object: it is looked at again in an image of such returns alone, at most
/// kMaxLooks times; a return that is shadowed even then is a component by itself. So a near buoy neither hides nor swallows the shore behind it.
Groups LabelComponents(const Scan& scan, std::span<const Return> returns, const LabellingParams& params);

/// A bound for heads that stand still. Twice what is needed: at 10 Hz a pixel of 512 columns holds four columns of two returns, eight returns.
inline constexpr int kMaxLooks = 16;

}  // namespace lookout::segmenter
