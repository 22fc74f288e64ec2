#include "common/bus/datagram_filter.hpp"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>

#include <cstddef>
#include <utility>

namespace lookout::bus {

namespace {

// A UDP socket's filter sees the datagram from its UDP header on.
constexpr std::uint32_t kUdpHeaderBytes = 8;
constexpr std::uint32_t kDestinationPort = 2;
constexpr std::uint32_t kMagic = kUdpHeaderBytes;
constexpr std::uint32_t kMessageSize = kUdpHeaderBytes + 8;
constexpr std::uint32_t kFragmentOffset = kUdpHeaderBytes + 12;
constexpr std::uint32_t kFragmentNumber = kUdpHeaderBytes + 16;
constexpr std::uint32_t kNumFragments = kUdpHeaderBytes + 18;
constexpr std::uint32_t kShortName = kUdpHeaderBytes + kShortHeaderBytes;
constexpr std::uint32_t kFragmentName = kUdpHeaderBytes + kFragmentHeaderBytes;
// In the IP header.
constexpr auto kDestinationAddress = static_cast<std::uint32_t>(SKF_NET_OFF) + 16;
constexpr auto kPacketType = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_PKTTYPE);
constexpr auto kInterfaceIndex = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_IFINDEX);

constexpr std::uint32_t kShortMagic = 0x4c433032;     // LC02
constexpr std::uint32_t kFragmentMagic = 0x4c433033;  // LC03

// Scratch words of the program.
constexpr std::uint32_t kNameSlot = 0;    // bytes of the name with its NUL
constexpr std::uint32_t kSizeSlot = 1;    // of the message
constexpr std::uint32_t kOffsetSlot = 2;  // of the fragment

// Its products and sums must stay below 32 bits.
static_assert(65'535ULL * kMaxFragmentBytes < 1ULL << 32);
static_assert(kMaxForeignMessageBytes < 1U << 30);

// Conditional jumps reach 255 instructions, so each drops by a `return` of its own behind it, and only the plain jumps go far. A load outside of the
// datagram ends a program with 0: dropped.
class Program {
 public:
  void Do(unsigned int code, std::uint32_t value = 0) { instructions_.push_back({static_cast<std::uint16_t>(code), 0, 0, value}); }

  void LoadWord(std::uint32_t place) { Do(BPF_LD | BPF_W | BPF_ABS, place); }
  void LoadHalf(std::uint32_t place) { Do(BPF_LD | BPF_H | BPF_ABS, place); }
  void LoadLength() { Do(BPF_LD | BPF_W | BPF_LEN); }
  void LoadNumber(std::uint32_t value) { Do(BPF_LD | BPF_IMM, value); }
  void LoadSlot(std::uint32_t slot) { Do(BPF_LD | BPF_MEM, slot); }
  void LoadIndexFromSlot(std::uint32_t slot) { Do(BPF_LDX | BPF_MEM, slot); }
  void LoadIndex(std::uint32_t value) { Do(BPF_LDX | BPF_IMM, value); }
  void CopyToIndex() { Do(BPF_MISC | BPF_TAX); }
  void Store(std::uint32_t slot) { Do(BPF_ST, slot); }

  void DropUnlessEqual(std::uint32_t value) { DropUnless(BPF_JEQ | BPF_K, value); }
  void DropUnlessAtLeast(std::uint32_t value) { DropUnless(BPF_JGE | BPF_K, value); }
  void DropIfGreater(std::uint32_t value) { DropIf(BPF_JGT | BPF_K, value); }
  void DropIfGreaterThanIndex() { DropIf(BPF_JGT | BPF_X, 0); }
  void DropIfAtLeastIndex() { DropIf(BPF_JGE | BPF_X, 0); }

  void Drop() { Do(BPF_RET | BPF_K, 0); }
  void Take() { Do(BPF_RET | BPF_K, 0xFFFFFFFF); }

  // Jumps over the next `count` when equal.
  void SkipIfEqual(std::uint32_t value, std::uint8_t count) { instructions_.push_back({BPF_JMP | BPF_JEQ | BPF_K, count, 0, value}); }
  void SkipUnlessEqual(std::uint32_t value, std::uint8_t count) { instructions_.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, count, value}); }

  // A jump whose target comes later.
  std::size_t Jump() {
    Do(BPF_JMP | BPF_JA);
    return instructions_.size() - 1;
  }
  void LandHere(std::size_t jump) { instructions_[jump].k = static_cast<std::uint32_t>(instructions_.size() - jump - 1); }

  std::vector<sock_filter> Finish() { return std::move(instructions_); }

 private:
  void DropUnless(unsigned int condition, std::uint32_t value) {
    instructions_.push_back({static_cast<std::uint16_t>(BPF_JMP | condition), 1, 0, value});
    Drop();
  }
  void DropIf(unsigned int condition, std::uint32_t value) {
    instructions_.push_back({static_cast<std::uint16_t>(BPF_JMP | condition), 0, 1, value});
    Drop();
  }

  std::vector<sock_filter> instructions_;
};

// The name from the index on, and where it ends: its length with NUL into its slot. Goes on behind itself.
void CheckName(Program& program) {
  std::vector<std::size_t> ends;
  for (std::uint32_t i = 0; i <= kMaxChannelCharacters; ++i) {
    program.Do(BPF_LD | BPF_B | BPF_IND, i);
    if (i > 0) {
      program.SkipUnlessEqual(0, 2);
      program.LoadNumber(i + 1);
      ends.push_back(program.Jump());
    }
    program.DropUnlessAtLeast(' ');
    program.DropIfGreater('~');
  }
  program.Drop();  // too long
  for (const auto end : ends) program.LandHere(end);
  program.Store(kNameSlot);
}

}  // namespace

std::vector<sock_filter> DatagramFilter(const DatagramPolicy& policy) {
  Program program;
  program.LoadWord(kDestinationAddress);
  program.DropUnlessEqual(policy.group);
  program.LoadHalf(kDestinationPort);
  program.DropUnlessEqual(policy.port);
  if (policy.is_this_computer_only) {
    program.LoadWord(kPacketType);
    program.SkipIfEqual(PACKET_LOOPBACK, 3);
    program.LoadWord(kInterfaceIndex);
    program.DropUnlessEqual(policy.loopback_index);
  }
  program.LoadNumber(0);
  for (const auto slot : {kNameSlot, kSizeSlot, kOffsetSlot}) program.Store(slot);

  program.LoadWord(kMagic);
  program.SkipUnlessEqual(kShortMagic, 2);
  program.LoadIndex(kShortName);
  const auto to_name_of_short = program.Jump();
  program.DropUnlessEqual(kFragmentMagic);

  // A fragment's header. Its last field is read first: that it is there says that all are.
  program.LoadHalf(kNumFragments);
  program.CopyToIndex();
  program.LoadHalf(kFragmentNumber);
  program.DropIfAtLeastIndex();
  program.LoadWord(kFragmentOffset);
  program.DropIfGreater(kMaxForeignMessageBytes);
  program.Store(kOffsetSlot);
  program.LoadWord(kMessageSize);
  program.DropIfGreater(kMaxForeignMessageBytes);
  program.Store(kSizeSlot);
  program.LoadHalf(kNumFragments);
  program.Do(BPF_ALU | BPF_MUL | BPF_K, kMaxFragmentBytes);
  program.CopyToIndex();
  program.LoadSlot(kSizeSlot);
  program.DropIfGreaterThanIndex();
  program.LoadIndex(kFragmentName);
  program.LoadHalf(kFragmentNumber);
  program.SkipIfEqual(0, 1);
  const auto to_end_of_fragment = program.Jump();

  program.LandHere(to_name_of_short);
  CheckName(program);
  program.Do(BPF_MISC | BPF_TXA);
  program.SkipUnlessEqual(kShortName, 1);
  program.Take();

  program.LandHere(to_end_of_fragment);
  program.LoadLength();  // the whole header and name were read: no difference is below 0
  program.Do(BPF_ALU | BPF_SUB | BPF_K, kFragmentName);
  program.LoadIndexFromSlot(kNameSlot);
  program.Do(BPF_ALU | BPF_SUB | BPF_X);
  program.LoadIndexFromSlot(kOffsetSlot);
  program.Do(BPF_ALU | BPF_ADD | BPF_X);
  program.LoadIndexFromSlot(kSizeSlot);
  program.DropIfGreaterThanIndex();
  program.Take();
  return program.Finish();
}

std::vector<sock_filter> DatagramFilter(const MulticastAddress& address) {
  DatagramPolicy policy;
  in_addr group{};
  inet_pton(AF_INET, address.group.c_str(), &group);
  policy.group = ntohl(group.s_addr);
  policy.port = static_cast<std::uint16_t>(address.port);
  policy.is_this_computer_only = address.time_to_live == 0;
  if (const auto index = if_nametoindex("lo"); index != 0) policy.loopback_index = index;
  return DatagramFilter(policy);
}

}  // namespace lookout::bus
