// A capture file: Ethernet, IPv4, UDP, as tcpdump would have written it.
#pragma once

#include <filesystem>
#include <memory>

#include "tools/sim/datagram.hpp"

namespace lookout::sim {

class PcapSink final : public Sink {
 public:
  /// @param lidar_ports  datagrams to other ports come from the navigation computer
  /// @throws std::runtime_error when the file cannot be made
  PcapSink(const std::filesystem::path& file, std::vector<int> lidar_ports);
  ~PcapSink() override;

  void Send(const Datagram& datagram) override;

  /// Writes out what is buffered. @throws std::runtime_error when the disk does not take it
  void Close();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::vector<int> lidar_ports_;
  std::uint16_t num_sent_ = 0;  // identification of the IP header
};

}  // namespace lookout::sim
