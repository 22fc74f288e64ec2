// Clock and disk, as the kernel tells them.
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>

#include "common/runtime/process.hpp"
#include "tools/doctor/machine.hpp"

namespace lookout::doctor {

namespace {

namespace fs = std::filesystem;

// The recorder that was heard last; nullptr = none.
const health_t* RecorderHeard(const Observations& seen) {
  const auto found = seen.processes.find("recorder");
  return found == seen.processes.end() || found->second.empty() ? nullptr : &found->second.back().last;
}

// Where it is, or its nearest parent that is there: the recorder makes what is missing.
fs::path Existing(fs::path folder) {
  std::error_code error;
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

}  // namespace

bool IsHostClockSet() {
  timex state{};  // modes 0: only asks
  return adjtimex(&state) != TIME_ERROR;
}

DiskSeen ReadDisk(const Observations& seen) {
  DiskSeen disk;
  if (!seen.config.log_folder) return disk;
  const auto* recorder = RecorderHeard(seen);
  if (recorder != nullptr && recorder->host != runtime::HostName()) {
    disk.other_host = recorder->host;
    return disk;
  }
  std::error_code error;
  auto folder = *seen.config.log_folder;
  if (folder.is_relative()) {
    const auto start = recorder != nullptr ? fs::read_symlink("/proc/" + std::to_string(recorder->pid) + "/cwd", error) : fs::path();
    disk.is_guessed = start.empty();
    folder = (start.empty() ? fs::current_path(error) : start) / folder;
  }
  disk.folder = folder;
  const auto existing = Existing(folder);
  const auto space = fs::space(existing, error);
  if (!error) disk.free_bytes = std::max<std::int64_t>(0, static_cast<std::int64_t>(space.available) - seen.config.log_reserve_bytes);
  // A recorder that writes may be another user.
  const bool is_recording = recorder != nullptr && recorder->state != health_t::STATE_FAILED;
  disk.is_writable = is_recording || access(existing.c_str(), W_OK) == 0;
  return disk;
}

}  // namespace lookout::doctor
