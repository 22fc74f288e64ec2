// The image that SqueezeSeg sees: a scan as four views of 90 degrees.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::learned {

inline constexpr int kNumViews = 4;
inline constexpr int kViewColumns = 512;
/// Forward, left and up of the view in metres, intensity from 0 to 1, range in metres.
inline constexpr int kNumChannels = 5;

/// Pixels of all views: [view x row x column], column fastest. A row is a ring, from the lowest up; columns go clockwise as seen from above. View 0
/// is centred on the lidar's x axis, view 1 on the direction 90 degrees clockwise of it (starboard), and so on.
struct Views {
  static constexpr std::int32_t kEmpty = -1;

  int num_rows = 0;
  std::vector<std::int32_t> pixel_of_return;  // [returns] a pixel of all views
  std::vector<std::int32_t> return_of_pixel;  // [pixels] index of the nearest return there, the first of equals; or kEmpty

  int PixelsOfView() const { return num_rows * kViewColumns; }
};

/// Places the returns of a scan in the views. Returns that share a pixel with a nearer one are not seen by the network. Cost: one pass.
Views ProjectToViews(const segmenter::Scan& scan, std::span<const segmenter::Return> returns);

/// The network's input for a return, in the frame of a view (x forward along the view's centre, y left, z up): so each view looks like the view
/// ahead.
///
/// @param view  0 to 3
std::array<float, kNumChannels> ChannelsOf(const segmenter::Scan& scan, const segmenter::Return& one, int view);

}  // namespace lookout::learned
