// Config of the navigator process (navigator.txtpb, boat.txtpb) as checked values.
#pragma once

#include <filesystem>
#include <string>

#include "services/navigator/core/navigator.hpp"

namespace lookout::navigator {

enum class Input { kOutside, kLog };  // kOutside: datagrams and LIDAR_NMEA; kLog: NAV_RAW only, and publishes none

struct Params {
  Input input = Input::kOutside;
  bool use_lidar_nmea = true;
  NavigatorParams navigator;

  // For main and replay: where datagrams come from.
  std::string bind_address;
  int nmea_port = 0;
};

/// @param config_folder  the boat's folder, holding boat.txtpb and navigator.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::navigator
