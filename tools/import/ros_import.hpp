// Messages of ROS into the items of a log.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "tools/import/cloud_scan.hpp"
#include "tools/import/log_maker.hpp"
#include "tools/import/recording.hpp"
#include "tools/import/topic_map.hpp"
#include "tools/import/truth_files.hpp"

namespace lookout::importer {

/// The fate of the messages of a topic.
struct TopicTally {
  std::int64_t num_used = 0;
  std::int64_t num_refused = 0;     // not a message of the topic's type, or text of more than 64 KiB
  std::int64_t num_empty = 0;       // without usable content: no sentence in the text, no finite number
  std::int64_t num_lines_lost = 0;  // lines of texts that may not enter NAV_RAW: see DatagramLines
  std::int64_t num_other_time = 0;  // the stamp was not used (TimeBasis::kAuto)
};

class RosImport {
 public:
  /// @param truth  takes the labels of clouds; nullptr: nobody does
  RosImport(TopicMap map, LogMaker& log, TruthFiles* truth = nullptr) : map_(std::move(map)), log_(log), truth_(truth) {}

  /// Shows the beginning of a recording, to learn the beams of a lidar whose clouds are imported.
  void Learn(Recording& recording);

  void Take(const RecordedMessage& message);

  const std::map<std::string, TopicTally>& tallies() const { return tallies_; }
  const CloudScans& clouds() const { return clouds_; }

  /// "imported:/fix"
  static std::string SourceOf(const std::string& topic);

 private:
  static std::optional<std::int64_t> TimeNsOf(const RecordedMessage& message, std::int64_t stamp_ns, TimeBasis basis, TopicTally& tally);
  void TakePackets(const RecordedMessage& message, const TopicUse& use, TopicTally& tally);
  void TakeCloud(const RecordedMessage& message, TimeBasis basis, TopicTally& tally);
  void TakeImu(const RecordedMessage& message, const TopicUse& use, TopicTally& tally);
  void TakeSentence(const RecordedMessage& message, TimeBasis basis, TopicTally& tally);
  void TakeFix(const RecordedMessage& message, TimeBasis basis, TopicTally& tally);
  void TakeVelocity(const RecordedMessage& message, TimeBasis basis, TopicTally& tally);
  void TakeOxts(const RecordedMessage& message, TopicTally& tally);
  void AddSentence(Utime time, const std::string& topic, std::string sentence, TopicTally& tally);

  TopicMap map_;
  LogMaker& log_;
  TruthFiles* truth_;
  CloudScans clouds_;
  std::map<std::string, TopicTally> tallies_;
};

}  // namespace lookout::importer
