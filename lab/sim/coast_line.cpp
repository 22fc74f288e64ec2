#include "lab/sim/coast_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

constexpr double kRoughStepM = 2.5;  // between vertices of a waterline with bays
constexpr double kPlainStepM = 8.0;  // and without
constexpr double kArcStepRad = DegToRad(12.0);
constexpr int kNumBendTries = 20;
constexpr double kMostLengthM = 5000.0;    // a longer line hardly fits into a message of the truth, and its bends take minutes to try
constexpr double kMostBayOfLength = 0.25;  // from one bay to the next: their sides then run at some 60 deg to the shore
constexpr double kLeastDepthM = 1.0;
constexpr double kMostBayOfRadius = 0.35;  // of a closed line, so that the line does not cross itself

Vector2d LeftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

double CrossProduct(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Whether the line comes back to within this distance of a part of it from which it had gone further away.
bool ComesBack(const Line& line_m, double distance_m) {
  for (std::size_t i = 0; i + 1 < line_m.size(); ++i) {
    bool was_far = false;
    for (std::size_t k = i + 1; k < line_m.size(); ++k) {
      const bool is_near = (line_m[k] - line_m[i]).norm() < distance_m;
      if (is_near && was_far) return true;
      was_far = was_far || !is_near;
    }
  }
  for (std::size_t i = 0; i + 1 < line_m.size(); ++i) {
    for (std::size_t k = i + 2; k + 1 < line_m.size(); ++k) {
      const Vector2d ab_m = line_m[i + 1] - line_m[i];
      const Vector2d cd_m = line_m[k + 1] - line_m[k];
      if (CrossProduct(ab_m, line_m[k] - line_m[i]) * CrossProduct(ab_m, line_m[k + 1] - line_m[i]) < 0.0 &&
          CrossProduct(cd_m, line_m[i] - line_m[k]) * CrossProduct(cd_m, line_m[i + 1] - line_m[k]) < 0.0) {
        return true;
      }
    }
  }
  return false;
}

Line TryBentLine(const config::Scene::Land& land, double length_m, Random& random) {
  const int num_bends = static_cast<int>(std::lround(DrawNumber(land.bends(), 0.0, 0.0, random)));
  Vector2d at_m = Vector2d::Zero();
  double heading_rad = 0.0;  // from x, counter-clockwise
  Line line_m{at_m};
  double gone_m = 0.0;
  const auto go = [&](double way_m) {
    at_m += way_m * Vector2d(std::cos(heading_rad), std::sin(heading_rad));
    line_m.push_back(at_m);
  };
  for (int bend = 0; bend < num_bends; ++bend) {
    const double to_m = length_m * (bend + random.Uniform(0.25, 0.75)) / num_bends;
    go(to_m - gone_m);
    gone_m = to_m;
    const double turn_rad = -DegToRad(DrawNumber(land.bend_deg(), -30.0, 30.0, random));
    const double radius_m = DrawNumber(land.bend_radius_m(), 0.0, 0.0, random);
    const int num_steps = radius_m > 0.0 ? std::max(1, static_cast<int>(std::ceil(std::abs(turn_rad) / kArcStepRad))) : 1;
    for (int step = 0; step < num_steps; ++step) {
      heading_rad += turn_rad / num_steps / 2.0;
      if (radius_m > 0.0) go(2.0 * radius_m * std::sin(std::abs(turn_rad) / num_steps / 2.0));
      heading_rad += turn_rad / num_steps / 2.0;
    }
  }
  go(length_m - gone_m);
  return line_m;
}

// Length of the line.
double LengthOf(const Line& line_m) {
  double length_m = 0.0;
  for (std::size_t i = 0; i + 1 < line_m.size(); ++i) length_m += (line_m[i + 1] - line_m[i]).norm();
  return length_m;
}

// Moves and turns it so that its middle is the origin and it runs along x there.
void Centre(Line& line_m) {
  double rest_m = LengthOf(line_m) / 2.0;
  for (std::size_t i = 0; i + 1 < line_m.size(); ++i) {
    const Vector2d edge_m = line_m[i + 1] - line_m[i];
    if (edge_m.norm() < rest_m) {
      rest_m -= edge_m.norm();
      continue;
    }
    const Vector2d along = edge_m.normalized();
    const Vector2d middle_m = line_m[i] + rest_m * along;
    for (auto& p_m : line_m) p_m = {along.dot(p_m - middle_m), CrossProduct(along, p_m - middle_m)};
    return;
  }
}

Line Resampled(const Line& line_m, bool is_closed, double step_m) {
  Line finer_m;
  const std::size_t num_edges = is_closed ? line_m.size() : line_m.size() - 1;
  for (std::size_t i = 0; i < num_edges; ++i) {
    const Vector2d edge_m = line_m[(i + 1) % line_m.size()] - line_m[i];
    const int num_steps = std::max(1, static_cast<int>(std::lround(edge_m.norm() / step_m)));
    for (int step = 0; step < num_steps; ++step) finer_m.emplace_back(line_m[i] + edge_m * (static_cast<double>(step) / num_steps));
  }
  if (!is_closed) finer_m.push_back(line_m.back());
  return finer_m;
}

std::vector<Vector2d> InlandOf(const Line& line_m, bool is_closed) {
  std::vector<Vector2d> inland;
  const std::size_t last = line_m.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const Vector2d& before_m = line_m[i > 0 ? i - 1 : is_closed ? last : 0];
    const Vector2d& after_m = line_m[i < last ? i + 1 : is_closed ? 0 : last];
    // The mean of both edges' directions, so that a corner is halved however long they are.
    const Vector2d in = (line_m[i] - before_m).normalized();
    const Vector2d out = (after_m - line_m[i]).normalized();
    const Vector2d along = in + out;
    inland.push_back(LeftOf(along.norm() > 1e-6 ? along.normalized() : out));
  }
  return inland;
}

// How far inland from a vertex the others of the line are at least 0.8 of that away.
double MaxDepthM(const Line& line_m, const std::vector<Vector2d>& inland, std::size_t of) {
  constexpr double kRest = 1.0 - 0.8 * 0.8;
  double depth_m = 1e3;
  for (const auto& other_m : line_m) {
    const Vector2d from_m = line_m[of] - other_m;
    const double towards_m = from_m.dot(inland[of]);
    const double discriminant = towards_m * towards_m - kRest * from_m.squaredNorm();
    if (towards_m >= 0.0 || discriminant < 0.0) continue;
    depth_m = std::min(depth_m, (-towards_m - std::sqrt(discriminant)) / kRest);
  }
  return depth_m;
}

}  // namespace

double DrawNumber(const google::protobuf::RepeatedField<double>& numbers, double low, double high, Random& random) {
  if (numbers.size() == 1) return numbers[0];
  return numbers.empty() ? random.Uniform(low, high) : random.Uniform(numbers[0], numbers[1]);
}

int DrawIndex(int count, Random& random) { return static_cast<int>(random.Uniform() * count); }

Line BentLine(const config::Scene::Land& land, double length_m, Random& random) {
  constexpr double kLeastWaterM = 8.0;
  Line line_m;
  for (int i = 0; i < kNumBendTries; ++i) {
    line_m = TryBentLine(land, length_m, random);
    if (LengthOf(line_m) > kMostLengthM) throw std::length_error("with its bends it is longer than 5 km");
    if (!ComesBack(Resampled(line_m, false, kPlainStepM), kLeastWaterM)) break;
    line_m = {Vector2d::Zero(), Vector2d(length_m, 0.0)};
  }
  Centre(line_m);
  return line_m;
}

Line Ring(double length_m, double width_m) {
  constexpr int kLeastSteps = 12;
  const int num_steps = std::max(kLeastSteps, static_cast<int>(kPi * (length_m + width_m) / 2.0 / kRoughStepM));
  Line line_m;
  for (int i = 0; i < num_steps; ++i) {
    const double angle_rad = kTwoPi * i / num_steps;
    line_m.emplace_back(length_m / 2.0 * std::cos(angle_rad), width_m / 2.0 * std::sin(angle_rad));
  }
  return line_m;
}

std::vector<WaterlineVertex> WithBays(const Line& line_m, bool is_closed, const config::Scene::Land& land, Random& random) {
  double bay_m = DrawNumber(land.bay_m(), 0.0, 0.0, random);
  const double bay_length_m = DrawNumber(land.bay_length_m(), 30.0, 30.0, random);
  bay_m = std::min(bay_m, kMostBayOfLength * bay_length_m);
  const Line finer_m = is_closed ? line_m : Resampled(line_m, false, bay_m > 0.0 ? kRoughStepM : kPlainStepM);
  const auto inland = InlandOf(finer_m, is_closed);
  // Waves along the line; round a closed one a whole number of them.
  constexpr std::array<double, 3> kWavelength{1.0, 0.43, 0.17};
  constexpr std::array<double, 3> kShare{0.6, 0.28, 0.12};
  std::array<double, 3> phase_rad{};
  for (auto& phase : phase_rad) phase = random.Uniform(0.0, kTwoPi);
  double total_m = LengthOf(finer_m);
  if (is_closed) {
    total_m += (finer_m.front() - finer_m.back()).norm();
    bay_m = std::min(bay_m, kMostBayOfRadius * total_m / kTwoPi);
  }
  std::vector<WaterlineVertex> vertices;
  double along_m = 0.0;
  for (std::size_t i = 0; i < finer_m.size(); ++i) {
    if (i > 0) along_m += (finer_m[i] - finer_m[i - 1]).norm();
    double inland_m = 0.0;
    for (std::size_t k = 0; k < kShare.size(); ++k) {
      double waves = total_m / (bay_length_m * kWavelength[k]);
      if (is_closed) waves = std::max(2.0, std::round(waves));
      inland_m += bay_m * kShare[k] * std::sin(kTwoPi * waves * along_m / total_m + phase_rad[k]);
    }
    // Across the line without its bays, whose sides would run into each other.
    const double depth_m = std::max(MaxDepthM(finer_m, inland, i) - inland_m, kLeastDepthM);
    const double step_m = i > 0 ? (finer_m[i] + inland_m * inland[i] - vertices.back().place_m).norm() : 0.0;
    vertices.push_back({finer_m[i] + inland_m * inland[i], inland[i], (i > 0 ? vertices.back().along_m : 0.0) + step_m, depth_m});
  }
  return vertices;
}

Line Opposite(const Line& line_m, double distance_m) {
  const Line finer_m = Resampled(line_m, false, kPlainStepM);
  const auto inland = InlandOf(finer_m, false);
  Line other_m;
  for (std::size_t i = finer_m.size(); i-- > 0;) {
    const Vector2d p_m = finer_m[i] - distance_m * inland[i];
    // Inside of a bend that is sharper than the distance it would run backwards.
    const bool is_too_near = std::ranges::any_of(finer_m, [&](const Vector2d& q_m) { return (q_m - p_m).norm() < 0.98 * distance_m; });
    if (!is_too_near) other_m.push_back(p_m);
  }
  // Where the rest of such a bend turns back on itself.
  constexpr double kLeastCosine = 0.5;
  for (std::size_t i = 1; i + 1 < other_m.size();) {
    const bool is_kink = (other_m[i] - other_m[i - 1]).normalized().dot((other_m[i + 1] - other_m[i]).normalized()) < kLeastCosine;
    if (is_kink) other_m.erase(other_m.begin() + static_cast<std::ptrdiff_t>(i));
    i = is_kink && i > 1 ? i - 1 : is_kink ? i : i + 1;
  }
  if (other_m.size() < 2) other_m = {finer_m.back() - distance_m * inland.back(), finer_m.front() - distance_m * inland.front()};
  return other_m;
}

}  // namespace lookout::sim
