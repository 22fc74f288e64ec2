// Tells the messages of one publisher of a channel from those of a second one, by their numbers and times, and counts missing messages.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/bytes.hpp"

namespace lookout::bus {

/// Where a message stands in the stream of its publisher.
struct StreamPlace {
  std::int64_t seq = 0;
  std::int64_t part_index = 0;  // parts of one scan share `seq` and `utime_us`; -1 = not known, or none: such messages may share them
  std::int64_t num_parts = 1;
  std::int64_t utime_us = 0;
  std::uint64_t digest = 0;  // of all its bytes
};

/// Whether a fingerprint is that of the channel's type.
bool IsOfType(const Channel& channel, std::uint64_t fingerprint);

/// Not cryptographic. The same on every computer.
std::uint64_t DigestOf(Bytes bytes);

/// Place of a message that is not decoded.
///
/// @return nullopt when the bytes are not of the channel's type
std::optional<StreamPlace> PlaceOf(const Channel& channel, Bytes bytes);

/// Place of a decoded message.
template <typename T>
StreamPlace PlaceOf(const T& message, Bytes bytes) {
  StreamPlace place{.seq = message.seq, .utime_us = message.utime_us, .digest = DigestOf(bytes)};
  if constexpr (requires { message.part_index; }) {
    place.part_index = message.part_index;
    place.num_parts = message.num_parts;
  } else if constexpr (requires { message.is_watch; }) {
    place.part_index = -1;  // without a scan ALERTS repeat the last number
  }
  return place;
}

/// Whether the channel has one publisher, which numbers its messages: not HEALTH, ALERT_ACK and the like, which have several, and not channels that
/// tell of the machine or of a simulation.
constexpr bool IsGuarded(const Channel& channel) { return channel.is_replayed && !HasSeveralPublishers(channel); }

/// Whether each message of its publisher was measured after the one before: not where several sensors share a channel, or a time.
constexpr bool HasRisingTimes(const Channel& channel) {
  return channel.name == kPose.name || channel.name == kLidarScan.name || channel.name == kLidarClock.name || channel.name == kSegments.name ||
         channel.name == kObstacles.name || channel.name == kTracks.name || channel.name == kLidarScan2.name || channel.name == kLidarClock2.name ||
         channel.name == kSegments2.name;
}

/// Keeps the stream first heard. A message that cannot follow in it is held: it belongs to a second publisher when the kept stream goes on, and to
/// the channel's next publisher (a restart) when the kept stream is silent for a second.
///
/// Limits: a second stream whose first message happens to have the very next number counts as the first one, until the first goes on. Of two streams
/// with equal numbers and equal times equal bytes are used once, and different bytes not at all.
class StreamGuard {
 public:
  /// Receive time, by any clock that goes forward.
  using Time = std::chrono::nanoseconds;

  enum class Act { kTake, kHold, kRefuse };
  enum class Held { kStay, kTake, kRefuse };

  /// The decision: first for the held messages, oldest first, then for this one.
  struct Decision {
    Held held = Held::kStay;
    Act act = Act::kTake;
    std::int64_t num_lost = 0;  // messages that are missing before those that are taken now, or among them
  };

  /// @param has_rising_times  see HasRisingTimes
  explicit StreamGuard(double max_rate_hz, bool has_rising_times = false) : max_rate_hz_(max_rate_hz), has_rising_times_(has_rising_times) {}
  explicit StreamGuard(const Channel& channel) : StreamGuard(channel.max_rate_hz, HasRisingTimes(channel)) {}

  /// Takes the place of the next message.
  ///
  /// @param mark  of the caller, say the number of the event in its log: see first_interleaving
  Decision Next(const StreamPlace& place, Time now, std::int64_t mark = 0);

  /// To be called now and then: whether the messages that are held are to be taken, as the kept stream is silent.
  ///
  /// @return nullopt when they stay; else how many are missing among them
  std::optional<std::int64_t> Release(Time now);

  /// Release at the end of the input: nothing can show any more to which publisher the held messages belong.
  std::optional<std::int64_t> ReleaseAtEnd();

  /// Whether messages are held.
  bool is_holding() const { return num_held_ > 0; }

  /// There is no room any more: refuses the oldest held message.
  void RefuseOldestHeld(Time now);

  /// Messages that were refused, among them lone ones whose number is corrupt.
  std::int64_t num_refused() const { return num_refused_; }

  /// Whether a second publisher was heard within the last `period`. A lone message with a wrong number is none.
  bool HasSecond(Time now, Time period) const;

  /// `mark` of the first message of a second publisher, and when it came.
  struct Interleaving {
    std::int64_t mark = 0;
    Time time{0};
  };
  const std::optional<Interleaving>& first_interleaving() const { return first_interleaving_; }

  /// The kept stream is silent for so long, or for three times its period where that is longer, when the next one replaces it.
  static constexpr Time kSilence = std::chrono::seconds(1);

 private:
  struct Stream {
    StreamPlace first;
    StreamPlace last;
    Time received{0};  // its last message
    Time began{0};     // its first message, or the first that is held
    std::int64_t mark = 0;
    std::int64_t num_steps = 0;  // messages with a new number, the first included
    std::int64_t num_lost = 0;   // among those that are held
    // Time of measurement between successive numbers: mean and mean deviation.
    double period_us = 0.0;
    double deviation_us = 0.0;
    std::int64_t num_periods = 0;
  };
  enum class Fit { kNo, kLoss, kExact };

  Decision Weigh(const StreamPlace& place, Time now, std::int64_t mark);
  Fit FitOf(const Stream& stream, const StreamPlace& place, Time now) const;
  bool IsPlausibleLoss(const Stream& stream, const StreamPlace& place, Time now, std::uint64_t distance) const;
  double MostWithin(double gap_us) const;
  int Nearer(const StreamPlace& place, Time now) const;
  bool IsOtherKeptGoingOn() const;
  Decision Join(const StreamPlace& place, Time now);
  static bool IsEven(const Stream& stream);
  bool IsEvenAndRising(const Stream& stream) const { return has_rising_times_ && IsEven(stream); }
  static Time SilenceOf(const Stream& stream);
  static bool IsAlive(const Stream& stream, Time now) { return now - stream.received < SilenceOf(stream); }
  static std::int64_t Follow(Stream& stream, const StreamPlace& place, Time now);
  static Stream Begin(const StreamPlace& place, Time now, std::int64_t mark);
  Decision Keep(const StreamPlace& place, Time now, std::int64_t mark);
  Decision DecideInKept(const StreamPlace& place, Time now);
  Decision DecideInOther(const StreamPlace& place, Time now, std::int64_t mark);
  Decision DecideInNone(const StreamPlace& place, Time now, std::int64_t mark);
  void NoteRefused(std::int64_t number, Time now, std::int64_t mark, Time began);
  bool WasTaken(const StreamPlace& place) const;
  void NoteTaken(const StreamPlace& place);

  double max_rate_hz_;
  bool has_rising_times_;
  std::optional<Stream> kept_;
  std::optional<Stream> other_;
  std::int64_t num_held_ = 0;  // of `other_`
  std::int64_t num_refused_ = 0;
  struct Refused {
    std::int64_t mark = 0;
    Time began{0};
    Time time{0};
  };
  std::optional<Refused> last_refused_;
  std::optional<Time> last_second_;
  std::optional<Interleaving> first_interleaving_;

  // The latest that were taken: a second publisher that computes the same gives the same bytes.
  struct Taken {
    std::int64_t seq = 0;
    std::uint64_t digest = 0;
    bool is_set = false;
  };
  std::array<Taken, 64> taken_{};
  std::size_t next_taken_ = 0;
};

}  // namespace lookout::bus
