// The recorder process without its clock: every channel in, lcm-logs and RUN_INFO out.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/stream_guard.hpp"
#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "lookout/run_info_t.hpp"
#include "services/recorder/io/disk_writer.hpp"
#include "services/recorder/params.hpp"

namespace lookout::recorder {

class Service {
 public:
  /// Makes the folder and the log, with RUN_INFO as its first event. Where the disk has no more than its reserve the service waits for room.
  ///
  /// @param run_info  what runs, without time and number
  /// @param clock     host time: an event's time is its reception
  /// @throws std::runtime_error when the log cannot be made and begun
  Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock, Disk disk = RealDisk());

  /// Sends RUN_INFO every 10 s; begins a new log when the log is old enough, or where it failed. To be called once a second at least.
  void AdvanceTo(Utime now);

  /// Goes on in a new log. Each event is in either the old or the new log, never in both.
  void Rotate(Utime now);

  /// Waits until all that was received is on the disk, or lost.
  void Flush() { writer_.Flush(); }

  /// The log that is written, or was when writing failed.
  std::filesystem::path log_file() const { return writer_.Status().file; }

  /// Lines for the log of the process that came up since the last call: channels that are not in the table, losses. Printable.
  std::vector<std::string> TakeWarnings();

  /// Events of the last minute, by the time of AdvanceTo, and states that still hold.
  HealthReport Report() const;

 private:
  void OnEvent(std::string_view channel, Bytes bytes);
  void KeepBeams(Bytes bytes);
  bool IsRecordable(std::string_view channel, Bytes bytes);
  void BeginFile(Utime now, bool must_publish);
  std::vector<std::uint8_t> EncodeRunInfo(Utime now);
  void PublishRunInfo(Utime now, std::vector<std::uint8_t> bytes);
  bool IsOwnRunInfo(Bytes bytes);
  void Write(Utime time, std::string_view channel, Bytes bytes);
  void WatchGaps(const bus::Channel& channel, Bytes bytes);
  void WatchUnknown(std::string_view channel);
  void WatchDisk();
  void NoteMissing(const bus::Channel& channel, std::int64_t number);
  std::string SecondPublisherText() const;

  bus::Bus& bus_;
  Params params_;
  run_info_t run_info_;
  std::function<Utime()> clock_;
  DiskWriter writer_;
  Utime file_start_;
  Utime last_run_info_;
  std::int64_t file_bytes_ = 0;  // size of the file once the writer has written all that was passed to it
  std::int64_t num_file_events_ = 0;
  std::vector<std::uint8_t> event_;                                      // scratch
  std::deque<std::vector<std::uint8_t>> own_run_infos_;                  // sent, and not yet come back from the bus
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> beams_;  // the last LIDAR_BEAMS of each lidar
  std::map<std::string, bus::StreamGuard, std::less<>> guards_;          // watch only: everything is recorded
  std::set<std::string, std::less<>> unknown_channels_;
  std::vector<std::string> warnings_;
  DiskStatus seen_{.is_recording = true};  // status when no new log was waited for last
  std::int64_t num_unknown_ = 0;
  std::int64_t num_nameless_ = 0;
  std::int64_t num_name_too_long_ = 0;
  std::int64_t num_too_large_ = 0;
  PassedTime time_;
  Recently lost_;
  Recently disturbed_;
  Recently raw_missing_;
  std::int64_t num_missing_ = 0;      // gaps in seq, of any channel
  std::int64_t num_raw_missing_ = 0;  // of these, gaps of raw channels
};

}  // namespace lookout::recorder
