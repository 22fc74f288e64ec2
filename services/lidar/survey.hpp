// Which lidars speak: told by port, size and head of their datagrams, without a config. For lookout-doctor.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/packet_judge.hpp"
#include "services/lidar/core/models/ouster.hpp"
#include "services/lidar/core/models/table.hpp"

namespace lookout::lidar {

/// A sensor whose data packets were seen: one address that sends to one port.
struct Speaker {
  std::string source_address;       // numeric; empty where it is not known
  std::string destination_address;  // of the last data packet; empty where it is not known
  int data_port = 0;
  std::optional<int> second_port;   // to which the same address sends position, IMU or GPS packets
  std::string name;                 // "Hesai XT32", "Velodyne VLP-16", "Ouster", "RoboSense"; for people
  bool is_of_vlp16_family = false;  // read by MODEL_AUTO
  std::optional<OtherModel> other;  // read when `model` names it. Neither of the two: packets of this sensor are not read
  std::int64_t num_packets = 0;     // data
  std::size_t size_bytes = 0;       // of the last data packet
  Utime first{};
  Utime last{};
  std::vector<OusterLayout> layouts;  // Ouster: layouts that packets of this size may have
  /// Host time minus the stamp of the packet, the least; nullopt where the stamp is not a whole time.
  std::optional<std::chrono::microseconds> host_minus_stamp;
  std::optional<Utime> stamp;  // of the last data packet
};

class Survey {
 public:
  /// Any datagram: what is no lidar's changes nothing. The first 64 pairs of sender and port are kept.
  ///
  /// @param destination_address  numeric; empty where it is not known
  void Add(Utime host_time, const std::string& source_address, const std::string& destination_address, int port, Bytes payload);

  /// By address, then port.
  std::vector<Speaker> Speakers() const;

 private:
  struct Heard {
    Speaker speaker;
    std::unique_ptr<PacketJudge> family_judge;  // of product byte 0x21
    std::unique_ptr<PacketReader> reader;       // of a Hesai, for its stamps
    Packet packet;
  };
  using Key = std::pair<std::string, int>;

  void Identify(Bytes payload, Heard& heard) const;
  static std::optional<std::chrono::nanoseconds> StampOf(Bytes payload, Heard& heard);

  std::map<Key, Heard> heard_;
  std::map<std::string, int> second_port_;  // by address
};

/// The meaning of a difference between the sensor's and the host's clock, for people: "37 s ahead, as TAI is of UTC". Empty within 0.25 s.
///
/// @param host_minus_stamp  as Speaker
/// @param stamp             since 1970 where the clock is set
/// @param whose             clock the host's is: "this computer's", "the capture's"
std::string ClockDifferenceText(std::chrono::microseconds host_minus_stamp, Utime stamp, const std::string& whose);

/// The lines that lidar.txtpb needs for this sensor, each with its end of line; empty where it is not read.
std::string ConfigLines(const Speaker& speaker);

}  // namespace lookout::lidar
