#include "services/lidar/io/beam_fetcher.hpp"

#include <exception>
#include <utility>

namespace lookout::lidar {

BeamFetcher::BeamFetcher(Fetch fetch, std::chrono::milliseconds pause) : fetch_(std::move(fetch)), pause_(pause), thread_([this] { Run(); }) {}

BeamFetcher::~BeamFetcher() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  stop_.request_stop();
  thread_.join();
}

std::optional<std::string> BeamFetcher::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(text_, std::nullopt);
}

void BeamFetcher::AskAgain() {
  {
    const std::lock_guard lock(mutex_);
    is_asked_ = true;
  }
  changed_.notify_all();
}

std::string BeamFetcher::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

std::int64_t BeamFetcher::num_failures() const {
  const std::lock_guard lock(mutex_);
  return num_failures_;
}

void BeamFetcher::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ending_ || is_asked_; });
    if (is_ending_) return;
    is_asked_ = false;
    std::optional<std::string> text;
    std::string fault;
    lock.unlock();
    try {
      text = fetch_(stop_.get_token());
    } catch (const std::exception& error) {
      fault = error.what();
    }
    lock.lock();
    fault_ = fault;
    if (text) {
      text_ = std::move(text);
      continue;
    }
    ++num_failures_;
    is_asked_ = true;
    changed_.wait_for(lock, pause_, [this] { return is_ending_; });
  }
}

}  // namespace lookout::lidar
