// The texts that the server sends to a browser (PROTOCOL.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"
#include "services/page/core/recordings.hpp"

namespace lookout::page {

struct Hello {
  bool is_log = false;
  std::string version;
  std::string host;
  Utime server_time;
  bool may_acknowledge = false;
};

/// @param sources  JSON text of the array
std::string HelloText(const Hello& hello, std::string_view sources);

/// @param sources  JSON text of the array
std::string SourcesMessage(std::string_view sources);

/// @param share  0 to 1
std::string IndexingText(int source, double share);

/// @param num_frames  that were sent before it
std::string AnswerText(std::uint32_t id, int source, const Answer& answer, std::size_t num_frames);

std::string RefusedText(std::uint32_t id, std::string_view reason);

}  // namespace lookout::page
