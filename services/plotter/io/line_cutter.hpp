// Cuts a received stream into lines.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "services/plotter/io/port.hpp"

namespace lookout::plotter {

class LineCutter {
 public:
  static constexpr std::size_t kMaxLineBytes = 1024;

  /// Adds the lines that end in `bytes` to the received ones: without CR and LF, either of which ends one; empty ones are none. A line longer than
  /// kMaxLineBytes is refused.
  void Cut(std::string_view bytes, Traffic& traffic) {
    for (const char byte : bytes) {
      if (byte == '\r' || byte == '\n') {
        if (is_too_long_) ++traffic.num_refused;
        if (!is_too_long_ && !line_.empty()) traffic.Add(std::exchange(line_, {}));
        line_.clear();
        is_too_long_ = false;
      } else if (line_.size() < kMaxLineBytes) {
        line_ += byte;
      } else {
        is_too_long_ = true;
      }
    }
  }

 private:
  std::string line_;
  bool is_too_long_ = false;
};

}  // namespace lookout::plotter
