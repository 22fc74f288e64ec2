// SIGINT and its like for programs that work through files: the work ends at its next step, so that its outputs are put away in order.
#pragma once

#include <stdexcept>

namespace lookout::io {

/// The work was asked to stop: exit code 1.
class Stopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// From here on SIGINT, SIGTERM and SIGHUP (unless it was ignored: nohup) are noted, not deadly; SIGPIPE and SIGXFSZ become errors of write(2).
/// A system call that blocks (a pipe that nobody reads) ends with EINTR, at the latest a second after the signal; from then on the next signal is
/// deadly, for work that does not look. Where standard input, output or error is closed a file in its place is opened, so that no output gets its
/// number. To be called once, first in main.
void CatchStopSignals();

/// Whether the program was started so that this signal does nothing, as nohup does with SIGHUP.
bool IsIgnored(int signal);

/// Whether one has come. Any thread.
bool IsStopAsked();

/// To be called in every loop that may run long. @throws Stopped "stopped by SIGINT" when one has come
void ThrowIfStopAsked();

}  // namespace lookout::io
