// The file that lookout-setup writes: boat.txtpb, a boat in one file.
#pragma once

#include <string>

#include "tools/setup/answers.hpp"

namespace lookout::setup {

/// The text of boat.txtpb. Equal answers, lidars and sources of sentences give equal text, however long and fast they were heard.
std::string BoatFile(const config::Answers& answers, const Heard& heard);

}  // namespace lookout::setup
