// What replay reads: captures and lcm-logs, told apart by their first bytes.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/replay/chain.hpp"

namespace lookout::replay {

enum class InputKind { kCapture, kLog };

/// @return by content: what begins as a capture is one, what holds an event of LCM is a log, all else is left to libpcap
/// @throws std::runtime_error when the file cannot be read
InputKind KindOf(const std::filesystem::path& file);

/// Where the chain has to begin for these files: what raw channels the logs hold.
///
/// @throws std::runtime_error when captures and logs are mixed, or logs hold no raw channel
RawInput Inspect(const std::vector<std::filesystem::path>& files);

/// What was read and what was left out.
struct InputSummary {
  std::int64_t num_events = 0;                                // datagrams or raw messages
  std::vector<std::pair<std::string, std::int64_t>> refused;  // reason, count; counts above 0
};

/// Feeds the files, in their order, into the chain. @throws std::runtime_error when one cannot be read
InputSummary Feed(const std::vector<std::filesystem::path>& files, Chain& chain);

}  // namespace lookout::replay
