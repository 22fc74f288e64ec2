#include "services/lidar/core/vlp16/packet_sequencer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lookout::vlp16 {

namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr microseconds kHour(format::kMicrosecondsPerHour);
// A longer gap is not a loss that could be counted: the sensor may have been off.
constexpr microseconds kMaxGap = std::chrono::seconds(1);
// Rate of the head: it may change by so much of the way while packets are missing (real heads: 0.3 %).
constexpr double kMaxRateError = 0.02;
// A head that rotates slower, per format::kBlockPeriod, is about to stand or to start: its azimuth tells of no loss.
constexpr double kStillRateCdeg = 1.0;
// Datagrams may wait in a network for so long: the host's clock tells of no smaller step.
constexpr microseconds kHostResolution = std::chrono::milliseconds(20);
// The rate is known from one packet to some percent at first.
constexpr double kMaxDarkError = 0.1;

// The way from one stamp to another, within half an hour to either side.
microseconds Difference(std::uint32_t from_us, std::uint32_t to_us) {
  microseconds difference = (microseconds(to_us) - microseconds(from_us)) % kHour;
  if (difference >= kHour / 2) difference -= kHour;
  if (difference < -kHour / 2) difference += kHour;
  return difference;
}

// Per format::kBlockPeriod, jumps left out.
double MeanGapCdeg(const DataPacket& packet, const Steps& steps) {
  return static_cast<double>(std::accumulate(steps.gap_cdeg.begin(), steps.gap_cdeg.begin() + packet.num_steps, 0)) / packet.num_steps;
}

double Ratio(nanoseconds a, nanoseconds b) { return static_cast<double>(a.count()) / static_cast<double>(b.count()); }

}  // namespace

PacketVerdict PacketSequencer::Add(Utime host_time, const DataPacket& packet, Model model) {
  if (!last_) {
    Give(host_time, packet, model, {Kind::kRestart, SensorTime(packet.stamp_us), 0, false});
    return PacketVerdict::kTaken;
  }
  if (IsKnown(packet)) {
    ++counts_.num_duplicates;
    return PacketVerdict::kDuplicate;
  }
  auto place = PlaceOf(host_time, packet);
  num_late_in_a_row_ = place.kind == Kind::kLate ? num_late_in_a_row_ + 1 : 0;
  if (num_late_in_a_row_ > kMaxHeld) place.kind = Kind::kRestart;  // not late: the stream is another one
  if ((place.kind == Kind::kStep || place.kind == Kind::kRestart) && !held_.empty()) {
    Flush();
    if (num_late_in_a_row_ == 0) place = PlaceOf(host_time, packet);
  }
  if (place.kind == Kind::kRestart) place.time = SensorTime(packet.stamp_us);
  switch (place.kind) {
    case Kind::kLate:
      ++counts_.num_reordered;
      ++counts_.num_late;
      return PacketVerdict::kLate;
    case Kind::kOverlapping:
      ++counts_.num_overlapping;
      return PacketVerdict::kOverlapping;
    case Kind::kMissing:
      Hold(host_time, packet, model);
      if (held_.size() > kMaxHeld) ReleaseFirst();
      return PacketVerdict::kTaken;
    default:
      if (!held_.empty()) ++counts_.num_reordered;
      Give(host_time, packet, model, place);
      ReleaseWhatIsNext();
      return PacketVerdict::kTaken;
  }
}

void PacketSequencer::Flush() {
  while (!held_.empty()) ReleaseFirst();
}

std::optional<SensorTime> PacketSequencer::TimeOfStamp(Utime host_time, std::uint32_t stamp_us) const {
  if (!last_ || std::chrono::abs(host_time - last_->host_time) > kMaxGap) return std::nullopt;
  return last_->time + Difference(last_->packet.stamp_us, stamp_us);
}

// Precondition: there is a last packet. Changes nothing.
PacketSequencer::Place PacketSequencer::PlaceOf(Utime host_time, const DataPacket& packet) const {
  const microseconds difference = Difference(last_->packet.stamp_us, packet.stamp_us);
  const bool is_set = IsClockSet(host_time, packet, difference);
  Place place;
  place.time = last_->time + difference;
  // A packet that comes late was fired where the head was then.
  const double back_cdeg = rate_cdeg_ * Ratio(difference, format::kBlockPeriod);
  const bool is_late = difference >= -kMaxGap && IsAt(packet, last_->packet.azimuth_cdeg[0] + back_cdeg);
  const bool is_far_back = difference < -static_cast<int>(kMaxHeld) * last_->packet.period() && !is_late;
  const bool is_long_ago = std::chrono::abs(host_time - last_->host_time) > kHour / 2 && !IsContinuing(packet);
  if (is_long_ago || difference > kMaxGap || is_far_back) {
    place.kind = is_set ? Kind::kStep : Kind::kRestart;
  } else if (difference <= microseconds(0)) {
    place.kind = is_set ? Kind::kStep : Kind::kLate;
  } else if (difference < last_->packet.period() / 2) {
    place.kind = is_set ? Kind::kStep : Kind::kOverlapping;
  } else {
    const double num_missing = Ratio(difference - last_->steps.duration, last_->packet.period());
    // How long the head was dark within the last packet is an estimate; where it goes on, nothing is missing.
    const double num_dark = Ratio(last_->steps.duration, last_->packet.period()) - 1.0;
    const bool is_dark_longer = IsContinuing(packet) && num_missing < kMaxDarkError * num_dark;
    if (num_missing >= 0.5 && !is_dark_longer) return PlaceBehindGap(host_time, packet, place, num_missing);
    place.is_disagreeing = !IsContinuing(packet) && SweepCdeg() > 0.0;
  }
  if (place.kind == Kind::kStep) place.time = last_->time + std::chrono::round<microseconds>(last_->steps.duration);
  return place;
}

// Whether the sensor's clock was set by the difference of the stamps, less the packet that passed: the head goes on where it was, and the host's
// clock is nearer to one packet than to the difference, where it can tell at all.
bool PacketSequencer::IsClockSet(Utime host_time, const DataPacket& packet, microseconds difference) const {
  if (!IsContinuing(packet)) return false;
  const nanoseconds step = difference - last_->steps.duration;
  if (std::chrono::abs(step) < kHostResolution) return true;
  const nanoseconds elapsed = host_time - last_->host_time;
  return std::chrono::abs(elapsed - last_->steps.duration) < std::chrono::abs(elapsed - difference);
}

// Sensor time says that packets are missing: does the azimuth agree?
PacketSequencer::Place PacketSequencer::PlaceBehindGap(Utime host_time, const DataPacket& packet, Place place, double num_missing) const {
  place.kind = Kind::kMissing;
  place.num_lost = static_cast<int>(std::lround(num_missing));
  const double sweep_cdeg = SweepCdeg();
  if (sweep_cdeg <= 0.0) return place;  // a head that stands
  const Gap gap{last_->steps.end_cdeg, packet.azimuth_cdeg[0]};
  const int gap_cdeg = ClockwiseCdeg(gap.from_cdeg, gap.to_cdeg);
  const double packets_per_revolution = static_cast<double>(format::kAzimuthsPerRevolution) / sweep_cdeg;
  const double num_passed = gap_cdeg / sweep_cdeg;
  const double error = std::abs(std::remainder(num_passed - num_missing, packets_per_revolution));
  place.is_disagreeing = error > 0.5 + kMaxRateError * num_missing;
  // A gap of about whole revolutions looks like none in azimuth.
  const bool is_about_a_revolution = num_missing > packets_per_revolution - 1.0;
  const bool is_set = IsClockSet(host_time, packet, place.time - last_->time);
  if (is_set && (place.is_disagreeing || is_about_a_revolution)) {
    return {Kind::kStep, last_->time + std::chrono::round<microseconds>(last_->steps.duration), 0, false};
  }
  const int sector_cdeg = blind_sector_.WidthCdeg();
  if (sector_cdeg == 0 || place.is_disagreeing) return place;
  const double num_revolutions = std::max(0.0, std::round((num_missing - num_passed) / packets_per_revolution));
  const int hidden_cdeg = blind_sector_.HiddenCdeg(gap, last_->last_gap_cdeg());
  const double visible_cdeg = (gap_cdeg - hidden_cdeg) + num_revolutions * (format::kAzimuthsPerRevolution - sector_cdeg);
  place.num_lost = std::max(0, static_cast<int>(std::lround(visible_cdeg / sweep_cdeg)));
  if (place.num_lost == 0) place.kind = Kind::kNext;
  return place;
}

// Measures the rate from the begin of one packet to the begin of the next where none is missing between. Averages over some 16 packets, as azimuths
// have a resolution of 0.01 deg.
void PacketSequencer::MeasureRate(const DataPacket& packet, const PlacedPacket& placed) {
  constexpr double kShare = 1.0 / 16.0;
  const int rotated_cdeg = ClockwiseCdeg(last_->packet.azimuth_cdeg[0], packet.azimuth_cdeg[0]);
  const double rate_cdeg = rotated_cdeg / Ratio(placed.time - last_->time, format::kBlockPeriod);
  if (rate_cdeg > kMaxGapCdeg) return;  // an encoder that went back a little
  rate_cdeg_ += (rate_cdeg - rate_cdeg_) * (rate_cdeg_ > 0.0 ? kShare : 1.0);
}

// Rotation of the head during one packet; 0 when the head stands, or its rate is not known.
double PacketSequencer::SweepCdeg() const { return rate_cdeg_ < kStillRateCdeg ? 0.0 : rate_cdeg_ * last_->packet.num_steps; }

// Whether the packet begins at this azimuth, to half of a packet's rotation; false when the rate is not known.
bool PacketSequencer::IsAt(const DataPacket& packet, double azimuth_cdeg) const {
  const double off_cdeg = std::abs(std::remainder(packet.azimuth_cdeg[0] - azimuth_cdeg, format::kAzimuthsPerRevolution));
  return SweepCdeg() > 0.0 && off_cdeg <= 0.5 * SweepCdeg();
}

// Whether the head is where the last packet ended, as far as is known.
bool PacketSequencer::IsContinuing(const DataPacket& packet) const { return IsAt(packet, last_->steps.end_cdeg); }

bool PacketSequencer::IsKnown(const DataPacket& packet) const {
  const auto is_same = [&](std::uint32_t stamp_us, int azimuth_cdeg) {
    return stamp_us == packet.stamp_us && azimuth_cdeg == packet.azimuth_cdeg[0];
  };
  // Packets that are after the last cannot have been passed on.
  const bool may_be_given = Difference(last_->packet.stamp_us, packet.stamp_us) <= microseconds(0);
  return (may_be_given && std::ranges::any_of(known_, [&](const Known& known) { return is_same(known.stamp_us, known.azimuth_cdeg); })) ||
         std::ranges::any_of(held_, [&](const Held& held) { return is_same(held.packet.stamp_us, held.packet.azimuth_cdeg[0]); });
}

void PacketSequencer::Hold(Utime host_time, const DataPacket& packet, Model model) {
  const auto since_last = [this](std::uint32_t stamp_us) { return Difference(last_->packet.stamp_us, stamp_us); };
  const auto place =
      std::ranges::upper_bound(held_, since_last(packet.stamp_us), {}, [&](const Held& held) { return since_last(held.packet.stamp_us); });
  if (place != held_.end()) ++counts_.num_reordered;
  auto& held = *held_.insert(place, Held{host_time, packet, model, {}});
  std::ranges::copy(packet.payload, held.payload.begin());
}

void PacketSequencer::ReleaseFirst() {
  Held first = held_.front();
  first.packet.payload = first.payload;
  held_.erase(held_.begin());
  const auto place = PlaceOf(first.host_time, first.packet);
  if (place.kind == Kind::kLate || place.kind == Kind::kOverlapping) {
    ++counts_.num_overlapping;  // the packet overlaps a held packet
  } else {
    Give(first.host_time, first.packet, first.model, place);
  }
  ReleaseWhatIsNext();
}

void PacketSequencer::ReleaseWhatIsNext() {
  if (!held_.empty() && PlaceOf(held_.front().host_time, held_.front().packet).kind != Kind::kMissing) ReleaseFirst();
}

void PacketSequencer::Give(Utime host_time, const DataPacket& packet, Model model, const Place& place) {
  PlacedPacket placed;
  placed.packet = packet;
  placed.model = model;
  placed.host_time = host_time;
  placed.time = place.time;
  placed.is_restart = place.kind == Kind::kRestart;
  placed.is_elsewhere = place.kind == Kind::kNext && place.is_disagreeing;
  if (placed.is_restart) rate_cdeg_ = 0.0;
  // A head that stands or starts to turn goes on nowhere, and its rate must be measured to see that it turns.
  const bool is_next = place.kind == Kind::kNext && !last_->steps.jump && (SweepCdeg() == 0.0 || IsContinuing(packet));
  if (is_next) MeasureRate(packet, placed);
  placed.steps = MeasureSteps(packet, rate_cdeg_);
  if (rate_cdeg_ == 0.0) rate_cdeg_ = MeanGapCdeg(packet, placed.steps);
  counts_.num_disagreements += place.is_disagreeing ? 1 : 0;
  if (place.kind == Kind::kStep) ++counts_.num_clock_steps;
  if (place.kind == Kind::kStep || placed.is_restart) known_ = {};
  if (placed.is_restart) {
    if (last_) ++counts_.num_restarts;
    blind_sector_ = {};
  }
  if (place.kind == Kind::kMissing) {
    const Gap gap{last_->steps.end_cdeg, packet.azimuth_cdeg[0]};
    const int num_unsent = blind_sector_.OnLoss(gap, place.num_lost, last_->last_gap_cdeg());
    placed.num_lost = num_unsent > 0 ? 0 : place.num_lost;
    counts_.num_lost += place.num_lost - num_unsent;
  }
  counts_.num_lost -= blind_sector_.OnPacket(packet, placed.steps);
  known_[next_known_] = {packet.stamp_us, packet.azimuth_cdeg[0]};
  next_known_ = (next_known_ + 1) % known_.size();
  last_ = placed;
  last_->packet.payload = {};
  on_packet_(placed);
}

}  // namespace lookout::vlp16
