// A program that is run to its end, and its output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lookout::archive {

struct ChildEnd {
  int exit_code = 0;  // of a program that ended by itself
  int signal = 0;     // 0: the program ended by itself
  std::string out;    // standard output, at most the first 1 MB
  std::string error;  // the last 64 kB of standard error
  double wall_s = 0;
  double cpu_s = 0;
  std::int64_t peak_bytes = 0;  // greatest resident size

  bool IsFine() const { return exit_code == 0 && signal == 0; }
  /// Killed by somebody: a computer that shut down, or one without memory. Run again, it may end otherwise.
  bool WasKilled() const;
  /// The signal that asked the program to stop, as it says itself in a line "...: stopped by SIGTERM" of standard error; empty: none.
  std::string StoppedBy() const;
  /// The last line of standard error that is not empty, of printable characters.
  std::string LastLine() const;
  /// The disk, the memory or a mount failed, not the work: the text of an error that is of the computer, empty: none.
  std::string FaultOfComputer() const;
};

/// Runs `arguments` (the program first) in `folder`, its standard input closed. It ends when this process does.
/// @throws std::runtime_error when it cannot be started; io::Stopped, when this program was asked to stop: the child has ended then
ChildEnd RunChild(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

}  // namespace lookout::archive
