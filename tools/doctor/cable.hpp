// Which lidars speak, whatever lidar.txtpb says: on the cables of this computer, or in captures.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "common/io/source.hpp"
#include "services/lidar/survey.hpp"
#include "tools/doctor/observations.hpp"

namespace lookout::doctor {

/// Listens beside the ports of the config: with CAP_NET_RAW on each interface but loopback, also to what is sent to other addresses; without it on
/// those ports, of the ports to which lidars send as delivered, that are free.
class Cable {
 public:
  /// @param ports_in_use  the ports of lidar.txtpb: somebody else hears them
  explicit Cable(const std::vector<int>& ports_in_use);

  /// Passes on the waiting datagrams.
  void Poll(Utime now, const std::function<void(const io::Source::Piece&)>& take);
  void Poll(Utime now, lidar::Survey& survey);

  bool hears_all_ports() const { return hears_all_ports_; }

 private:
  std::vector<std::unique_ptr<io::Source>> sources_;
  bool hears_all_ports_ = false;
};

/// Datagrams that the kernel, and by captures we, could not put together from IP fragments, since the start of the computer; -1 = not known.
std::int64_t NumReassemblyFailures();

/// Reads captures to their end: fills lidar, end and watched_s of `seen`, whose config is used where it is right.
///
/// @throws std::runtime_error when a file cannot be read
void ReadCaptures(const std::vector<std::filesystem::path>& files, Observations& seen);

}  // namespace lookout::doctor
