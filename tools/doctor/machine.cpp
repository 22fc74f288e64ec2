#include "tools/doctor/machine.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <system_error>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/services.hpp"
#include "common/config/boat_sections.hpp"
#include "common/config/text_config.hpp"
#include "common/io/disk_reserve.hpp"
#include "common/runtime/process.hpp"
#include "services/lidar/sources.hpp"
#include "services/page/params.hpp"
#include "services/page/tiles.hpp"
#include "services/page/token.hpp"
#include "services/plotter/params.hpp"
#include "services/recorder/params.hpp"
#include "services/tracker/params.hpp"
#include "tools/doctor/config_checks.hpp"

namespace lookout::doctor {

namespace {

namespace fs = std::filesystem;

std::string TextOfFile(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Numeric; empty for what is no IP address.
std::string AddressText(const sockaddr* address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address == nullptr) return {};
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text.data(), text.size());
  } else if (address->sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text.data(), text.size());
  }
  return text.data();
}

int PrefixBits(const sockaddr* netmask) {
  const auto mask = io::ParseIpAddress(AddressText(netmask));
  if (!mask) return 0;
  // An IPv4 mask is mapped behind 80 zeros and 16 ones, which are none of its own.
  int num_bits = netmask->sa_family == AF_INET ? -16 : 0;
  for (const auto byte : mask->bytes) num_bits += std::popcount(byte);
  return num_bits;
}

// Written by lookout-firewall.service while its rule is loaded (deploy/firewall).
constexpr const char* kClosedFile = "/run/lookout-firewall/closed";
// The user of the package's units.
constexpr const char* kOwnUser = "lookout";
constexpr std::string_view kOwnPrograms = "lookout-";

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
      const auto name = TextOfFile(process->path() / "comm");  // a line
      holders[std::strtoull(target.c_str() + kSocket.size(), nullptr, 10)] = name.substr(0, name.find('\n')) + " (pid " + pid + ")";
    }
  }
  return holders;
}

// The folder, or its nearest parent that exists: the recorder makes missing ones.
fs::path Existing(fs::path folder) {
  std::error_code error;
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

}  // namespace

ConfigSeen ReadConfig(const fs::path& config_folder) {
  ConfigSeen seen;
  const auto check = [&](const std::string& file_name, const std::function<void()>& load) {
    config::FaultList found;
    // By itself first: a process whose boat.txtpb is wrong looks no further.
    found.Try([&] { config::EffectiveTextOf(config_folder, file_name); });
    found.Try(load);
    if (fs::exists(config_folder / file_name) || config::SectionOf(file_name).empty()) seen.files[file_name];
    for (const auto& fault : found.faults()) {
      // Into the file that the line names: a process may find that boat.txtpb is wrong.
      const auto path = fault.substr(0, fault.find(".txtpb:"));
      auto& lines = seen.files[path == fault ? file_name : fs::path(path).filename().string() + ".txtpb"];
      if (std::ranges::find(lines, fault) == lines.end()) lines.push_back(fault);
    }
  };
  check("boat.txtpb", [&] { seen.boat = config::LoadBoat(config_folder); });
  seen.has_plotter_outputs = false;
  for (const auto& service : ConfigChecks()) {
    const auto file_name = std::string(service.service) + ".txtpb";
    check(file_name, [&] { service.load(config_folder); });
  }
  check("lidar.txtpb", [&] { seen.lidar = lidar::LoadChecked(config_folder); });
  seen.lidar_place = config::PlaceInWords(config_folder, "lidar.txtpb");
  if (lidar::HasSecond(config_folder)) check("lidar_2.txtpb", [&] { seen.lidar_2 = lidar::LoadChecked(config_folder, 2); });
  // Values for other findings. Faults of these files are told already.
  const auto look = [](const std::function<void()>& load) { config::FaultList().Try(load); };
  look([&] { seen.navigation = navigator::LoadParams(config_folder); });
  look([&] { seen.odometer = odometer::LoadParams(config_folder); });
  look([&] { seen.tracker = tracker::LoadParams(config_folder); });
  look([&] { seen.has_plotter_outputs = !plotter::LoadParams(config_folder).outputs.empty(); });
  look([&] { seen.page = page::LoadParams(config_folder); });
  look([&] {
    const auto params = recorder::LoadParams(config_folder);
    seen.log_folder = params.log_folder;
    seen.log_reserve_bytes = params.reserve_bytes;
  });
  // RUN_INFO holds every file of the folder, so the recorder does not start where any is wrong.
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(config_folder, error)) {
    const auto name = entry.path().filename().string();
    if (entry.path().extension() == ".txtpb" && !seen.files.contains(name)) check(name, [] {});
  }
  return seen;
}

BusSeen ReadBus(const std::string& url) {
  BusSeen bus;
  bus.url = url;
  bus.fault = bus::LcmUrlFault(url);
  if (!bus.fault.empty()) return bus;
  const auto multicast = bus::ParseMulticast(url);
  if (!multicast) return bus;
  bus.group = multicast->group;
  bus.time_to_live = multicast->time_to_live;
  bus.port = multicast->port;
  if (!bus::HasRoute(*multicast)) {
    bus.fault = "there is no route for multicast to " + bus.group + ": no process can start";
    return bus;
  }
  bus.route_device = DeviceOfRoute(TextOfFile("/proc/net/route"), bus.group);
  return bus;
}

std::string DeviceOfRoute(const std::string& table, const std::string& address) {
  in_addr target{};
  if (inet_pton(AF_INET, address.c_str(), &target) != 1) return {};
  constexpr unsigned int kUp = 0x1;        // RTF_UP
  constexpr unsigned int kReject = 0x200;  // RTF_REJECT
  std::string best;
  int best_bits = -1;
  long best_metric = 0;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string device;
    std::string gateway;
    std::uint32_t destination = 0;
    unsigned int flags = 0;
    long references = 0;
    long uses = 0;
    long metric = 0;
    std::uint32_t mask = 0;
    // Addresses stand there as numbers of this machine, so they compare with those in memory.
    if (!(words >> device >> std::hex >> destination >> gateway >> flags >> std::dec >> references >> uses >> metric >> std::hex >> mask)) continue;
    if ((flags & kUp) == 0 || (flags & kReject) != 0 || (target.s_addr & mask) != destination) continue;
    const int num_bits = std::popcount(mask);
    if (num_bits < best_bits || (num_bits == best_bits && metric >= best_metric)) continue;
    best = device;
    best_bits = num_bits;
    best_metric = metric;
  }
  return best;
}

BuffersSeen ReadBuffers(const ConfigSeen& config) {
  BuffersSeen buffers;
  buffers.asked = bus::kReceiveBufferBytes;
  if (config.lidar) buffers.asked = std::max<std::int64_t>(buffers.asked, config.lidar->sources.receive_buffer_bytes);
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto granted = [descriptor] {
    int size = 0;
    socklen_t length = sizeof size;
    return getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, &length) == 0 ? size : 0;
  };
  buffers.by_default = granted();
  const int asked = static_cast<int>(buffers.asked);
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked);
  buffers.granted = granted() / 2;  // socket(7): the kernel doubles the requested size, and tells that
  close(descriptor);
  return buffers;
}

std::vector<InterfaceSeen> ReadInterfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, &freeifaddrs);
  std::vector<InterfaceSeen> interfaces;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    InterfaceSeen interface;
    interface.name = entry->ifa_name;
    // RUNNING stands for the carrier.
    interface.has_carrier = (entry->ifa_flags & IFF_UP) != 0 && (entry->ifa_flags & IFF_RUNNING) != 0;
    interface.is_loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    interface.address = io::ParseIpAddress(AddressText(entry->ifa_addr));
    if (interface.address) interface.prefix_bits = PrefixBits(entry->ifa_netmask);
    interfaces.push_back(std::move(interface));
  }
  // Each interface stands there once more for its link: told only where it has no address.
  std::set<std::string> with_address;
  for (const auto& interface : interfaces) {
    if (interface.address) with_address.insert(interface.name);
  }
  std::erase_if(interfaces, [&](const auto& interface) { return !interface.address && with_address.contains(interface.name); });
  return interfaces;
}

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
  if (bus.group.empty()) return seen;
  seen.is_closed = TextOfFile(kClosedFile).starts_with(std::to_string(bus.port) + " ");
  const auto holders = HoldersOfSockets();
  for (const auto& socket : SocketsOfPort(TextOfFile("/proc/net/udp"), bus.port)) {
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

bool IsHostClockSet() {
  timex state{};  // modes 0: only asks
  return adjtimex(&state) != TIME_ERROR;
}

namespace {

// Whether nobody else could listen there now.
bool IsTaken(const std::string& bind_address, int port) {
  const auto address = io::ParseIpAddress(bind_address);
  if (!address) return false;
  const bool is_v6 = bind_address.find(':') != std::string::npos;
  const int descriptor = socket(is_v6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  v4.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, bind_address.c_str(), &v4.sin_addr);
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  v6.sin6_port = v4.sin_port;
  inet_pton(AF_INET6, bind_address.c_str(), &v6.sin6_addr);
  const int result = is_v6 ? bind(descriptor, reinterpret_cast<const sockaddr*>(&v6), sizeof v6)
                           : bind(descriptor, reinterpret_cast<const sockaddr*>(&v4), sizeof v4);
  const bool is_taken = result != 0 && errno == EADDRINUSE;
  close(descriptor);
  return is_taken;
}

std::string FaultOf(const std::function<void()>& open) {
  try {
    open();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace

PageSeen ReadPage(const ConfigSeen& config) {
  PageSeen seen;
  if (!config.page) return seen;
  const auto& params = *config.page;
  seen.is_port_taken = IsTaken(params.bind_address, params.port);
  std::error_code error;
  // A token file in the state folder belongs to the user of the page's process: for another user no file is found here.
  if (params.allows_acknowledgements && fs::exists(params.token_file, error)) seen.token_fault = FaultOf([&] { page::ReadToken(params.token_file); });
  if (!params.map_file.empty()) seen.map_fault = FaultOf([&] { const page::Tiles tiles(params.map_file); });
  if (!params.spool_folder.empty()) {
    const auto free_bytes = io::FreeBytes(params.spool_folder);
    const auto reserve = io::ReserveAt(params.spool_folder, params.log_folder, params.reserve_bytes);
    if (free_bytes >= 0) seen.free_bytes = std::max<std::int64_t>(0, reserve.BytesForOthers(free_bytes, 0));
  }
  return seen;
}

DiskSeen ReadDisk(const Observations& seen) {
  DiskSeen disk = seen.disk;
  if (!seen.config.log_folder) return disk;
  const auto* recorder = seen.LastHealth("recorder");
  if (recorder != nullptr && recorder->host != runtime::HostName()) {
    disk.other_host = recorder->host;
    return disk;
  }
  std::error_code error;
  auto folder = *seen.config.log_folder;
  if (folder.is_relative()) {
    const auto start = recorder != nullptr ? fs::read_symlink("/proc/" + std::to_string(recorder->pid) + "/cwd", error) : fs::path();
    disk.is_guessed = start.empty();
    folder = (start.empty() ? fs::current_path(error) : start) / folder;
  }
  disk.folder = folder;
  const auto existing = Existing(folder);
  const auto space = fs::space(existing, error);
  if (!error) disk.free_bytes = std::max<std::int64_t>(0, static_cast<std::int64_t>(space.available) - seen.config.log_reserve_bytes);
  // A recorder that writes may be another user.
  const bool is_recording = recorder != nullptr && recorder->state != health_t::STATE_FAILED;
  disk.is_writable = is_recording || access(existing.c_str(), W_OK) == 0;
  return disk;
}

}  // namespace lookout::doctor
