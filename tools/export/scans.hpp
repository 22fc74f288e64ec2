// Scans of a log with their labels, and one scan out of many.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "common/messages/scan_collector.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

using messages::ScanMessages;

/// Whether LIDAR_SCAN and SEGMENTS of a scan are whole.
bool IsLabelled(const ScanMessages& scan);
/// And TRACKS.
bool IsTracked(const ScanMessages& scan);

/// Collects scans in the order of the log; each waits until `is_complete`, or a later one is, or too many wait.
messages::ScanCollector MakeCollector(messages::ScanCollector::Predicate is_complete, messages::ScanCollector::Handler on_scan);

/// Adds a message of LIDAR_SCAN, SEGMENTS, OBSTACLES or TRACKS.
Taken AddTo(messages::ScanCollector& collector, std::string_view channel, Bytes bytes);

/// @return the labels of a part of a scan; nullptr where the log holds none
const segments_t* LabelsOf(const ScanMessages& scan, const lidar_scan_t& part);

/// Messages of SEGMENTS with columns that no part of the scan has.
std::int64_t NumOrphans(const ScanMessages& scan);

/// One scan of a log: the first of a number, or the last that is whole and not cut at either end (the last of all where none is).
class ChosenScan {
 public:
  enum class Of { kReturns, kObstacles };

  /// @param seq  number of the scan; nullopt = the last whole one
  ChosenScan(Of channels, std::optional<std::int64_t> seq);
  ChosenScan(const ChosenScan&) = delete;
  ChosenScan& operator=(const ChosenScan&) = delete;

  Taken Take(std::string_view channel, Bytes bytes) { return AddTo(collector_, channel, bytes); }
  void Finish() { collector_.Finish(); }

  /// Whether the wanted scan is complete; never so for the last.
  bool IsDone() const { return seq_ && chosen_; }

  const std::optional<ScanMessages>& chosen() const { return chosen_; }

  /// Time of the scan that is looked at now: of the chosen one where its number was given; 0 = none yet.
  std::int64_t utime_us() const { return IsDone() ? chosen_->utime_us : latest_utime_us_; }

 private:
  void Consider(const ScanMessages& scan);

  Of channels_;
  std::optional<std::int64_t> seq_;
  std::optional<ScanMessages> chosen_;
  bool is_chosen_whole_ = false;
  std::int64_t latest_utime_us_ = 0;
  messages::ScanCollector collector_;
};

}  // namespace lookout::exporter
