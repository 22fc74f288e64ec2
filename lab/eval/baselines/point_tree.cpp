#include "lab/eval/baselines/point_tree.hpp"

#include <cmath>
#include <nanoflann.hpp>
#include <utility>

namespace lookout::eval {

struct PointTree::Index {
  // Names that nanoflann asks for.
  struct Cloud {
    std::vector<segmenter::Point> points_m;

    std::size_t kdtree_get_point_count() const { return points_m.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const {
      const auto& point = points_m[index];
      return axis == 0 ? point.x_m : axis == 1 ? point.y_m : point.z_m;
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;  // nanoflann computes the bounding box
    }
  };

  explicit Index(std::vector<segmenter::Point> points_m) : cloud{std::move(points_m)}, tree(3, cloud) {}

  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

  Cloud cloud;
  Tree tree;
  mutable std::vector<std::pair<std::uint32_t, float>> found;  // kept for its memory
};

PointTree::PointTree(std::vector<segmenter::Point> points_m) : index_(std::make_unique<Index>(std::move(points_m))) {}

PointTree::~PointTree() = default;

void PointTree::FindWithin(const segmenter::Point& p_m, double radius_m, std::vector<std::int32_t>& indices) const {
  const float place[3] = {p_m.x_m, p_m.y_m, p_m.z_m};
  nanoflann::SearchParams params;
  params.sorted = false;
  index_->tree.radiusSearch(place, static_cast<float>(radius_m * radius_m), index_->found, params);
  indices.clear();
  for (const auto& [index, squared_m2] : index_->found) indices.push_back(static_cast<std::int32_t>(index));
}

std::optional<PointTree::Neighbour> PointTree::FindNearest(const segmenter::Point& p_m) const {
  const float place[3] = {p_m.x_m, p_m.y_m, p_m.z_m};
  std::uint32_t index = 0;
  float squared_m2 = 0.0F;
  if (index_->cloud.points_m.empty() || index_->tree.knnSearch(place, 1, &index, &squared_m2) == 0) return std::nullopt;
  return Neighbour{static_cast<std::int32_t>(index), std::sqrt(double{squared_m2})};
}

}  // namespace lookout::eval
