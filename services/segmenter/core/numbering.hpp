// Components become numbered segments.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/segmenter/core/groups.hpp"

namespace lookout::segmenter {

/// Joins the components of a cluster, leaves out those that are too small, and numbers the rest in the order of their first return.
class Numbering {
 public:
  /// @param cluster_of_component  [components.count] any numbers below components.count; empty: each component is a cluster by itself
  /// @param max_segments          where there are more, the largest are kept; of equals, the first
  /// Allocates nothing once it has seen as many returns and components.
  void Number(const Groups& components, std::span<const std::int32_t> cluster_of_component, int min_points, std::int32_t max_segments);

  const Groups& groups() const { return groups_; }
  /// The cluster that became this group.
  std::int32_t ClusterOf(std::int32_t group) const { return in_order_[static_cast<std::size_t>(group)]; }
  std::int32_t num_too_small() const { return num_too_small_; }
  std::int32_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Cluster {
    std::int32_t num_points = 0;
    std::int32_t number = Groups::kNone;  // in the order of the first return
  };

  Groups groups_;
  std::vector<Cluster> clusters_;
  std::vector<std::int32_t> in_order_;             // clusters that are kept
  std::vector<std::int32_t> number_of_component_;  // scratch
  std::int32_t num_too_small_ = 0;
  std::int32_t num_over_limit_ = 0;
};

}  // namespace lookout::segmenter
