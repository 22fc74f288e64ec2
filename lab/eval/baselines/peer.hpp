// The common parts of all peers: the returns that are looked at, numbers of segments, and the time of each stage.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "services/segmenter/core/paper/breadth_first_search.hpp"
#include "services/segmenter/core/returns.hpp"

namespace lookout::eval {

/// Groups of other sizes are in no segment.
struct SizeLimits {
  int min_returns = 1;
  int max_returns = std::numeric_limits<int>::max();
};

/// Takes the time of one stage after the other.
class StageClock {
 public:
  StageClock() : last_(std::chrono::steady_clock::now()) {}

  void End(std::string stage) {
    const auto now = std::chrono::steady_clock::now();
    stages_.emplace_back(std::move(stage), now - last_);
    last_ = now;
  }

  const std::vector<std::pair<std::string, std::chrono::nanoseconds>>& stages() const { return stages_; }

 private:
  std::chrono::steady_clock::time_point last_;
  std::vector<std::pair<std::string, std::chrono::nanoseconds>> stages_;
};

/// Groups the returns of a whole scan, and ends its stages. @return a group for each return, kNone for those that it leaves out
using Grouping = std::function<segmenter::Groups(const segmenter::Scan&, std::span<const segmenter::Return>, StageClock&)>;

/// A method that is a grouping of the returns.
///
/// Returns out of range, out of the field of view and of the own vessel are left out by the filter of the segmenter, so that all methods see the same
/// returns; in dual return, a return that repeats another return of its shot has the other's label. Segments are numbered in the order of their first
/// return. None of the papers knows a doubt: a size is the choice that they offer (SizeLimits).
class Peer final : public Method {
 public:
  Peer(std::string name, const segmenter::ReturnFilter& filter, SizeLimits limits, Grouping grouping)
      : name_(std::move(name)), filter_(filter), limits_(limits), grouping_(std::move(grouping)) {}

  std::string name() const override { return name_; }
  Labelling Segment(const segmenter::Scan& scan) override;

 private:
  std::string name_;
  segmenter::ReturnFilter filter_;
  SizeLimits limits_;
  Grouping grouping_;
};

}  // namespace lookout::eval
