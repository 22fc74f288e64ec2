// The recorder process without its clock: every channel in, an lcm-log and RUN_INFO out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/sequence.hpp"
#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "lookout/run_info_t.hpp"
#include "services/recorder/params.hpp"

namespace lookout::recorder {

class Service {
 public:
  /// Makes the folder and the log, with RUN_INFO as its first event.
  ///
  /// @param run_info  what runs, without time and number
  /// @param clock     host time: that of an event is when it is received
  /// @throws std::runtime_error when the log cannot be made and begun
  Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock);

  /// Writes to the disk what is held, RUN_INFO every 10 s, and begins a new log where the one before failed. To be called once a second at least.
  void AdvanceTo(Utime now);

  /// The log that is written, or was when writing failed.
  const std::filesystem::path& log_file() const { return log_file_; }

  /// Lines for the log of the process that came up since the last call: channels that are not in the table, faults of the disk. Printable.
  std::vector<std::string> TakeWarnings();

  HealthReport Report() const;

 private:
  void OnEvent(std::string_view channel, Bytes bytes);
  void BeginLog(Utime now);
  std::vector<std::uint8_t> EncodeRunInfo(Utime now);
  void PublishRunInfo(Utime now);
  void Write(Utime time, std::string_view channel, Bytes bytes);
  void Flush();
  void Fail(std::string_view reason);
  void WatchGaps(std::string_view channel, Bytes bytes);
  void WatchUnknown(std::string_view channel);

  bus::Bus& bus_;
  Params params_;
  run_info_t run_info_;
  std::function<Utime()> clock_;
  std::unique_ptr<bus::LogWriter> writer_;  // empty after a fault, until writing works again
  std::filesystem::path log_file_;
  std::optional<Utime> last_run_info_;
  std::vector<std::uint8_t> own_run_info_;  // as sent last: it comes back from the bus
  std::map<std::string, bus::SequenceWatch, std::less<>> raw_sequences_;
  std::set<std::string, std::less<>> unknown_channels_;
  std::vector<std::string> warnings_;
  std::string fault_;  // of the disk, the last
  bool is_failing_ = false;
  std::int64_t num_unflushed_ = 0;
  std::int64_t num_events_ = 0;
  std::int64_t num_bytes_ = 0;
  std::int64_t num_lost_ = 0;
  std::int64_t num_unknown_ = 0;
  std::int64_t num_nameless_ = 0;
  std::int64_t num_raw_missing_ = 0;
  std::int64_t num_faults_ = 0;
};

}  // namespace lookout::recorder
