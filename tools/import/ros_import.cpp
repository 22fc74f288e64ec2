#include "tools/import/ros_import.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bus/decode.hpp"
#include "services/navigator/core/lines.hpp"
#include "tools/import/oxts.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/ros_sentences.hpp"

namespace lookout::importer {

namespace {

std::optional<Utime> UtimeOfNs(std::int64_t time_ns) { return UtimeFromWire(time_ns / 1000 - (time_ns % 1000 < 0 ? 1 : 0)); }

bool IsNear(std::int64_t one_ns, std::int64_t other_ns) {
  std::int64_t off_ns = 0;
  return !__builtin_sub_overflow(one_ns, other_ns, &off_ns) && off_ns >= -kMaxStampOffNs && off_ns <= kMaxStampOffNs;
}

// Model of a cloud, which does not name its sensor.
std::string ModelOf(const std::string& type) {
  if (type == kTypePcd) return "PCD";
  if (type.starts_with("livox")) return "Livox";
  return type == kTypeKittiPoints ? "KITTI" : "PointCloud2";
}

std::optional<RosPointCloud> CloudOf(const RecordedMessage& message) {
  const bool is_livox = std::ranges::find(kTypesLivox, message.topic->type) != kTypesLivox.end();
  return (is_livox ? ParseLivoxPoints : ParsePointCloud)(message.topic->encoding, message.bytes);
}

// rad/s and m/s2: the greatest value that NAV_RAW accepts.
constexpr double kMaxImportImuValue = 1000.0;
// Longest text of a message: some hundred lines. Looking for sentences in a text takes longer than reading it.
constexpr std::size_t kMaxSentenceText = std::size_t{64} << 10;

}  // namespace

std::string RosImport::SourceOf(const std::string& topic) {
  std::string source(navigator::kImportedSource);
  const auto room = navigator::kMaxImportedSourceCharacters - source.size();
  for (const char letter : topic.substr(topic.size() > room ? topic.size() - room : 0)) source += letter > ' ' && letter < '\x7F' ? letter : '_';
  return source;
}

void RosImport::Learn(Recording& recording) {
  constexpr int kNumLearned = 20;
  int num_clouds = 0;
  const bool has_clouds = std::ranges::any_of(map_, [](const auto& use) { return use.second.use == Use::kLidarScan; });
  while (has_clouds && num_clouds < kNumLearned) {
    const auto message = recording.Next();
    if (!message) return;
    const auto use = map_.find(message->topic->name);
    if (use == map_.end() || use->second.use != Use::kLidarScan) continue;
    if (const auto cloud = CloudOf(*message)) {
      num_clouds += clouds_.Learn(*cloud) ? 1 : 0;
    }
  }
}

void RosImport::Take(const RecordedMessage& message) {
  const auto found = map_.find(message.topic->name);
  if (found == map_.end() || found->second.use == Use::kNone) return;
  const auto use = found->second;
  auto& tally = tallies_[message.topic->name];
  // First: what was recorded before a clock was set back must be out before anything of the new era is in.
  if (const auto recorded = UtimeOfNs(message.time_ns)) log_.AdvanceTo(*recorded);
  switch (use.use) {
    case Use::kLidarPackets:
    case Use::kPositionPackets:
      TakePackets(message, use, tally);
      break;
    case Use::kLidarScan:
      TakeCloud(message, use.time, tally);
      break;
    case Use::kImu:
    case Use::kImuFlu:
      TakeImu(message, use, tally);
      break;
    case Use::kSentences:
      TakeSentence(message, use.time, tally);
      break;
    case Use::kFix:
      TakeFix(message, use.time, tally);
      break;
    case Use::kVelocity:
      TakeVelocity(message, use.time, tally);
      break;
    case Use::kOxts:
      TakeOxts(message, tally);
      break;
    case Use::kNone:
      break;
  }
}

// nullopt where the one that counts is no time.
std::optional<std::int64_t> RosImport::TimeNsOf(const RecordedMessage& message, std::int64_t stamp_ns, TimeBasis basis, TopicTally& tally) {
  bool uses_stamp = basis == TimeBasis::kStamp;
  if (basis == TimeBasis::kAuto) {
    uses_stamp = (stamp_ns != 0 || message.time_ns == 0) && IsNear(stamp_ns, message.time_ns);
    tally.num_other_time += uses_stamp ? 0 : 1;
  }
  const auto time_ns = uses_stamp ? stamp_ns : message.time_ns;
  if (UtimeOfNs(time_ns)) return time_ns;
  ++tally.num_refused;
  return std::nullopt;
}

void RosImport::TakePackets(const RecordedMessage& message, const TopicUse& use, TopicTally& tally) {
  const auto packets = ParsePackets(message.topic->encoding, message.topic->type, message.bytes);
  if (!packets) {
    ++tally.num_refused;
    return;
  }
  tally.num_used += packets->empty() ? 0 : 1;
  tally.num_empty += packets->empty() ? 1 : 0;
  for (const auto& packet : *packets) {
    auto stamp_ns = packet.stamp_ns;
    // A scan is recorded when its last packet is there: by that clock the others came as much earlier as their stamps say.
    const auto before_last_ns = packets->back().stamp_ns - packet.stamp_ns;
    const bool has_stamp = stamp_ns != 0;
    const bool is_off = has_stamp && use.time == TimeBasis::kAuto && !IsNear(stamp_ns, message.time_ns);
    if ((is_off || use.time == TimeBasis::kRecorded) && before_last_ns >= 0 && before_last_ns <= kMaxStampOffNs / 10) {
      tally.num_other_time += is_off ? 1 : 0;
      stamp_ns = message.time_ns - before_last_ns;
    } else if (use.time == TimeBasis::kRecorded || is_off || (!has_stamp && message.time_ns != 0)) {
      stamp_ns = message.time_ns;
    }
    const auto time = UtimeOfNs(stamp_ns);
    if (!time) {
      ++tally.num_refused;
      continue;
    }
    ImportItem item;
    if (use.use == Use::kPositionPackets) item.kind = ImportItem::Kind::kPositionPacket;
    item.bytes.assign(packet.payload.begin(), packet.payload.end());
    log_.Add(*time, std::move(item));
  }
}

void RosImport::TakeCloud(const RecordedMessage& message, TimeBasis basis, TopicTally& tally) {
  const auto cloud = CloudOf(message);
  if (!cloud) {
    ++tally.num_refused;
    return;
  }
  const auto time_ns = TimeNsOf(message, cloud->header.stamp_ns, basis, tally);
  if (!time_ns) return;
  const auto parts = clouds_.Convert(*cloud, *time_ns, ModelOf(message.topic->type));
  ++(parts.empty() ? tally.num_empty : tally.num_used);
  if (truth_ != nullptr) truth_->Add(parts, clouds_.cell_labels());
  for (const auto& part : parts) {
    ImportItem item;
    item.kind = ImportItem::Kind::kScanPart;
    item.bytes = bus::Encode(part);
    log_.Add(Utime(std::chrono::microseconds(part.end_utime_us)), std::move(item));
  }
}

void RosImport::TakeImu(const RecordedMessage& message, const TopicUse& use, TopicTally& tally) {
  const auto imu = ParseImu(message.topic->encoding, message.bytes);
  if (!imu) {
    ++tally.num_refused;
    return;
  }
  const auto time_ns = TimeNsOf(message, imu->header.stamp_ns, use.time, tally);
  if (!time_ns) return;
  const auto time = *UtimeOfNs(*time_ns);
  ImportItem item;
  item.kind = ImportItem::Kind::kImu;
  item.source = SourceOf(message.topic->name);
  item.imu = {{imu->angular_velocity_radps[0], imu->angular_velocity_radps[1], imu->angular_velocity_radps[2]},
              {imu->linear_acceleration_mps2[0], imu->linear_acceleration_mps2[1], imu->linear_acceleration_mps2[2]}};
  for (auto* vector : {&item.imu.angular_velocity_radps, &item.imu.specific_force_mps2}) {
    if (use.use == Use::kImuFlu) *vector = {vector->x(), -vector->y(), -vector->z()};
    for (int i = 0; i < 3; ++i) {
      if (std::abs((*vector)[i]) <= kMaxImportImuValue) continue;  // not for NaN
      ++tally.num_empty;
      return;
    }
  }
  ++tally.num_used;
  log_.Add(time, std::move(item));
}

void RosImport::AddSentence(Utime time, const std::string& topic, std::string sentence, TopicTally& tally) {
  if (!navigator::IsLine(sentence)) {
    ++tally.num_empty;
    return;
  }
  ImportItem item;
  item.kind = ImportItem::Kind::kSentence;
  item.sentence = std::move(sentence);
  item.source = SourceOf(topic);
  log_.Add(time, std::move(item));
}

void RosImport::TakeSentence(const RecordedMessage& message, TimeBasis basis, TopicTally& tally) {
  const bool has_header = message.topic->type == kTypeSentence;
  const auto sentence = ParseSentenceMessage(message.topic->encoding, message.bytes, has_header);
  if (!sentence || sentence->text.size() > kMaxSentenceText) {
    ++tally.num_refused;
    return;
  }
  const auto time_ns = TimeNsOf(message, sentence->header.stamp_ns, has_header ? basis : TimeBasis::kRecorded, tally);
  if (!time_ns) return;
  const auto time = *UtimeOfNs(*time_ns);
  // Some drivers leave the end of the line in it, or put several lines into one message.
  const auto lines = navigator::SplitDatagram({reinterpret_cast<const std::uint8_t*>(sentence->text.data()), sentence->text.size()});
  ++(lines.lines.empty() ? tally.num_empty : tally.num_used);
  tally.num_lines_lost += lines.num_no_start + lines.num_too_long + lines.num_not_printable + lines.num_cut_off;
  for (const auto& line : lines.lines) AddSentence(time, message.topic->name, line, tally);
}

void RosImport::TakeFix(const RecordedMessage& message, TimeBasis basis, TopicTally& tally) {
  const auto fix = ParseNavSatFix(message.topic->encoding, message.bytes);
  if (!fix) {
    ++tally.num_refused;
    return;
  }
  const auto time_ns = TimeNsOf(message, fix->header.stamp_ns, basis, tally);
  if (!time_ns) return;
  const auto time = *UtimeOfNs(*time_ns);
  ++tally.num_used;
  // The accuracy (GST) comes first, as it holds for the fixes behind it.
  if (auto accuracy = GstOf(*fix, time); !accuracy.empty()) AddSentence(time, message.topic->name, std::move(accuracy), tally);
  AddSentence(time, message.topic->name, GgaOf(*fix, time), tally);
}

void RosImport::TakeVelocity(const RecordedMessage& message, TimeBasis basis, TopicTally& tally) {
  const auto twist = ParseTwist(message.topic->encoding, message.bytes, message.topic->type == kTypeTwistWithCovariance);
  if (!twist) {
    ++tally.num_refused;
    return;
  }
  const auto time_ns = TimeNsOf(message, twist->header.stamp_ns, basis, tally);
  if (!time_ns) return;
  const auto time = *UtimeOfNs(*time_ns);
  auto sentence = VtgOf(*twist);
  ++(sentence.empty() ? tally.num_empty : tally.num_used);
  if (!sentence.empty()) AddSentence(time, message.topic->name, std::move(sentence), tally);
}

void RosImport::TakeOxts(const RecordedMessage& message, TopicTally& tally) {
  const auto time = UtimeOfNs(message.time_ns);
  auto items = time ? ParseOxts({reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()}, *time) : std::nullopt;
  if (!items) {
    ++tally.num_refused;
    return;
  }
  ++tally.num_used;
  for (auto& sentence : items->sentences) AddSentence(*time, message.topic->name, std::move(sentence), tally);
  if (!items->imu) return;
  ImportItem item;
  item.kind = ImportItem::Kind::kImu;
  item.source = SourceOf(message.topic->name);
  item.imu = *items->imu;
  log_.Add(*time, std::move(item));
}

}  // namespace lookout::importer
