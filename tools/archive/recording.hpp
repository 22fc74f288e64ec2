// What a file of an archive is, and what joins it to the other files of its run.
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
    kOlder,       // of other wire types
    kUnreadable,  // no right to read it, or the disk fails
  };

  State state = State::kForeign;
  std::string kind;    // "lcm-log", "capture", "text log", "bag"
  std::string reason;  // of all states but kSound
  std::string digest;  // over all that replay reads of it
  std::optional<std::int64_t> start_us;
  std::optional<std::int64_t> end_us;
  StreamEnds lidar;
  StreamEnds navigator;
  bool can_be_cut = true;             // false: a second lidar or LIDAR_BEAMS, of which no cut is exact
  std::vector<std::int64_t> cuts_us;  // log times where all processes began anew: what replay makes of the rest does not depend on what was before

  bool IsUsed() const { return state == State::kSound || state == State::kDamaged; }
};

/// The word for it in the index: "sound", "damaged", "foreign", "older", "unreadable".
const char* Word(Recording::State state);
Recording::State StateOfWord(const std::string& word);

/// Reads a file: of a log the raw channels, ALERTS and RUN_INFO; all of a capture, text log or bag; else the first bytes. Never throws for what it
/// reads. @throws io::Stopped
Recording LookAt(const std::filesystem::path& file);

/// Start, end, ends of streams and cuts as JSON, and back. @throws std::runtime_error for a text that is not of FactsText
std::string FactsText(const Recording& recording);
void TakeFacts(const std::string& text, Recording& recording);

}  // namespace lookout::archive
