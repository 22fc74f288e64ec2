// Captures with the truth about each return: a second world, written by others than our simulator.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/render.hpp"

namespace lookout::eval {

/// NAME-SEED.pcap.xz and the files beside it: NAME-SEED.truth.csv.xz, NAME-SEED.objects.csv.xz.
struct CaptureWithTruth {
  std::string scene;  // NAME
  std::uint64_t seed = 0;
  std::filesystem::path capture;
  std::filesystem::path truth;
  std::filesystem::path objects;
};

/// The truth beside a capture: the object of each return, or its objects alone.
enum class CaptureTruth { kOfReturns, kOfObjects };

/// @return the captures of a folder, by name and then by seed
/// @throws std::runtime_error when the folder cannot be read, a name does not end in -SEED, or a capture stands without its truth
std::vector<CaptureWithTruth> ListCaptures(const std::filesystem::path& folder, CaptureTruth truth = CaptureTruth::kOfReturns);

/// The boat of the captures: facts from the boat.txtpb beside them, all else (segmenter, decoder) from a config folder. Where there is no
/// boat.txtpb beside them, the facts come from the config folder, too.
///
/// @throws config::ConfigError
Boat LoadBoatOfCaptures(const std::filesystem::path& folder, const std::filesystem::path& config_folder);

/// How the returns of the whole scans of a capture met their truth.
struct CaptureReport {
  std::int64_t num_scans = 0;
  std::int64_t num_returns = 0;
  std::int64_t num_own_vessel = 0;  // left out of the scans
  std::int64_t num_clutter = 0;
  std::int64_t num_unmatched = 0;  // without truth: counted as clutter
};

/// Share of returns without truth above which a capture and its truth do not belong together.
inline constexpr double kMaxUnmatchedShare = 0.001;

/// A return and its truth have one ring, times that differ by at most this, and one range in steps of 2 mm.
inline constexpr std::chrono::microseconds kMatchTolerance{3};

/// A capture, unpacked into memory that has the name of a file, as libpcap asks for one.
class UnpackedCapture {
 public:
  /// @throws std::runtime_error "file: reason"
  explicit UnpackedCapture(const std::filesystem::path& file);

  std::filesystem::path path() const;

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> memory_;
};

/// Objects of a capture by id, called by their type and id. @throws std::runtime_error "file:line: reason"
std::map<std::int32_t, ScanObject> ReadObjectsOfCapture(const CaptureWithTruth& files);

/// Decodes a capture as lookout-lidar does and hands on each whole scan with its truth. Times are by the sensor's clock.
///
/// Returns of the own vessel (object -1) are taken out of the scan; clutter (object 0) stays. Each row of the truth is met once; of several possible
/// rows, the row of the same return index, then the nearest in time. The truth is read as it is needed, so it must be in the order of time.
/// Deterministic. Memory: a scan, its truth, and the whole capture unpacked, 1 GiB at most.
/// @throws std::runtime_error "file:line: reason" or "file: reason" for a file that cannot be read; when more than kMaxUnmatchedShare have no truth;
/// when there is no whole scan
CaptureReport ReadCapture(const CaptureWithTruth& files, const Boat& boat, const ScanHandler& on_scan);

}  // namespace lookout::eval
