// Which NMEA 0183 sentences come, from where, how fast, and what they hold.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/lines.hpp"

namespace lookout::setup {

inline constexpr int kNmeaPort = 10110;  // UDP, registered for NMEA 0183

/// A source of sentences with right checksums.
struct NmeaHeard {
  enum class Kind { kUdp, kSerial, kLidar };  // kLidar: in the position packets of a lidar
  Kind kind = Kind::kUdp;
  int port = 0;                                          // kUdp
  std::string device = {};                               // kSerial
  int baud = 0;                                          // kSerial
  std::map<std::string, std::int64_t> num_by_type = {};  // "RMC"
  bool has_position = false;
  bool has_heading = false;
  bool has_tilt = false;
  double seconds = 0.0;  // from the source's first to its last sentence
};

/// "RMC 1.0/s, HDT 10.0/s"; without a rate where it was heard for less than two seconds.
std::string SentencesInWords(const NmeaHeard& heard);

class NmeaSurvey {
 public:
  /// Any datagram: one without a sentence with a right checksum changes nothing. The first 32 ports are kept.
  ///
  /// @param is_frame  seen on an interface, not by a socket: the same datagram may come both ways, and counts once
  void AddDatagram(Utime time, int port, Bytes payload, bool is_frame);

  /// Takes the sentence of a lidar's position packet.
  void AddPositionPacket(Utime time, Bytes payload);

  /// @param bytes  a stretch of a stream. @return whether it held a sentence with a right checksum
  bool AddSerial(Utime time, const std::string& device, int baud, Bytes bytes);

  /// Forgets the begun line of a device: another baud rate begins.
  void BeginSerial(const std::string& device) { lines_.erase(device); }

  /// The lidar first, UDP by port, then devices by name.
  std::vector<NmeaHeard> Sources() const;

 private:
  struct Count {
    NmeaHeard heard;
    Utime first{};
    Utime last{};
  };
  static bool Take(Utime time, const std::string& line, Count& count);

  std::map<int, Count> by_socket_;
  std::map<int, Count> by_frame_;
  std::map<std::string, Count> by_device_;
  std::map<std::string, navigator::LineAssembler> lines_;
  Count lidar_;
};

}  // namespace lookout::setup
