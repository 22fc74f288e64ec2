// The datagrams that a socket of the bus accepts, decided in the kernel before anybody reads them.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <vector>

#include "common/bus/lcm_url.hpp"
#include "common/bus/log_file.hpp"

namespace lookout::bus {

/// LCM's header of a short message (LC02) and of a fragment (LC03), its longest channel name, and the most of a message in one UDP datagram.
inline constexpr std::uint32_t kShortHeaderBytes = 8;
inline constexpr std::uint32_t kFragmentHeaderBytes = 20;
inline constexpr std::uint32_t kMaxChannelCharacters = kMaxLogChannelBytes;
inline constexpr std::uint32_t kMaxFragmentBytes = 65'487;

/// Greatest message that is accepted: what a log can hold, far above any of ours (kMaxMessageBytes).
inline constexpr std::uint32_t kMaxForeignMessageBytes = kMaxLogDataBytes;

struct DatagramPolicy {
  std::uint32_t group = 0;  // IPv4, as a number of this machine: 239.255.76.67 is 0xEFFF4C43
  std::uint16_t port = 0;
  bool is_this_computer_only = false;  // as with a time-to-live of 0
  std::uint32_t loopback_index = 1;    // of the interface `lo`
};

/// A classic BPF program for SO_ATTACH_FILTER on an IPv4 UDP socket. It takes a datagram, whole, when all of this is so, and drops it otherwise:
/// - it was sent to the group and port;
/// - where only this computer counts: it was looped back (PACKET_LOOPBACK) or came by `lo`. No address is asked: a sender's may change or be made up;
/// - it is a short message or a fragment of LCM with its whole header;
/// - where it has a channel's name (a short message, a first fragment): 1 to 63 printable ASCII characters, and its NUL is in the datagram;
/// - of a fragment: its number is below that of the fragments, so many can hold the message, the message has at most kMaxForeignMessageBytes, and
///   the fragment ends within it.
/// So LCM's receiver cannot be made to read or write outside of its buffers: its sums stay below 32 bits, its strings end.
std::vector<sock_filter> DatagramFilter(const DatagramPolicy& policy);

/// The filter for the bus at this address; with a time-to-live of 0 only this computer counts.
std::vector<sock_filter> DatagramFilter(const MulticastAddress& address);

}  // namespace lookout::bus
