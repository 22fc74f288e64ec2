// Config of the lidar process (lidar.txtpb) as checked values.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/lidar/core/models/table.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::lidar {

enum class Input { kOutside, kLog };  // kLog: subscribes LIDAR_PACKETS and publishes no raw

/// Where datagrams come from: for main. The service does not look at it.
struct Sources {
  enum class Kind { kUdp, kCapture, kLog, kInterface };  // in the order of the schema
  Kind kind = Kind::kUdp;
  std::vector<std::filesystem::path> capture_files;  // in the order in which they are read
  double capture_speed = 1.0;                        // 0 = as fast as possible
  std::string bind_address;
  std::string interface;        // empty = any
  std::string multicast_group;  // empty = none
  std::vector<std::string>
      allowed_source_addresses;  // empty = all; as inet_ntop writes them, to be compared as texts; a text that is no address stays
  std::string bpf_filter;        // empty = made of the ports
  int receive_buffer_bytes = 0;
};

/// A lidar that is not of the VLP-16 family.
struct OtherLidar {
  OtherModel model = OtherModel::kOuster;
  std::string beam_text = {};       // content of beam_file; empty = none
  std::string beam_origin = {};     // where beam_text comes from, for people
  std::string sensor_address = {};  // numeric; empty: the sensor is not asked
  int sensor_port = 0;
};

/// Fault of a text for this model, from a file, the sensor or a log; empty where it is right.
std::string BeamFault(OtherModel model, const std::string& text);

struct Params {
  int number = 1;  // 2: the second lidar of the boat, of lidar_2.txtpb
  Input input = Input::kOutside;
  int data_port = vlp16::format::kDataPort;
  int position_port = vlp16::format::kPositionPort;
  vlp16::DecoderParams decoder;     // of other models only its `time` and its cut azimuth count
  std::optional<OtherLidar> other;  // nullopt: of the VLP-16 family
  Sources sources;
  std::optional<Eigen::Matrix3d> R_vessel_lidar;  // mounting of the lidar, where boat.txtpb has it: for the IMU in the lidar
};

/// The word of the schema for `model` in lidar.txtpb. @param other  nullopt: of the VLP-16 family
std::string ModelWord(const std::optional<OtherModel>& other);

/// @param config_folder  the boat's folder, holding lidar.txtpb
/// @param number         2: of the second lidar, of lidar_2.txtpb
/// @throws config::ConfigError with every fault. Addresses, captures and the filter are texts here: LoadChecked checks them for who opens sources
Params LoadParams(const std::filesystem::path& config_folder, int number);
inline Params LoadParams(const std::filesystem::path& config_folder) { return LoadParams(config_folder, 1); }

/// "lidar.txtpb", "lidar_2.txtpb".
std::string ConfigFileName(int number);

/// Whether the boat has a second lidar: its file is there.
bool HasSecond(const std::filesystem::path& config_folder);

/// LoadParams that adds fields that do not go together to `faults`, a line each: for a caller that has more to check and reports all faults at once.
///
/// @throws config::ConfigError when the file is not of the schema
Params LoadParams(const std::filesystem::path& config_folder, int number, std::vector<std::string>& faults);

}  // namespace lookout::lidar
