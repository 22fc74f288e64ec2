// The decoder of any model whose packets a PacketReader reads.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "services/lidar/core/driver/column_cutter.hpp"
#include "services/lidar/core/driver/decoder.hpp"
#include "services/lidar/core/driver/packet_judge.hpp"
#include "services/lidar/core/driver/packet_order.hpp"
#include "services/lidar/core/driver/stamp_clock.hpp"
#include "services/lidar/core/models/packet_reader.hpp"
#include "services/lidar/core/vlp16/sensor_clock.hpp"

namespace lookout::lidar {

struct ColumnDecoderParams {
  std::function<std::unique_ptr<PacketReader>()> make_reader;
  bool has_position_packets = false;  // as a VLP-16
  /// For models whose second port carries other payloads: returns the sentence in a payload, empty where there is none. Without a function payloads
  /// of the second port are not used.
  std::function<std::string(Bytes payload)> sentence_of = {};
  TimeChoice time = TimeChoice::kAuto;
  double cut_azimuth_rad = 0.0;
};

class ColumnDecoder final : public Decoder {
 public:
  ColumnDecoder(ColumnDecoderParams params, ScanHandler on_scan, SentenceHandler on_sentence);

  bool OnDataPayload(Utime host_time, Bytes payload) override;
  void OnPositionPayload(Utime host_time, Bytes payload) override;
  void Flush() override;
  void Reset() override;

  std::vector<Counter> counters() const override;
  const std::string& last_refusal() const override { return last_refusal_; }
  std::int64_t num_out_of_stream() const override;
  const std::optional<ClockReading>& last_clock() const override { return last_clock_; }
  double last_rate_radps() const override { return last_rate_radps_; }
  std::optional<Telemetry> telemetry() const override { return state_->telemetry; }

 private:
  static constexpr std::size_t kNumFaults = 7;  // of PacketFault

  struct Totals {
    std::array<std::int64_t, kNumFaults> packets{};  // by PacketFault
    std::int64_t num_scans = 0;
    std::int64_t num_partial_scans = 0;
    std::int64_t num_scans_with_hole = 0;
    std::int64_t num_capped_scans = 0;
    std::int64_t num_too_far = 0;
    std::int64_t num_sentences = 0;
    std::int64_t num_bad_positions = 0;
    std::int64_t num_positions = 0;
  };

  /// State that a start mark makes void.
  struct State {
    State(const ColumnDecoderParams& params, PacketOrder::Handler on_packet, ScanHandler on_scan);

    std::unique_ptr<PacketReader> reader;
    PacketOrder order;
    ColumnCutter cutter;
    vlp16::SensorClock past_hour;
    StampClock absolute;
    std::int64_t num_packets = 0;
    const Head* head = nullptr;  // of heads_
    int head_number = 0;         // of the reader
    std::optional<Telemetry> telemetry;
  };

  std::unique_ptr<State> MakeState();
  void OnPacket(const PlacedColumns& placed);
  void OnScan(const Scan& scan);
  PacketCounts Counts() const;
  const Head& Interned(const PacketReader& reader);
  const Head& Interned(const Head& head);
  bool Refuse(std::string reason);

  ColumnDecoderParams params_;
  ScanHandler on_scan_;
  SentenceHandler on_sentence_;
  Totals totals_;
  SequenceCounts past_counts_;                      // of the runs before the last start mark
  std::vector<std::unique_ptr<const Head>> heads_;  // every head that was seen, one for each mode of the sensor. Scans point to these
  std::unique_ptr<State> state_;
  Packet packet_;  // a member, so that its vectors keep their memory
  std::string last_refusal_;
  std::optional<ClockReading> last_clock_;
  double last_rate_radps_ = 0.0;
};

/// Judges data packets by a reader of its own, as a whole: junk of the right size is silence. That reads each packet twice.
JudgeMaker MakeReaderJudge(std::function<std::unique_ptr<PacketReader>()> make_reader, std::size_t position_size_bytes);

}  // namespace lookout::lidar
