// Counts by name, that any thread may add to.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace lookout::page {

class Counts {
 public:
  void Add(std::string_view name, std::int64_t number = 1) {
    const std::lock_guard lock(mutex_);
    const auto found = numbers_.find(name);
    if (found != numbers_.end()) {
      found->second += number;
    } else {
      numbers_.emplace(name, number);
    }
  }

  std::int64_t Of(std::string_view name) const {
    const std::lock_guard lock(mutex_);
    const auto found = numbers_.find(name);
    return found == numbers_.end() ? 0 : found->second;
  }

  std::map<std::string, std::int64_t, std::less<>> All() const {
    const std::lock_guard lock(mutex_);
    return numbers_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::int64_t, std::less<>> numbers_;
};

/// Adds 1 to a count of things that are there now, for as long as this object lives.
class Place {
 public:
  Place(std::shared_ptr<Counts> counts, std::string_view name) : counts_(std::move(counts)), name_(name) { counts_->Add(name_); }
  ~Place() {
    if (counts_) counts_->Add(name_, -1);
  }
  Place(Place&&) = default;
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  Place& operator=(Place&&) = delete;

 private:
  std::shared_ptr<Counts> counts_;
  std::string_view name_;  // refers to a constant
};

}  // namespace lookout::page
