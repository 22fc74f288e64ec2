// A model of lidar, as the driver sees it: a reader of its packets. One file per family; the driver knows no model.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::lidar {

/// Which echo of a shot a return is.
enum class ReturnKind { kStrongest, kLast, kFirst, kSecond };

/// One beam of the head.
struct Beam {
  double elevation_rad = 0.0;
  double azimuth_offset_rad = 0.0;          // clockwise, to be added to the azimuth of the column
  double origin_height_m = 0.0;             // z at which the beam starts on the axis of rotation
  std::chrono::nanoseconds time_offset{0};  // from the time of the column to the beam's shot
  /// For how long the head turns on beyond the azimuth of the column until the beam's shot: time_offset (Velodyne), 0 (Ouster, most of Hesai).
  std::chrono::nanoseconds turning_time{0};
  int channel = 0;  // number on the sensor's wire, from 0

  friend bool operator==(const Beam&, const Beam&) = default;
};

/// The stamp of a packet.
enum class StampKind {
  kPastHour,  // microseconds past the hour of UTC, or of the sensor's own start; the stamp goes back to 0 at 3600 s
  kAbsolute,  // since 1970 where the sensor's clock is set, else since its start, or since any year
};

/// The sensor as it fires now: it changes with its mode, never within a packet. Frame: lidar (x along azimuth 0, y left, z up).
struct Head {
  std::string model;                // "Ouster OS1-128", for people and for LIDAR_SCAN
  double range_unit_m = 0.0;        // metres per count of Packet::range
  std::vector<Beam> beams;          // by ring, from the lowest up; 1 to 128
  std::vector<ReturnKind> returns;  // of a shot: 1 or 2
  StampKind stamp = StampKind::kAbsolute;
  bool is_hearing_three = false;  // the sensor sends three returns of a shot, of which two are kept

  friend bool operator==(const Head&, const Head&) = default;

  std::size_t num_cells_of_column() const { return beams.size() * returns.size(); }
};

/// One firing of all beams.
struct Column {
  double azimuth_rad = 0.0;          // azimuth of a beam without offset, clockwise seen from above, in [0, 2 pi)
  std::chrono::nanoseconds time{0};  // since the packet's stamp
};

/// The place of a packet among all of its sensor, where the sensor counts them. Numbers go on by 1 and begin anew behind `modulus` - 1.
struct PacketNumber {
  std::uint64_t number = 0;
  std::uint64_t modulus = 0;
};

/// The content of one data packet.
struct Packet {
  std::chrono::nanoseconds stamp{0};       // see Head::stamp
  std::chrono::nanoseconds duration{0};    // from its first column to the first column of the next packet, at the present rate of rotation
  std::optional<PacketNumber> number;      // nullopt: losses show in stamps alone
  std::vector<Column> columns;             // in the order in which they were fired; empty where the sensor marks no column as good
  std::vector<std::uint32_t> range;        // [columns x rings x returns] in Head::range_unit_m; 0 = no return
  std::vector<std::uint8_t> reflectivity;  // [columns x rings x returns]; 0 where there is no return
};

/// Why a payload was not used.
enum class PacketFault {
  kNone,
  kSize,      // no packet of this model has this size in any mode
  kHead,      // flags, versions, numbers of beams or blocks of another model, or of none
  kMode,      // an unknown return mode, or a profile other than the metadata's
  kAzimuth,   // beyond 360 deg
  kStamp,     // a date that is none
  kChecksum,  // refused only of a sensor whose checksum was right once
};

/// Reads the packets of one sensor. Not shared between threads.
class PacketReader {
 public:
  virtual ~PacketReader() = default;

  /// A copy of this reader in its present state; a copy of a reader that has read nothing is a new reader without the cost of its beam file.
  virtual std::unique_ptr<PacketReader> Clone() const = 0;

  /// Reads a data packet as a whole, or changes nothing but the reason. Bytes of any kind may come.
  ///
  /// @param packet  is overwritten; its vectors keep their memory from call to call
  virtual PacketFault Read(Bytes payload, Packet& packet) = 0;

  /// The head of the last packet that was read. The reference is valid as long as the reader; `head_number` counts changes of the head.
  virtual const Head& head() const = 0;
  virtual int head_number() const = 0;

  /// Why the last Read refused, in words with the model's name; for people.
  virtual const std::string& reason() const = 0;

  /// A cheap look: may a payload of this size be a data packet of this sensor in any of its modes?
  virtual bool MayBe(std::size_t size_bytes) const = 0;
};

}  // namespace lookout::lidar
