// Logs as recordings: one after the other in time, and others beside them.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "services/page/core/recordings.hpp"

namespace lookout::page {

struct FilmOptions {
  std::vector<std::filesystem::path> logs = {};    // source 0, in the order of their times
  std::vector<std::filesystem::path> beside = {};  // source 1: the same scans under another config; may be empty
  bool writes_index = true;                        // NAME.lcmlog.index beside each log
  // Called on the thread that makes the indices.
  std::function<void(int source, double share)> on_indexing = {};  // share: 0 to 1
  std::function<void()> on_sources = {};                           // an index is whole
  std::function<void(const std::string& line)> tell = {};          // for people
};

/// Indices are read or made on a thread of its own; requests of a source are refused until its index is complete (PROTOCOL.md).
class Film final : public Recordings {
 public:
  /// @throws std::runtime_error when there is no log, or one cannot be opened
  explicit Film(FilmOptions options);

  /// Ends the making of an index; its unfinished part is lost.
  ~Film() override;
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  std::string SourcesText() override;
  Answer Find(const At& request) override;
  Answer Find(const Range& request) override;
  std::string Strip(const StripRequest& request) override;

  /// Waits until the indices of all sources are whole.
  void Wait();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::page
