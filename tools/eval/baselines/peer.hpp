// What all peers share: the returns that are looked at, numbers of segments, and the time of each stage.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "services/segmenter/core/paper/breadth_first_search.hpp"
#include "services/segmenter/core/returns.hpp"
#include "tools/eval/method.hpp"

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

/// A method that groups the returns of a whole turn.
///
/// Returns out of range, out of the field of view and of the own vessel are sorted out by the filter of the segmenter, so that all methods look at
/// the same ones; in dual return, what repeats another return of its shot has the label of that one. Segments are numbered in the order of their
/// first return. None of the papers knows a doubt: a size is the choice that they give (SizeLimits).
class Peer : public Method {
 public:
  Peer(std::string name, const segmenter::ReturnFilter& filter, SizeLimits limits) : name_(std::move(name)), filter_(filter), limits_(limits) {}

  std::string name() const final { return name_; }
  Labelling Segment(const segmenter::Scan& scan) final;

 protected:
  const segmenter::ReturnFilter& filter() const { return filter_; }

  /// @return a group for each return, kNone for those that the method leaves out
  virtual segmenter::Groups GroupReturns(const segmenter::Scan& scan, std::span<const segmenter::Return> returns, StageClock& clock) const = 0;

 private:
  std::string name_;
  segmenter::ReturnFilter filter_;
  SizeLimits limits_;
};

}  // namespace lookout::eval
