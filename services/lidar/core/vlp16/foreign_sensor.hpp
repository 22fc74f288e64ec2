// Names of lidars that are not of the VLP-16 family, by their packets: for the person who has plugged in the wrong one.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/core/bytes.hpp"

namespace lookout::vlp16 {

/// The probable sensor of a payload. Says nothing of a packet of the VLP-16 family, nor of the HDL-32E, whose product byte some early VLP-16 share
/// (ModelDetector tells them apart): their names are never given.
///
/// @return maker and where possible model, printable ASCII; empty when nothing is recognised
std::string_view NameOfForeignPayload(Bytes payload);

/// @return the meaning of the product byte of a Velodyne data packet; empty when no two sources agree on it
std::string_view NameOfProduct(std::uint8_t product);

}  // namespace lookout::vlp16
