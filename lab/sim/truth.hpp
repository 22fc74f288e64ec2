// The truth about a simulation: objects.csv, object_poses.csv, outlines.csv, returns.csv, pose.csv, faults.csv (columns: README.md), and the messages
// of SIM_TRUTH in truth.lcmlog.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <filesystem>
#include <span>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "common/io/output_file.hpp"
#include "lab/sim/fault_plan.hpp"
#include "lab/sim/faulty_network.hpp"
#include "lab/sim/lidar.hpp"
#include "lab/sim/scene.hpp"

namespace lookout {
struct sim_truth_t;
}

namespace lookout::sim {

class TruthWriter {
 public:
  /// Makes the folder and writes objects, and the outlines of those that stand still.
  ///
  /// @param scene  outlives this
  /// @throws std::runtime_error as io::OutputFile, of any of the files; so do all functions below
  TruthWriter(const std::filesystem::path& folder, const Scene& scene, const config::BoatFacts& boat, Utime start,
              const io::OutputOptions& options = {});

  /// Packets in the order in which they were made, each before AdvanceTo goes beyond it. The log has kPacketsPerMessage of them in a message.
  void AddPacket(const LidarPacket& packet);
  /// Returns of a head without packets: they stand in returns.csv alone.
  void AddReturns(std::span<const TrueReturn> returns);
  static constexpr std::size_t kPacketsPerMessage = 24;  // as in LIDAR_PACKETS: 28 kB

  /// Writes a fault that happened to a packet.
  void AddFault(const Fault& fault);

  /// Writes a fault that was ordered for a part of the run.
  void AddFault(const TimedFault& fault);

  /// Writes poses and outlines up to `time`.
  void AdvanceTo(Utime time);

  /// @return the files, complete, for io::CommitAll
  std::vector<io::OutputFile*> Finish();

 private:
  // The folder, removed at the end where it is empty.
  struct Folder {
    explicit Folder(const std::filesystem::path& path);
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path made;  // empty: the folder was there before
  };
  struct LatitudeLongitude {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
  };

  LatitudeLongitude OnEarth(const Eigen::Vector3d& p_map_m) const;
  void WriteOutline(int object_id, const Placement& placement, const std::vector<Eigen::Vector2d>& outline_m, Utime time);
  void WriteObjects(Utime time);
  void WritePose(Utime time);
  void WritePackets();
  void WriteMessage(sim_truth_t& message);

  Folder folder_;
  const Scene& scene_;
  double reference_point_above_water_m_;
  SceneObject own_vessel_;  // with its outline in the vessel frame
  GeodeticPlace datum_;
  GeographicLib::LocalCartesian map_;
  Utime start_;
  Utime next_pose_;
  Utime next_objects_;
  std::vector<LidarPacket> packets_;  // not yet in the log
  std::int64_t num_packets_ = 0;      // in the log
  std::int64_t seq_ = 0;
  io::OutputFile log_file_;
  bus::LogWriter log_;
  io::OutputFile objects_;
  io::OutputFile object_poses_;
  io::OutputFile outlines_;
  io::OutputFile returns_;
  io::OutputFile pose_;
  io::OutputFile faults_;
};

}  // namespace lookout::sim
