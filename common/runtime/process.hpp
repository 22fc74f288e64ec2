// A live process: signals, timers, file descriptors, the LCM bus and HEALTH at 1 Hz, in one thread.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"

namespace lookout::runtime {

/// Host time. Only main, io and runtime call it; all else gets time as an argument.
Utime HostNow();

/// A clock that nobody sets, for durations. For whom HostNow() is.
std::chrono::steady_clock::time_point SteadyNow();

/// Name of this computer.
std::string HostName();

/// Blocks SIGINT, SIGTERM and SIGHUP: a signal from here on waits for Process::Run. Must be called first in main, so that an early signal does not
/// end the start.
void BlockStopSignals();

class Process {
 public:
  /// Blocks SIGINT, SIGTERM and SIGHUP, opens the bus.
  ///
  /// @param name  as in HEALTH: "segmenter"
  /// @throws std::runtime_error when the bus cannot be opened
  Process(const std::string& name, const std::string& lcm_url);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bus::LcmBus& bus() { return bus_; }

  /// Calls `handler` while `file_descriptor` is readable. It must read at least once and not wait.
  void OnReadable(int file_descriptor, std::function<void()> handler);

  /// Calls `handler` about every `period`, late rather than twice.
  void Every(std::chrono::milliseconds period, std::function<void()> handler);

  /// Calls `handler` on SIGHUP instead of ending Run. One that the kernel, or a shell, sends because the terminal is gone still ends it.
  void OnHangup(std::function<void()> handler);

  /// Runs until SIGINT, SIGTERM, SIGHUP (unless it was ignored at the start: nohup) or Stop(). Sends HEALTH once a second with the result of
  /// `report`, and after each, under systemd, feeds its watchdog: every input is handled in this loop, so a loop that makes its report is alive. At
  /// the end it still handles arrived messages, for 0.3 s at most.
  /// @throws exceptions of a handler
  void Run(const std::function<HealthReport()>& report);

  /// Sends HEALTH after the timers of this round too: for states that may be over before the next report. Rates, cpu, memory are those of the last
  /// second.
  void ReportNow();

  /// Ends Run after the handler that calls it (end of a capture).
  void Stop();

 private:
  struct Implementation;
  bus::LcmBus bus_;
  std::unique_ptr<Implementation> implementation_;
};

/// Sets the pattern of the default logger; "%v" is the text, of which no control character passes (PrintableLines): names in logs and captures, texts
/// of messages and configs may hold anything.
///
/// @param is_utc  whether times in the pattern are UTC, else local
void SetLogPattern(const std::string& pattern, bool is_utc = false);

/// Runs `body`, and turns its exceptions into a line of the log and an exit code: 0 fine, 1 failed, 2 wrong config. Lines of the log carry `name`.
int RunMain(const std::string& name, const std::function<void()>& body);

}  // namespace lookout::runtime
