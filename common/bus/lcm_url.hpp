// The address of the bus, "udpm://239.255.76.67:7667?ttl=1". LCM takes an argument that it does not understand for another one, so the address is
// read strictly before.
#pragma once

#include <optional>
#include <string>

namespace lookout::bus {

struct MulticastAddress {
  std::string group;  // IPv4
  int port = 0;
  int time_to_live = 0;  // 0 = this computer only
};

/// The fault of an address, for a program that shares a bus with others. LCM would go on with ttl=256 as 0, ignore an argument that it does not know,
/// and accept memq:// and file:// as if somebody listened there.
///
/// @return a sentence with the address and what to write instead; empty when nothing is wrong
std::string LcmUrlFault(const std::string& url);

/// @param url  what is left out has LCM's default
/// @return nullopt when it is no multicast address, or a wrong one
std::optional<MulticastAddress> ParseMulticast(const std::string& url);

/// The address in the environment variable LCM_DEFAULT_URL, else LCM's default group with a time-to-live of 0 (this computer only).
std::string DefaultLcmUrl();

}  // namespace lookout::bus
