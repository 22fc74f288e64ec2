// Revisions of the alerts that an output told, which one process leaves to the next.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/core/notice_schedule.hpp"

namespace lookout::plotter {

/// A receiver ignores an alert whose revision it knows already, so a process that begins must go on with the revisions of the process before. The
/// file holds a line for each alert that stands or ended within ten minutes: id, cause, when it was raised (us since 1970), level, state, sound,
/// escalation, revision. The file is whole whenever a process is killed. Where the file cannot be written, revisions begin anew, and alerts are told
/// all the same.
class RevisionFile {
 public:
  /// @param file  empty: nothing is written and nothing read
  explicit RevisionFile(std::filesystem::path file = {}) : file_(std::move(file)) {}

  /// The file of an output of this process, in io::RuntimeFolder.
  static RevisionFile Of(const std::string& output_name);

  /// Notices of the process before; empty where there was none, or its file is damaged.
  std::vector<ToldNotice> Read() const;
  /// Writes the file when its content differs from what was written last.
  void Write(std::span<const ToldNotice> notices);

 private:
  std::filesystem::path file_;
  std::string written_;
};

}  // namespace lookout::plotter
