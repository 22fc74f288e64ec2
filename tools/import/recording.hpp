// A recording of others as a sequence of messages on topics, whatever file it stands in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::importer {

/// How the bytes of a message are laid out.
enum class Encoding { kRos1, kCdr, kLcm, kText, kOther };

struct Topic {
  std::string name;
  std::string type;  // "sensor_msgs/Imu": without the "msg/" of ROS 2
  Encoding encoding = Encoding::kOther;
  std::int64_t num_messages = -1;  // -1: the recording does not say
};

/// By number of the recording's own; two numbers may be of one name (two publishers).
using Topics = std::map<std::uint32_t, Topic>;

struct RecordedMessage {
  std::int64_t time_ns = 0;  // when the message was recorded, since 1970
  const Topic* topic = nullptr;
  Bytes bytes;  // stand until the next call
};

/// Whether a message may have been recorded at it, since 1970: what Utime accepts from outside.
constexpr bool IsRecordedTime(std::int64_t time_ns) { return time_ns >= kMinUtimeUs * 1000 && time_ns <= kMaxUtimeUs * 1000; }

/// Losses of a recording.
struct Losses {
  std::int64_t num_damaged = 0;        // stretches, chunks or records that could not be read
  std::int64_t num_bytes_skipped = 0;  // of the file, where another chunk was looked for, or a record is too large to be read
  std::int64_t num_bad_messages = 0;   // messages of an unknown topic, or at an impossible time
  std::int64_t num_foreign = 0;        // files of a folder that do not belong to its recording
  bool is_cut = false;                 // the file ends before its end mark
  std::string first_fault;             // in words, with the place

  bool IsAny() const { return num_damaged > 0 || num_bad_messages > 0 || num_foreign > 0 || is_cut; }
  void Damage(std::uint64_t offset, const std::string& reason);
  /// Damage of a file of a folder. @param reason  names the file
  void DamageFile(const std::string& reason);
  void BadMessage(const std::string& reason);
};

class Recording {
 public:
  Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  virtual ~Recording() = default;

  /// In words: "ROS bag".
  virtual std::string kind() const = 0;

  /// @return the next message in the order of the file; nullopt at the end, or where nothing more can be read
  virtual std::optional<RecordedMessage> Next() = 0;

  /// Topics that have come so far.
  virtual const Topics& topics() const = 0;

  virtual const Losses& losses() const = 0;

  /// All topics, by the index of the recording; empty where it has none or that is damaged: then they are known when all has been read.
  virtual Topics IndexedTopics() = 0;

  /// How far it is read, 0 to 1.
  virtual double share() const = 0;

  /// What is missing in the recording, or how it is read, in words, for people and RUN_INFO.
  virtual std::vector<std::string> remarks() const { return {}; }

  /// Meaning of the labels of the recording's points (ParseLabelMap); empty where it has no labels.
  virtual std::string_view default_labels() const { return {}; }
};

/// Longest text of a name or type that is taken, so that a damaged length does not become a topic.
inline constexpr std::size_t kMaxNameBytes = 4096;

/// Topics of a recording at most: each costs memory.
inline constexpr std::size_t kMaxTopics = 10'000;

/// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" are one type.
std::string PlainTypeName(std::string type);

/// Opens a ROS bag, MCAP file, database of rosbag2, or a folder of scans.
///
/// @return nullptr when it is none of these
/// @throws std::runtime_error when it cannot be opened
std::unique_ptr<Recording> OpenRecording(const std::filesystem::path& file);

/// The files of a folder that rosbag2 has written (name_0.db3, name_1.db3, ...; .mcap), in their order; of any other path, and of a folder of scans,
/// itself.
/// @throws std::runtime_error when a folder holds none
std::vector<std::filesystem::path> FilesOfRecording(const std::filesystem::path& path);

}  // namespace lookout::importer
