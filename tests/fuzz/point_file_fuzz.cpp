// Any bytes as a PCD file and as a KITTI file with labels, and what is read as a turn.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "lab/data/kitti.hpp"
#include "lab/data/organise.hpp"
#include "lab/data/pcd.hpp"
#include "tools/import/file_bytes.hpp"

namespace {

using namespace lookout::data;
using lookout::importer::PointFileError;

void MakeTurn(const PointCloud& cloud) {
  const auto organised = Organise(cloud);
  std::size_t num_returns = 0;
  for (const auto range : organised.labelled.scan.columns.range) num_returns += range != 0 ? 1 : 0;
  // No point is lost uncounted.
  if (num_returns + static_cast<std::size_t>(organised.num_hidden + organised.num_out_of_range) != cloud.points.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    MakeTurn(ParsePcd(bytes, "pcd"));
  } catch (const PointFileError&) {
    // No point file: said, not a fault.
  }
  // 20 bytes of a point and its label: so both files fit each other.
  constexpr std::size_t kPointAndLabelBytes = 20;
  const std::size_t num_points = size / kPointAndLabelBytes;
  try {
    MakeTurn(ParseKitti(bytes.substr(0, 16 * num_points), "bin", bytes.substr(16 * num_points, 4 * num_points), "label"));
    MakeTurn(ParseKitti(bytes, "bin", std::nullopt, ""));
  } catch (const PointFileError&) {
    return 0;
  }
  return 0;
}
