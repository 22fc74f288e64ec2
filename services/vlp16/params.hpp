// Config of the vlp16 process (vlp16.txtpb) as checked values.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "services/vlp16/core/decoder.hpp"
#include "services/vlp16/core/packet_format.hpp"

namespace lookout::vlp16 {

enum class Input { kOutside, kLog };  // kLog: subscribes LIDAR_PACKETS and publishes no raw

struct Params {
  Input input = Input::kOutside;
  int data_port = format::kDataPort;
  int position_port = format::kPositionPort;
  DecoderParams decoder;
  bool use_vertical_origin_offsets = false;

  // For main: where datagrams come from.
  std::optional<std::filesystem::path> capture_file;  // set: they are read from it, at the speed at which it was recorded; else from UDP
  std::string bind_address;
  int receive_buffer_bytes = 0;
};

/// @param config_folder  the boat's folder, holding vlp16.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

}  // namespace lookout::vlp16
