// Sets that only grow together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lookout::segmenter {

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// The least member of the set of `item`.
  std::int32_t Find(std::int32_t item) {
    while (Parent(item) != item) {
      Parent(item) = Parent(Parent(item));
      item = Parent(item);
    }
    return item;
  }

  void Unite(std::int32_t a, std::int32_t b) {
    a = Find(a);
    b = Find(b);
    if (a < b) Parent(b) = a;
    if (b < a) Parent(a) = b;
  }

 private:
  std::int32_t& Parent(std::int32_t item) { return parent_[static_cast<std::size_t>(item)]; }

  std::vector<std::int32_t> parent_;
};

}  // namespace lookout::segmenter
