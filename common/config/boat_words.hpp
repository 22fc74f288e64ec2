// What the numbers of boat.txtpb mean, in words, so that who stands on the boat sees what is wrong.
#pragma once

#include <string>
#include <vector>

#include "common/config/boat.hpp"

namespace lookout::config {

struct BoatRemark {
  std::string words;
  std::string cure;  // what to look at; empty where nothing is doubtful
  bool is_under_water = false;
};

/// The box of own returns, and where lidar and antenna are. Doubtful is a box that is larger than the hull by more than 1 m in any direction, a lidar
/// or an antenna that is under water or more than 2 m outside of the hull (of the box, where the size of the hull is not set), and a hull whose size
/// is not set.
std::vector<BoatRemark> RemarksOnBoat(const BoatFacts& boat);

/// The same as comments of a text config, a line each: "# boat.txtpb: ...", "# boat.txtpb: warning: ...".
std::string RemarksAsComments(const BoatFacts& boat);

}  // namespace lookout::config
