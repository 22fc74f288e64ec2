// Who listens to the port of the bus on this computer, and whether other computers reach it.
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "tools/doctor/machine.hpp"

namespace lookout::doctor {

namespace {

namespace fs = std::filesystem;

// Written by lookout-firewall.service while its rule is loaded (deploy/firewall).
constexpr const char* kClosedFile = "/run/lookout-firewall/closed";
// The user of the package's units.
constexpr const char* kOwnUser = "lookout";
constexpr std::string_view kOwnPrograms = "lookout-";

std::string FirstLine(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string UserName(unsigned int user) {
  const passwd* entry = getpwuid(user);
  return entry != nullptr ? entry->pw_name : std::to_string(user);
}

// Programs that hold sockets, as far as this user may look: "lcm-logger (pid 17)" by inode.
std::map<std::uint64_t, std::string> HoldersOfSockets() {
  std::map<std::uint64_t, std::string> holders;
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end; process.increment(error)) {
    const auto pid = process->path().filename().string();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code denied;
    for (fs::directory_iterator descriptor(process->path() / "fd", denied), last; !denied && descriptor != last; descriptor.increment(denied)) {
      std::error_code gone;
      const auto target = fs::read_symlink(descriptor->path(), gone).string();
      constexpr std::string_view kSocket = "socket:[";
      if (gone || target.rfind(kSocket, 0) != 0) continue;
      holders[std::strtoull(target.c_str() + kSocket.size(), nullptr, 10)] = FirstLine(process->path() / "comm") + " (pid " + pid + ")";
    }
  }
  return holders;
}

}  // namespace

std::vector<SocketSeen> SocketsOfPort(const std::string& table, int port) {
  std::vector<SocketSeen> sockets;
  std::istringstream lines(table);
  std::string line;
  std::getline(lines, line);  // names of the columns
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string number;
    std::string local;
    std::string skipped;
    SocketSeen socket;
    // sl local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode
    if (!(words >> number >> local >> skipped >> skipped >> skipped >> skipped >> skipped >> socket.user >> skipped >> socket.inode)) continue;
    const auto colon = local.find(':');
    if (colon == std::string::npos || std::strtol(local.c_str() + colon + 1, nullptr, 16) != port) continue;
    sockets.push_back(socket);
  }
  return sockets;
}

PortSeen ReadPort(const BusSeen& bus) {
  PortSeen seen;
  seen.port = bus.port;
  if (bus.group.empty()) return seen;
  seen.is_closed = FirstLine(kClosedFile).rfind(std::to_string(bus.port) + " ", 0) == 0;
  const auto holders = HoldersOfSockets();
  std::ifstream udp("/proc/net/udp");
  std::ostringstream table;
  table << udp.rdbuf();
  for (const auto& socket : SocketsOfPort(table.str(), bus.port)) {
    const auto holder = holders.find(socket.inode);
    if (holder != holders.end()) {
      if (holder->second.rfind(kOwnPrograms, 0) != 0) seen.without_filter.push_back(holder->second);
    } else if (const auto user = UserName(socket.user); user != kOwnUser) {
      seen.without_filter.push_back("a program of user " + user);
    }
  }
  std::ranges::sort(seen.without_filter);
  seen.without_filter.erase(std::unique(seen.without_filter.begin(), seen.without_filter.end()), seen.without_filter.end());
  return seen;
}

}  // namespace lookout::doctor
