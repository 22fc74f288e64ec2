// What stands around the boat, as points on a grid of cubes. Frame: map, an own one of the odometer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/odometer/core/standing.hpp"

namespace lookout::odometer {

/// A set of cubes of space, by whole numbers along each axis. Its order depends on what was added alone.
class CubeIndex {
 public:
  static constexpr std::int32_t kNone = -1;

  void Clear();
  std::int32_t Find(const Eigen::Vector3i& cube) const;
  /// @return the number of the cube, and whether it is new: numbers count up from 0
  std::pair<std::int32_t, bool> Insert(const Eigen::Vector3i& cube);
  std::size_t size() const { return size_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int32_t number = kNone;
  };
  void Grow();

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

/// Cube of a point; cubes are `side_m` wide.
Eigen::Vector3i CubeOf(const Eigen::Vector3d& p_m, double side_m);

/// The first point of each cube, in their order.
std::vector<std::size_t> FirstOfEachCube(const std::vector<Eigen::Vector3d>& points_m, double side_m);

/// A return with its surroundings, map frame.
struct MapPoint {
  Eigen::Vector3d p_m;
  Eigen::Vector3d normal;
  Shape shape;
  double normal_sd_rad = 0.0;  // about the vertical
};

/// How a return is compared with the map where it lies.
struct Match {
  Eigen::Vector3d p_map_m;  // nearest point of the map
  Eigen::Matrix3d weight;   // of the difference along each direction: 1 across a surface, 0 along it, little in foliage
  Eigen::Vector3d along;    // level, along a surface; its length is the standard deviation of the normal (rad)
};

class LocalMap {
 public:
  static constexpr double kSideM = 1.0;
  static constexpr std::size_t kMaxPointsPerCube = 16;
  static constexpr double kMinSpacingM = 0.25;

  void Clear();
  void Add(const MapPoint& point);
  /// Cubes farther than this from `center_m` are forgotten.
  void Forget(const Eigen::Vector3d& center_m, double radius_m);

  /// @param radius_m at most 6 m
  /// @return nullopt where no point of the map that looks alike lies within `radius_m`
  std::optional<Match> Nearest(const MapPoint& point, double radius_m) const;

 private:
  struct Kept {
    Eigen::Vector3f p_m;
    Eigen::Vector3f normal;
    Shape shape = Shape::kRough;
    float normal_sd_rad = 0.0F;
  };
  struct Cube {
    Eigen::Vector3i place;
    std::array<Kept, kMaxPointsPerCube> points;
    std::size_t num_points = 0;
  };

  CubeIndex index_;
  std::vector<Cube> cubes_;
};

}  // namespace lookout::odometer
