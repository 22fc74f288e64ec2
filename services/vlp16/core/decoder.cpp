#include "services/vlp16/core/decoder.hpp"

#include <algorithm>
#include <utility>

namespace lookout::vlp16 {

namespace {

// More than ModelJudge needs when nothing is lost: without an interval in so many packets they are no stream.
constexpr std::size_t kMaxHeld = 16;

}  // namespace

Decoder::Decoder(const DecoderParams& params, TurnHandler on_turn, SentenceHandler on_sentence)
    : params_(params),
      on_turn_(std::move(on_turn)),
      on_sentence_(std::move(on_sentence)),
      state_(params, [this](const Turn& turn) { OnTurn(turn); }) {}

bool Decoder::OnDataPayload(Utime host_time, Bytes payload) {
  const auto result = ParseDataPacket(payload);
  const auto fault = static_cast<std::size_t>(result.fault);
  if (result.fault != DataFault::kNone) return Refuse(totals_.data_faults[fault], kDataFaultNames[fault]);
  ++totals_.data_faults[fault];
  const auto verdict = state_.judge.Judge(result.packet);
  if (verdict == ModelVerdict::kUndecided) {
    if (state_.held.size() == kMaxHeld) ReleaseHeld(ModelVerdict::kUndecided);
    auto& held = state_.held.emplace_back();
    held.host_time = host_time;
    std::ranges::copy(payload, held.payload.begin());
    return false;
  }
  // Packets wait for the verdict about their own product byte only.
  if (!state_.held.empty()) ReleaseHeld(result.packet.product == format::kProductHdl32e ? verdict : ModelVerdict::kUndecided);
  return OnVerdict(host_time, result.packet, verdict);
}

void Decoder::ReleaseHeld(ModelVerdict verdict) {
  const auto held = std::exchange(state_.held, {});
  for (const auto& packet : held) OnVerdict(packet.host_time, ParseDataPacket(packet.payload).packet, verdict);
}

bool Decoder::OnVerdict(Utime host_time, const DataPacket& packet, ModelVerdict verdict) {
  switch (verdict) {
    case ModelVerdict::kVlp16:
      return Take(host_time, packet, Model::kVlp16);
    case ModelVerdict::kPuckHiRes:
      return Take(host_time, packet, Model::kPuckHiRes);
    case ModelVerdict::kHdl32e:
      return Refuse(totals_.num_hdl32e, "the sensor is an HDL-32E, not of the VLP-16 family");
    case ModelVerdict::kUndecided:
      return Refuse(totals_.num_undecided, "product 0x21 may be a VLP-16 or an HDL-32E, and its packets are too few or too far apart to tell");
    default:
      return Refuse(totals_.num_unknown_product, "unknown product byte");
  }
}

bool Decoder::Take(Utime host_time, const DataPacket& packet, Model model) {
  auto& counts = state_.counts;
  ++counts.num_packets;
  const Steps steps = MeasureSteps(packet, state_.assembler.last_gap_cdeg());
  const PacketPlace place = state_.order.Place(packet, steps.duration);
  switch (place.kind) {
    case PacketKind::kDuplicate:
      ++counts.num_duplicates;
      return Refuse(totals_.num_duplicates, "came twice");
    case PacketKind::kReordered:
      ++counts.num_reordered;
      return Refuse(totals_.num_reordered, "came late");
    case PacketKind::kOverlapping:
      return Refuse(totals_.num_overlapping, "packets follow each other faster than a VLP-16 sends them");
    case PacketKind::kJump:
      ++totals_.num_jumps;
      state_.assembler.End(counts);
      state_.clock.ForgetOffset();
      break;
    default:
      break;
  }
  counts.num_lost += place.num_lost;
  totals_.num_lost += place.num_lost;
  state_.clock.OnDataPacket(host_time, place.time, steps.duration);
  const auto num_capped = state_.assembler.num_capped();
  state_.assembler.Add(packet, steps, {model, place.time, place.num_lost, state_.clock.Read(host_time), counts});
  totals_.num_capped_turns += state_.assembler.num_capped() - num_capped;
  last_refusal_ = {};
  return true;
}

void Decoder::OnPositionPayload(Utime host_time, Bytes payload) {
  auto result = ParsePositionPacket(payload);
  ++totals_.position_faults[static_cast<std::size_t>(result.fault)];
  if (result.fault != PositionFault::kNone) return;
  state_.clock.OnPositionPacket(host_time, result.packet);
  if (result.packet.sentence.empty()) return;
  ++totals_.num_sentences;
  const std::uint32_t stamp_us = result.packet.stamp_us;
  const auto sensor_time = state_.order.TimeOfStamp(stamp_us);
  const auto& turn_clock = state_.assembler.clock();
  const Utime time = sensor_time && turn_clock ? turn_clock->ToUtime(*sensor_time) : state_.clock.TimeOfStampAlone(host_time, stamp_us);
  on_sentence_({time, host_time, stamp_us, result.packet.pps, std::move(result.packet.sentence)});
}

void Decoder::Flush() {
  if (!state_.held.empty()) ReleaseHeld(state_.judge.JudgeNow());
  state_.assembler.End(state_.counts);
}

void Decoder::Reset() {
  state_ = State(params_, [this](const Turn& turn) { OnTurn(turn); });
}

bool Decoder::Refuse(std::int64_t& counter, std::string_view reason) {
  ++counter;
  last_refusal_ = reason;
  return false;
}

void Decoder::OnTurn(const Turn& turn) {
  ++totals_.num_turns;
  if (turn.is_partial_start || turn.is_partial_end) ++totals_.num_partial_turns;
  on_turn_(turn);
}

std::vector<Counter> Decoder::counters() const {
  std::vector<Counter> counters;
  for (std::size_t i = 0; i < kDataFaultNames.size(); ++i) counters.push_back({kDataFaultNames[i], totals_.data_faults[i]});
  for (std::size_t i = 0; i < kPositionFaultNames.size(); ++i) counters.push_back({kPositionFaultNames[i], totals_.position_faults[i]});
  counters.insert(counters.end(), {{"data_hdl32e", totals_.num_hdl32e},
                                   {"data_model_undecided", totals_.num_undecided},
                                   {"data_unknown_product", totals_.num_unknown_product},
                                   {"data_lost", totals_.num_lost},
                                   {"data_duplicate", totals_.num_duplicates},
                                   {"data_reordered", totals_.num_reordered},
                                   {"data_overlapping", totals_.num_overlapping},
                                   {"sensor_time_jumps", totals_.num_jumps},
                                   {"turns", totals_.num_turns},
                                   {"turns_partial", totals_.num_partial_turns},
                                   {"turns_capped", totals_.num_capped_turns},
                                   {"sentences", totals_.num_sentences}});
  return counters;
}

}  // namespace lookout::vlp16
