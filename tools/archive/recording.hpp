// The kind and state of a file of an archive, and the facts by which files are merged to runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lookout::archive {

/// Head and tail of a raw channel in a log.
struct StreamEnds {
  bool is_there = false;
  bool begins_with_start = false;
  bool ends_with_end = false;
  std::int64_t first_seq = 0;
  std::int64_t last_seq = 0;
};

struct Recording {
  enum class State {
    kSound,
    kDamaged,     // a log with stretches that are no event: its sound events are used
    kForeign,     // no recording
    kOlder,       // a log of other wire types
    kUnreadable,  // no right to read it, or the disk fails
  };

  State state = State::kForeign;
  std::string kind;    // "lcm-log", "capture", "text log", "bag"
  std::string reason;  // why the state is not kSound
  std::string digest;  // over all content that replay reads
  std::optional<std::int64_t> start_us;
  std::optional<std::int64_t> end_us;
  StreamEnds lidar;
  StreamEnds navigator;
  bool can_be_cut = true;             // false: holds a second lidar or LIDAR_BEAMS, with which no cut is exact
  std::vector<std::int64_t> cuts_us;  // log times where all processes began anew: results of replay from there do not depend on earlier data

  bool IsUsed() const { return state == State::kSound || state == State::kDamaged; }
};

/// The word for a state in the index: "sound", "damaged", "foreign", "older", "unreadable".
const char* Word(Recording::State state);
Recording::State StateOfWord(const std::string& word);

/// Reads a file: raw channels, ALERTS and RUN_INFO of a log; all of a capture, text log or bag; of other files the first bytes. Never throws for the
/// content of the file. @throws io::Stopped
Recording LookAt(const std::filesystem::path& file);

/// Start, end, ends of streams and cuts as JSON, and back. @throws std::runtime_error for a text that is not of FactsText
std::string FactsText(const Recording& recording);
void TakeFacts(const std::string& text, Recording& recording);

}  // namespace lookout::archive
