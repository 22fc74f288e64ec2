// Packets, sentences, samples and scans out of a recording, in the order of their times, as the messages of a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/core/driver/bundler.hpp"
#include "services/lidar/params.hpp"
#include "services/navigator/core/item_sequencer.hpp"

namespace lookout::importer {

/// One item of a recording, at one time.
struct ImportItem {
  enum class Kind { kPacket, kPositionPacket, kSentence, kImu, kScanPart };
  Kind kind = Kind::kPacket;
  std::vector<std::uint8_t> bytes;   // of a packet, or of a message of LIDAR_SCAN
  std::string sentence;              // of a sentence: navigator::IsLine
  navigator::StrapdownSample imu{};  // of a sample
  std::string source;                // of a sentence or sample: navigator::IsImportedSource
};

/// Puts items in order and makes messages of them: LIDAR_PACKETS in bundles as lookout-lidar makes them, NAV_RAW with ticks and marks as
/// lookout-navigator does, LIDAR_SCAN as it is. Topics are recorded with delays of their own: an item waits until what is recorded is kWait later.
class LogMaker {
 public:
  static constexpr std::chrono::seconds kWait{2};
  static constexpr std::size_t kMaxWaitingBytes = std::size_t{24} << 20;
  /// The recording's clock was set back when its time falls by this much: waiting items are released.
  static constexpr std::chrono::seconds kSetBack{10};

  using Write = std::function<void(Utime time, const bus::Channel& channel, Bytes bytes)>;

  /// @param has_navigation  whether sentences or samples are to be expected: only then is there NAV_RAW, which has ticks as well
  LogMaker(const lidar::Params& params, bool has_navigation, Write write);

  void Add(Utime time, ImportItem item);

  /// The time of recording has come so far; to be called before items that were recorded then are added.
  void AdvanceTo(Utime recorded);

  /// End of the recording: the rest, and the end marks.
  void Finish();

  std::int64_t num_late() const { return num_late_; }  // items older than what had been written: their topic was late by more than kWait
  std::vector<Counter> counters() const;

 private:
  void Release(Utime time, const ImportItem& item);
  void ReleaseUntil(Utime until);
  void WriteBundle(const lidar::PacketBundle& bundle);
  void WriteNavigation(const std::vector<navigator::Item>& items);

  Write write_;
  int data_port_;
  int position_port_;
  bool has_navigation_;
  lidar::Bundler bundler_;
  navigator::ItemSequencer sequencer_;
  std::multimap<Utime, ImportItem> waiting_;
  std::size_t num_waiting_bytes_ = 0;
  std::optional<Utime> newest_;    // of the recording
  std::optional<Utime> released_;  // the last item
  bool was_set_back_ = false;
  std::int64_t num_late_ = 0;
};

}  // namespace lookout::importer
