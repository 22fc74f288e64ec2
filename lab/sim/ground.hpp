// The ground behind a waterline, and what stands on it.
#pragma once

#include <array>
#include <vector>

#include "lab/sim/coast_line.hpp"

namespace lookout::sim {

/// A part of the waterline with one edge and one cover.
struct Stretch {
  config::Scene::Edge edge = config::Scene::BANK;
  config::Scene::Cover cover = config::Scene::BARE;
  std::size_t first = 0;  // vertex
  std::size_t last = 0;   // inclusive
  double length_m = 0.0;
  double top_m = 0.0;       // of the edge above the water
  double run_m = 0.0;       // from the waterline to there
  double hill_slope = 0.0;  // of the ground behind the waterline
  double reach_m = 0.0;     // of things in the water before the waterline, or hanging over it
};

/// Heights of the ground at five distances inland from each vertex, straight in between: under water, on the edge, on top of it, and two behind it.
struct Ground {
  static constexpr std::size_t kNumPoints = 5;
  struct Section {
    std::array<double, kNumPoints> inland_m;  // ascending
    std::array<double, kNumPoints> height_m;
  };
  std::vector<WaterlineVertex> vertices;
  std::vector<Section> sections;  // of each

  /// @param vertex  also between two
  Eigen::Vector3d At(double vertex, double inland_m) const;
  double MaxDepthM(double vertex) const { return sections[static_cast<std::size_t>(vertex)].inland_m.back(); }
  /// Along the waterline.
  Eigen::Vector2d DirectionAt(double vertex) const;
};

/// How far folds and fenders of a wall of sheet piles stand out of the waterline.
inline constexpr double kSheetPileReachM = 0.7;

/// Adds what stands in the water before a stretch and on its edge.
void AddEdge(const Stretch& stretch, const Ground& ground, Random& random, std::vector<Part>& parts);

/// Adds what stands on the ground behind it.
void AddCover(const Stretch& stretch, const Ground& ground, Random& random, std::vector<Part>& parts);

}  // namespace lookout::sim
