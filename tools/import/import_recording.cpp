#include "tools/import/import_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/run_info.hpp"
#include "services/lidar/params.hpp"
#include "tools/import/log_maker.hpp"
#include "tools/import/ros_import.hpp"
#include "tools/import/truth_files.hpp"

namespace lookout::importer {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<Recording> OpenKnown(const fs::path& file) {
  auto recording = OpenRecording(file);
  if (!recording) throw std::runtime_error(file.string() + ": is no ROS bag, recording of rosbag2, MCAP file or folder of scans");
  return recording;
}

// Reads all of it, to know its topics.
Topics CountTopics(Recording& recording) {
  std::map<const Topic*, std::int64_t> counts;
  while (const auto message = recording.Next()) {
    io::ThrowIfStopAsked();
    ++counts[message->topic];
  }
  auto topics = recording.topics();
  for (auto& [number, topic] : topics) topic.num_messages = counts[&recording.topics().at(number)];
  return topics;
}

// Reads the files one after the other, and keeps what was lost of them.
class RecordingReader {
 public:
  RecordingReader(const std::vector<fs::path>& files, std::ostream& notes)
      : files_(files), notes_(notes), progress_("lookout-import", runtime::OnlyTerminal(stderr)) {}

  template <typename Take>
  bool ForEach(const Take& take) {
    bool is_whole = true;
    for (std::size_t i = 0; i < files_.size(); ++i) {
      const auto recording = OpenKnown(files_[i]);
      while (const auto message = recording->Next()) {
        io::ThrowIfStopAsked();
        take(*message);
        progress_.Update((static_cast<double>(i) + recording->share()) / static_cast<double>(files_.size()));
      }
      progress_.Clear();
      is_whole = Tell(files_[i], recording->losses()) && is_whole;
    }
    return is_whole;
  }

 private:
  // @return whether nothing was lost
  bool Tell(const fs::path& file, const Losses& losses) {
    if (!losses.IsAny()) return true;
    auto text = PrintableLines(file.string()) + ": damaged:";
    const auto add = [&text](std::int64_t count, std::string_view what) {
      if (count > 0) text += fmt::format(" {} {};", count, what);
    };
    add(losses.num_damaged, "damaged places");
    add(losses.num_bytes_skipped, "bytes skipped");
    add(losses.num_bad_messages, "messages of no known topic or time");
    add(losses.num_foreign, "files that are not of it");
    if (losses.is_cut) text += " it ends before its end;";
    if (!losses.first_fault.empty()) text += " the first: " + PrintableLines(losses.first_fault);
    notes_ << "lookout-import: " << text << '\n';
    return false;
  }

  const std::vector<fs::path>& files_;
  std::ostream& notes_;
  runtime::Progress progress_;
};

// Messages of LCM as lookout-export has put them into an MCAP file: the log again.
bool CopyLcm(const RecordingRequest& request, log::LogOutput& output, std::ostream& notes) {
  std::int64_t num_written = 0;
  std::int64_t num_other = 0;
  std::int64_t num_bad_name = 0;
  const bool is_whole = RecordingReader(request.files, notes).ForEach([&](const RecordedMessage& message) {
    const bool is_lcm = message.topic->encoding == Encoding::kLcm;
    const bool has_name = !message.topic->name.empty() && message.topic->name.size() <= bus::kMaxLogChannelBytes;
    num_other += is_lcm ? 0 : 1;
    num_bad_name += is_lcm && !has_name ? 1 : 0;
    if (!is_lcm || !has_name) return;
    ++num_written;
    output.Write(Utime(std::chrono::microseconds(message.time_ns / 1000)), message.topic->name, message.bytes);
  });
  if (num_other > 0) notes << fmt::format("lookout-import: {} messages of other encodings are not used beside those of LCM\n", num_other);
  if (num_bad_name > 0) notes << fmt::format("lookout-import: {} messages of LCM are lost: the names of their channels are too long\n", num_bad_name);
  if (num_written == 0) throw std::runtime_error(request.files.front().string() + ": holds no message of LCM that can be read");
  return is_whole && num_bad_name == 0;
}

bool HasLcm(const Topics& topics) {
  return std::ranges::any_of(topics, [](const auto& topic) { return topic.second.encoding == Encoding::kLcm && topic.second.num_messages != 0; });
}

// Whether the index does not say if there are messages that decide how the file is read.
bool IsLcmUncounted(const Topics& topics) {
  return std::ranges::any_of(topics, [](const auto& topic) { return topic.second.encoding == Encoding::kLcm && topic.second.num_messages < 0; });
}

bool IsUsed(const TopicMap& map, std::initializer_list<Use> uses) {
  return std::ranges::any_of(map, [&](const auto& topic) { return std::ranges::find(uses, topic.second.use) != uses.end(); });
}

// @return nullptr where none is wanted
std::unique_ptr<TruthFiles> OpenTruth(const RecordingRequest& request, std::ostream& notes) {
  if (!request.truth_folder) return nullptr;
  std::string text;
  for (const auto& file : request.files) {
    if (text.empty()) text = OpenKnown(file)->default_labels();
  }
  std::string name = "labels";
  if (request.label_map_file) {
    name = request.label_map_file->string();
    text = config::ReadConfigFile(*request.label_map_file);
  } else if (text.empty()) {
    throw std::runtime_error("--truth: what the labels mean is not known here: give a file with their meaning as --labels");
  } else {
    notes << "lookout-import: what labels mean; to change it, keep these lines in a file, edit it and give it as --labels\n" << text;
  }
  return std::make_unique<TruthFiles>(*request.truth_folder, ParseLabelMap(text, name), request.force);
}

void FinishTruth(const RecordingRequest& request, TruthFiles& truth, std::ostream& notes) {
  if (truth.num_scans() == 0) throw std::runtime_error(request.files.front().string() + ": no scan has labels for --truth");
  truth.Finish();
  notes << fmt::format("lookout-import: truth: {} scans, {} objects", truth.num_scans(), truth.num_objects());
  if (truth.num_unknown() > 0) notes << fmt::format(", {} returns of classes whose meaning is not given, taken for none", truth.num_unknown());
  notes << '\n';
}

std::string FileNames(const std::vector<fs::path>& files) {
  std::string text;
  for (const auto& file : files) {
    const auto plain = fs::absolute(file).lexically_normal();  // also gives the name of a folder "x/" or "."
    text += "imported from " + PrintableLines((plain.has_filename() ? plain : plain.parent_path()).filename().string()) + "\n";
  }
  return text;
}

std::string TallyText(const std::string& topic, const TopicTally& tally) {
  auto text = fmt::format("{}: {} messages used", Printable(topic), tally.num_used);
  if (tally.num_refused > 0) text += fmt::format(", {} refused: not of their type, too long, or of no time", tally.num_refused);
  if (tally.num_empty > 0) text += fmt::format(", {} without what is looked for", tally.num_empty);
  if (tally.num_lines_lost > 0) text += fmt::format(", {} lines lost: without a start, too long, not printable, or cut off", tally.num_lines_lost);
  if (tally.num_other_time > 0) text += fmt::format(", {} by the time of recording: their stamps are more than 10 s off", tally.num_other_time);
  return text;
}

// Lines about the import, for the log and for people.
std::vector<std::string> ResultLines(const RosImport& import, const LogMaker& log) {
  std::vector<std::string> lines;
  for (const auto& [topic, tally] : import.tallies()) lines.push_back(TallyText(topic, tally));
  const auto& counts = import.clouds().counts();
  if (counts.num_points > 0) {
    lines.push_back(
        fmt::format("points: {}, of them {} without a return, {} out of range, {} hidden by a nearer one of their cell, {} of no known ring",
                    counts.num_points, counts.num_empty, counts.num_out_of_range, counts.num_hidden, counts.num_no_ring));
    if (counts.num_no_time > 0)
      lines.push_back(fmt::format("points: {} without a time of their own, which have that of the point before", counts.num_no_time));
  }
  for (const auto& remark : import.clouds().Remarks()) lines.push_back(remark);
  for (const auto& counter : log.counters()) {
    if (counter.count > 0) lines.push_back(fmt::format("{}: {}", counter.name, counter.count));
  }
  if (log.num_late() > 0) lines.push_back(fmt::format("{} items came more than {} s late", log.num_late(), LogMaker::kWait.count()));
  return lines;
}

}  // namespace

Topics TopicsOf(const std::vector<fs::path>& files) {
  Topics topics;
  for (const auto& file : files) {
    const auto recording = OpenKnown(file);
    auto of_file = recording->IndexedTopics();
    if (of_file.empty() || IsLcmUncounted(of_file)) of_file = CountTopics(*recording);
    for (auto& [number, topic] : of_file) topics.emplace(static_cast<std::uint32_t>(topics.size()), std::move(topic));
  }
  return topics;
}

bool ImportRecording(const RecordingRequest& request, log::LogOutput& output, std::ostream& notes) {
  const auto topics = TopicsOf(request.files);
  if (HasLcm(topics)) return CopyLcm(request, output, notes);
  const auto map = request.topic_map_file ? ParseTopicMap(config::ReadConfigFile(*request.topic_map_file), request.topic_map_file->string(), topics)
                                          : GuessTopics(topics);
  const auto map_text = TopicMapText(topics, map);
  notes << (request.topic_map_file ? "" : "lookout-import: guessed; to change it, keep these lines in a file, edit it and give it as --topics\n")
        << map_text;
  auto truth = OpenTruth(request, notes);
  const auto params = lidar::LoadParams(request.config_folder);
  auto run_info = runtime::MakeRunInfo("import", request.config_folder);
  run_info.file_name.emplace_back("lookout-import");
  run_info.file_text.push_back(FileNames(request.files) + map_text);
  run_info.num_files = static_cast<std::int32_t>(run_info.file_name.size());
  const auto write_run_info = [&](Utime time) {
    run_info.utime_us = ToUtimeUs(time);
    output.Write(time, bus::kRunInfo.name, bus::Encode(run_info));
    ++run_info.seq;
  };
  std::optional<Utime> last;
  const bool has_navigation = IsUsed(map, {Use::kImu, Use::kImuFlu, Use::kSentences, Use::kFix, Use::kVelocity, Use::kOxts});
  LogMaker log(params, has_navigation, [&](Utime time, const bus::Channel& channel, Bytes bytes) {
    if (!last) write_run_info(time);
    last = time;
    output.Write(time, channel.name, bytes);
  });
  RosImport import(map, log, truth.get());
  for (const auto& file : request.files) import.Learn(*OpenKnown(file));
  const bool is_whole = RecordingReader(request.files, notes).ForEach([&](const RecordedMessage& message) { import.Take(message); });
  log.Finish();
  auto lines = ResultLines(import, log);
  for (const auto& file : request.files) {
    for (auto& remark : OpenKnown(file)->remarks()) lines.push_back(std::move(remark));
  }
  for (const auto& line : lines) notes << "lookout-import: " << line << '\n';
  if (truth && last) FinishTruth(request, *truth, notes);
  if (!last) {
    const auto kind = OpenKnown(request.files.front())->kind();
    throw std::runtime_error(request.files.front().string() + ": is a " + kind + " that holds nothing that is imported");
  }
  // RUN_INFO once more at the end, with the results of the import.
  for (const auto& line : lines) run_info.file_text.back() += line + "\n";
  write_run_info(*last);
  return is_whole && std::ranges::none_of(import.tallies(), [](const auto& tally) { return tally.second.num_refused > 0; });
}

}  // namespace lookout::importer
