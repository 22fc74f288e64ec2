// lookout-plotter live: so many targets ten times a second, to a TCP client of NMEA 0183 and a UDP receiver of Signal K. Prints the time from the end
// of a scan (here: its TRACKS are sent) to the first sentence of a target that is due with it, and the process's share of a core.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/support/plotter_scene.hpp"

namespace {

using namespace lookout;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kTcpPort = 10111;
constexpr int kUdpPort = 10112;

int Connect() {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(kTcpPort);
  if (connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    std::perror("connect");
    std::exit(1);
  }
  return client;
}

// Drops what waits. @return bytes of it
std::int64_t Drain(int descriptor, std::string* text = nullptr) {
  std::int64_t num_bytes = 0;
  char buffer[65536];
  for (ssize_t num = 0; (num = recv(descriptor, buffer, sizeof(buffer), MSG_DONTWAIT)) > 0; num_bytes += num) {
    if (text != nullptr) text->append(buffer, static_cast<std::size_t>(num));
  }
  return num_bytes;
}

}  // namespace

int main(int argc, char** argv) {
  int num_targets = 200;
  int length_s = 60;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--targets") == 0) num_targets = std::atoi(argv[i + 1]);
    if (std::strcmp(argv[i], "--seconds") == 0) length_s = std::atoi(argv[i + 1]);
  }
  const support::TempDir folder;
  std::filesystem::copy(support::kDemoConfig, folder / "config");
  std::ofstream(folder / "config/plotter.txtpb") << "output { name: 'tcp' format: NMEA0183 tcp_server { bind_address: '127.0.0.1' port: " << kTcpPort
                                                 << " } }\noutput { name: 'udp' format: SIGNALK udp { address: '127.0.0.1' port: " << kUdpPort
                                                 << " } }\n";
  bus::LcmBus bus(bus::DefaultLcmUrl());
  health_t health{};
  std::vector<double> shares;
  bus.SubscribeRaw(bus::kHealth, [&](std::string_view, Bytes bytes) {
    if (auto message = bus::Decode<health_t>(bytes)) {
      health = *std::move(message);
      shares.push_back(health.cpu_fraction);
    }
  });
  support::Child child({support::Bin("plotter"), "--config", (folder / "config").string()}, (folder / "out").string());
  while (health.pid == 0) bus.HandleOnce(milliseconds(100));

  const int udp = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(kUdpPort);
  if (bind(udp, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) return 1;
  const int tcp = Connect();

  support::PlotterScene scene(bus);
  scene.num_tracks = num_targets;
  std::vector<double> latencies_ms;
  std::int64_t num_tcp_bytes = 0;
  std::int64_t num_udp_bytes = 0;
  const auto begin = Clock::now();
  auto next = begin;
  shares.clear();
  while (Clock::now() - begin < std::chrono::seconds(length_s)) {
    next += milliseconds(100);
    std::string text;
    num_tcp_bytes += Drain(tcp);
    const auto sent = Clock::now();
    scene.SendScan();
    bool is_there = false;
    while (Clock::now() < next) {
      pollfd ready{tcp, POLLIN, 0};
      poll(&ready, 1, 1);
      num_tcp_bytes += Drain(tcp, &text);
      num_udp_bytes += Drain(udp);
      if (!is_there && text.find("$RATTM,") != std::string::npos) {
        is_there = true;
        latencies_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - sent).count());
      }
      bus.HandleOnce(milliseconds(0));
    }
  }
  std::sort(latencies_ms.begin(), latencies_ms.end());
  std::sort(shares.begin(), shares.end());
  const auto at = [](const std::vector<double>& values, double share) {
    return values.empty() ? -1.0 : values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
  };
  std::printf("%d targets, %d s: NMEA 0183 %.1f kB/s, Signal K %.1f kB/s\n", num_targets, length_s,
              1e-3 * static_cast<double>(num_tcp_bytes) / length_s, 1e-3 * static_cast<double>(num_udp_bytes) / length_s);
  std::printf("TRACKS to TTM: %zu scans, median %.1f ms, 95 %% %.1f ms, most %.1f ms\n", latencies_ms.size(), at(latencies_ms, 0.5),
              at(latencies_ms, 0.95), at(latencies_ms, 1.0));
  std::printf("cpu: median %.2f %%, 95 %% %.2f %% of a core; memory %.1f MB\n", 100.0 * at(shares, 0.5), 100.0 * at(shares, 0.95),
              static_cast<double>(health.resident_bytes) / 1e6);
  close(tcp);
  close(udp);
  return child.Terminate().value_or(-1);
}
