// Fetches the beams of a sensor beside the main loop, which never waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lookout::lidar {

class BeamFetcher {
 public:
  /// @param fetch  asks the sensor, and throws std::runtime_error; is called in a thread of its own: at once, and after each failure again
  /// @param pause  between a failure and the next try
  explicit BeamFetcher(std::function<std::string()> fetch, std::chrono::milliseconds pause = std::chrono::seconds(2));

  /// Waits for the request that runs.
  ~BeamFetcher();

  BeamFetcher(const BeamFetcher&) = delete;
  BeamFetcher& operator=(const BeamFetcher&) = delete;

  /// @return the text that was fetched, once
  std::optional<std::string> Take();

  /// Asks once more, unless that is being done: packets say that the sensor has another mode.
  void AskAgain();

  /// Why the last request failed; empty when it did not, or none has ended.
  std::string fault() const;
  std::int64_t num_failures() const;

 private:
  void Run();

  std::function<std::string()> fetch_;
  std::chrono::milliseconds pause_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool is_asked_ = true;
  bool is_ending_ = false;
  std::optional<std::string> text_;
  std::string fault_;
  std::int64_t num_failures_ = 0;
  std::thread thread_;  // last: it begins when all else is there
};

}  // namespace lookout::lidar
