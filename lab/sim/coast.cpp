#include "lab/sim/coast.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/angles.hpp"
#include "lab/sim/ground.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Land = config::Scene::Land;
using Section = Ground::Section;

constexpr double kUsualDepthM = 40.0;
// Points of a section.
constexpr std::size_t kKnee = 3;
constexpr std::size_t kRim = 4;
constexpr double kWallFootM = -1.0;  // of walls, below the water

bool IsUpright(config::Scene::Edge edge) {
  return edge == config::Scene::FACE || edge == config::Scene::FENDERED || edge == config::Scene::SHEET_PILES;
}

// Ranges from which the sizes of edges are drawn: those common at lakes and harbours.
Stretch DrawStretch(const Land& land, double wall_top_m, double depth_m, Random& random) {
  using config::Scene;
  Stretch stretch;
  stretch.edge = land.edge_size() > 0 ? static_cast<Scene::Edge>(land.edge(DrawIndex(land.edge_size(), random))) : Scene::BANK;
  stretch.cover = land.cover_size() > 0 ? static_cast<Scene::Cover>(land.cover(DrawIndex(land.cover_size(), random))) : Scene::BARE;
  stretch.hill_slope = DrawNumber(land.hill_slope(), 0.0, 0.25, random);
  const auto draw_top = [&](double low_m, double high_m) { return DrawNumber(land.edge_height_m(), low_m, high_m, random); };
  switch (stretch.edge) {
    case Scene::BANK:
      stretch.top_m = draw_top(0.4, 1.5);
      stretch.run_m = stretch.top_m * random.Uniform(0.3, 2.5);
      break;
    case Scene::BEACH: {
      // The steepness is drawn as a run per metre, so that flat beaches are as frequent as steep ones.
      const double run_per_m = random.Uniform(1.0 / (land.slope_size() > 0 ? land.slope(land.slope_size() - 1) : 1.0 / 3.0),
                                              1.0 / (land.slope_size() > 0 ? land.slope(0) : 1.0 / 30.0));
      stretch.top_m = draw_top(0.5, 2.0);
      stretch.run_m = std::min(stretch.top_m * run_per_m, 0.6 * depth_m);
      stretch.top_m = stretch.run_m / run_per_m;
      stretch.hill_slope = std::max(stretch.hill_slope * random.Uniform(), 1.0 / run_per_m * 0.5);
      break;
    }
    case Scene::REEDS:
      stretch.top_m = draw_top(0.2, 0.8);
      stretch.run_m = stretch.top_m * random.Uniform(0.5, 4.0);
      stretch.reach_m = random.Uniform(0.8, 4.0);
      break;
    case Scene::RIPRAP:
      stretch.top_m = draw_top(0.8, 3.0);
      stretch.run_m = stretch.top_m * random.Uniform(1.2, 2.0);
      stretch.reach_m = 1.0;
      break;
    case Scene::CLIFF:
      stretch.top_m = draw_top(2.0, 15.0);
      stretch.run_m = stretch.top_m * random.Uniform(0.05, 0.5);
      stretch.reach_m = 0.3;
      break;
    case Scene::FACE:
    case Scene::FENDERED:
    case Scene::SHEET_PILES:
      stretch.top_m = wall_top_m;
      stretch.run_m = 0.0;
      stretch.hill_slope *= 0.2;
      stretch.reach_m = stretch.edge == Scene::FENDERED ? 0.35 : stretch.edge == Scene::SHEET_PILES ? kSheetPileReachM : 0.0;
      break;
  }
  if (stretch.cover == Scene::WOODS && !IsUpright(stretch.edge)) stretch.reach_m = std::max(stretch.reach_m, 1.5);  // boughs
  if (stretch.cover == Scene::ROCKS) stretch.reach_m = std::max(stretch.reach_m, 1.0);
  return stretch;
}

// One after the other along the line.
std::vector<Stretch> DrawStretches(const Land& land, const std::vector<WaterlineVertex>& vertices, bool is_closed, double depth_m, Random& random) {
  const double wall_top_m = DrawNumber(land.edge_height_m(), 0.5, 4.0, random);
  const std::size_t last = is_closed ? vertices.size() : vertices.size() - 1;  // the vertex after the last of a closed line is the first
  const auto along_m = [&](std::size_t vertex) { return vertices[std::min(vertex, vertices.size() - 1)].along_m; };
  std::vector<Stretch> stretches;
  for (std::size_t first = 0; first < last;) {
    Stretch stretch = DrawStretch(land, wall_top_m, depth_m, random);
    stretch.first = first;
    const double end_m = along_m(first) + DrawNumber(land.stretch_m(), 20.0, 60.0, random);
    while (first < last && along_m(first) < end_m) ++first;
    if (first + 1 >= last) first = last;
    first = std::max(first, stretch.first + 1);
    stretch.last = std::min(first, vertices.size() - 1);
    stretch.length_m = along_m(stretch.last) - along_m(stretch.first);
    stretches.push_back(stretch);
  }
  return stretches;
}

Section DrawSection(const Stretch& stretch, double depth_m, Random& random) {
  const bool is_upright = IsUpright(stretch.edge);
  // Room for the three steps on narrow land.
  const double uneven = is_upright ? 0.0 : stretch.edge == config::Scene::BEACH ? 0.06 : 0.2;
  const double run_m = is_upright ? 0.0 : std::min(stretch.run_m, 0.7 * depth_m) * (1.0 + uneven * random.Uniform(-1.0, 1.0));
  Section section{};
  const double top_m = stretch.top_m * (1.0 + uneven * random.Uniform(-1.0, 1.0)) * (is_upright ? 1.0 : std::min(1.0, run_m / stretch.run_m + 0.2));
  const double under_m = is_upright ? 0.0 : std::min(0.7, run_m);  // the edge goes on below the water, where a trough bares it
  const double top_inland_m = is_upright ? std::min(0.4, 0.5 * depth_m) : run_m;
  const double knee_m = top_inland_m + random.Uniform(0.2, 0.6) * (depth_m - top_inland_m);
  section.inland_m = {-under_m, 0.5 * run_m, top_inland_m, knee_m, depth_m};
  const double bulge = is_upright ? 2.0 : stretch.edge == config::Scene::BEACH ? random.Uniform(0.9, 1.1) : random.Uniform(0.7, 1.3);
  section.height_m = {is_upright ? kWallFootM : -under_m * top_m / run_m, 0.5 * top_m * bulge, top_m, 0.0, 0.0};
  // Hummocks, but for the ground behind a wall.
  for (const std::size_t i : {kKnee, kRim}) {
    const double rise = stretch.hill_slope * (is_upright ? 1.0 : random.Uniform(0.4, 1.6));
    section.height_m[i] = section.height_m[i - 1] + rise * (section.inland_m[i] - section.inland_m[i - 1]);
  }
  return section;
}

// Hills run on behind the border of two stretches.
void SmoothHills(bool is_closed, std::vector<Section>& sections) {
  constexpr int kNumPasses = 6;
  const std::size_t count = sections.size();
  for (int pass = 0; pass < kNumPasses; ++pass) {
    const auto before = sections;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t left = i > 0 ? i - 1 : is_closed ? count - 1 : 0;
      const std::size_t right = i + 1 < count ? i + 1 : is_closed ? 0 : i;
      sections[i].height_m[kRim] = (before[left].height_m[kRim] + before[i].height_m[kRim] + before[right].height_m[kRim]) / 3.0;
      // Hummocks of the knee stay half as high as they are.
      const double around_m = (before[left].height_m[kKnee] + before[right].height_m[kKnee]) / 2.0;
      if (pass < 2) sections[i].height_m[kKnee] = std::lerp(before[i].height_m[kKnee], around_m, 0.5);
    }
  }
}

Vector3d OnGround(const Vector2d& p_m, double z_m) { return {p_m.x(), p_m.y(), z_m}; }

Material MaterialOf(config::Scene::Edge edge) {
  if (IsUpright(edge)) return Material{0.4};
  if (edge == config::Scene::BEACH) return Material{0.5};
  return Material{edge == config::Scene::CLIFF || edge == config::Scene::RIPRAP ? 0.3 : 0.35};
}

// A strip of ground between two sections.
void AddStrip(const Ground& ground, std::size_t from, std::size_t to, const Material& material, std::vector<Part>& parts) {
  const auto point = [&](std::size_t vertex, std::size_t i) {
    const auto& [place_m, inland, along_m, depth_m] = ground.vertices[vertex];
    return OnGround(place_m + ground.sections[vertex].inland_m[i] * inland, ground.sections[vertex].height_m[i]);
  };
  for (std::size_t i = 0; i + 1 < Ground::kNumPoints; ++i) {
    const Vector3d a_m = point(from, i);
    const Vector3d b_m = point(to, i);
    const Vector3d c_m = point(to, i + 1);
    const Vector3d d_m = point(from, i + 1);
    parts.push_back({Triangle{a_m, b_m, c_m}, material});
    parts.push_back({Triangle{a_m, c_m, d_m}, material});
  }
}

// The side of the land at an end of the line: down from its surface.
void AddEndFace(const Ground& ground, std::size_t vertex, const Material& material, std::vector<Part>& parts) {
  const auto& section = ground.sections[vertex];
  const auto point = [&](std::size_t i, double height_m) {
    return OnGround(ground.vertices[vertex].place_m + section.inland_m[i] * ground.vertices[vertex].inland, height_m);
  };
  for (std::size_t i = 0; i + 1 < Ground::kNumPoints; ++i) {
    const Vector3d a_m = point(i, kWallFootM);
    const Vector3d b_m = point(i + 1, kWallFootM);
    const Vector3d c_m = point(i + 1, section.height_m[i + 1]);
    parts.push_back({Triangle{a_m, b_m, c_m}, material});
    parts.push_back({Triangle{a_m, c_m, point(i, section.height_m[i])}, material});
  }
}

Coast MakeLandAlong(std::string_view kind, const Land& land, const Line& line_m, bool is_closed, Random& random) {
  Coast coast{SceneObject{0, "", std::string(kind), Track{}, {}, {}}, line_m};
  Ground ground;
  ground.vertices = WithBays(line_m, is_closed, land, random);
  const auto& vertices = ground.vertices;
  const double depth_m = DrawNumber(land.depth_m(), kUsualDepthM, kUsualDepthM, random);
  const auto stretches = DrawStretches(land, vertices, is_closed, depth_m, random);
  std::vector<std::size_t> stretch_of;
  for (std::size_t i = 0, k = 0; i < vertices.size(); ++i) {
    while (k + 1 < stretches.size() && i >= stretches[k + 1].first) ++k;
    stretch_of.push_back(k);
    ground.sections.push_back(DrawSection(stretches[k], std::min(depth_m, vertices[i].max_depth_m * (is_closed ? 0.85 : 1.0)), random));
  }
  SmoothHills(is_closed, ground.sections);
  auto& parts = coast.object.parts;
  const std::size_t num_strips = is_closed ? vertices.size() : vertices.size() - 1;
  for (std::size_t i = 0; i < num_strips; ++i) AddStrip(ground, i, (i + 1) % vertices.size(), MaterialOf(stretches[stretch_of[i]].edge), parts);
  if (is_closed) {
    // Over the middle.
    Vector3d top_m = Vector3d::Zero();
    for (std::size_t i = 0; i < vertices.size(); ++i) top_m += ground.At(static_cast<double>(i), ground.sections[i].inland_m.back());
    top_m /= static_cast<double>(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t next = (i + 1) % vertices.size();
      parts.push_back({Triangle{ground.At(static_cast<double>(i), ground.sections[i].inland_m.back()),
                                ground.At(static_cast<double>(next), ground.sections[next].inland_m.back()), top_m},
                       MaterialOf(stretches[stretch_of[i]].edge)});
    }
  } else {
    AddEndFace(ground, 0, MaterialOf(stretches.front().edge), parts);
    AddEndFace(ground, vertices.size() - 1, MaterialOf(stretches.back().edge), parts);
  }
  for (const auto& stretch : stretches) {
    AddEdge(stretch, ground, random, parts);
    AddCover(stretch, ground, random, parts);
  }
  auto& outline_m = coast.object.outline_m;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    // Where two stretches meet both count.
    const double reach_m = std::max(stretches[stretch_of[i]].reach_m, stretches[stretch_of[i > 0 ? i - 1 : 0]].reach_m);
    outline_m.emplace_back(vertices[i].place_m - reach_m * vertices[i].inland);
    coast.reach_m.push_back(reach_m);
  }
  coast.num_front = outline_m.size();
  for (std::size_t i = vertices.size(); !is_closed && i-- > 0;) {
    outline_m.emplace_back(vertices[i].place_m + ground.sections[i].inland_m.back() * vertices[i].inland);
  }
  return coast;
}

}  // namespace

Vector3d Ground::At(double vertex, double inland_m) const {
  const auto from = std::min(static_cast<std::size_t>(vertex), vertices.size() - 1);
  const std::size_t to = std::min(from + 1, vertices.size() - 1);
  const double share = vertex - static_cast<double>(from);
  const auto height_m = [&](std::size_t i) {
    const auto& [at_m, heights_m] = sections[i];
    if (inland_m <= at_m.front()) return heights_m.front();
    for (std::size_t k = 0; k + 1 < kNumPoints; ++k) {
      if (inland_m > at_m[k + 1]) continue;
      const double width_m = at_m[k + 1] - at_m[k];
      return width_m > 0.0 ? std::lerp(heights_m[k], heights_m[k + 1], (inland_m - at_m[k]) / width_m) : heights_m[k + 1];
    }
    return heights_m.back();
  };
  const Vector2d a_m = vertices[from].place_m + inland_m * vertices[from].inland;
  const Vector2d b_m = vertices[to].place_m + inland_m * vertices[to].inland;
  return OnGround(a_m + share * (b_m - a_m), std::lerp(height_m(from), height_m(to), share));
}

Vector2d Ground::DirectionAt(double vertex) const {
  const auto from = std::min(static_cast<std::size_t>(vertex), vertices.size() - 2);
  return (vertices[from + 1].place_m - vertices[from].place_m).normalized();
}

Coast MakeCoast(std::string_view kind, const Land& land, double length_m, Random& random) {
  return MakeCoastAlong(kind, land, BentLine(land, length_m, random), random);
}

Coast MakeCoastAlong(std::string_view kind, const Land& land, const Line& line_m, Random& random) {
  return MakeLandAlong(kind, land, line_m, false, random);
}

Coast MakeIslandOf(std::string_view kind, const Land& land, double length_m, double width_m, Random& random) {
  return MakeLandAlong(kind, land, Ring(length_m, width_m), true, random);
}

}  // namespace lookout::sim
