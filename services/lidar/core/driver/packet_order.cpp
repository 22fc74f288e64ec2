#include "services/lidar/core/driver/packet_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::lidar {

namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kHour = std::chrono::hours(1);
// A longer gap is not a loss that could be counted: the sensor may have been off.
constexpr nanoseconds kMaxGap = std::chrono::seconds(1);
// Datagrams may wait in a network for so long: the host's clock tells of no smaller step.
constexpr nanoseconds kHostResolution = std::chrono::milliseconds(20);
// No packet is shorter: stamps that stand still do not make a gap of millions of packets.
constexpr nanoseconds kMinDuration = std::chrono::microseconds(10);
// Numbers that are farther ahead are of another stream.
constexpr std::int64_t kMaxMissingNumbers = 4096;
// Behind the last packet by more than so many, a number is of another stream.
constexpr std::int64_t kMaxLateNumbers = 512;
constexpr double kSameSectorRad = DegToRad(2.0);
constexpr int kSectorSeen = 3;
constexpr std::size_t kMaxSectors = 8;
constexpr std::size_t kMaxEmptyAhead = 64;

// By how many numbers the second is ahead, the short way round.
std::int64_t WayTo(const PacketNumber& from, const PacketNumber& to) {
  const auto modulus = static_cast<std::int64_t>(to.modulus);
  auto way = static_cast<std::int64_t>(to.number) - static_cast<std::int64_t>(from.number);
  if (way > modulus / 2) way -= modulus;
  if (way < -(modulus / 2)) way += modulus;
  return way;
}

// The way from one stamp to another; of stamps past the hour within half an hour to either side.
nanoseconds Difference(StampKind kind, nanoseconds from, nanoseconds to) {
  if (kind == StampKind::kAbsolute)
    return std::clamp(to / 2 - from / 2, -kHour, kHour) == to / 2 - from / 2 ? to - from : (to > from ? kHour : -kHour);
  nanoseconds difference = (to - from) % kHour;
  if (difference >= kHour / 2) difference -= kHour;
  if (difference < -kHour / 2) difference += kHour;
  return difference;
}

double Ratio(nanoseconds a, nanoseconds b) { return static_cast<double>(a.count()) / static_cast<double>(b.count()); }

double TurnRad(double from_rad, double to_rad) { return WrapTo2Pi(to_rad - from_rad); }

double ApartRad(double one_rad, double other_rad) { return std::abs(std::remainder(one_rad - other_rad, kTwoPi)); }

}  // namespace

PacketOrder::Mark PacketOrder::MarkOf(const Packet& packet, const Head& head) {
  Mark mark{.stamp = packet.stamp,
            .duration = std::clamp<nanoseconds>(packet.duration, kMinDuration, kMaxGap),
            .number = packet.number,
            .stamp_kind = head.stamp};
  if (!packet.columns.empty()) {
    mark.has_columns = true;
    mark.first_azimuth_rad = packet.columns.front().azimuth_rad;
    mark.last_azimuth_rad = packet.columns.back().azimuth_rad;
    mark.last_column = packet.columns.back().time;
  }
  return mark;
}

// A packet without a good column says no more than that it was sent: its stamp may be none.
void PacketOrder::PassEmpty(Utime host_time, const Packet& packet) {
  if (!last_ || !packet.number || !last_->mark.number || packet.number->modulus != last_->mark.number->modulus) return;
  const auto way = WayTo(*last_->mark.number, *packet.number);
  if (way <= 0 || way > kMaxMissingNumbers) return;
  if (empty_ahead_.size() >= kMaxEmptyAhead) empty_ahead_.erase(empty_ahead_.begin());
  if (std::ranges::find(empty_ahead_, packet.number->number) == empty_ahead_.end()) empty_ahead_.push_back(packet.number->number);
  if (way == 1) last_->host_time = host_time;
  SkipEmpty();
  ReleaseWhatIsNext();
}

// Goes on over packets without a good column whose turn it is.
void PacketOrder::SkipEmpty() {
  auto& mark = last_->mark;
  if (!mark.number || mark.number->modulus == 0) return;
  std::erase_if(empty_ahead_, [&](std::uint64_t empty) { return WayTo(*mark.number, {empty, mark.number->modulus}) <= 0; });
  while (!empty_ahead_.empty()) {
    const auto next = (mark.number->number + 1) % mark.number->modulus;
    const auto found = std::ranges::find(empty_ahead_, next);
    if (found == empty_ahead_.end()) return;
    empty_ahead_.erase(found);
    mark.number->number = next;
    mark.stamp += mark.duration;
    mark.has_columns = false;
    last_->time += mark.duration;
  }
}

// Counts, and forgets, packets before this one that seem to be missing but came without a good column.
int PacketOrder::NumEmptyBefore(const PacketNumber& number) {
  if (!last_ || !last_->mark.number) return 0;
  const auto until = WayTo(*last_->mark.number, number);
  return static_cast<int>(std::erase_if(empty_ahead_, [&](std::uint64_t empty) {
    const auto way = WayTo(*last_->mark.number, {empty, number.modulus});
    return way > 0 && way < until;
  }));
}

PacketVerdict PacketOrder::Add(Utime host_time, const Packet& packet, const Head& head) {
  if (packet.columns.empty()) {
    PassEmpty(host_time, packet);
    return PacketVerdict::kTaken;
  }
  const auto mark = MarkOf(packet, head);
  if (!last_ || last_->mark.stamp_kind != mark.stamp_kind) {
    Flush();
    Give(host_time, packet, head, {Kind::kRestart, packet.stamp, 0});
    return PacketVerdict::kTaken;
  }
  if (IsKnown(mark)) {
    ++counts_.num_duplicates;
    return PacketVerdict::kDuplicate;
  }
  auto place = PlaceOf(host_time, mark);
  num_late_in_a_row_ = place.kind == Kind::kLate ? num_late_in_a_row_ + 1 : 0;
  if (num_late_in_a_row_ > kMaxHeld) place.kind = Kind::kRestart;  // not late: the stream is another one
  if ((place.kind == Kind::kStep || place.kind == Kind::kRestart) && !held_.empty()) {
    Flush();
    if (num_late_in_a_row_ == 0) place = PlaceOf(host_time, mark);
  }
  if (place.kind == Kind::kRestart) place.time = packet.stamp;
  switch (place.kind) {
    case Kind::kDuplicate:
      ++counts_.num_duplicates;
      return PacketVerdict::kDuplicate;
    case Kind::kLate:
      ++counts_.num_reordered;
      ++counts_.num_late;
      return PacketVerdict::kLate;
    case Kind::kOverlapping:
      ++counts_.num_overlapping;
      return PacketVerdict::kOverlapping;
    case Kind::kMissing:
      Hold(host_time, packet, head);
      if (held_.size() > kMaxHeld) ReleaseFirst();
      return PacketVerdict::kTaken;
    default:
      if (!held_.empty()) ++counts_.num_reordered;
      Give(host_time, packet, head, place);
      ReleaseWhatIsNext();
      return PacketVerdict::kTaken;
  }
}

void PacketOrder::Flush() {
  while (!held_.empty()) ReleaseFirst();
}

std::optional<SensorTime> PacketOrder::TimeOfStamp(Utime host_time, microseconds stamp) const {
  if (!last_ || std::chrono::abs(host_time - last_->host_time) > std::chrono::duration_cast<microseconds>(kMaxGap)) return std::nullopt;
  return std::chrono::floor<microseconds>(last_->time + Difference(StampKind::kPastHour, last_->mark.stamp, stamp));
}

// Precondition: there is a last packet. Changes nothing.
PacketOrder::Place PacketOrder::PlaceOf(Utime host_time, const Mark& mark) const {
  const auto difference = Difference(mark.stamp_kind, last_->mark.stamp, mark.stamp);
  if (const auto place = PlaceByNumber(host_time, mark, difference)) return *place;
  const auto duration = last_->mark.duration;
  const bool is_set = IsContinuing(mark) && IsClockSet(host_time, duration, difference);
  const Place step{Kind::kStep, last_->time + duration, 0};
  if (difference > kMaxGap || difference < -kMaxGap) return is_set ? step : Place{Kind::kRestart, {}, 0};
  if (is_set) return step;
  if (difference <= nanoseconds(0)) return {Kind::kLate, last_->time + difference, 0};
  if (difference < duration / 2) return {Kind::kOverlapping, last_->time + difference, 0};
  const auto num_missing = static_cast<int>(std::lround(Ratio(difference - duration, duration)));
  return {num_missing > 0 ? Kind::kMissing : Kind::kNext, last_->time + difference, std::max(0, num_missing)};
}

// nullopt where numbers tell nothing: the sensor has none, or all of them are the same.
std::optional<PacketOrder::Place> PacketOrder::PlaceByNumber(Utime host_time, const Mark& mark, nanoseconds difference) const {
  const auto& from = last_->mark.number;
  const auto& to = mark.number;
  if (!from || !to || from->modulus != to->modulus || to->modulus < 2) return std::nullopt;
  const auto way = WayTo(*from, *to);
  if (way == 0) return difference == nanoseconds(0) ? std::optional(Place{Kind::kDuplicate, last_->time, 0}) : std::nullopt;
  if (way < 0) {
    const bool is_late = way >= -kMaxLateNumbers && difference <= nanoseconds(0) && difference >= -kMaxGap;
    return is_late ? Place{Kind::kLate, last_->time + difference, 0} : Place{Kind::kRestart, {}, 0};
  }
  if (way > kMaxMissingNumbers) return Place{Kind::kRestart, {}, 0};
  // The last packet of a window has the duration of all that is dark behind it: the true time may be less.
  const auto expected = way * last_->mark.duration;
  const auto num_lost = static_cast<int>(way - 1);
  const auto kind = num_lost > 0 ? Kind::kMissing : Kind::kNext;
  if (IsClockSet(host_time, expected, difference)) return Place{num_lost > 0 ? Kind::kRestart : Kind::kStep, last_->time + expected, num_lost};
  // A clock that is set back by a little at a time (PTP): the numbers go on.
  if (way == 1 && difference <= nanoseconds(0) && difference >= -kMaxGap) return Place{Kind::kStep, last_->time + expected, 0};
  if (difference <= nanoseconds(0) || difference > kMaxGap) return Place{Kind::kRestart, {}, 0};
  return Place{kind, last_->time + difference, num_lost};
}

// Whether the sensor's clock was set, where `expected` should have passed by it: the host's clock is nearer to that than to the difference.
bool PacketOrder::IsClockSet(Utime host_time, nanoseconds expected, nanoseconds difference) const {
  if (std::chrono::abs(difference - expected) < kHostResolution) return false;
  const nanoseconds elapsed = std::clamp<microseconds>(host_time - last_->host_time, -microseconds(std::chrono::hours(1)), std::chrono::hours(1));
  return std::chrono::abs(elapsed - expected) < std::chrono::abs(elapsed - difference);
}

// Where the next packet begins when the head fires on.
double PacketOrder::EndAzimuth() const {
  const auto& mark = last_->mark;
  return WrapTo2Pi(mark.last_azimuth_rad + rate_radps_ * ToSeconds(mark.duration - mark.last_column));
}

// Whether the head is where the last packet ended, to half of a packet; false when that is not known.
bool PacketOrder::IsContinuing(const Mark& mark) const {
  if (rate_radps_ <= 0.0 || !mark.has_columns || !last_->mark.has_columns) return false;
  return ApartRad(mark.first_azimuth_rad, EndAzimuth()) <= 0.5 * rate_radps_ * ToSeconds(last_->mark.duration);
}

bool PacketOrder::IsKnown(const Mark& mark) const {
  const bool may_be_given = Difference(mark.stamp_kind, last_->mark.stamp, mark.stamp) <= nanoseconds(0);
  const auto is_same = [&](nanoseconds stamp, double azimuth_rad) { return stamp == mark.stamp && azimuth_rad == mark.first_azimuth_rad; };
  return (may_be_given && std::ranges::any_of(known_, [&](const Known& known) { return is_same(known.stamp, known.first_azimuth_rad); })) ||
         std::ranges::any_of(held_, [&](const Held& held) {
           const auto other = MarkOf(held.packet, *held.head);
           return is_same(other.stamp, other.first_azimuth_rad);
         });
}

void PacketOrder::Hold(Utime host_time, const Packet& packet, const Head& head) {
  const auto since_last = [this](const Packet& one, const Head& its) { return Difference(its.stamp, last_->mark.stamp, one.stamp); };
  const auto place =
      std::ranges::upper_bound(held_, since_last(packet, head), {}, [&](const Held& held) { return since_last(held.packet, *held.head); });
  if (place != held_.end()) ++counts_.num_reordered;
  held_.insert(place, Held{host_time, packet, &head});
}

void PacketOrder::ReleaseFirst() {
  const Held first = std::move(held_.front());
  held_.erase(held_.begin());
  const auto place = PlaceOf(first.host_time, MarkOf(first.packet, *first.head));
  if (place.kind == Kind::kLate || place.kind == Kind::kOverlapping || place.kind == Kind::kDuplicate) {
    ++counts_.num_overlapping;  // the packet overlaps a held packet
  } else {
    Give(first.host_time, first.packet, *first.head, place.kind == Kind::kRestart ? Place{Kind::kRestart, first.packet.stamp, 0} : place);
  }
  ReleaseWhatIsNext();
}

void PacketOrder::ReleaseWhatIsNext() {
  if (!held_.empty() && PlaceOf(held_.front().host_time, MarkOf(held_.front().packet, *held_.front().head)).kind != Kind::kMissing) ReleaseFirst();
}

void PacketOrder::Give(Utime host_time, const Packet& packet, const Head& head, const Place& place) {
  const auto mark = MarkOf(packet, head);
  PlacedColumns placed{
      .packet = &packet, .head = &head, .host_time = host_time, .time = place.time, .num_lost = 0, .is_restart = place.kind == Kind::kRestart};
  if (place.kind == Kind::kStep) ++counts_.num_clock_steps;
  if (placed.is_restart) {
    if (last_) ++counts_.num_restarts;
    known_ = {};
    dark_.clear();
    fired_.reset();
    empty_ahead_.clear();
    rate_radps_ = 0.0;
  } else {
    const int num_empty = mark.number && place.num_lost > 0 ? NumEmptyBefore(*mark.number) : 0;
    placed.num_lost = LostOfGap(mark, std::max(0, place.num_lost - num_empty));
    if (place.kind == Kind::kNext && place.num_lost == 0 && mark.has_columns && last_->mark.has_columns) {
      constexpr double kShare = 1.0 / 16.0;
      const double rate_radps = TurnRad(last_->mark.first_azimuth_rad, mark.first_azimuth_rad) / ToSeconds(place.time - last_->time);
      constexpr double kFastestRadps = 40.0 * kTwoPi;
      if (rate_radps < kFastestRadps) rate_radps_ += (rate_radps - rate_radps_) * (rate_radps_ > 0.0 ? kShare : 1.0);
    }
  }
  NoteFired(packet);
  known_.at(next_known_) = {mark.stamp, mark.first_azimuth_rad};
  next_known_ = (next_known_ + 1) % known_.size();
  last_ = Last{mark, host_time, place.time};
  on_packet_(placed);
  SkipEmpty();
}

// Packets that the sensor did not send, because its field of view is limited, are no loss. A missing packet is lost where the head has fired before.
int PacketOrder::LostOfGap(const Mark& mark, int num_missing) {
  if (num_missing == 0) return 0;
  const bool may_be_dark = !mark.number && mark.has_columns && last_->mark.has_columns && rate_radps_ > 0.0;
  const double from_rad = may_be_dark ? EndAzimuth() : 0.0;
  if (!may_be_dark || HasFiredInside(from_rad, mark.first_azimuth_rad)) {
    counts_.num_lost += num_missing;
    return num_missing;
  }
  // Beyond the sector whole turns may be missing.
  const double packet_rad = rate_radps_ * ToSeconds(last_->mark.duration);
  const auto num_dark = static_cast<int>(std::lround(TurnRad(from_rad, mark.first_azimuth_rad) / packet_rad));
  const int num_beyond = (num_missing - num_dark) * packet_rad > kPi ? num_missing - num_dark : 0;
  const auto is_here = [&](const DarkSector& sector) {
    return ApartRad(sector.from_rad, from_rad) < kSameSectorRad && ApartRad(sector.to_rad, mark.first_azimuth_rad) < kSameSectorRad;
  };
  auto sector = std::ranges::find_if(dark_, is_here);
  if (sector == dark_.end()) {
    if (dark_.size() == kMaxSectors) dark_.erase(dark_.begin());
    sector = dark_.insert(dark_.end(), DarkSector{from_rad, mark.first_azimuth_rad});
  }
  if (++sector->num_seen < kSectorSeen) {
    sector->num_counted += num_missing - num_beyond;
    counts_.num_lost += num_missing;
    return num_missing;
  }
  counts_.num_lost += num_beyond - std::exchange(sector->num_counted, 0);
  return num_beyond;
}

// Whether the head ever fired between these azimuths; what is too narrow to tell counts as if.
bool PacketOrder::HasFiredInside(double from_rad, double to_rad) const {
  const double width_rad = TurnRad(from_rad, to_rad);
  // Edges are known to a column or two.
  const double margin_rad = std::min(kSameSectorRad, width_rad / 4.0);
  const auto first = static_cast<std::int64_t>(std::ceil((from_rad + margin_rad) / kBinRad));
  const auto end = static_cast<std::int64_t>(std::floor((from_rad + width_rad - margin_rad) / kBinRad));
  for (auto bin = first; bin < end; ++bin) {
    if (fired_.test(static_cast<std::size_t>(bin) % fired_.size())) return true;
  }
  return first >= end;
}

void PacketOrder::NoteFired(const Packet& packet) {
  for (const auto& column : packet.columns) fired_.set(static_cast<std::size_t>(WrapTo2Pi(column.azimuth_rad) / kBinRad) % fired_.size());
}

}  // namespace lookout::lidar
