// The navigator process without its sources: datagrams and LIDAR_NMEA, or NAV_RAW, in; NAV_RAW, GNSS_FIX, ATTITUDE and POSE out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_odometry_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "services/navigator/core/item_sequencer.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/wire.hpp"

namespace lookout::navigator {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// NMEA 0183, or MAVLink of a source whose protocol that is, from outside. Each line is published as NAV_RAW, and then exactly that message is
  /// consumed. Not for a service that reads NAV_RAW.
  ///
  /// @param source  IsSourceName
  /// @param sender  address and port: lines may be cut over datagrams of one sender. Empty: the lines of each datagram are complete
  void OnDatagram(Utime arrival, Bytes payload, const std::string& source = kUdpSource, const std::string& sender = {});

  /// Bytes of a stream, in pieces of any size.
  void OnStream(Utime arrival, Bytes bytes, const std::string& source);

  /// The stream broke off: its incomplete line is void.
  void OnStreamEnd(const std::string& source);

  /// Advances to this host time: ticks, and a start mark when the host clock was set back. Not for a service that reads NAV_RAW.
  void AdvanceTo(Utime host_time);

  /// End of input: publishes the END mark, if anything ever came, and consumes it; a service that reads NAV_RAW publishes the last pose, unless an
  /// END mark did.
  void Finish(Utime host_time);

  HealthReport Report() const;

  /// For tests and measurements.
  const Navigator& navigator() const { return navigator_; }

 private:
  void OnLines(Utime arrival, const DatagramLines& lines, const std::string& source);
  void OnMavlink(Utime arrival, const MavlinkLines& found, const std::string& source);
  void OnLidarNmea(const lidar_nmea_t& message);
  void OnLidarOdometry(const lidar_odometry_t& message);
  void OnNavRaw(const nav_raw_t& message);
  void PublishAndConsume(const std::vector<Item>& items);
  void Consume(const Item& item);
  void PublishOutput(const NavigatorOutput& output);

  bus::Bus& bus_;
  Params params_;
  std::map<std::string, LineAssembler> assemblers_;  // by source
  std::map<std::string, DatagramJoiner> joiners_;    // by source
  std::map<std::string, MavlinkCutter> autopilots_;  // the sources whose protocol is MAVLink
  ItemSequencer sequencer_;
  Navigator navigator_;
  std::int64_t raw_seq_ = 0;  // of the item that is being consumed
  std::int64_t fix_seq_ = 0;
  std::int64_t attitude_seq_ = 0;
  std::int64_t pose_seq_ = 0;

  static constexpr auto kCountNames = std::to_array<std::string_view>(
      {"no_start", "too_long", "not_printable", "cut_off", "bad_host_time", "lidar_nmea_bad", "lidar_odometry_bad", kRawTime, kRawKind, kRawText,
       kRawImu, "nav_raw_backwards", "mavlink_bad_checksum", "mavlink_other_sender", "mavlink_skipped_bytes"});
  Counts<kCountNames> counts_;
};

}  // namespace lookout::navigator
