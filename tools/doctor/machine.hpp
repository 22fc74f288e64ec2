// The state of this computer: network, buffers, clock, disk, the boat's config files. Nothing here changes anything.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Every *.txtpb of the folder and every one that a process needs, each checked as its process does at its start. Never throws for their contents.
ConfigSeen ReadConfig(const std::filesystem::path& config_folder);

/// @param url  LCM address, as LcmBus takes it
/// @return address, time-to-live and route; `fault` is set where a multicast address has no route
BusSeen ReadBus(const std::string& url);

/// A UDP socket of this computer.
struct SocketSeen {
  unsigned int user = 0;
  std::uint64_t inode = 0;
};

/// @param table  text of /proc/net/udp
std::vector<SocketSeen> SocketsOfPort(const std::string& table, int port);

/// Listeners to the port of the bus. Only their own user knows the programs of other users.
PortSeen ReadPort(const BusSeen& bus);

/// The device by which an address goes: the longest match, of equal ones the least metric.
///
/// @param table    text of /proc/net/route
/// @param address  IPv4, "239.255.76.67"
/// @return empty when none matches
std::string DeviceOfRoute(const std::string& table, const std::string& address);

/// Asks the kernel for receive buffers as the processes do.
///
/// @param config  of which the lidar's buffer is taken, where it is right
BuffersSeen ReadBuffers(const ConfigSeen& config);

std::vector<InterfaceSeen> ReadInterfaces();

/// Whether something steers this computer's clock (the kernel's state, as NTP and PPS set it).
bool IsHostClockSet();

/// Needs of the page: its port, its token's file, its map, room.
PageSeen ReadPage(const ConfigSeen& config);

/// The disk of the log folder; the rate stays as it is in `seen`. A recorder that runs shows where a relative folder is.
DiskSeen ReadDisk(const Observations& seen);

}  // namespace lookout::doctor
