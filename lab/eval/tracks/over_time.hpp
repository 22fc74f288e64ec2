// "ours over time": the labels that returns have by the boat's tracks, where all other methods see one scan alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/tracks/track_sources.hpp"

namespace lookout::eval {

/// In tables.
inline constexpr std::string_view kOverTime = "ours over time";

/// Lets all services run on the sensors' messages of a boat, scan after scan, and keeps the label of each return: the track of its piece.
/// Land is no track, and returns that no track explains are none either: both keep the label of their segment, so that each island is compared with
/// its own.
///
/// A run begins without any history: its first scans have the labels of SEGMENTS. Its time would be that of the whole boat, and is not stated.
class OverTimeMethod final : public Method {
 public:
  /// Sends the sensors' messages in the run of a scan. @return false: there is no such run, and its scans are not labelled
  using Feed = std::function<bool(const ScanPlace& place, const DatagramHandler& on_datagram, const ScanMessageHandler& on_scan)>;

  /// @param config_folder  of the boat
  OverTimeMethod(std::filesystem::path config_folder, Feed feed) : config_folder_(std::move(config_folder)), feed_(std::move(feed)) {}

  std::string name() const override { return std::string(kOverTime); }
  /// Runs the services where the scene or the seed is another than before. @throws config::ConfigError
  bool BeginScan(const ScanPlace& place) override;
  /// @throws std::runtime_error unless the scan is one of the run, behind the last one. Returns that it lacks, as those of the own vessel in
  /// captures, do not matter.
  Labelling Segment(const segmenter::Scan& scan) override;

 private:
  struct LabelledCells {
    std::vector<std::uint16_t> range;  // as in LIDAR_SCAN
    std::vector<std::int32_t> label;
  };

  void Run(const ScanPlace& place);

  std::filesystem::path config_folder_;
  Feed feed_;
  std::string scene_;
  std::uint64_t seed_ = 0;
  bool has_run_ = false;
  std::vector<LabelledCells> scans_;
  std::size_t next_ = 0;  // of scans_
};

/// Feeds of the runs of a plan, by the names that scenes have in tables, and of captures.
///
/// @param lidar  the head in place of the scenes'; empty: theirs
OverTimeMethod::Feed FeedOfScenes(const std::filesystem::path& config_folder, std::span<const std::string> scenes, double seconds,
                                  const std::string& lidar = {});
OverTimeMethod::Feed FeedOfCaptures(std::vector<CaptureWithTruth> captures);

}  // namespace lookout::eval
