#include "services/lidar/core/vlp16/decoder.hpp"

#include <algorithm>
#include <utility>

#include "services/lidar/core/vlp16/foreign_sensor.hpp"

namespace lookout::vlp16 {

namespace {

// More than ModelDetector needs when nothing is lost: without an interval in so many packets they are no stream.
constexpr std::size_t kMaxHeld = 16;

// Azimuth at the first whole second of the sensor's clock within the packet, if there is one.
std::optional<int> PhaseCdeg(const PlacedPacket& placed) {
  constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
  const std::int64_t into_second_us = placed.packet.stamp_us % kMicrosecondsPerSecond;
  const std::chrono::nanoseconds until_second = std::chrono::microseconds(kMicrosecondsPerSecond - into_second_us) % std::chrono::seconds(1);
  for (int step = placed.packet.num_steps - 1; step >= 0; --step) {
    const auto since_step = until_second - placed.steps.time[static_cast<std::size_t>(step)];
    if (since_step < std::chrono::nanoseconds(0)) continue;
    if (since_step >= format::kBlockPeriod) return std::nullopt;
    const auto rotated_cdeg = placed.steps.gap_cdeg[static_cast<std::size_t>(step)] * since_step / format::kBlockPeriod;
    return static_cast<int>((placed.packet.azimuth_cdeg[static_cast<std::size_t>(step)] + rotated_cdeg) % format::kAzimuthsPerRevolution);
  }
  return std::nullopt;
}

}  // namespace

Decoder::Decoder(const DecoderParams& params, ScanHandler on_scan, SentenceHandler on_sentence)
    : params_(params), on_scan_(std::move(on_scan)), on_sentence_(std::move(on_sentence)), state_(MakeState()) {}

Decoder::State Decoder::MakeState() {
  return State(
      params_, [this](const PlacedPacket& placed) { OnPacket(placed); }, [this](const Scan& scan) { OnScan(scan); });
}

bool Decoder::OnDataPayload(Utime host_time, Bytes payload) {
  const auto result = ParseDataPacket(payload);
  const auto fault = static_cast<std::size_t>(result.fault);
  ++totals_.data_faults[fault];
  if (result.fault != DataFault::kNone) {
    const auto name = NameOfForeignPayload(payload);
    return Refuse(name.empty() ? std::string(kDataFaultNames[fault]) : "a packet of another sensor: " + std::string(name));
  }
  if (result.packet.has_wrapped_azimuth) ++totals_.num_wrapped_azimuths;
  if (result.packet.stamp_us >= format::kMicrosecondsPerHour) ++totals_.num_stamps_beyond_hour;
  const auto verdict = state_.detector.Detect(result.packet);
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
    default: {
      ++totals_.num_unknown_product;
      const auto name = NameOfForeignPayload(packet.payload);
      return Refuse(name.empty() ? "unknown product byte " + std::to_string(packet.product) : "a packet of another sensor: " + std::string(name));
    }
  }
}

bool Decoder::Take(Utime host_time, const DataPacket& packet, Model model) {
  ++state_.num_packets;
  switch (state_.sequencer.Add(host_time, packet, model)) {
    case PacketVerdict::kDuplicate:
      return Refuse("came twice");
    case PacketVerdict::kLate:
      return Refuse("came too late");
    case PacketVerdict::kOverlapping:
      return Refuse("packets follow each other faster than one VLP-16 sends them");
    default:
      last_refusal_.clear();
      return true;
  }
}

void Decoder::OnPacket(const PlacedPacket& placed) {
  const PacketCounts counts = Counts();
  if (placed.is_restart) state_.cutter.End(counts);
  state_.clock.OnDataPacket({.host_time = placed.host_time,
                             .time = placed.time,
                             .duration = std::chrono::duration_cast<std::chrono::microseconds>(placed.steps.duration),
                             .stamp_us = placed.packet.stamp_us,
                             .is_restart = placed.is_restart});
  if (const auto phase_cdeg = PhaseCdeg(placed)) state_.phase_cdeg = phase_cdeg;
  const auto num_capped = state_.cutter.num_capped();
  state_.cutter.Add(placed, state_.clock.Read(placed.host_time), counts);
  totals_.num_capped_scans += state_.cutter.num_capped() - num_capped;
}

PacketCounts Decoder::Counts() const {
  const auto& counts = state_.sequencer.counts();
  return {state_.num_packets, counts.num_lost, counts.num_duplicates, counts.num_reordered};
}

void Decoder::OnPositionPayload(Utime host_time, Bytes payload) {
  auto result = ParsePositionPacket(payload);
  ++totals_.position_faults[static_cast<std::size_t>(result.fault)];
  if (result.fault != PositionFault::kNone && result.fault != PositionFault::kSentence) return;
  const std::uint32_t stamp_us = result.packet.stamp_us;
  const auto sensor_time = state_.sequencer.TimeOfStamp(host_time, stamp_us);
  state_.telemetry = result.packet.telemetry;
  state_.clock.OnPositionPacket(host_time, result.packet, sensor_time);
  if (result.packet.sentence.empty()) return;
  ++totals_.num_sentences;
  const auto& scan_clock = state_.cutter.clock();
  const Utime time = sensor_time && scan_clock ? scan_clock->ToUtime(*sensor_time) : state_.clock.TimeOfStampAlone(host_time, stamp_us);
  on_sentence_({time, host_time, stamp_us, result.packet.pps, std::move(result.packet.sentence)});
}

void Decoder::Flush() {
  if (!state_.held.empty()) ReleaseHeld(state_.detector.Decide());
  state_.sequencer.Flush();
  state_.cutter.End(Counts());
}

void Decoder::Reset() {
  past_counts_ += state_.sequencer.counts();
  state_ = MakeState();
}

bool Decoder::Refuse(std::int64_t& counter, std::string_view reason) {
  ++counter;
  return Refuse(reason);
}

bool Decoder::Refuse(std::string_view reason) {
  last_refusal_ = reason;
  return false;
}

void Decoder::OnScan(const Scan& scan) {
  ++totals_.num_scans;
  if (scan.is_partial_start || scan.is_partial_end) ++totals_.num_partial_scans;
  if (scan.has_hole) ++totals_.num_scans_with_hole;
  last_clock_ = scan.clock;
  last_rate_radps_ = scan.rate_radps;
  on_scan_(scan);
}

std::int64_t Decoder::num_out_of_stream() const {
  SequenceCounts sequence = past_counts_;
  sequence += state_.sequencer.counts();
  return sequence.num_restarts + sequence.num_overlapping + sequence.num_disagreements;
}

std::vector<Counter> Decoder::counters() const {
  std::vector<Counter> counters;
  for (std::size_t i = 0; i < kDataFaultNames.size(); ++i) counters.push_back({kDataFaultNames[i], totals_.data_faults[i]});
  for (std::size_t i = 0; i < kPositionFaultNames.size(); ++i) counters.push_back({kPositionFaultNames[i], totals_.position_faults[i]});
  SequenceCounts sequence = past_counts_;
  sequence += state_.sequencer.counts();
  counters.insert(counters.end(), {{"data_hdl32e", totals_.num_hdl32e},
                                   {"data_model_undecided", totals_.num_undecided},
                                   {"data_unknown_product", totals_.num_unknown_product},
                                   {"data_azimuth_wrapped", totals_.num_wrapped_azimuths},
                                   {"data_stamp_beyond_hour", totals_.num_stamps_beyond_hour},
                                   {"data_lost", sequence.num_lost},
                                   {"data_duplicate", sequence.num_duplicates},
                                   {"data_reordered", sequence.num_reordered},
                                   {"data_late", sequence.num_late},
                                   {"data_overlapping", sequence.num_overlapping},
                                   {"data_azimuth_disagrees", sequence.num_disagreements},
                                   {"sensor_restarts", sequence.num_restarts},
                                   {"sensor_clock_steps", sequence.num_clock_steps},
                                   {"scans", totals_.num_scans},
                                   {"scans_partial", totals_.num_partial_scans},
                                   {"scans_with_hole", totals_.num_scans_with_hole},
                                   {"scans_capped", totals_.num_capped_scans},
                                   {"sentences", totals_.num_sentences}});
  return counters;
}

}  // namespace lookout::vlp16
