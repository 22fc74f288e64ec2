// The decoder of the VLP-16 family.
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
#include "services/lidar/core/driver/decoder.hpp"
#include "services/lidar/core/driver/scan.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"
#include "services/lidar/core/vlp16/model.hpp"
#include "services/lidar/core/vlp16/packet_sequencer.hpp"
#include "services/lidar/core/vlp16/position_packet.hpp"
#include "services/lidar/core/vlp16/scan_cutter.hpp"
#include "services/lidar/core/vlp16/sensor_clock.hpp"

namespace lookout::vlp16 {

struct DecoderParams {
  ModelChoice model = ModelChoice::kAuto;
  TimeChoice time = TimeChoice::kAuto;
  double cut_azimuth_rad = 0.0;
  bool use_vertical_origin_offsets = false;  // beams start at the heights of the table, not all at the origin
};

using lidar::PacketCounts;
using lidar::Scan;
using lidar::ScanHandler;
using lidar::SentenceHandler;
using lidar::SentenceOfLidar;

class Decoder final : public lidar::Decoder {
 public:
  Decoder(const DecoderParams& params, ScanHandler on_scan, SentenceHandler on_sentence);

  bool OnDataPayload(Utime host_time, Bytes payload) override;
  void OnPositionPayload(Utime host_time, Bytes payload) override;
  void Flush() override;
  void Reset() override;

  std::vector<Counter> counters() const override;
  const std::string& last_refusal() const override { return last_refusal_; }
  std::int64_t num_out_of_stream() const override;
  const std::optional<ClockReading>& last_clock() const override { return last_clock_; }
  double last_rate_radps() const override { return last_rate_radps_; }
  std::optional<int> phase_cdeg() const override { return state_.phase_cdeg; }
  std::optional<Telemetry> telemetry() const override { return state_.telemetry; }

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
        : detector(params.model),
          sequencer(std::move(on_packet)),
          clock(params.time),
          cutter(params.cut_azimuth_rad, params.use_vertical_origin_offsets, std::move(on_scan)) {}
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
