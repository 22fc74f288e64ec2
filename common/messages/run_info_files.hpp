// The config that stands in RUN_INFO.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "lookout/run_info_t.hpp"

namespace lookout::messages {

/// @return the text of a file; nullptr where RUN_INFO does not hold it. It stands as long as `info`
inline const std::string* FileTextOf(const run_info_t& info, std::string_view file_name) {
  const auto found = std::ranges::find(info.file_name, file_name);
  const auto index = static_cast<std::size_t>(found - info.file_name.begin());
  return found == info.file_name.end() || index >= info.file_text.size() ? nullptr : &info.file_text[index];
}

}  // namespace lookout::messages
