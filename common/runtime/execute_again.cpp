#include "common/runtime/execute_again.hpp"

#include <linux/close_range.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string>

namespace lookout::runtime {

void ExecuteAgain(char** argv) {
  const std::string self = "/proc/self/exe";
  // By its own path, so that ps shows its name; by the link, when the file was replaced meanwhile.
  std::error_code error;
  std::string program = std::filesystem::read_symlink(self, error).string();
  if (error || access(program.c_str(), X_OK) != 0) program = self;

  std::cout.flush();
  spdlog::default_logger()->flush();
  // What libraries opened without O_CLOEXEC must not pile up from start to start. Since Linux 5.11.
  constexpr unsigned int kFirstAfterStandardError = 3;
  constexpr unsigned int kLast = ~0U;
  if (close_range(kFirstAfterStandardError, kLast, CLOSE_RANGE_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("cannot close descriptors for a new start: ") + std::strerror(errno));
  }
  execv(program.c_str(), argv);
  throw std::runtime_error("cannot start " + program + " again: " + std::strerror(errno));
}

}  // namespace lookout::runtime
