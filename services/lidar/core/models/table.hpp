// The models that are read beside the VLP-16 family: one row each.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "services/lidar/core/models/packet_reader.hpp"

namespace lookout::lidar {

enum class OtherModel { kVlp32c, kHdl32e, kVls128, kOuster, kXt16, kXt32, kXt32m, kQt64, kQt128, kPandar40p, kPandar64 };

struct ModelRow {
  OtherModel model;
  std::string_view name;            // for people
  bool needs_beam_file;             // without the file there are no angles: Ouster
  std::string_view beam_file_is;    // name of the file for people; empty: the angles come from the maker's table
  bool has_position_packets;        // as a VLP-16: 512 bytes with PPS and an NMEA sentence
  std::size_t position_size_bytes;  // of the payloads to the second port; 0 = none are used
  int usual_data_port;              // as delivered
  int usual_position_port;
  int usual_control_port;  // TCP, on the sensor, where it tells its beams; 0 = the model does not tell them
};

std::span<const ModelRow> ModelTable();
const ModelRow& RowOf(OtherModel model);

/// @param beam_text  content of the maker's file: metadata (JSON) of an Ouster, angle correction (CSV) of a Hesai; empty = none
/// @throws std::runtime_error with the fault of the file
std::unique_ptr<PacketReader> MakeReader(OtherModel model, const std::string& beam_text);

}  // namespace lookout::lidar
