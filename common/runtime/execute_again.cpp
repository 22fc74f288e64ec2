#include "common/runtime/execute_again.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string>

namespace lookout::runtime {

namespace {

// What libraries opened without O_CLOEXEC must not pile up from start to start. Where this cannot be it is no reason to end a look-out.
void CloseAllAtExecution() {
  constexpr int kFirstAfterStandardError = 3;
  constexpr unsigned int kLast = ~0U;
  if (close_range(kFirstAfterStandardError, kLast, CLOSE_RANGE_CLOEXEC) == 0) return;
  // Before Linux 5.11.
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string name = entry.path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (descriptor >= kFirstAfterStandardError) fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  }
}

}  // namespace

void ExecuteAgain(char** argv) {
  const std::string self = "/proc/self/exe";
  // By its own path, so that ps shows its name; by the link, when the file was replaced meanwhile.
  std::error_code error;
  std::string program = std::filesystem::read_symlink(self, error).string();
  if (error || access(program.c_str(), X_OK) != 0) program = self;

  std::cout.flush();
  spdlog::default_logger()->flush();
  CloseAllAtExecution();
  execv(program.c_str(), argv);
  throw std::runtime_error("cannot start " + program + " again: " + std::strerror(errno));
}

}  // namespace lookout::runtime
