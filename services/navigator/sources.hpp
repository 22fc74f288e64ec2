// Opens what navigator.txtpb names. For main, and for lookout-doctor.
#pragma once

#include <memory>

#include "services/navigator/io/source.hpp"
#include "services/navigator/params.hpp"

namespace lookout::navigator {

/// @param connection  no text log: those are played by TextLogPlayer
/// @throws std::runtime_error when a UDP port cannot be opened; a serial port and a server may come later
std::unique_ptr<Source> OpenSource(const Connection& connection);

}  // namespace lookout::navigator
