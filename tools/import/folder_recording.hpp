// Folders with a file for each scan, and their times beside them: PCD files, and the layouts of KITTI, SemanticKITTI and SeePerSea.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/point_message.hpp"
#include "tools/import/recording.hpp"

namespace lookout::importer {

class FolderRecording final : public Recording {
 public:
  /// More files are no recording.
  static constexpr std::size_t kMaxFrames = 1'000'000;

  /// Whether a folder holds scans in a layout that is known.
  static bool IsLayout(const std::filesystem::path& folder);

  /// Lists the files and reads their times.
  /// @throws std::runtime_error when it holds no scans in a layout that is known
  explicit FolderRecording(const std::filesystem::path& folder);

  std::string kind() const override { return "folder of scans"; }
  std::optional<RecordedMessage> Next() override;
  const Topics& topics() const override { return topics_; }
  const Losses& losses() const override { return losses_; }
  Topics IndexedTopics() override { return topics_; }
  double share() const override;
  std::vector<std::string> remarks() const override { return remarks_; }
  std::string_view default_labels() const override;

 private:
  enum class Labels { kNone, kPoints, kBoxes };
  struct Frame {
    std::optional<std::int64_t> time_ns;
    bool is_oxts = false;
    std::string name;  // of the file, in its folder
  };
  struct Layout {
    std::filesystem::path points;  // folder; empty: none
    std::filesystem::path oxts;
    std::string extension;  // of the points
  };

  static Layout LayoutOf(const std::filesystem::path& folder);
  void AddFrames(const std::filesystem::path& folder, std::string_view extension, bool is_oxts);
  void FindTimes(const std::filesystem::path& folder, bool is_oxts, std::vector<Frame>& frames);
  void FindLabels();
  bool Read(const Frame& frame);
  void ReadPoints(const Frame& frame);
  PointMessage MessageOf(const Frame& frame, const std::string& bytes);

  Layout layout_;
  std::filesystem::path label_folder_;
  Labels labels_ = Labels::kNone;
  Topics topics_;
  std::vector<Frame> frames_;  // by time
  std::size_t next_ = 0;
  Losses losses_;
  std::vector<std::string> remarks_;
  std::int64_t message_time_ns_ = 0;
  std::vector<std::uint8_t> message_;
};

}  // namespace lookout::importer
