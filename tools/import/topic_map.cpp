#include "tools/import/topic_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <sstream>
#include <utility>

#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "tools/import/ros_message.hpp"

namespace lookout::importer {

namespace {

struct UseRow {
  Use use;
  std::string_view word;
  std::array<std::string_view, 6> types;  // of messages
};

constexpr std::array kUseRows{
    UseRow{Use::kNone, "none", {}},
    UseRow{Use::kLidarPackets,
           "lidar_packets",
           {kTypeVelodyneScan, kTypePandarScan, kTypeNebulaPackets, kTypesOusterPacket[0], kTypesOusterPacket[1], kTypesOusterPacket[2]}},
    UseRow{Use::kPositionPackets, "position_packets", {kTypesOusterPacket[0], kTypesOusterPacket[1], kTypesOusterPacket[2]}},
    UseRow{Use::kLidarScan, "lidar_scan", {kTypePointCloud, kTypesLivox[0], kTypesLivox[1], kTypePcd, kTypeKittiPoints}},
    UseRow{Use::kImu, "imu", {kTypeImu}},
    UseRow{Use::kImuFlu, "imu_flu", {kTypeImu}},
    UseRow{Use::kSentences, "sentences", {kTypeSentence, kTypeString}},
    UseRow{Use::kFix, "fix", {kTypeNavSatFix}},
    UseRow{Use::kVelocity, "velocity", {kTypeTwist, kTypeTwistWithCovariance}},
    UseRow{Use::kOxts, "oxts", {kTypeOxts}}};

const UseRow& RowOf(Use use) { return *std::ranges::find(kUseRows, use, &UseRow::use); }

bool IsReadable(const Topic& topic) {
  return topic.encoding == Encoding::kRos1 || topic.encoding == Encoding::kCdr || topic.encoding == Encoding::kText;
}

bool Fits(const UseRow& row, const Topic& topic) {
  return row.use == Use::kNone || (IsReadable(topic) && !topic.type.empty() && std::ranges::find(row.types, topic.type) != row.types.end());
}

// By name; of two connections of one name the first.
std::map<std::string, Topic> ByName(const Topics& topics) {
  std::map<std::string, Topic> by_name;
  for (const auto& [number, topic] : topics) {
    const auto [place, is_new] = by_name.try_emplace(topic.name, topic);
    if (!is_new && topic.num_messages > 0) place->second.num_messages = std::max<std::int64_t>(0, place->second.num_messages) + topic.num_messages;
  }
  return by_name;
}

struct WordWeight {
  std::string_view word;
  int weight;
};

int ScoreOf(const std::string& name, std::initializer_list<WordWeight> weights) {
  std::string lower = name;
  for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  int score = 0;
  for (const auto& [word, weight] : weights) score += lower.find(word) == std::string::npos ? 0 : weight;
  return score;
}

// The best of those that fit; of equals the first by name. nullptr: none is good enough.
const Topic* Best(const std::map<std::string, Topic>& topics, Use use, int least_score, std::initializer_list<WordWeight> weights) {
  const Topic* best = nullptr;
  int best_score = least_score - 1;
  for (const auto& [name, topic] : topics) {
    const int score = ScoreOf(name, weights);
    if (topic.num_messages == 0 || !Fits(RowOf(use), topic) || score <= best_score) continue;
    best = &topic;
    best_score = score;
  }
  return best;
}

std::string FolderOf(const std::string& name) { return name.substr(0, name.find_last_of('/') + 1); }

}  // namespace

TopicMap GuessTopics(const Topics& topics) {
  const auto by_name = ByName(topics);
  TopicMap map;
  const auto take = [&map](const Topic* topic, Use use) {
    if (topic != nullptr) map[topic->name].use = use;
    return topic != nullptr;
  };
  if (take(Best(by_name, Use::kLidarPackets, -5, {{"lidar", 2}, {"imu", -9}}), Use::kLidarPackets)) {
    take(Best(by_name, Use::kPositionPackets, 1, {{"imu", 2}, {"lidar_p", -9}}), Use::kPositionPackets);
  } else {
    take(Best(by_name, Use::kLidarScan, 0,
              {{"raw", 2},       {"points", 2},   {"lidar", 2},    {"velodyne", 2}, {"ouster", 2},  {"hesai", 2},   {"rslidar", 2},
               {"pandar", 2},    {"livox", 2},    {"os1", 1},      {"os_", 1},      {"cloud", 1},   {"filter", -3}, {"ground", -3},
               {"obstacle", -5}, {"cluster", -5}, {"segment", -5}, {"map", -5},     {"regist", -5}, {"depth", -6},  {"camera", -6},
               {"stereo", -6},   {"zed", -6},     {"radar", -6},   {"sonar", -6},   {"2/", -1}}),
         Use::kLidarScan);
  }
  take(Best(by_name, Use::kImuFlu, -5,
            {{"imu", 2},
             {"data", 1},
             {"raw", -1},
             {"ouster", -2},
             {"os_", -2},
             {"os1", -2},
             {"livox", -2},
             {"lidar", -2},
             {"camera", -3},
             {"zed", -3}}),
       Use::kImuFlu);
  take(Best(by_name, Use::kOxts, 0, {}), Use::kOxts);
  bool has_sentences = false;
  for (const auto& [name, topic] : by_name) {
    if (topic.type == kTypeSentence && topic.num_messages != 0 && IsReadable(topic)) has_sentences = take(&topic, Use::kSentences);
  }
  if (has_sentences) return map;
  const auto* const fix = Best(by_name, Use::kFix, -5, {{"fix", 2}, {"gps", 1}, {"gnss", 1}, {"rtk", 1}, {"filter", -2}, {"odom", -2}, {"raw", -1}});
  if (!take(fix, Use::kFix)) return map;
  // A velocity of the same receiver: beside its fix, or by its name. A velocity that is a command does not count.
  std::map<std::string, Topic> beside;
  for (const auto& [name, topic] : by_name) {
    const int score = ScoreOf(name, {{"gps", 1}, {"gnss", 1}, {"fix", 1}, {"cmd", -9}, {"command", -9}, {"body", -9}, {"local", -9}, {"set", -9}});
    const bool is_beside = FolderOf(name) == FolderOf(fix->name) && ScoreOf(name, {{"vel", 1}}) > 0;
    if (score > 0 || (score == 0 && is_beside)) beside.emplace(name, topic);
  }
  take(Best(beside, Use::kVelocity, -9, {{"vel", 1}, {"fix", 1}}), Use::kVelocity);
  return map;
}

std::string TopicMapText(const Topics& topics, const TopicMap& map) {
  std::string text;
  for (const auto& [name, topic] : ByName(topics)) {
    const auto found = map.find(name);
    const auto use = found == map.end() ? TopicUse{} : found->second;
    text += Printable(name) + " " + std::string(RowOf(use.use).word);
    if (use.time == TimeBasis::kStamp) text += " time=stamp";
    if (use.time == TimeBasis::kRecorded) text += " time=recorded";
    text += "  # " + (topic.type.empty() ? std::string("of no type") : Printable(topic.type));
    if (topic.num_messages >= 0) text += ", " + std::to_string(topic.num_messages) + " messages";
    if (topic.type == kTypeOdometry) text += "; odometry is not used";
    text += "\n";
  }
  return text;
}

TopicMap ParseTopicMap(const std::string& text, const std::string& name, const Topics& topics) {
  const auto by_name = ByName(topics);
  config::FaultList faults;
  TopicMap map;
  std::istringstream lines(text);
  std::string line;
  std::optional<std::string> lidar;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string topic;
    std::string word;
    if (!(words >> topic)) continue;
    const auto fault = [&](const std::string& reason) { faults.Add(fmt::format("{}:{}: {}", name, number, reason)); };
    const auto found = by_name.find(topic);
    if (found == by_name.end()) {
      fault("the recording has no topic " + topic);
      continue;
    }
    words >> word;
    const auto row = std::ranges::find(kUseRows, std::string_view(word), &UseRow::word);
    if (row == kUseRows.end()) {
      fault(fmt::format("'{}' is no use of a topic: {}", word, UseWords()));
      continue;
    }
    if (!Fits(*row, found->second)) fault(fmt::format("{} is of type {}, which cannot be {}", topic, found->second.type, word));
    TopicUse use{row->use, TimeBasis::kAuto};
    while (words >> word) {
      constexpr std::array<std::pair<std::string_view, TimeBasis>, 3> kTimes{
          {{"time=auto", TimeBasis::kAuto}, {"time=stamp", TimeBasis::kStamp}, {"time=recorded", TimeBasis::kRecorded}}};
      const auto* const time = std::ranges::find(kTimes, std::string_view(word), &std::pair<std::string_view, TimeBasis>::first);
      if (time == kTimes.end()) {
        fault("'" + word + "' is not time=auto, time=stamp or time=recorded");
      } else {
        use.time = time->second;
      }
    }
    if (!map.try_emplace(topic, use).second) fault(topic + " stands in a line before");
    if (use.use != Use::kLidarPackets && use.use != Use::kLidarScan) continue;
    if (lidar) fault("a log holds one lidar, and " + *lidar + " is it");
    lidar = topic;
  }
  faults.ThrowIfAny();
  return map;
}

std::string UseWords() {
  std::string words;
  for (const auto& row : kUseRows) words.append(words.empty() ? "" : ", ").append(row.word);
  return words;
}

}  // namespace lookout::importer
