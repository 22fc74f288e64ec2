// Seeds of the readers of other lidars.
#include <string>

#include "tests/fuzz/corpus.hpp"
#include "tests/unit/lidar_models/hesai_packet.hpp"
#include "tests/unit/lidar_models/velodyne_packet.hpp"

namespace lookout::fuzz {

// Model, then a control byte (the greater size) before each packet.
void WriteHesaiPackets(const Folder& folder) {
  for (int i = 0; i < lidar::kNumHesaiModels; ++i) {
    for (const int mode : {0x33, 0x37, 0x39, 0x3d, 0x3e}) {
      Payload script{static_cast<std::uint8_t>(i)};
      for (int packet = 0; packet < 3; ++packet) {
        lidar::MadeHesaiPacket made(static_cast<lidar::HesaiModel>(i), static_cast<std::uint8_t>(mode));
        for (std::size_t block = 0; block < made.num_blocks; ++block) {
          made.SetCell(block, 3, static_cast<std::uint16_t>(1000 + 100 * block), 50);
          made.SetCell(block, 9, 0xFFFF, 255);
        }
        const bool is_without_number = made.bytes.size() == 1262 || made.bytes.size() == 1194;
        script = script + Payload{static_cast<std::uint8_t>(is_without_number ? 0 : 1)} + made.bytes;
      }
      folder.Write("model_" + std::to_string(i) + "_mode_" + std::to_string(mode), script);
    }
  }
  const std::string table = "Channel,Elevation,Azimuth\r\n1,15,-1.042\r\n2,14.5,3.125\r\n";
  const Payload kind{lidar::kNumHesaiModels};
  folder.Write("angles", kind + Payload(table.begin(), table.end()));
  const std::string other = "EEFF,1,1\nAzimuth;Laser id;Elevation\n+0.5;2;-3\n359;1;1e1\n";
  folder.Write("angles_in_another_order", kind + Payload(other.begin(), other.end()));
}

void WriteVelodynePackets(const Folder& folder) {
  for (int i = 0; i < lidar::kNumVelodyneModels; ++i) {
    for (const int mode : {0x37, 0x38, 0x39}) {
      Payload script{static_cast<std::uint8_t>(i)};
      for (const int azimuth_cdeg : {1000, 18'000, 35'980}) {
        script = script + Payload{0} + lidar::MakeVelodynePacket(static_cast<lidar::VelodyneModel>(i), static_cast<std::uint8_t>(mode), azimuth_cdeg);
      }
      folder.Write("model_" + std::to_string(i) + "_mode_" + std::to_string(mode), script);
    }
  }
}

// As ouster_fuzz.cpp takes them: metadata, or a script of a head and steps.
void WriteOuster(const Folder& folder) {
  const std::string beams = R"("beam_altitude_angles":[10.5,-5],"beam_azimuth_angles":[1.5,-1.5],"lidar_origin_to_beam_origin_mm":15.806)";
  const std::string format =
      R"({"columns_per_frame":1024,"columns_per_packet":16,"pixels_per_column":2,"column_window":[370,85],"udp_profile_lidar":"RNG15_RFL8_NIR8"})";
  const std::string sensor = R"("prod_line":"OS-1-128","prod_sn":"122246000293","build_rev":"v3.0.1","initialization_id":1629346)";
  const std::string transform = R"([-1,0,0,0,0,-1,0,0,0,0,1,36.18,0,0,0,1])";
  const std::string mode = R"("lidar_mode":"1024x10","timestamp_mode":"TIME_FROM_PTP_1588","return_order":"STRONGEST_TO_WEAKEST")";
  folder.Write("flat",
               "{" + beams + "," + sensor + "," + mode + R"(,"data_format":)" + format + R"(,"lidar_to_sensor_transform":)" + transform + "}");
  folder.Write("nested", R"({"beam_intrinsics":{)" + beams + R"(,"beam_to_lidar_transform":[1,0,0,15.8,0,1,0,0,0,0,1,0,0,0,0,1]},"sensor_info":{)" +
                             sensor + R"(},"config_params":{)" + mode + R"(},"lidar_data_format":)" + format +
                             R"(,"imu_intrinsics":{"imu_to_sensor_transform":)" + transform + "}}");
  folder.Write("firmware_1", "{" + beams + R"(,"lidar_mode":"512x20","lidar_data_format":"error: Command not recognized."})");
  for (const std::uint8_t profile : {0, 1, 2, 3, 4}) {
    Payload script{profile, 15, 0xF0, 3, 0, 0, 0xFF, 3};
    for (std::uint8_t i = 0; i < 12; ++i) {
      const std::uint8_t kind = i < 8 ? 8 : i % 4;
      script = script + Payload{kind} + LittleEndian(16U * i, 2) + LittleEndian(7, 2) + LittleEndian(1'562'496, 4) + LittleEndian(48'828, 2) +
               LittleEndian(i == 5 ? 0 : 0xFFF0, 2) + LittleEndian(40U * i, 2) + Payload{i};
    }
    folder.Write("packets_" + std::to_string(profile), script);
  }
}

}  // namespace lookout::fuzz
