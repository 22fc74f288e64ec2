// Which build this is.
#pragma once

#include <string>

namespace lookout::runtime {

/// Version of Lookout, from the build.
std::string Version();

}  // namespace lookout::runtime
