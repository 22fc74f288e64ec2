#include "services/lidar/core/driver/column_decoder.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "services/lidar/core/vlp16/foreign_sensor.hpp"
#include "services/lidar/core/vlp16/position_packet.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::microseconds;

constexpr std::array<std::string_view, 7> kPacketFaultNames{"data_packets_whole", "data_bad_size",  "data_bad_head",    "data_bad_return_mode",
                                                            "data_bad_azimuth",   "data_bad_stamp", "data_bad_checksum"};

class ReaderJudge final : public PacketJudge {
 public:
  ReaderJudge(std::unique_ptr<PacketReader> reader, std::size_t position_size_bytes)
      : reader_(std::move(reader)), position_size_bytes_(position_size_bytes) {}

  Verdict Judge(Stream stream, Bytes payload) override {
    if (stream == Stream::kPosition) return payload.size() == position_size_bytes_ ? Verdict::kValid : Verdict::kInvalid;
    return reader_->Read(payload, packet_) == PacketFault::kNone ? Verdict::kValid : Verdict::kInvalid;
  }

 private:
  std::unique_ptr<PacketReader> reader_;
  std::size_t position_size_bytes_;
  Packet packet_;
};

}  // namespace

JudgeMaker MakeReaderJudge(std::function<std::unique_ptr<PacketReader>()> make_reader, std::size_t position_size_bytes) {
  return [make_reader = std::move(make_reader), position_size_bytes] { return std::make_unique<ReaderJudge>(make_reader(), position_size_bytes); };
}

ColumnDecoder::State::State(const ColumnDecoderParams& params, PacketOrder::Handler on_packet, ScanHandler on_scan)
    : reader(params.make_reader()),
      order(std::move(on_packet)),
      cutter(params.cut_azimuth_rad, std::move(on_scan)),
      past_hour(params.time),
      absolute(params.time) {}

ColumnDecoder::ColumnDecoder(ColumnDecoderParams params, ScanHandler on_scan, SentenceHandler on_sentence)
    : params_(std::move(params)), on_scan_(std::move(on_scan)), on_sentence_(std::move(on_sentence)), state_(MakeState()) {}

std::unique_ptr<ColumnDecoder::State> ColumnDecoder::MakeState() {
  return std::make_unique<State>(
      params_, [this](const PlacedColumns& placed) { OnPacket(placed); }, [this](const Scan& scan) { OnScan(scan); });
}

bool ColumnDecoder::OnDataPayload(Utime host_time, Bytes payload) {
  auto& reader = *state_->reader;
  const auto fault = reader.Read(payload, packet_);
  ++totals_.packets.at(static_cast<std::size_t>(fault));
  if (fault != PacketFault::kNone) {
    const auto name = vlp16::NameOfForeignPayload(payload);
    return Refuse(reader.reason() + (name.empty() ? "" : "; it seems to be of another sensor: " + std::string(name)));
  }
  ++state_->num_packets;
  const auto verdict = state_->order.Add(host_time, packet_, Interned(reader));
  if (packet_.columns.empty()) return Refuse("the " + reader.head().model + " says of no column that it is good: it starts, or has shut down");
  switch (verdict) {
    case PacketVerdict::kDuplicate:
      return Refuse("came twice");
    case PacketVerdict::kLate:
      return Refuse("came too late");
    case PacketVerdict::kOverlapping:
      return Refuse("packets follow each other faster than one " + reader.head().model + " sends them");
    default:
      last_refusal_.clear();
      return true;
  }
}

void ColumnDecoder::OnPacket(const PlacedColumns& placed) {
  const auto counts = Counts();
  if (placed.is_restart) state_->cutter.End(counts);
  const auto time = std::chrono::floor<microseconds>(placed.time);
  const auto stamp = std::chrono::floor<microseconds>(placed.packet->stamp);
  // It was sent after its last shot; behind that the head may be dark for long.
  std::chrono::nanoseconds last_shot{0};
  for (const auto& beam : placed.head->beams) last_shot = std::max(last_shot, beam.time_offset);
  const auto duration = std::chrono::floor<microseconds>(std::max<std::chrono::nanoseconds>(placed.packet->columns.back().time + last_shot, {}));
  ClockReading clock;
  if (placed.head->stamp == StampKind::kPastHour) {
    state_->past_hour.OnDataPacket({.host_time = placed.host_time,
                                    .time = time,
                                    .duration = duration,
                                    .stamp_us = static_cast<std::uint32_t>(stamp.count()),
                                    .is_restart = placed.is_restart});
    clock = state_->past_hour.Read(placed.host_time);
  } else {
    state_->absolute.OnDataPacket(placed.host_time, time, stamp, duration, placed.is_restart);
    clock = state_->absolute.Read();
  }
  const auto num_capped = state_->cutter.num_capped();
  const auto num_too_far = state_->cutter.num_too_far();
  state_->cutter.Add(placed, clock, counts);
  totals_.num_capped_scans += state_->cutter.num_capped() - num_capped;
  totals_.num_too_far += state_->cutter.num_too_far() - num_too_far;
}

void ColumnDecoder::OnPositionPayload(Utime host_time, Bytes payload) {
  ++totals_.num_positions;
  if (params_.sentence_of) {
    auto text = params_.sentence_of(payload);
    if (text.empty()) {
      ++totals_.num_bad_positions;
      return;
    }
    ++totals_.num_sentences;
    on_sentence_({host_time, host_time, 0, 0, std::move(text)});
    return;
  }
  if (!params_.has_position_packets) return;
  auto result = vlp16::ParsePositionPacket(payload);
  if (result.fault != vlp16::PositionFault::kNone) ++totals_.num_bad_positions;
  if (result.fault != vlp16::PositionFault::kNone && result.fault != vlp16::PositionFault::kSentence) return;
  const auto stamp_us = result.packet.stamp_us;
  const auto sensor_time = state_->order.TimeOfStamp(host_time, microseconds(stamp_us));
  state_->telemetry = result.packet.telemetry;
  state_->past_hour.OnPositionPacket(host_time, result.packet, sensor_time);
  if (result.packet.sentence.empty()) return;
  ++totals_.num_sentences;
  const auto& scan_clock = state_->cutter.clock();
  const Utime time = sensor_time && scan_clock ? scan_clock->ToUtime(*sensor_time) : state_->past_hour.TimeOfStampAlone(host_time, stamp_us);
  on_sentence_({time, host_time, stamp_us, result.packet.pps, std::move(result.packet.sentence)});
}

void ColumnDecoder::Flush() {
  state_->order.Flush();
  state_->cutter.End(Counts());
}

void ColumnDecoder::Reset() {
  past_counts_ += state_->order.counts();
  state_ = MakeState();
}

PacketCounts ColumnDecoder::Counts() const {
  const auto& counts = state_->order.counts();
  return {state_->num_packets, counts.num_lost, counts.num_duplicates, counts.num_reordered};
}

// Comparing takes as long as the head has beams, so it is done when the reader says that its head is another.
const Head& ColumnDecoder::Interned(const PacketReader& reader) {
  if (state_->head != nullptr && state_->head_number == reader.head_number()) return *state_->head;
  state_->head_number = reader.head_number();
  state_->head = &Interned(reader.head());
  return *state_->head;
}

const Head& ColumnDecoder::Interned(const Head& head) {
  for (const auto& known : heads_) {
    if (*known == head) return *known;
  }
  return *heads_.emplace_back(std::make_unique<const Head>(head));
}

bool ColumnDecoder::Refuse(std::string reason) {
  last_refusal_ = std::move(reason);
  return false;
}

void ColumnDecoder::OnScan(const Scan& scan) {
  ++totals_.num_scans;
  if (scan.is_partial_start || scan.is_partial_end) ++totals_.num_partial_scans;
  if (scan.has_hole) ++totals_.num_scans_with_hole;
  last_clock_ = scan.clock;
  last_rate_radps_ = scan.rate_radps;
  on_scan_(scan);
}

std::int64_t ColumnDecoder::num_out_of_stream() const {
  auto sequence = past_counts_;
  sequence += state_->order.counts();
  return sequence.num_restarts + sequence.num_overlapping;
}

std::vector<Counter> ColumnDecoder::counters() const {
  std::vector<Counter> counters;
  for (std::size_t i = 0; i < kPacketFaultNames.size(); ++i) counters.push_back({kPacketFaultNames.at(i), totals_.packets.at(i)});
  auto sequence = past_counts_;
  sequence += state_->order.counts();
  counters.insert(counters.end(), {{"position_packets", totals_.num_positions},
                                   {"position_bad", totals_.num_bad_positions},
                                   {"data_lost", sequence.num_lost},
                                   {"data_duplicate", sequence.num_duplicates},
                                   {"data_reordered", sequence.num_reordered},
                                   {"data_late", sequence.num_late},
                                   {"data_overlapping", sequence.num_overlapping},
                                   {"sensor_restarts", sequence.num_restarts},
                                   {"sensor_clock_steps", sequence.num_clock_steps},
                                   {"returns_too_far", totals_.num_too_far},
                                   {"scans", totals_.num_scans},
                                   {"scans_partial", totals_.num_partial_scans},
                                   {"scans_with_hole", totals_.num_scans_with_hole},
                                   {"scans_capped", totals_.num_capped_scans},
                                   {"sentences", totals_.num_sentences}});
  return counters;
}

}  // namespace lookout::lidar
