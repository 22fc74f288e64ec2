// How far a long run is, for people.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>
#include <string>

namespace lookout::eval {

/// Says every few seconds what is being done, what part is done, and about how long the rest takes.
class Progress {
 public:
  /// @param out  nullptr = silent; outlives this
  Progress(std::ostream* out, std::int64_t num_steps);

  /// @param doing  what the step that is done was about
  void Step(const std::string& doing);

 private:
  std::ostream* out_;
  std::int64_t num_steps_;
  std::int64_t num_done_ = 0;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace lookout::eval
