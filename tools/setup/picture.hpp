// The boat and its sensors in text: seen from above, and from the side.
#pragma once

#include <string>

#include "config/schema/answers.pb.h"

namespace lookout::setup {

/// The boat from above and from the side, the bow to the right, with the places that are known so far: L the lidar, an arrow beside it where its x
/// axis points, G the antenna of GNSS. Before the size of the hull is known: empty.
std::string Picture(const config::Answers& answers);

}  // namespace lookout::setup
