// A k-d tree over points, so that neighbours are found fast.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "services/segmenter/core/returns.hpp"

namespace lookout::eval {

/// The tree itself is nanoflann's (README.md says why). Single precision, as the points are.
class PointTree {
 public:
  explicit PointTree(std::vector<segmenter::Point> points_m);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// Indices of all points nearer to p than the radius, p itself among them if it is one, in no particular order.
  void FindWithin(const segmenter::Point& p_m, double radius_m, std::vector<std::int32_t>& indices) const;

  struct Neighbour {
    std::int32_t index = 0;
    double distance_m = 0.0;
  };
  /// @return nullopt for a tree without points
  std::optional<Neighbour> FindNearest(const segmenter::Point& p_m) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace lookout::eval
