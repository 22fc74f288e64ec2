// Revisions of the alerts that an output told, which one process leaves to the next.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/core/notice_schedule.hpp"

namespace lookout::plotter {

/// A receiver takes a revision that it knows for what it knows already, so a process that begins must go on where the one before it stopped. The file
/// holds a line for each alert that stands or ended within ten minutes: id, cause, when it was raised (us since 1970), level, state, sound,
/// escalation, revision. It is whole whenever a process is killed. Where it cannot be written, revisions begin anew, and alerts are told all the
/// same.
class RevisionFile {
 public:
  /// @param file  empty: nothing is left and nothing found
  explicit RevisionFile(std::filesystem::path file = {}) : file_(std::move(file)) {}

  /// Of an output of this process, in io::RuntimeFolder.
  static RevisionFile Of(const std::string& output_name);

  /// Of the process before; empty where there is none, or its file is damaged.
  std::vector<ToldNotice> Read() const;
  /// Written when it differs from what was written last.
  void Write(std::span<const ToldNotice> notices);

 private:
  std::filesystem::path file_;
  std::string written_;
};

}  // namespace lookout::plotter
