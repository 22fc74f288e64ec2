// Whose packets are used: the lidar that was heard first, by address and source port, until it is silent.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/packet_judge.hpp"

namespace lookout::lidar {

/// Where a datagram came from. Without an address (packets that were made here): one sender like any other.
struct Sender {
  std::string address;  // numeric, IPv4 or IPv6 without a zone, as inet_ntop writes it
  int port = 0;

  friend bool operator==(const Sender&, const Sender&) = default;
};

/// "192.168.1.201:2368", "[fe80::1]:2368". For people.
std::string ToText(const Sender& sender);

/// The rule uses stamps of arrival and no clock, so live and replay of a capture accept the same packets:
/// - The first sender of a valid packet of the lidar that was asked for holds the stream. Before there is a holder every packet is accepted.
/// - Data packets decide the address; position packets are taken from it alone. Each stream has a source port of its own. While nobody sends valid
///   data, the first sender of valid position packets holds that stream by itself.
/// - The holder is replaced when it was silent for kSilence, or by its own address with another port (a simulator or forwarder that started again)
///   for kPortSilence: invalid packets are silence. The next holder must have been heard for kTrial without a packet of the holder in between: a
///   clock that was set, or a process that stood still, is not silence.
class SenderLock {
 public:
  static constexpr std::chrono::seconds kSilence{10};
  static constexpr std::chrono::seconds kPortSilence{1};
  static constexpr std::chrono::milliseconds kTrial{250};
  /// A packet of a sender on trial counts for this much time at most, and a sender that is silent for longer than kTrialPause begins its trial anew.
  static constexpr std::chrono::milliseconds kTrialStep{50};
  static constexpr std::chrono::seconds kTrialPause{1};

  /// @param allowed  addresses that may hold a stream, one at a time; empty = all
  SenderLock(JudgeMaker make_judge, std::vector<std::string> allowed);

  struct Outcome {
    bool is_taken = false;
    bool is_new_holder = false;  // this packet made its sender the holder of the stream
    bool is_valid = false;       // as a packet of the lidar that was asked for
  };

  /// A packet of the right size for its stream.
  Outcome Check(Utime time, Stream stream, const Sender& sender, Bytes payload);

  /// nullopt while there is none.
  const std::optional<Sender>& holder(Stream stream) const { return streams_[static_cast<std::size_t>(stream)].holder; }

  /// When the holder's last valid packet came.
  Utime heard(Stream stream) const { return streams_[static_cast<std::size_t>(stream)].heard; }

  bool IsAllowed(const Sender& sender) const;

  /// Forgets the holders of both streams: a new run begins.
  void Reset();

 private:
  struct Candidate {
    Sender sender;
    std::unique_ptr<PacketJudge> judge;
    Utime last{};
    std::chrono::microseconds heard_for{0};
  };
  struct StreamState {
    std::optional<Sender> holder;
    std::unique_ptr<PacketJudge> judge;  // of the holder's packets
    Utime heard{};                       // when the holder's last valid packet came
    std::optional<Candidate> candidate;
  };

  Candidate* CandidateFor(StreamState& state, Utime time, const Sender& sender, Verdict alone) const;

  JudgeMaker make_judge_;
  std::vector<std::string> allowed_;
  std::array<StreamState, 2> streams_;
};

}  // namespace lookout::lidar
