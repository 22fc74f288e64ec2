// From raw payloads to scans and sentences: everything that replay computes again from LIDAR_PACKETS.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/vlp16/core/data_packet.hpp"
#include "services/vlp16/core/model.hpp"
#include "services/vlp16/core/packet_sequencer.hpp"
#include "services/vlp16/core/position_packet.hpp"
#include "services/vlp16/core/scan.hpp"
#include "services/vlp16/core/scan_cutter.hpp"
#include "services/vlp16/core/sensor_clock.hpp"

namespace lookout::vlp16 {

struct DecoderParams {
  ModelChoice model = ModelChoice::kAuto;
  TimeChoice time = TimeChoice::kAuto;
  double cut_azimuth_rad = 0.0;
};

/// The NMEA 0183 sentence of one position packet.
struct SentenceOfLidar {
  Utime time;       // when the packet was made, by the clock that stamps the scans
  Utime host_time;  // when it came
  std::uint32_t stamp_us = 0;
  int pps = 0;
  std::string text;
};

class Decoder {
 public:
  using ScanHandler = std::function<void(const Scan&)>;
  using SentenceHandler = std::function<void(const SentenceOfLidar&)>;

  Decoder(const DecoderParams& params, ScanHandler on_scan, SentenceHandler on_sentence);
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// A payload of the data port. Calls the scan handler for each scan that it ends.
  /// @return whether it is usable: a whole packet of a known model at its place in time
  bool OnDataPayload(Utime host_time, Bytes payload);

  /// A payload of the position port. Calls the sentence handler when it holds one.
  void OnPositionPayload(Utime host_time, Bytes payload);

  /// End of input: ends the scan, if there is one.
  void Flush();

  /// Start of a run: all that was learnt is void; counters go on.
  void Reset();

  /// Work done, losses, and each kind of refusal, since the start of the process.
  std::vector<Counter> counters() const;

  /// Why the last data payload was not usable, with the name of the sensor it seems to come from; empty when it was. For people.
  const std::string& last_refusal() const { return last_refusal_; }

  /// Packets since the start of the process that do not follow one another: restarts, overlaps, azimuths elsewhere.
  std::int64_t num_out_of_stream() const;

  /// Of the last scan.
  const std::optional<ClockReading>& last_clock() const { return last_clock_; }
  double last_rate_radps() const { return last_rate_radps_; }

  /// Where the head was at the last whole second of the sensor's clock, for one that is locked to a phase; nullopt before the first.
  std::optional<int> phase_cdeg() const { return state_.phase_cdeg; }

  /// Of the last position packet; nullopt when its firmware does not tell, or none has come.
  const std::optional<Telemetry>& telemetry() const { return state_.telemetry; }

 private:
  struct HeldPacket {
    Utime host_time;
    std::array<std::uint8_t, format::kDataPacketSizeBytes> payload{};
  };

  struct Totals {
    std::array<std::int64_t, kDataFaultNames.size()> data_faults{};
    std::array<std::int64_t, kPositionFaultNames.size()> position_faults{};
    std::int64_t num_unknown_product = 0;
    std::int64_t num_hdl32e = 0;
    std::int64_t num_undecided = 0;
    std::int64_t num_wrapped_azimuths = 0;
    std::int64_t num_stamps_beyond_hour = 0;
    std::int64_t num_scans = 0;
    std::int64_t num_partial_scans = 0;
    std::int64_t num_scans_with_hole = 0;
    std::int64_t num_capped_scans = 0;
    std::int64_t num_sentences = 0;
  };

  /// State that a start mark makes void.
  struct State {
    State(const DecoderParams& params, PacketSequencer::Handler on_packet, ScanHandler on_scan)
        : detector(params.model), sequencer(std::move(on_packet)), clock(params.time), cutter(params.cut_azimuth_rad, std::move(on_scan)) {}
    ModelDetector detector;
    PacketSequencer sequencer;
    SensorClock clock;
    ScanCutter cutter;
    std::int64_t num_packets = 0;  // whole ones of a known model
    std::vector<HeldPacket> held;  // until the model is known
    std::optional<int> phase_cdeg;
    std::optional<Telemetry> telemetry;
  };

  State MakeState();
  bool OnVerdict(Utime host_time, const DataPacket& packet, ModelVerdict verdict);
  void ReleaseHeld(ModelVerdict verdict);
  bool Take(Utime host_time, const DataPacket& packet, Model model);
  bool Refuse(std::int64_t& counter, std::string_view reason);
  bool Refuse(std::string_view reason);
  void OnPacket(const PlacedPacket& placed);
  void OnScan(const Scan& scan);
  PacketCounts Counts() const;

  DecoderParams params_;
  ScanHandler on_scan_;
  SentenceHandler on_sentence_;
  Totals totals_;
  SequenceCounts past_counts_;  // of the runs before the last start mark
  State state_;
  std::string last_refusal_;
  std::optional<ClockReading> last_clock_;
  double last_rate_radps_ = 0.0;
};

}  // namespace lookout::vlp16
