// The truth about a simulation as CSV files (objects.csv, object_poses.csv, outlines.csv, returns.csv, pose.csv, faults.csv; columns:
// README.md) and as truth.lcmlog.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <filesystem>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/utime.hpp"
#include "common/io/output_file.hpp"
#include "tools/sim/fault_plan.hpp"
#include "tools/sim/faults.hpp"
#include "tools/sim/lidar.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/truth_log.hpp"

namespace lookout::sim {

class TruthWriter {
 public:
  /// Makes the folder and writes objects, and the outlines of those that stand still.
  ///
  /// @param scene  outlives this
  /// @throws std::runtime_error as io::OutputFile, of any of the files
  TruthWriter(const std::filesystem::path& folder, const Scene& scene, const config::BoatFacts& boat, Utime start,
              const io::OutputOptions& options = {});

  void AddPacket(const LidarPacket& packet);

  /// What happened to a packet.
  void AddFault(const Fault& fault);

  /// What was ordered for a part of the run.
  void AddFault(const TimedFault& fault);

  /// Writes poses and moving outlines up to `time`.
  void AdvanceTo(Utime time);

  /// All is told: the files get their names. @throws std::runtime_error as io::CommitAll
  void Close() { io::CommitAll(Finish()); }

  /// All is told, and is in the files that are given: for io::CommitAll.
  std::vector<io::OutputFile*> Finish();

 private:
  void WriteObjects();
  void WriteOutline(const SceneObject& object, Utime time);
  void WriteOutline(int object_id, const Placement& placement, const std::vector<Eigen::Vector2d>& outline_m, Utime time);
  void WriteObjectPose(int object_id, const Eigen::Isometry3d& T_map_object, Utime time);
  void WriteObjectsAt(Utime time);
  void WritePose(Utime time);

  // The folder, taken away again where nothing came into it.
  struct Folder {
    explicit Folder(const std::filesystem::path& path);
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path made;  // empty: it was there before
  };

  Folder folder_;
  const Scene& scene_;
  double reference_point_above_water_m_;
  std::vector<Eigen::Vector2d> own_outline_m_;  // vessel frame
  GeographicLib::LocalCartesian map_;
  Utime start_;
  Utime next_pose_;
  Utime next_outline_;
  TruthLog log_;
  io::OutputFile objects_;
  io::OutputFile object_poses_;
  io::OutputFile outlines_;
  io::OutputFile returns_;
  io::OutputFile pose_;
  io::OutputFile faults_;
};

}  // namespace lookout::sim
