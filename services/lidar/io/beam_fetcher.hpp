// Fetches the beams of a sensor beside the main loop, which never waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace lookout::lidar {

class BeamFetcher {
 public:
  /// Asks the sensor; gives up where a stop is asked for. @throws std::runtime_error
  using Fetch = std::function<std::string(std::stop_token)>;

  /// @param fetch  is called in a thread of its own: at once, and after each failure again
  /// @param pause  between a failure and the next try
  explicit BeamFetcher(Fetch fetch, std::chrono::milliseconds pause = std::chrono::seconds(2));

  /// Stops the request that runs.
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

  Fetch fetch_;
  std::stop_source stop_;
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
