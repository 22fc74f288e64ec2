// From raw payloads to turns and sentences: everything that replay computes again from LIDAR_PACKETS.
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
#include "services/vlp16/core/packet_order.hpp"
#include "services/vlp16/core/position_packet.hpp"
#include "services/vlp16/core/scan_assembler.hpp"
#include "services/vlp16/core/sensor_clock.hpp"
#include "services/vlp16/core/turn.hpp"

namespace lookout::vlp16 {

struct DecoderParams {
  ModelChoice model = ModelChoice::kAuto;
  TimeChoice time = TimeChoice::kAuto;
  double cut_azimuth_rad = 0.0;
};

/// The NMEA 0183 sentence of one position packet.
struct SentenceOfLidar {
  Utime time;       // when the packet was made, by the clock that stamps the turns
  Utime host_time;  // when it came
  std::uint32_t stamp_us = 0;
  int pps = 0;
  std::string text;
};

class Decoder {
 public:
  using TurnHandler = std::function<void(const Turn&)>;
  using SentenceHandler = std::function<void(const SentenceOfLidar&)>;

  Decoder(const DecoderParams& params, TurnHandler on_turn, SentenceHandler on_sentence);
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// A payload of the data port. Calls the turn handler for each turn that it ends.
  /// @return whether it is usable: a whole packet of a known model at its place in time
  bool OnDataPayload(Utime host_time, Bytes payload);

  /// A payload of the position port. Calls the sentence handler when it holds one.
  void OnPositionPayload(Utime host_time, Bytes payload);

  /// End of input: ends the turn, if there is one.
  void Flush();

  /// Start of a run: all that was learnt is void; counters go on.
  void Reset();

  /// Work done, losses, and each kind of refusal, since the start of the process.
  std::vector<Counter> counters() const;

  /// Why the last data payload was not usable; empty when it was. For people.
  std::string_view last_refusal() const { return last_refusal_; }

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
    std::int64_t num_lost = 0;
    std::int64_t num_duplicates = 0;
    std::int64_t num_reordered = 0;
    std::int64_t num_overlapping = 0;
    std::int64_t num_jumps = 0;
    std::int64_t num_turns = 0;
    std::int64_t num_partial_turns = 0;
    std::int64_t num_capped_turns = 0;
    std::int64_t num_sentences = 0;
  };

  /// What a start mark makes void.
  struct State {
    State(const DecoderParams& params, TurnHandler on_turn)
        : judge(params.model), clock(params.time), assembler(params.cut_azimuth_rad, std::move(on_turn)) {}
    ModelJudge judge;
    PacketOrder order;
    SensorClock clock;
    ScanAssembler assembler;
    PacketCounts counts;
    std::vector<HeldPacket> held;  // until the model is known
  };

  bool OnVerdict(Utime host_time, const DataPacket& packet, ModelVerdict verdict);
  void ReleaseHeld(ModelVerdict verdict);
  bool Take(Utime host_time, const DataPacket& packet, Model model);
  bool Refuse(std::int64_t& counter, std::string_view reason);
  void OnTurn(const Turn& turn);

  DecoderParams params_;
  TurnHandler on_turn_;
  SentenceHandler on_sentence_;
  Totals totals_;
  State state_;
  std::string_view last_refusal_;
};

}  // namespace lookout::vlp16
