// The truth about a simulation as messages: SIM_TRUTH in an lcm-log.
#pragma once

#include <filesystem>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "common/io/output_file.hpp"
#include "tools/sim/lidar.hpp"
#include "tools/sim/scene.hpp"

namespace lookout {
struct sim_truth_t;
}

namespace lookout::sim {

class TruthLog {
 public:
  /// @param scene  outlives this
  /// @throws std::runtime_error as io::OutputFile
  TruthLog(const std::filesystem::path& file, const Scene& scene, const config::BoatFacts& boat, Utime start, io::OutputOptions options = {});

  /// Packets in the order in which they were made, each before AdvanceTo goes beyond it. They are held until there are kPacketsPerMessage.
  ///
  /// @throws std::runtime_error as the two below: when the disk does not take it
  void AddPacket(const LidarPacket& packet);

  /// Writes where everything is, every kObjectPeriod up to `time`.
  void AdvanceTo(Utime time);

  /// Writes out what is held; the file gets its name.
  void Close() { Finish().Commit(); }

  /// Writes out what is held, into the file that is given: for io::CommitAll.
  io::OutputFile& Finish();

  static constexpr std::size_t kPacketsPerMessage = 24;  // as in LIDAR_PACKETS: 28 kB
  static constexpr std::chrono::milliseconds kObjectPeriod{100};

 private:
  struct Packet {
    Utime stamp;
    std::vector<TrueReturn> returns;
  };
  void WritePackets();
  void WriteObjects(Utime time);
  void Write(sim_truth_t& message);

  const Scene& scene_;
  config::BoatFacts boat_;
  Utime start_;
  Utime next_objects_;
  io::OutputFile file_;
  bus::LogWriter log_;
  std::vector<Packet> packets_;
  std::int64_t num_packets_ = 0;  // written
  std::int64_t seq_ = 0;
};

}  // namespace lookout::sim
