// Processes that run beside each other and end when this one does.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace lookout::archive {

class Processes {
 public:
  Processes() = default;
  /// Ends those that still run, with all that they have started (SIGTERM), and waits for them.
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  /// In a group of its own, so that a signal of the terminal comes to this process alone, which ends them in order.
  ///
  /// @param arguments    the program first; standard input is closed, output and errors are this process' own
  /// @param environment  added to that of this process
  /// @throws std::runtime_error when it cannot be started
  void Start(const std::vector<std::string>& arguments, const std::map<std::string, std::string>& environment);

  std::size_t num_running() const { return running_.size(); }

  /// Waits until one has ended, for so long at most.
  void WaitForOne(std::chrono::milliseconds at_most);

 private:
  std::vector<pid_t> running_;
};

}  // namespace lookout::archive
