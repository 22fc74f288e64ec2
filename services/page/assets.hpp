// The files of the page (web/built), compressed, inside the program.
#pragma once

#include <vector>

#include "services/page/io/server.hpp"

namespace lookout::page {

std::vector<Asset> Assets();

}  // namespace lookout::page
