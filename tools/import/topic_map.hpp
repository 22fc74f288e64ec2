// Which topic of a recording becomes what: guessed, printed, and read from a text file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/recording.hpp"

namespace lookout::importer {

enum class Use { kNone, kLidarPackets, kPositionPackets, kLidarScan, kImu, kImuFlu, kSentences, kFix, kVelocity, kOxts };

/// Whose time a message has: the stamp in it where that is within kMaxStampOffNs of the recording's, else the recording's; or always one of them.
enum class TimeBasis { kAuto, kStamp, kRecorded };
inline constexpr std::int64_t kMaxStampOffNs = 10'000'000'000;

struct TopicUse {
  Use use = Use::kNone;
  TimeBasis time = TimeBasis::kAuto;

  friend bool operator==(const TopicUse&, const TopicUse&) = default;
};

/// By name of the topic; what is not in it is not used.
using TopicMap = std::map<std::string, TopicUse, std::less<>>;

/// A topic that lookout-import can use, and one for each purpose:
///   lidar: packets before PointCloud2; of several the one whose name is most like a lidar's raw points
///   IMU: of several the one that is not inside of a lidar or camera
///   receiver: all topics of sentences; without any a NavSatFix, and the velocity beside it
TopicMap GuessTopics(const Topics& topics);

/// A line for each topic: name, use, and as a comment its type and number of messages. It can be read again.
std::string TopicMapText(const Topics& topics, const TopicMap& map);

/// Lines "TOPIC USE [time=auto|stamp|recorded]"; # begins a comment.
///
/// @throws config::ConfigError with all faults, each with its line: unknown words, topics that the recording has not, types that do not fit, two
///         lidars
TopicMap ParseTopicMap(const std::string& text, const std::string& name, const Topics& topics);

/// The words of all uses, for --help.
std::string UseWords();

}  // namespace lookout::importer
