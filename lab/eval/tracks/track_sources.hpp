// Sources of runs to be tracked: the sensors' messages of a boat, with the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/eval/methods/captures.hpp"
#include "lab/eval/methods/run_plan.hpp"
#include "lab/eval/truth.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tools/replay/stage.hpp"

namespace lookout::eval {

/// Options that the commands for tracks and for alerts share.
struct RunOptions {
  std::filesystem::path config_folder;
  RunPlan plan;                                    // scenes may be none
  bool is_tuning = false;                          // seeds of tuning
  std::filesystem::path csv_folder;                // empty = none
  bool is_forced = false;                          // files that are there are replaced
  std::vector<std::filesystem::path> block_files;  // in whose marked blocks the tables are written (FillBlocks)
};

/// Before all work: checks config, seeds and blocks, and catches signals to stop.
///
/// @param option  of the command line, for errors: "--tracks"
/// @throws config::ConfigError; std::invalid_argument for seeds of the other range and where nothing is to be run; std::runtime_error for files
void BeginRuns(const RunOptions& options, bool has_captures, const std::string& option);

using RunHandler = std::function<void(const std::filesystem::path& file, const std::string& scene, std::uint64_t seed)>;

/// Calls handle(file, scene, seed) for each scene and seed of the plan.
void ForEachRun(const RunOptions& options, const RunHandler& handle);

/// As ForEachRun, with progress on stderr. @throws io::Stopped between two runs
void ForEachRunWithProgress(const RunOptions& options, const RunHandler& handle);

/// The time 0 of simulated runs, as lookout-sim has it: any date serves, as long as it is always the same.
inline constexpr Utime kSimulationStart{std::chrono::microseconds(1'781'532'600'000'000)};

using DatagramHandler = std::function<void(const replay::Datagram&)>;

/// Sends a scan in place of its packets: all parts of LIDAR_SCAN.
using ScanMessageHandler = std::function<void(Utime time, const std::vector<lidar_scan_t>& parts)>;

/// Simulates a scene as lookout-sim does.
///
/// @param on_scan  of a scene whose head has no packets; without one such a scene is refused
/// @param lidar    the head in place of the scene's; empty: the scene's
/// @param truth  empty; objects and outlines stand in it before the first datagram, returns before that of their packet
/// @throws config::ConfigError
void SimulateRun(const std::filesystem::path& config_folder, const std::filesystem::path& scene_file, std::uint64_t seed, double seconds,
                 Truth& truth, const DatagramHandler& on_datagram, const ScanMessageHandler& on_scan = {}, const std::string& lidar = {});

/// The truth of SimulateRun without a run: objects and outlines alone.
void AddSceneTruth(const std::filesystem::path& config_folder, const std::filesystem::path& scene_file, std::uint64_t seed, double seconds,
                   Truth& truth);

/// The own hull in the vessel frame, as lookout-tracker has it: in the middle of the box of own returns, no larger than it; the whole box where the
/// size of the hull is not set. Its corners are those of the outline of the own boat in the truth, in their order.
Polygon OwnHullOf(const config::BoatFacts& boat);

/// Time by which a return of a capture and of its truth may differ.
inline constexpr std::int64_t kCaptureToleranceUs = 3;

/// The datagrams of a capture, without its truth. @throws std::runtime_error "file: reason"
void SendCapture(const CaptureWithTruth& files, const DatagramHandler& on_datagram);

/// Reads a capture, and NAME-SEED.objects.csv.xz, .shapes.csv.xz, .ego.csv.xz and .truth.csv.xz beside it.
///
/// An object of the shapes has their outline, any other a rectangle of its length and width; between two scans, of whose middle the objects are, it
/// moves straight. The own boat is its hull at the place and heading of .ego.
/// @param truth  empty, of tolerance kCaptureToleranceUs; all of it is read before the first datagram
/// @throws std::runtime_error "file:line: reason"
void ReadRun(const CaptureWithTruth& files, const config::BoatFacts& boat, Truth& truth, const DatagramHandler& on_datagram);

/// ReadRun without the objects of returns: no .truth.csv.xz need be there.
void ReadRunOfObjects(const CaptureWithTruth& files, const config::BoatFacts& boat, Truth& truth, const DatagramHandler& on_datagram);

/// As .objects.csv.xz counts them, scan by scan; nothing where it has none of that time.
CountReturns ReadReturnCounts(const CaptureWithTruth& files);

/// A new, empty folder that goes with all that is in it.
class TempFolder {
 public:
  /// @throws std::runtime_error
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A config folder with the boat of the captures in place of its own: as long as this lives.
class ConfigOfCaptures {
 public:
  /// Copies config_folder, and boat.txtpb of the captures over it where there is one. @throws std::filesystem::filesystem_error
  ConfigOfCaptures(const std::filesystem::path& captures, const std::filesystem::path& config_folder);
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

/// A config folder whose navigator does not read the receiver behind the lidar: as long as this lives.
class ConfigWithoutLidarNmea {
 public:
  /// @throws std::filesystem::filesystem_error; config::ConfigError; std::runtime_error
  explicit ConfigWithoutLidarNmea(const std::filesystem::path& config_folder);
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

/// A config folder whose segmenter has other evidence: as long as this lives.
class ConfigWithEvidence {
 public:
  /// @throws std::filesystem::filesystem_error; config::ConfigError; std::runtime_error
  ConfigWithEvidence(const std::filesystem::path& config_folder, const std::filesystem::path& evidence_file);
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

}  // namespace lookout::eval
