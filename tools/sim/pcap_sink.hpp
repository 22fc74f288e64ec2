// A capture file: Ethernet, IPv4, UDP, as tcpdump would have written it.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/io/output_file.hpp"
#include "tools/sim/datagram.hpp"

namespace lookout::sim {

class PcapSink final : public Sink {
 public:
  /// @param lidar_ports  datagrams to other ports come from the navigation computer
  /// @throws std::runtime_error as io::OutputFile
  PcapSink(const std::filesystem::path& file, std::vector<int> lidar_ports, io::OutputOptions options = {});
  ~PcapSink() override;

  /// @throws std::runtime_error when the disk does not take it
  void Send(const Datagram& datagram) override;

  /// All was sent: the file gets its name. @throws std::runtime_error as io::OutputFile::Commit
  void Close() { Finish().Commit(); }

  /// All was sent, and is in the file that is given: for io::CommitAll. @throws std::runtime_error when the disk does not take it
  io::OutputFile& Finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::vector<int> lidar_ports_;
  std::uint16_t num_sent_ = 0;  // identification of the IP header
};

}  // namespace lookout::sim
