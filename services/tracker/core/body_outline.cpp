// How far a body reaches.
#include <algorithm>
#include <cmath>
#include <limits>

#include "services/tracker/core/body.hpp"
#include "services/tracker/core/body_measured.hpp"

namespace lookout::tracker {

namespace {

constexpr double kBoatLengthPerBeam = 2.7;  // small craft: 2.3 to 3.5
constexpr double kLongestAssumedM = 12.0;
constexpr double kLongestStepS = 0.2;
constexpr double kPartsForS = 3.0;  // after so long the parts seen in that time are all of it
constexpr double kPartForgottenS = 6.0;
constexpr double kGreatestOutlineSizeM = 10.0;

}  // namespace

Directions Body::SideDirections() const {
  Directions directions = CompassDirections();
  for (auto& direction : directions) direction = turned_ * direction;
  return directions;
}

Support Body::SupportFrom(const std::vector<Eigen::Vector2d>& corners_m) const {
  std::vector<Eigen::Vector2d> turned_back = corners_m;
  for (auto& corner : turned_back) corner = turned_.transpose() * corner;
  return SupportOf(turned_back);
}

// From the position to the middle of the outline: a thing turns about its middle.
void Body::Center() {
  const auto directions = SideDirections();
  const Eigen::Vector2d middle = middle_m();
  for (std::size_t i = 0; i < kDirections; ++i) {
    sides_[i].reach_m -= directions[i].dot(middle);
    for (auto& part : others_) part.sides[i].reach_m -= directions[i].dot(middle);
  }
  standing_ += middle;
  moving_.head<2>() += middle;
  centered_m_ += turned_.transpose() * middle;
  for (auto& measured : last_measured_) measured += middle;
}

double Body::size_m() const {
  const auto whole = WholeSides();
  double size_m = 0.0;
  for (std::size_t i = 0; i < kDirections / 2; ++i) size_m = std::max(size_m, whole[i].reach_m + whole[Opposite(i)].reach_m);
  return std::min(size_m, kGreatestOutlineSizeM);
}

// Sides beyond the outline belong to it, too. Where only parts are seen for long, they are all.
void Body::TakePart(const Measured& measured, double dt_s) {
  const auto directions = SideDirections();
  if (parts_s_ == 0.0) parts_reach_m_.fill(-std::numeric_limits<double>::infinity());
  parts_s_ += std::min(dt_s, kLongestStepS);
  const bool is_all = parts_s_ > kPartsForS;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double reach_m = measured.reach_m[i] - directions[i].dot(position_m());
    parts_reach_m_[i] = std::max(parts_reach_m_[i], reach_m);
    const double variance = sides_[i].variance_m2;
    const double gain = variance / (variance + measured.variance_m2[i] + jitter_m2_);
    sides_[i].reach_m += gain * std::max(0.0, reach_m - sides_[i].reach_m);
    if (is_all && measured.kind[i] == Measured::Kind::kEdge) sides_[i].reach_m = std::min(sides_[i].reach_m, parts_reach_m_[i]);
  }
  if (is_all) parts_s_ = 0.0;
}

// The hidden side of a boat under way: its length lies along its course, and its visible width says how long it is.
void Body::AssumeBy(const Measured& measured) {
  const Eigen::Vector2d& sight = measured.sight;
  const Eigen::Vector2d course = velocity_mps().normalized();
  const Eigen::Vector2d across(-sight.y(), sight.x());
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  double nearest = least;
  for (const auto& corner : Outline()) {
    least = std::min(least, across.dot(corner));
    most = std::max(most, across.dot(corner));
    nearest = std::min(nearest, sight.dot(corner));
  }
  const double cosine = std::abs(course.dot(sight));
  const double sine = std::abs(course.dot(across));
  const double length_m = std::min((most - least) / (sine + cosine / kBoatLengthPerBeam), kLongestAssumedM);
  const double depth_m = length_m * (cosine + sine / kBoatLengthPerBeam);
  const Eigen::Vector2d middle = (nearest + 0.5 * depth_m) * sight + 0.5 * (least + most) * across - position_m();
  const Eigen::Vector2d beam(-course.y(), course.x());
  const auto directions = SideDirections();
  for (std::size_t i = 0; i < kDirections; ++i) {
    if (sides_[i].is_seen) continue;
    const double reach = 0.5 * length_m * (std::abs(directions[i].dot(course)) + std::abs(directions[i].dot(beam)) / kBoatLengthPerBeam);
    sides_[i].reach_m = std::max(directions[i].dot(middle) + reach, measured.reach_m[i] - directions[i].dot(position_m()));
  }
}

void Body::Include(const std::vector<Eigen::Vector2d>& outline_m) {
  const auto directions = SideDirections();
  const Support support = SupportFrom(outline_m);
  for (std::size_t i = 0; i < kDirections; ++i) sides_[i].reach_m = std::max(sides_[i].reach_m, support[i] - directions[i].dot(position_m()));
}

std::vector<Eigen::Vector2d> Body::Outline() const {
  const auto whole = WholeSides();
  Support support;
  for (std::size_t i = 0; i < kDirections; ++i) support[i] = whole[i].reach_m;
  auto corners = Polygon(support);
  const Eigen::Vector2d position = position_m();
  for (auto& corner : corners) corner = turned_ * corner + position;
  return corners;
}

Eigen::Isometry2d Body::Frame() const {
  Eigen::Isometry2d frame = Eigen::Isometry2d::Identity();
  frame.linear() = turned_;
  frame.translation() = position_m() - frame.linear() * centered_m_;
  return frame;
}

double Body::SeenShare() const {
  const auto whole = WholeSides();
  return static_cast<double>(std::ranges::count_if(whole, &Side::is_seen)) / static_cast<double>(kDirections);
}

// Of all parts the one that reaches farthest.
Body::Reaches Body::WholeSides() const {
  Reaches whole = sides_;
  for (const auto& part : others_) {
    for (std::size_t i = 0; i < kDirections; ++i) {
      if (part.sides[i].reach_m > whole[i].reach_m) whole[i] = part.sides[i];
    }
  }
  return whole;
}

void Body::ForgetParts(double dt_s) {
  for (auto& part : others_) part.unseen_s += std::min(dt_s, kLongestStepS);
  std::erase_if(others_, [](const Part& part) { return part.unseen_s > kPartForgottenS; });
}

Eigen::Vector2d Body::middle_m() const {
  constexpr std::size_t kNorth = kDirections / 4;
  const auto whole = WholeSides();
  return turned_ *
         Eigen::Vector2d(0.5 * (whole[0].reach_m - whole[Opposite(0)].reach_m), 0.5 * (whole[kNorth].reach_m - whole[Opposite(kNorth)].reach_m));
}

}  // namespace lookout::tracker
