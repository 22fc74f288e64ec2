// This computer as a device of an NMEA 2000 network: it claims an address and keeps it, and says who it is. ISO 11783-5 (claim, contention, commanded
// address), ISO 11783-3 (request, acknowledgement, broadcast of several packets) and canboat's description of PGN 126464, 126993 and 126996.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/plotter/core/n2k_frame.hpp"

namespace lookout::plotter {

inline constexpr int kMostN2kAddress = 251;

/// NAME of 64 bits, of which the lower wins an address: unique number, manufacturer 2046, function 190 (navigation management) of class 60
/// (navigation), industry group 4 (marine), capable of any address. The manufacturer is none that NMEA has given: Lookout has no number there.
///
/// @param unique_number  21 bits, of this device among all on the network
std::uint64_t N2kName(std::uint32_t unique_number);

/// 21 bits out of a text, the same on each computer and at each start.
std::uint32_t UniqueNumberOf(std::string_view text);

/// The NAME in a claim of an address. nullopt: the frame is no such claim.
std::optional<std::uint64_t> ClaimedNameOf(const N2kFrame& frame);

struct N2kIdentity {
  std::uint64_t name = 0;
  std::uint8_t preferred_address = 0;  // 0 to kMostN2kAddress
  std::string model = {};              // this text and the next two: ASCII, cut off after 32 bytes
  std::string software_version = {};
  std::string serial_number = {};
  std::vector<std::uint32_t> sent_pgns = {};  // besides the PGNs that each device sends
};

/// Begin tells the network which address this device wants. Where nobody contends for 250 ms the address is ours. Where two NAMEs want it the lower
/// NAME wins; the loser claims the next address that no device was heard to have. After the last address the device says that it has none, and tries
/// again after a minute. Time is host time passed.
class N2kDevice {
 public:
  static constexpr std::chrono::milliseconds kClaimWait{250};
  static constexpr std::chrono::seconds kHeartbeatPeriod{60};
  static constexpr std::chrono::seconds kRetryPeriod{60};
  /// Most answers a second to requests and contending claims: a flood of these holds nobody up.
  static constexpr int kMostAnswers = 20;

  enum class State { kOff, kClaiming, kClaimed, kNoAddress };

  struct Sending {
    N2kMessage message;
    std::uint8_t source = kN2kNoAddress;
  };

  explicit N2kDevice(N2kIdentity identity) : identity_(std::move(identity)), address_(identity_.preferred_address) {}

  /// The network is there, or is there again: claims the address that this device had last. Forgets the addresses of other devices.
  void Begin(std::chrono::microseconds now);
  /// Does what is due. Ten times a second or more.
  void Advance(std::chrono::microseconds now);
  /// Reads any frame of the network. Frames of other PGNs, and frames to other devices, change nothing.
  ///
  /// @return false where the frame is impossible: a request, a claim or a part of a commanded address of a wrong length
  bool Take(const N2kFrame& frame, std::chrono::microseconds now);

  /// Messages to be sent, in this order. Each is returned once.
  std::vector<Sending> TakeSendings();

  State state() const { return state_; }
  /// The address that is claimed or being claimed.
  std::uint8_t address() const { return address_; }
  /// Messages of ours may be sent from address().
  bool is_claimed() const { return state_ == State::kClaimed; }
  std::int64_t num_addresses_lost() const { return num_lost_; }
  /// Answers that were not given, since more than kMostAnswers were asked for in a second.
  std::int64_t num_unanswered() const { return num_unanswered_; }

 private:
  void Send(N2kMessage message, std::uint8_t source) { sendings_.push_back({std::move(message), source}); }
  bool MayAnswer(std::chrono::microseconds now);
  void Claim(std::uint8_t address, std::chrono::microseconds now);
  void ClaimNext(std::chrono::microseconds now);
  void GiveUp(std::chrono::microseconds now);
  void SayThatNone(std::chrono::microseconds now);
  bool TakeClaim(std::uint8_t source, const N2kFrame& frame, std::chrono::microseconds now);
  bool TakeRequest(const N2kHeader& header, const N2kFrame& frame, std::chrono::microseconds now);
  void Answer(std::uint32_t pgn, const N2kHeader& header);
  bool TakeAnnouncement(const N2kHeader& header, const N2kFrame& frame);
  bool TakePacket(const N2kHeader& header, const N2kFrame& frame, std::chrono::microseconds now);
  void ObeyCommand(std::chrono::microseconds now);
  N2kMessage ClaimMessage() const;
  N2kMessage ProductMessage() const;
  N2kMessage ListMessage(bool is_sent, std::uint8_t destination) const;

  static constexpr std::size_t kCommandBytes = 9;  // NAME, new address
  static constexpr std::size_t kPacketBytes = 7;

  N2kIdentity identity_;
  std::uint8_t address_;
  State state_ = State::kOff;
  std::chrono::microseconds claimed_{0};   // when the address was claimed last
  std::chrono::microseconds next_try_{0};  // with kNoAddress
  std::optional<std::chrono::microseconds> cannot_claim_due_;
  std::chrono::microseconds next_heartbeat_{0};
  int heartbeat_ = 0;                                                       // 0 to 252
  std::array<std::optional<std::uint64_t>, kMostN2kAddress + 1> owners_{};  // others' NAMEs by address
  std::vector<Sending> sendings_;
  std::chrono::microseconds answers_since_{0};
  int num_answers_ = 0;
  // A commanded address that is being received: from whom, what came.
  std::optional<std::uint8_t> commander_;
  std::vector<std::uint8_t> command_;
  std::int64_t num_lost_ = 0;
  std::int64_t num_unanswered_ = 0;
};

}  // namespace lookout::plotter
