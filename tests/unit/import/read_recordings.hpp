// What a made recording gives when it is read.
#pragma once

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/unit/import/made_recordings.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/mcap_file.hpp"
#include "tools/import/ros_bag.hpp"

namespace lookout::importer::test {

struct Read {
  std::vector<Made> messages;
  Losses losses;
};

inline Read ReadAll(Recording& recording) {
  Read read;
  while (const auto message = recording.Next()) {
    read.messages.push_back({message->topic->name, message->topic->type, message->time_ns, {message->bytes.begin(), message->bytes.end()}});
  }
  read.losses = recording.losses();
  return read;
}

inline std::unique_ptr<Recording> OpenBag(Payload bytes) { return std::make_unique<RosBag>(std::make_unique<MemorySource>(std::move(bytes))); }
inline std::unique_ptr<Recording> OpenMcap(Payload bytes) { return std::make_unique<McapFile>(std::make_unique<MemorySource>(std::move(bytes))); }

inline void ExpectEqual(const std::vector<Made>& read, const std::vector<Made>& made) {
  ASSERT_EQ(read.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_EQ(read[i].topic, made[i].topic);
    EXPECT_EQ(read[i].type, made[i].type);
    EXPECT_EQ(read[i].time_ns, made[i].time_ns);
    EXPECT_EQ(read[i].bytes, made[i].bytes);
  }
}

/// Those that are read are messages that were written, in their order; none is made up.
inline void ExpectSome(const std::vector<Made>& read, const std::vector<Made>& made, std::size_t least) {
  EXPECT_GE(read.size(), least);
  auto next = made.begin();
  for (const auto& message : read) {
    next = std::find_if(next, made.end(), [&](const Made& one) { return one.topic == message.topic && one.time_ns == message.time_ns; });
    ASSERT_NE(next, made.end());
    EXPECT_EQ(next->bytes, message.bytes);
  }
}

inline std::map<std::string, std::int64_t> CountsOf(const Topics& topics) {
  std::map<std::string, std::int64_t> counts;
  for (const auto& [number, topic] : topics) counts[topic.name] = topic.num_messages;
  return counts;
}

/// A source that counts the bytes that were read of it.
class CountingSource final : public ByteSource {
 public:
  CountingSource(Payload bytes, std::uint64_t& num_read) : source_(std::move(bytes)), num_read_(num_read) {}
  std::uint64_t size() const override { return source_.size(); }
  std::size_t Read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
    const auto count = source_.Read(offset, out);
    num_read_ += count;
    return count;
  }

 private:
  MemorySource source_;
  std::uint64_t& num_read_;
};

/// A schema, and a channel of it.
inline Payload McapTopic(std::uint16_t number, const std::string& name, std::string_view encoding = "cdr") {
  const auto schema = static_cast<std::uint16_t>(number + 1);
  return Writer()
      .Raw(McapRecord(3,
                      Writer().Number(schema).Sized(std::string_view("nmea_msgs/msg/Sentence")).Sized(std::string_view("ros2msg")).Number(0U).bytes))
      .Raw(McapRecord(4, Writer().Number(number).Number(schema).Sized(name).Sized(encoding).Number(0U).bytes))
      .bytes;
}

inline Payload McapMessage(std::uint16_t number, std::int64_t time_ns, const Payload& bytes) {
  return McapRecord(5, Writer().Number(number).Number(0U).Number(time_ns).Number(time_ns).Raw(bytes).bytes);
}

inline const std::map<std::string, std::int64_t> kFourEach{{"/imu", 4}, {"/nmea", 4}, {"/packets", 4}};

}  // namespace lookout::importer::test
