// From raw payloads to scans and sentences: everything that replay computes again from LIDAR_PACKETS.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/clock_reading.hpp"
#include "services/lidar/core/driver/scan.hpp"

namespace lookout::lidar {

/// The NMEA 0183 sentence of one position packet.
struct SentenceOfLidar {
  Utime time;       // when the packet was made, by the clock that stamps the scans
  Utime host_time;  // arrival of the packet
  std::uint32_t stamp_us = 0;
  int pps = 0;
  std::string text;
};

/// Values of a sensor about itself.
struct Telemetry {
  int top_board_celsius = 0;
  int bottom_board_celsius = 0;
  bool is_shut_down = false;  // the lasers are off for their temperature
  int shutdown_celsius = 0;   // temperature at the last shutdown for temperature
  int power_up_celsius = 0;

  friend bool operator==(const Telemetry&, const Telemetry&) = default;
};

using SentenceHandler = std::function<void(const SentenceOfLidar&)>;

class Decoder {
 public:
  virtual ~Decoder() = default;
  Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// A payload of the data port. Calls the scan handler for each scan that it ends.
  /// @return whether it is usable: a whole packet of a known model at its place in time
  virtual bool OnDataPayload(Utime host_time, Bytes payload) = 0;

  /// A payload of the position port. Calls the sentence handler when it holds a sentence.
  virtual void OnPositionPayload(Utime host_time, Bytes payload) = 0;

  /// End of input: ends the scan, if there is one.
  virtual void Flush() = 0;

  /// Start of a run: all that was learnt is void; counters go on.
  virtual void Reset() = 0;

  /// Work done, losses, and each kind of refusal, since the start of the process.
  virtual std::vector<Counter> counters() const = 0;

  /// Why the last data payload was not usable, with the name of the sensor it seems to come from; empty when it was. For people.
  virtual const std::string& last_refusal() const = 0;

  /// Packets since the start of the process that do not follow one another: restarts, overlaps, azimuths elsewhere.
  virtual std::int64_t num_out_of_stream() const = 0;

  /// Clock reading and rate of rotation of the last scan.
  virtual const std::optional<ClockReading>& last_clock() const = 0;
  virtual double last_rate_radps() const = 0;

  /// Where the head was at the last whole second of the sensor's clock, for one that is locked to a phase; nullopt before the first.
  virtual std::optional<int> phase_cdeg() const { return std::nullopt; }

  /// nullopt when the sensor does not tell, or has not yet.
  virtual std::optional<Telemetry> telemetry() const { return std::nullopt; }
};

}  // namespace lookout::lidar
