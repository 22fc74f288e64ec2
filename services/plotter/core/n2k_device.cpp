#include "services/plotter/core/n2k_device.hpp"

#include <algorithm>
#include <utility>

#include "common/core/hash.hpp"

namespace lookout::plotter {

namespace {

using std::chrono::microseconds;

enum Pgn : std::uint32_t {
  kAcknowledgement = 59392,
  kRequest = 59904,
  kTransportData = 60160,
  kTransportControl = 60416,
  kAddressClaim = 60928,
  kCommandedAddress = 65240,
  kPgnList = 126464,
  kHeartbeat = 126993,
  kProductInformation = 126996,
};
// PGNs that each device sends, and PGNs that each device accepts.
constexpr std::array<std::uint32_t, 6> kSentByEach{kAcknowledgement, kRequest, kAddressClaim, kPgnList, kHeartbeat, kProductInformation};
constexpr std::array<std::uint32_t, 3> kTakenByEach{kRequest, kAddressClaim, kCommandedAddress};

// A device that cannot claim an address says so after a delay of up to 153 ms, as many devices may have to at once.
constexpr std::uint64_t kMostDelays = 154;

constexpr std::uint8_t kPriority = 6;
constexpr std::size_t kNameBytes = 8;
constexpr std::size_t kPgnBytes = 3;

void AddLittleEndian(std::vector<std::uint8_t>& bytes, std::uint64_t value, std::size_t num_bytes) {
  for (std::size_t i = 0; i < num_bytes; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> 8U * i));
}

std::uint64_t LittleEndian(const std::vector<std::uint8_t>& bytes, std::size_t offset, std::size_t num_bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < num_bytes; ++i) value |= static_cast<std::uint64_t>(bytes.at(offset + i)) << 8U * i;
  return value;
}

// Adds a text of fixed length, filled up with 0xFF. Each byte that is no printable ASCII becomes a blank.
void AddFixedText(std::vector<std::uint8_t>& bytes, const std::string& text) {
  constexpr std::size_t kFixedTextBytes = 32;
  for (std::size_t i = 0; i < kFixedTextBytes; ++i) {
    const auto letter = static_cast<std::uint8_t>(i < text.size() ? text[i] : '\xFF');
    const bool is_printable = letter >= 0x20 && letter < 0x7F;
    bytes.push_back(i >= text.size() || is_printable ? letter : static_cast<std::uint8_t>(' '));
  }
}

N2kMessage RequestOfAddresses() {
  N2kMessage message{.pgn = kRequest, .priority = kPriority, .payload = {}};
  AddLittleEndian(message.payload, kAddressClaim, kPgnBytes);
  return message;
}

// Control byte 1: no such PGN; 3: cannot respond, of a PGN that comes by itself.
N2kMessage NoMessage(std::uint32_t pgn, bool is_sent, std::uint8_t destination) {
  const auto control = static_cast<std::uint8_t>(is_sent ? 3 : 1);
  N2kMessage message{.pgn = kAcknowledgement, .priority = kPriority, .payload = {control, 0xFF, 0xFF, 0xFF, 0xFF}, .destination = destination};
  AddLittleEndian(message.payload, pgn, kPgnBytes);
  return message;
}

N2kMessage HeartbeatMessage(int number) {
  constexpr std::uint64_t kPeriodIn10Ms = std::chrono::milliseconds(N2kDevice::kHeartbeatPeriod).count() / 10;
  constexpr std::uint8_t kOperational = 0xCF;  // states of both controllers not stated, equipment status 0, reserved bits set
  N2kMessage message{.pgn = kHeartbeat, .priority = 7, .payload = {}};
  AddLittleEndian(message.payload, kPeriodIn10Ms, 2);
  message.payload.insert(message.payload.end(), {static_cast<std::uint8_t>(number), kOperational, 0xFF, 0xFF, 0xFF, 0xFF});
  return message;
}

}  // namespace

std::uint64_t N2kName(std::uint32_t unique_number) {
  constexpr std::uint64_t kManufacturer = 2046;
  constexpr std::uint64_t kFunction = 190;
  constexpr std::uint64_t kClass = 60;
  constexpr std::uint64_t kMarine = 4;
  return (unique_number & 0x1F'FFFFU) | kManufacturer << 21U | kFunction << 40U | kClass << 49U | kMarine << 60U | std::uint64_t{1} << 63U;
}

std::uint32_t UniqueNumberOf(std::string_view text) {
  const auto hash = Fnv1a(text);
  return static_cast<std::uint32_t>((hash >> 42U ^ hash >> 21U ^ hash) & 0x1F'FFFFU);
}

std::optional<std::uint64_t> ClaimedNameOf(const N2kFrame& frame) {
  if (HeaderOf(frame.id).pgn != kAddressClaim || frame.bytes.size() != kNameBytes) return std::nullopt;
  return LittleEndian(frame.bytes, 0, kNameBytes);
}

N2kMessage N2kDevice::ClaimMessage() const {
  N2kMessage message{.pgn = kAddressClaim, .priority = kPriority, .payload = {}};
  AddLittleEndian(message.payload, identity_.name, kNameBytes);
  return message;
}

N2kMessage N2kDevice::ProductMessage() const {
  N2kMessage message{.pgn = kProductInformation, .priority = kPriority, .is_fast_packet = true, .payload = {}};
  auto& bytes = message.payload;
  AddLittleEndian(bytes, 2100, 2);    // version of NMEA 2000, in thousandths
  AddLittleEndian(bytes, 0xFFFF, 2);  // NMEA has given no product code
  AddFixedText(bytes, identity_.model);
  AddFixedText(bytes, identity_.software_version);
  AddFixedText(bytes, {});  // version of the hardware
  AddFixedText(bytes, identity_.serial_number);
  bytes.push_back(0xFF);  // not certified
  bytes.push_back(0);     // takes no current from the network
  return message;
}

N2kMessage N2kDevice::ListMessage(bool is_sent, std::uint8_t destination) const {
  N2kMessage message{.pgn = kPgnList, .priority = kPriority, .is_fast_packet = true, .payload = {}, .destination = destination};
  message.payload.push_back(is_sent ? 0 : 1);
  const auto add = [&message](const auto& pgns) {
    for (const auto pgn : pgns) AddLittleEndian(message.payload, pgn, kPgnBytes);
  };
  if (!is_sent) {
    add(kTakenByEach);
    return message;
  }
  add(kSentByEach);
  add(identity_.sent_pgns);
  return message;
}

std::vector<N2kDevice::Sending> N2kDevice::TakeSendings() { return std::exchange(sendings_, {}); }

bool N2kDevice::MayAnswer(microseconds now) {
  if (now - answers_since_ >= std::chrono::seconds(1)) {
    answers_since_ = now;
    num_answers_ = 0;
  }
  if (++num_answers_ <= kMostAnswers) return true;
  ++num_unanswered_;
  return false;
}

void N2kDevice::Begin(microseconds now) {
  owners_.fill(std::nullopt);
  sendings_.clear();
  commander_.reset();
  Send(RequestOfAddresses(), kN2kNoAddress);
  Claim(address_, now);
}

void N2kDevice::Claim(std::uint8_t address, microseconds now) {
  address_ = address;
  state_ = State::kClaiming;
  claimed_ = now;
  cannot_claim_due_.reset();
  Send(ClaimMessage(), address_);
}

void N2kDevice::ClaimNext(microseconds now) {
  ++num_lost_;
  if (!MayAnswer(now)) return GiveUp(now);
  for (int i = 1; i <= kMostN2kAddress; ++i) {
    const auto candidate = static_cast<std::uint8_t>((address_ + i) % (kMostN2kAddress + 1));
    if (!owners_.at(candidate)) return Claim(candidate, now);
  }
  GiveUp(now);
}

void N2kDevice::GiveUp(microseconds now) {
  state_ = State::kNoAddress;
  next_try_ = now + kRetryPeriod;
  SayThatNone(now);
}

void N2kDevice::SayThatNone(microseconds now) {
  if (!cannot_claim_due_) cannot_claim_due_ = now + std::chrono::milliseconds(identity_.name % kMostDelays);
}

void N2kDevice::Advance(microseconds now) {
  constexpr int kMostHeartbeat = 252;
  if (cannot_claim_due_ && now >= *cannot_claim_due_) {
    cannot_claim_due_.reset();
    Send(ClaimMessage(), kN2kNoAddress);
  }
  if (state_ == State::kNoAddress && now >= next_try_) return Begin(now);
  if (state_ == State::kClaiming && now - claimed_ >= kClaimWait) {
    state_ = State::kClaimed;
    next_heartbeat_ = now;
  }
  if (state_ != State::kClaimed || now < next_heartbeat_) return;
  Send(HeartbeatMessage(heartbeat_), address_);
  heartbeat_ = heartbeat_ == kMostHeartbeat ? 0 : heartbeat_ + 1;
  next_heartbeat_ = now + kHeartbeatPeriod;
}

bool N2kDevice::Take(const N2kFrame& frame, microseconds now) {
  if (state_ == State::kOff) return true;
  const auto header = HeaderOf(frame.id);
  const bool is_to_us = header.destination == kN2kEverybody || (header.destination == address_ && state_ != State::kNoAddress);
  if (!is_to_us) return true;
  switch (header.pgn) {
    case kRequest:
      return TakeRequest(header, frame, now);
    case kAddressClaim:
      return TakeClaim(header.source, frame, now);
    case kTransportControl:
      return TakeAnnouncement(header, frame);
    case kTransportData:
      return TakePacket(header, frame, now);
    default:
      return true;
  }
}

bool N2kDevice::TakeClaim(std::uint8_t source, const N2kFrame& frame, microseconds now) {
  const auto claimed = ClaimedNameOf(frame);
  if (!claimed) return false;
  const auto name = *claimed;
  if (name == identity_.name) return true;  // our own claim, which came back
  std::ranges::replace(owners_, std::optional(name), std::optional<std::uint64_t>());
  if (source > kMostN2kAddress) return true;  // the device has no address
  const bool is_ours = source == address_ && (state_ == State::kClaiming || state_ == State::kClaimed);
  if (is_ours && identity_.name < name) {
    if (MayAnswer(now)) Send(ClaimMessage(), address_);
    return true;
  }
  owners_.at(source) = name;
  if (is_ours) ClaimNext(now);
  return true;
}

bool N2kDevice::TakeRequest(const N2kHeader& header, const N2kFrame& frame, microseconds now) {
  if (frame.bytes.size() < kPgnBytes) return false;
  const auto pgn = static_cast<std::uint32_t>(LittleEndian(frame.bytes, 0, kPgnBytes));
  if (pgn == kAddressClaim) {
    if (!MayAnswer(now)) return true;
    if (state_ == State::kNoAddress) {
      SayThatNone(now);
    } else {
      Send(ClaimMessage(), address_);
    }
    return true;
  }
  if (state_ != State::kClaimed || header.source > kMostN2kAddress) return true;
  const bool is_known = pgn == kProductInformation || pgn == kPgnList || pgn == kHeartbeat;
  // Also of a PGN that comes by itself: who asked us alone waits for an answer.
  const bool is_refused = !is_known && header.destination != kN2kEverybody;
  if ((is_known || is_refused) && MayAnswer(now)) Answer(pgn, header);
  return true;
}

void N2kDevice::Answer(std::uint32_t pgn, const N2kHeader& header) {
  switch (pgn) {
    case kProductInformation:
      return Send(ProductMessage(), address_);
    case kPgnList:
      Send(ListMessage(true, header.source), address_);
      return Send(ListMessage(false, header.source), address_);
    case kHeartbeat:
      return Send(HeartbeatMessage(heartbeat_), address_);
    default:
      return Send(NoMessage(pgn, std::ranges::find(identity_.sent_pgns, pgn) != identity_.sent_pgns.end(), header.source), address_);
  }
}

// A broadcast of several packets begins: its size, how many packets, the PGN.
bool N2kDevice::TakeAnnouncement(const N2kHeader& header, const N2kFrame& frame) {
  constexpr std::uint8_t kBroadcast = 32;
  constexpr std::size_t kBytes = 8;
  if (frame.bytes.size() != kBytes) return false;
  if (frame.bytes.front() != kBroadcast || LittleEndian(frame.bytes, 5, kPgnBytes) != kCommandedAddress) return true;
  if (LittleEndian(frame.bytes, 1, 2) != kCommandBytes || frame.bytes.at(3) != 2) return false;
  commander_ = header.source;
  command_.clear();
  return true;
}

bool N2kDevice::TakePacket(const N2kHeader& header, const N2kFrame& frame, microseconds now) {
  if (commander_ != header.source) return true;
  const auto number = command_.size() / kPacketBytes + 1;
  if (frame.bytes.size() != kPacketBytes + 1 || frame.bytes.front() != number) {
    commander_.reset();
    return false;
  }
  command_.insert(command_.end(), frame.bytes.begin() + 1, frame.bytes.end());
  if (command_.size() < kCommandBytes) return true;
  commander_.reset();
  ObeyCommand(now);
  return true;
}

void N2kDevice::ObeyCommand(microseconds now) {
  const auto address = command_.at(kNameBytes);
  if (LittleEndian(command_, 0, kNameBytes) != identity_.name || address > kMostN2kAddress) return;
  if (address != address_ && MayAnswer(now)) Claim(address, now);
}

}  // namespace lookout::plotter
