#include "tools/import/folder_recording.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "common/core/printable.hpp"
#include "tools/import/box_labels.hpp"
#include "tools/import/file_bytes.hpp"
#include "tools/import/label_map.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/stamps.hpp"

namespace lookout::importer {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kPointsTopic = 0;
constexpr std::uint32_t kOxtsTopic = 1;
constexpr std::array<std::string_view, 2> kTimeFiles{"timestamps.txt", "times.txt"};

bool HasFile(const fs::path& folder, std::string_view extension) {
  std::error_code fault;
  fs::directory_iterator entry(folder, fault);
  for (; !fault && entry != fs::directory_iterator(); entry.increment(fault)) {
    if (entry->path().extension() == extension && entry->is_regular_file(fault)) return true;
  }
  return false;
}

// "x/" and "." have no name: their parent is found all the same.
fs::path PlainFolder(const fs::path& folder) {
  auto plain = fs::absolute(folder).lexically_normal();
  return plain.has_filename() ? plain : plain.parent_path();
}

bool IsBlank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == std::string_view::npos; }

// The first time in a file of one frame's.
std::optional<Stamp> StampInText(const std::string& text) {
  const TimeList list(text);
  return list.Of("", 0, list.size());
}

std::string StemText(const std::string& name) { return fs::path(name).stem().string(); }

}  // namespace

FolderRecording::Layout FolderRecording::LayoutOf(const fs::path& folder) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kPlaces{{{"velodyne_points/data", ".bin"},
                                                                                  {"velodyne", ".bin"},
                                                                                  {"point_clouds", ".pcd"},
                                                                                  {"", ".pcd"},
                                                                                  {"", ".bin"},
                                                                                  {"data", ".pcd"},
                                                                                  {"data", ".bin"}}};
  const auto plain = PlainFolder(folder);
  Layout layout;
  for (const auto& [place, extension] : kPlaces) {
    const auto points = place.empty() ? plain : plain / place;
    if (!HasFile(points, extension)) continue;
    layout.points = points;
    layout.extension = extension;
    break;
  }
  if (HasFile(plain / "oxts" / "data", ".txt")) layout.oxts = plain / "oxts" / "data";
  return layout;
}

bool FolderRecording::IsLayout(const fs::path& folder) {
  const auto layout = LayoutOf(folder);
  return !layout.points.empty() || !layout.oxts.empty();
}

FolderRecording::FolderRecording(const fs::path& folder) : layout_(LayoutOf(folder)) {
  if (layout_.points.empty() && layout_.oxts.empty()) {
    throw std::runtime_error(PrintableLines(folder.string()) + ": is a folder without scans (*.pcd, *.bin of KITTI)");
  }
  if (!layout_.points.empty()) {
    const bool is_pcd = layout_.extension == ".pcd";
    topics_[kPointsTopic] = {"/points", std::string(is_pcd ? kTypePcd : kTypeKittiPoints), Encoding::kRos1, 0};
    AddFrames(layout_.points, layout_.extension, false);
    FindLabels();
  }
  if (!layout_.oxts.empty()) {
    topics_[kOxtsTopic] = {"oxts", std::string(kTypeOxts), Encoding::kText, 0};
    AddFrames(layout_.oxts, ".txt", true);
  }
  // Frames without a time go by their names, behind frames with a time.
  std::ranges::stable_sort(frames_, [](const Frame& one, const Frame& other) {
    if (one.time_ns.has_value() != other.time_ns.has_value()) return one.time_ns.has_value();
    return one.time_ns.value_or(0) < other.time_ns.value_or(0);
  });
  for (auto& [number, topic] : topics_) {
    topic.num_messages = std::ranges::count_if(frames_, [number = number](const Frame& frame) { return frame.is_oxts == (number == kOxtsTopic); });
  }
}

void FolderRecording::AddFrames(const fs::path& folder, std::string_view extension, bool is_oxts) {
  std::vector<Frame> frames;
  std::string first_foreign;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::error_code fault;
    auto name = entry.path().filename().string();
    if (entry.is_directory(fault) || name.starts_with('.')) continue;
    if (entry.path().extension() == extension && !name.ends_with(".pcd.bin") && frames.size() < kMaxFrames) {
      frames.push_back({std::nullopt, is_oxts, std::move(name)});
    } else if (entry.path().extension() != ".label" && std::ranges::find(kTimeFiles, name) == kTimeFiles.end()) {
      ++losses_.num_foreign;
      if (first_foreign.empty() || name < first_foreign) first_foreign = std::move(name);
    }
  }
  if (!first_foreign.empty() && losses_.first_fault.empty()) losses_.first_fault = first_foreign + ": is no file of this recording";
  std::ranges::sort(frames, {}, &Frame::name);
  FindTimes(folder, is_oxts, frames);
  frames_.insert(frames_.end(), std::make_move_iterator(frames.begin()), std::make_move_iterator(frames.end()));
}

void FolderRecording::FindTimes(const fs::path& folder, bool is_oxts, std::vector<Frame>& frames) {
  std::optional<TimeList> list;
  std::string list_name;
  for (const auto& place : {folder, folder.parent_path()}) {
    for (const auto name : kTimeFiles) {
      if (list || !fs::is_regular_file(place / name)) continue;
      list_name = name;
      try {
        list.emplace(ReadFileBytes(place / name));
      } catch (const PointFileError& error) {
        losses_.DamageFile(error.what());
      }
    }
  }
  // SeePerSea: a file of its own for the time of each frame.
  fs::path time_folder;
  for (const std::string_view name : {"timestamp", "timestamps"}) {
    if (!is_oxts && HasFile(folder.parent_path() / name, ".txt")) time_folder = folder.parent_path() / name;
  }
  bool is_undated = false;
  bool is_zoneless = false;
  std::size_t num_without = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto stem = StemText(frames[i].name);
    auto stamp = list ? list->Of(stem, i, frames.size()) : std::nullopt;
    const auto time_file = time_folder / (stem + ".txt");
    if (!stamp && !time_folder.empty() && fs::is_regular_file(time_file)) {
      try {
        stamp = StampInText(ReadFileBytes(time_file));
      } catch (const PointFileError& error) {
        losses_.DamageFile(error.what());
      }
    }
    if (!stamp && !list && time_folder.empty()) stamp = StampOfName(stem);
    num_without += stamp ? 0 : 1;
    if (!stamp) continue;
    frames[i].time_ns = stamp->time_ns;
    is_undated = is_undated || !stamp->is_dated;
    is_zoneless = is_zoneless || stamp->is_zoneless;
  }
  if (list && list->num_bad() > 0) remarks_.push_back(list_name + ": " + std::to_string(list->num_bad()) + " lines are no time");
  if (is_undated) remarks_.emplace_back("the times have no date: they count from 1970-01-01, where the log begins");
  const std::string zoneless = "the times name no zone: they are taken for UTC";
  if (is_zoneless && std::ranges::find(remarks_, zoneless) == remarks_.end()) remarks_.push_back(zoneless);
  if (num_without > 0 && list_name.empty() && time_folder.empty()) {
    remarks_.push_back(std::to_string(num_without) + " files have no time in their name, and beside them is no timestamps.txt or times.txt" +
                       (layout_.extension == ".pcd" ? ": they have that of their first point, where points have a timestamp" : ""));
  }
}

void FolderRecording::FindLabels() {
  const auto beside = layout_.points.parent_path();
  if (HasFile(layout_.points, ".label")) {
    label_folder_ = layout_.points;
    labels_ = Labels::kPoints;
  } else if (HasFile(beside / "labels", ".label")) {
    label_folder_ = beside / "labels";
    labels_ = Labels::kPoints;
  } else if (HasFile(beside / "annotations", ".json")) {
    label_folder_ = beside / "annotations";
    labels_ = Labels::kBoxes;
  }
}

std::string_view FolderRecording::default_labels() const {
  if (labels_ == Labels::kNone) return {};
  return labels_ == Labels::kBoxes ? kBoxLabels : kSemanticKittiLabels;
}

double FolderRecording::share() const { return frames_.empty() ? 1.0 : static_cast<double>(next_) / static_cast<double>(frames_.size()); }

std::optional<RecordedMessage> FolderRecording::Next() {
  while (next_ < frames_.size()) {
    const auto& frame = frames_[next_++];
    try {
      if (Read(frame)) return RecordedMessage{message_time_ns_, &topics_.at(frame.is_oxts ? kOxtsTopic : kPointsTopic), message_};
    } catch (const PointFileError& error) {
      losses_.DamageFile(error.what());
    }
  }
  return std::nullopt;
}

// @return whether there is a message
bool FolderRecording::Read(const Frame& frame) {
  message_.clear();
  if (!frame.time_ns && (frame.is_oxts || layout_.extension != ".pcd")) {
    losses_.BadMessage(frame.name + ": has no time");
    return false;
  }
  if (!frame.is_oxts) {
    ReadPoints(frame);
    return !message_.empty();
  }
  const auto text = ReadFileBytes(layout_.oxts / frame.name);
  message_.assign(text.begin(), text.end());
  message_time_ns_ = *frame.time_ns;
  return true;
}

void FolderRecording::ReadPoints(const Frame& frame) {
  auto made = MessageOf(frame, ReadFileBytes(layout_.points / frame.name));
  message_time_ns_ = made.stamp_ns;
  message_ = std::move(made.bytes);
  if (!made.fault.empty()) losses_.DamageFile(made.fault);
}

PointMessage FolderRecording::MessageOf(const Frame& frame, const std::string& bytes) {
  std::string label_bytes;
  std::optional<std::vector<LabelledBox>> boxes;
  PointLabels labels;
  const auto label_file = label_folder_ / (StemText(frame.name) + (labels_ == Labels::kBoxes ? ".json" : ".label"));
  if (labels_ != Labels::kNone && fs::is_regular_file(label_file)) {
    label_bytes = ReadFileBytes(label_file);
    if (labels_ == Labels::kPoints) {
      labels.of_points = label_bytes;
    } else if (!IsBlank(label_bytes)) {  // of the frames for tests they are empty
      boxes = ParseBoxes(label_bytes);
      if (!boxes) losses_.DamageFile(label_file.filename().string() + ": holds no boxes of 3D-BAT");
      if (boxes) labels.boxes = *boxes;
    }
  }
  return layout_.extension == ".pcd" ? MessageOfPcd(bytes, frame.name, frame.time_ns, labels)
                                     : MessageOfKitti(bytes, frame.name, *frame.time_ns, labels);
}

}  // namespace lookout::importer
