// How far a replay is, for people: one line on standard error that is written over.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>

#include "common/core/utime.hpp"

namespace lookout::replay {

class Progress {
 public:
  /// @param out  nullptr = silent; stays open
  Progress(std::FILE* out, std::int64_t num_bytes) : out_(out), num_bytes_(num_bytes) {}
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// To be called after each event: looks at the clock now and then, and writes twice a second.
  ///
  /// @param num_bytes_done  of the input
  /// @param data_span  of the events so far
  void Update(std::int64_t num_bytes_done, std::chrono::microseconds data_span);

 private:
  std::FILE* out_;
  std::int64_t num_bytes_;
  std::int64_t num_calls_ = 0;
  bool has_line_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_ = start_;
};

}  // namespace lookout::replay
