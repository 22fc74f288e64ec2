// Disjoint sets, for joining what belongs together in any order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lookout::segmenter {

/// The root of a set is its least member, so that it does not depend on the order of the joins.
class UnionFind {
 public:
  UnionFind() = default;
  explicit UnionFind(std::size_t size) { Reset(size); }

  void Reset(std::size_t size) {
    parent_.resize(size);
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::int32_t Find(std::int32_t member) {
    while (parent_[At(member)] != member) {
      parent_[At(member)] = parent_[At(parent_[At(member)])];
      member = parent_[At(member)];
    }
    return member;
  }

  /// @return false when they were of one set already
  bool Join(std::int32_t one, std::int32_t other) {
    one = Find(one);
    other = Find(other);
    if (one == other) return false;
    parent_[At(std::max(one, other))] = std::min(one, other);
    return true;
  }

  std::size_t size() const { return parent_.size(); }

 private:
  static std::size_t At(std::int32_t member) { return static_cast<std::size_t>(member); }

  std::vector<std::int32_t> parent_;
};

}  // namespace lookout::segmenter
