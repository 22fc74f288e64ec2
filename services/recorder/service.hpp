// The recorder process: every channel into an lcm-log, RUN_INFO first.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "lookout/run_info_t.hpp"
#include "services/recorder/params.hpp"

namespace lookout::recorder {

class Service {
 public:
  /// Makes the folder and a new log in it, named by the time, and writes RUN_INFO.
  ///
  /// @param run_info  what runs; its time and number are set here
  /// @param clock     host time: an event is logged with the time at which it was received
  /// @throws std::runtime_error when the log cannot be made
  Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock);

  /// Every so often: sends RUN_INFO each 10 s, hands the log to the disk each second.
  void AdvanceTo(Utime now);

  const std::filesystem::path& log_file() const { return log_file_; }

  HealthReport Report() const;

 private:
  void OnMessage(std::string_view channel, Bytes bytes);
  void Write(Utime time, std::string_view channel, Bytes bytes);
  void SendRunInfo(Utime now);

  bus::Bus& bus_;
  std::function<Utime()> clock_;
  run_info_t run_info_;
  std::filesystem::path log_file_;
  std::unique_ptr<bus::LogWriter> log_;
  Utime last_run_info_{};
  Utime last_flush_{};
  std::int64_t num_events_ = 0;
  std::int64_t num_unknown_channel_ = 0;
  std::int64_t num_not_written_ = 0;
  std::string write_error_;  // the last one; empty while the disk takes everything
};

}  // namespace lookout::recorder
