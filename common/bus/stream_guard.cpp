#include "common/bus/stream_guard.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "common/bus/schema.hpp"

namespace lookout::bus {

namespace {

// A greater jump is a corrupt number, whatever the times say.
constexpr std::uint64_t kMaxDistance = 1'000'000'000;
// Times of measurement that are further apart are no period: a corrupt time, or a pause.
constexpr double kMaxPeriodUs = 60e6;
// How many periods make a mean, and how even a stream is that is measured by it.
constexpr std::int64_t kMinPeriods = 8;
constexpr double kMeanWeight = 0.125;
constexpr double kEvenDeviation = 0.1;
// A pause is no period: a longer one counts as so many times the mean, after the first few.
constexpr double kMostPeriods = 4.0;
constexpr std::int64_t kFewPeriods = 3;
// Most that a queue holds that was not emptied (common/bus/channels.hpp).
constexpr double kQueueUs = 2e6;
// Silence before a restart is believed is bounded also for slow channels.
constexpr std::chrono::seconds kMaxSilence(15);
// Of two guesses the better counts where it is so much better.
constexpr double kClearlyNearer = 0.5;
// Messages that come at one instant may be lost together.
constexpr double kBurstSeconds = 0.1;
constexpr double kLeastBurst = 2.0;
// How far numbers and times of one publisher may be apart, of what passed between them.
constexpr double kSameStream = 0.05;

// Numbers come from outside: subtracted as unsigned, so that no pair of them overflows.
std::uint64_t Distance(std::int64_t from, std::int64_t to) { return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from); }

// Microseconds from one time of measurement to another; may be negative.
double GapUs(const StreamPlace& from, const StreamPlace& to) { return static_cast<double>(to.utime_us) - static_cast<double>(from.utime_us); }

double InUs(std::chrono::nanoseconds time) { return 1e-3 * static_cast<double>(time.count()); }

}  // namespace

bool IsOfType(const Channel& channel, std::uint64_t fingerprint) {
  static const auto kFingerprints = [] {
    std::map<std::string_view, std::uint64_t> fingerprints;
    for (const auto& entry : kChannels) {
      const auto found = std::ranges::find(TypeFingerprints(), entry.type, &TypeFingerprint::type);
      if (found != TypeFingerprints().end()) fingerprints[entry.name] = found->fingerprint;
    }
    return fingerprints;
  }();
  const auto found = kFingerprints.find(channel.name);
  return found != kFingerprints.end() && found->second == fingerprint;
}

std::uint64_t DigestOf(Bytes bytes) {
  constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15;
  std::uint64_t digest = bytes.size() * kFactor;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    digest = (digest ^ ReadU64BigEndian(bytes, i)) * kFactor;
    digest ^= digest >> 29;
  }
  for (; i < bytes.size(); ++i) digest = (digest ^ bytes[i]) * kFactor;
  return digest ^ digest >> 32;
}

std::optional<StreamPlace> PlaceOf(const Channel& channel, Bytes bytes) {
  const auto header = ReadHeader(bytes);
  if (!header || !IsOfType(channel, header->fingerprint)) return std::nullopt;
  const bool is_one_a_seq = channel.type != kLidarScan.type && channel.type != kSegments.type && channel.type != kObstacles.type &&
                            channel.type != kTracks.type && channel.type != kAlerts.type;
  return StreamPlace{
      .seq = header->seq, .part_index = is_one_a_seq ? 0 : -1, .num_parts = 1, .utime_us = header->utime_us, .digest = DigestOf(bytes)};
}

StreamGuard::Decision StreamGuard::Next(const StreamPlace& place, Time now, std::int64_t mark) {
  Decision before;
  if (kept_ && now < kept_->received && kept_->received - now < kSilence) now = kept_->received;  // a clock that is adjusted
  if (kept_ && now < kept_->received) {  // an earlier log behind a later one: another stream, and nothing to weigh it against
    if (const auto num_lost = ReleaseAtEnd()) before = {Held::kTake, Act::kTake, *num_lost};
    kept_.reset();
    other_.reset();
  } else if (const auto num_lost = Release(now)) {
    before = {Held::kTake, Act::kTake, *num_lost};
  }
  auto decision = Weigh(place, now, mark);
  // Nothing is held any more where they were given out.
  if (before.held == Held::kTake) decision.held = Held::kTake;
  decision.num_lost += before.num_lost;
  return decision;
}

StreamGuard::Decision StreamGuard::Weigh(const StreamPlace& place, Time now, std::int64_t mark) {
  if (!kept_) return Keep(place, now, mark);
  if (other_ && num_held_ == 0 && !IsAlive(*other_, now)) other_.reset();
  const bool is_kept_alive = IsAlive(*kept_, now);
  if (is_kept_alive && WasTaken(place)) {
    NoteRefused(1, now, mark, now);
    return {Held::kStay, Act::kRefuse, 0};
  }
  const Fit in_kept = FitOf(*kept_, place, now);
  const Fit in_other = other_ ? FitOf(*other_, place, now) : Fit::kNo;
  if (in_kept == Fit::kNo && in_other == Fit::kNo) {
    // Silent: the next one, at once.
    return is_kept_alive || other_ ? DecideInNone(place, now, mark) : Keep(place, now, mark);
  }
  if (in_kept == Fit::kLoss && in_other != Fit::kNo && num_held_ > 0 && IsOtherKeptGoingOn()) return Join(place, now);
  int nearer = static_cast<int>(in_kept) - static_cast<int>(in_other);
  if (nearer == 0) nearer = Nearer(place, now);
  if (nearer > 0) return DecideInKept(place, now);
  if (nearer < 0) return DecideInOther(place, now, mark);
  // Whose it is, nothing tells. Both are followed; that both still speak shows by the second message with this number.
  const Time other_received = other_->received;
  Follow(*kept_, place, now);
  Follow(*other_, place, now);
  other_->received = other_received;
  NoteRefused(1 + num_held_, now, num_held_ > 0 ? other_->mark : mark, num_held_ > 0 ? other_->began : now);
  num_held_ = 0;
  return {Held::kRefuse, Act::kRefuse, 0};
}

// Whether the held stream goes on where the kept stream ended, by its numbers. It does when a reader stood still and more was lost than its queue
// held: nothing explains the jump at first, and then each message fits in both.
bool StreamGuard::IsOtherKeptGoingOn() const {
  const double gap_us = GapUs(kept_->last, other_->first);
  if (other_->first.seq <= kept_->last.seq || gap_us < kQueueUs) return false;
  const auto number = static_cast<double>(Distance(kept_->last.seq, other_->first.seq));
  if (!IsEven(*kept_)) return number <= MostWithin(gap_us);
  return std::abs(gap_us - number * kept_->period_us) <= (0.5 + kSameStream * number) * kept_->period_us;
}

// Both streams are one, and this is its next message.
StreamGuard::Decision StreamGuard::Join(const StreamPlace& place, Time now) {
  const auto num_lost = Follow(*other_, place, now);
  other_->num_lost += num_lost;
  return {Held::kTake, Act::kTake, ReleaseAtEnd().value_or(0)};
}

double StreamGuard::MostWithin(double gap_us) const { return 1e-6 * gap_us * max_rate_hz_ + std::max(kLeastBurst, kBurstSeconds * max_rate_hz_); }

std::optional<std::int64_t> StreamGuard::Release(Time now) {
  if (num_held_ == 0 || IsAlive(*kept_, now)) return std::nullopt;
  // A lone one may be a number gone wrong in a stream that pauses: it is given the same time to go on.
  if (other_->num_steps < 2 && IsAlive(*other_, now)) return std::nullopt;
  return ReleaseAtEnd();
}

std::optional<std::int64_t> StreamGuard::ReleaseAtEnd() {
  if (num_held_ == 0) return std::nullopt;
  std::int64_t num_lost = other_->num_lost;
  // So much is missing that the times did not explain it; still the numbers go on.
  const auto distance = Distance(kept_->last.seq, other_->first.seq);
  const double gap_s = 1e-6 * GapUs(kept_->last, other_->first);
  if (other_->first.seq > kept_->last.seq && distance <= kMaxDistance && static_cast<double>(distance) <= gap_s * max_rate_hz_) {
    num_lost += static_cast<std::int64_t>(distance) - 1;
  }
  kept_ = other_;
  other_.reset();
  num_held_ = 0;
  taken_ = {};
  NoteTaken(kept_->last);
  return num_lost;
}

void StreamGuard::RefuseOldestHeld(Time now) {
  if (num_held_ == 0) return;
  --num_held_;
  NoteRefused(1, now, other_->mark, other_->began);
}

bool StreamGuard::HasSecond(Time now, Time period) const { return last_second_ && now - *last_second_ < period; }

StreamGuard::Time StreamGuard::SilenceOf(const Stream& stream) {
  constexpr double kPeriods = 3.0;
  const Time periods(std::llround(1e3 * kPeriods * std::min(stream.period_us, kMaxPeriodUs)));
  return std::clamp<Time>(periods, kSilence, kMaxSilence);
}

bool StreamGuard::IsEven(const Stream& stream) {
  return stream.num_periods >= kMinPeriods && stream.deviation_us < kEvenDeviation * stream.period_us;
}

StreamGuard::Fit StreamGuard::FitOf(const Stream& stream, const StreamPlace& place, Time now) const {
  const auto& last = stream.last;
  if (place.seq == last.seq) {
    const bool is_next_part = place.utime_us == last.utime_us && (place.part_index < 0 || place.part_index > last.part_index);
    return is_next_part ? Fit::kExact : Fit::kNo;
  }
  if (place.seq < last.seq) return Fit::kNo;
  const auto distance = Distance(last.seq, place.seq);
  if (distance == 1) {
    // Its clock may be set back, or be exchanged for another.
    constexpr double kLeastStepBackUs = 200'000.0;
    const double gap_us = GapUs(last, place);
    return IsEvenAndRising(stream) && gap_us <= 0.0 && gap_us > -kLeastStepBackUs ? Fit::kNo : Fit::kExact;
  }
  return distance <= kMaxDistance && IsPlausibleLoss(stream, place, now, distance) ? Fit::kLoss : Fit::kNo;
}

bool StreamGuard::IsPlausibleLoss(const Stream& stream, const StreamPlace& place, Time now, std::uint64_t distance) const {
  // Between two messages that waited in a queue there is no time of receipt; one from a computer whose clock is ahead must not pass by that.
  constexpr double kGreatestSpeed = 20.0;
  constexpr double kPause = 2.0;
  const double received_us = InUs(now - stream.received);
  const double measured_us = GapUs(stream.last, place);
  const double gap_us = measured_us < 0.0 ? received_us : std::min(measured_us, kGreatestSpeed * received_us + kQueueUs);
  const auto number = static_cast<double>(distance);
  if (IsEven(stream)) {
    const double tolerance = (has_rising_times_ ? 0.25 : 0.5) + 0.25 * number;
    // More time than messages: the stream paused, and its receipt shows the pause too. Else the clock is another computer's.
    const bool has_time = measured_us <= (number + tolerance) * stream.period_us || measured_us <= kPause * received_us;
    return has_time && (number - tolerance) * stream.period_us <= gap_us;
  }
  return number <= MostWithin(gap_us);
}

// Of a message that follows in both streams: > 0 it is of the kept one, < 0 of the held one, 0 undecided.
int StreamGuard::Nearer(const StreamPlace& place, Time now) const {
  // Without a period: a program does not start again within so short a time.
  constexpr std::chrono::milliseconds kShortestRestart(300);
  if (std::max(kept_->num_periods, other_->num_periods) < kFewPeriods) return now - kept_->received < kShortestRestart ? 1 : -1;
  const auto& best = kept_->num_periods >= other_->num_periods ? *kept_ : *other_;
  const auto error_us = [&](const Stream& stream) {
    const double period_us = stream.num_periods >= kFewPeriods ? stream.period_us : best.period_us;
    return std::abs(GapUs(stream.last, place) - static_cast<double>(Distance(stream.last.seq, place.seq)) * period_us);
  };
  const double in_kept_us = error_us(*kept_);
  const double in_other_us = error_us(*other_);
  if (in_kept_us < kClearlyNearer * in_other_us) return 1;
  return in_other_us < kClearlyNearer * in_kept_us ? -1 : 0;
}

// @return how many messages are missing between the last of the stream and this one
std::int64_t StreamGuard::Follow(Stream& stream, const StreamPlace& place, Time now) {
  const auto last = stream.last;
  stream.last = place;
  stream.received = now;
  const bool has_parts = place.part_index >= 0 && last.part_index >= 0;
  if (place.seq == last.seq) return has_parts ? std::max<std::int64_t>(0, place.part_index - last.part_index - 1) : 0;
  const auto distance = static_cast<std::int64_t>(Distance(last.seq, place.seq));
  ++stream.num_steps;
  const double period_us = GapUs(last, place) / static_cast<double>(distance);
  if (period_us >= 0.0 && period_us < kMaxPeriodUs) {
    const double weight = std::max(kMeanWeight, 1.0 / static_cast<double>(stream.num_periods + 1));
    const bool has_period = stream.num_periods >= kFewPeriods && stream.period_us > 0.0;
    const double sample_us = has_period ? std::min(period_us, kMostPeriods * stream.period_us) : period_us;
    stream.period_us += weight * (sample_us - stream.period_us);
    stream.deviation_us += weight * (std::abs(sample_us - stream.period_us) - stream.deviation_us);
    ++stream.num_periods;
  }
  const std::int64_t num_lost = distance - 1 + (has_parts ? last.num_parts - last.part_index - 1 + place.part_index : 0);
  return std::max<std::int64_t>(0, num_lost);
}

StreamGuard::Stream StreamGuard::Begin(const StreamPlace& place, Time now, std::int64_t mark) {
  Stream stream;
  stream.first = stream.last = place;
  stream.received = stream.began = now;
  stream.mark = mark;
  stream.num_steps = 1;
  return stream;
}

StreamGuard::Decision StreamGuard::Keep(const StreamPlace& place, Time now, std::int64_t mark) {
  kept_ = Begin(place, now, mark);
  taken_ = {};
  NoteTaken(place);
  return {};
}

StreamGuard::Decision StreamGuard::DecideInKept(const StreamPlace& place, Time now) {
  Decision decision;
  decision.num_lost = Follow(*kept_, place, now);
  NoteTaken(place);
  if (num_held_ == 0) return decision;
  decision.held = Held::kRefuse;
  NoteRefused(num_held_, now, other_->mark, other_->began);
  num_held_ = 0;
  return decision;
}

StreamGuard::Decision StreamGuard::DecideInOther(const StreamPlace& place, Time now, std::int64_t mark) {
  const auto num_lost = Follow(*other_, place, now);
  if (num_held_ == 0) {  // those before are refused already
    other_->first = place;
    other_->began = now;
    other_->mark = mark;
    other_->num_lost = 0;
  } else {
    other_->num_lost += num_lost;
  }
  ++num_held_;
  return {Held::kStay, Act::kHold, 0};
}

// A message that follows in neither stream.
StreamGuard::Decision StreamGuard::DecideInNone(const StreamPlace& place, Time now, std::int64_t mark) {
  if (other_ && other_->num_steps > 1 && IsAlive(*other_, now)) {
    if (place.seq == other_->last.seq) other_->received = now;  // of two that nothing tells apart: both still speak
    NoteRefused(1, now, mark, now);
    return {Held::kStay, Act::kRefuse, 0};
  }
  Decision decision{Held::kStay, Act::kHold, 0};
  if (num_held_ > 0) {
    decision.held = Held::kRefuse;
    NoteRefused(num_held_, now, other_->mark, other_->began);
  }
  other_ = Begin(place, now, mark);
  num_held_ = 1;
  return decision;
}

// A single message is a wrong number; two within the time that makes a silence are a second publisher.
void StreamGuard::NoteRefused(std::int64_t number, Time now, std::int64_t mark, Time began) {
  num_refused_ += number;
  const bool is_second = number > 1 || (last_refused_ && now - last_refused_->time < SilenceOf(*kept_));
  const Interleaving first{mark, began};
  if (is_second) {
    if (!first_interleaving_) first_interleaving_ = number > 1 ? first : Interleaving{last_refused_->mark, last_refused_->began};
    last_second_ = now;
  }
  last_refused_ = {mark, began, now};
}

bool StreamGuard::WasTaken(const StreamPlace& place) const {
  return std::ranges::any_of(taken_, [&](const Taken& taken) { return taken.is_set && taken.seq == place.seq && taken.digest == place.digest; });
}

void StreamGuard::NoteTaken(const StreamPlace& place) {
  taken_[next_taken_] = {place.seq, place.digest, true};
  next_taken_ = (next_taken_ + 1) % taken_.size();
}

}  // namespace lookout::bus
