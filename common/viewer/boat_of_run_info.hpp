// The boat of a recording: the config in RUN_INFO.
#pragma once

#include <optional>

#include "common/config/boat.hpp"
#include "lookout/run_info_t.hpp"

namespace lookout::viewer {

/// Takes boat.txtpb out of RUN_INFO; one that is faulty, or is not there, changes nothing.
///
/// @return false where it is faulty
bool TakeBoat(const run_info_t& info, std::optional<config::BoatFacts>& boat);

}  // namespace lookout::viewer
