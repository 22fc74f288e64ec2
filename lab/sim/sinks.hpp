// Where datagrams go: into a capture file, or onto the network, each when it is due.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/io/output_file.hpp"
#include "lab/sim/datagram.hpp"

struct pcap;
struct pcap_dumper;

namespace lookout::sim {

/// A capture file: Ethernet, IPv4, UDP, as tcpdump would have written it.
class PcapSink {
 public:
  /// @param lidar_ports  datagrams to other ports come from the navigation computer
  /// @throws std::runtime_error as io::OutputFile
  PcapSink(const std::filesystem::path& file, std::vector<int> lidar_ports, io::OutputOptions options = {});

  /// @throws std::runtime_error when the write fails
  void Send(const Datagram& datagram);

  /// @return the file, complete, for io::CommitAll. @throws std::runtime_error when the write fails
  io::OutputFile& Finish();

 private:
  [[noreturn]] void Fail() const;

  io::OutputFile file_;
  std::vector<int> lidar_ports_;
  std::unique_ptr<pcap, void (*)(pcap*)> capture_;
  std::unique_ptr<pcap_dumper, void (*)(pcap_dumper*)> dumper_;
  std::uint16_t num_sent_ = 0;  // identification of the IP header
};

/// Datagrams on the network.
class UdpSink {
 public:
  /// @param host  name or IPv4 address, also a broadcast address
  /// @throws std::runtime_error when the host is not known, or there is no socket
  explicit UdpSink(const std::string& host);
  ~UdpSink();
  UdpSink(const UdpSink&) = delete;
  UdpSink& operator=(const UdpSink&) = delete;

  /// A datagram that the network refuses is counted: a sensor does not wait for its listener either.
  void Send(const Datagram& datagram);

  std::int64_t num_refused() const { return num_refused_; }

 private:
  int socket_ = -1;
  std::uint32_t address_ = 0;  // network byte order
  std::int64_t num_refused_ = 0;
};

/// When each datagram of a live simulation is due. Each has a deadline of its own, so delays do not add up. Lateness is reported: a service that
/// hears a late datagram believes in a late sensor.
class Schedule {
 public:
  using Clock = std::chrono::steady_clock;

  /// Later than this is behind. Half a scan; a busy computer wakes up within some 10 ms.
  static constexpr std::chrono::milliseconds kLate{50};
  static constexpr std::chrono::seconds kReportEvery{1};

  /// @param start  of the simulation, due at `base`
  /// @param speed  times real time; 0 = everything is due at once, and nothing is late
  Schedule(Utime start, Clock::time_point base, double speed) : start_(start), base_(base), speed_(speed) {}

  Clock::time_point DueAt(Utime time) const;

  /// Counts a datagram that is sent now.
  /// @return by how much it is late; nullopt when it is not, or when a report was returned within the last kReportEvery
  std::optional<std::string> Report(Utime time, Clock::time_point now);

  /// @return how many were sent late and by how much at most; empty when none was
  std::string Summary() const;

 private:
  Utime start_;
  Clock::time_point base_;
  double speed_;
  std::int64_t num_sent_ = 0;
  std::int64_t num_late_ = 0;
  Clock::duration greatest_{};
  std::optional<Clock::time_point> last_report_;
};

}  // namespace lookout::sim
