// A scan with the truth about each of its returns.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/segmenter/core/scan.hpp"

namespace lookout::data {

/// Ids of returns that no object made.
inline constexpr std::int32_t kNoTrueObject = 0;  // stray, rain, spray, glint, crest, wake
inline constexpr std::int32_t kOwnVesselObject = -1;

struct ScanObject {
  std::string name;
  std::string kind;          // "kayak", "buoy", "shore", ...
  bool is_in_water = false;  // a boat, swimmer, buoy, marker; not land, piers, docks and walls
};

struct LabelledScan {
  segmenter::Scan scan;
  std::vector<std::int32_t> object;            // [cells of the scan] id of the true object; kNoTrueObject where there is no return
  std::map<std::int32_t, ScanObject> objects;  // all of the scene
};

}  // namespace lookout::data
