// The numbers of the guard zone in words: for --check and lookout-doctor.
#pragma once

#include <string>
#include <vector>

#include "services/tracker/params.hpp"

namespace lookout::tracker {

struct ZoneRemark {
  std::string words;
  std::string cure;  // advice; empty where nothing is doubtful
};

/// Whether the beams of the lidar can look into all of the guard zone, as far as the config tells, and how near low things are seen. Settings of the
/// lidar itself, and objects before it, only its scans tell. None without a zone.
std::vector<ZoneRemark> RemarksOnZone(const Params& params);

/// The same as comments of a text config, a line each: "# tracker.txtpb: ...", "# tracker.txtpb: warning: ...".
std::string ZoneRemarksAsComments(const Params& params);

}  // namespace lookout::tracker
