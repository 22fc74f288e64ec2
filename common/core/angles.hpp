// Angles on the circle, in radians. The only place that wraps them.
#pragma once

#include <cmath>
#include <numbers>

namespace lookout {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

constexpr double DegToRad(double angle_deg) { return angle_deg * (kPi / 180.0); }
constexpr double RadToDeg(double angle_rad) { return angle_rad * (180.0 / kPi); }

/// @return angle_rad + 2 pi n in [0, 2 pi); never 2 pi itself, also for tiny negative angles
inline double WrapTo2Pi(double angle_rad) {
  double wrapped_rad = std::fmod(angle_rad, kTwoPi);
  if (wrapped_rad < 0.0) wrapped_rad += kTwoPi;
  return wrapped_rad < kTwoPi ? wrapped_rad : 0.0;
}

/// @return angle_rad + 2 pi n in [-pi, pi): the short way round
inline double WrapToPi(double angle_rad) { return WrapTo2Pi(angle_rad + kPi) - kPi; }

/// A part of the circle: from `start_rad`, over `width_rad`, half open. A width of 2 pi or more is the whole circle.
struct Sector {
  double start_rad = 0.0;
  double width_rad = kTwoPi;

  bool Contains(double angle_rad) const { return width_rad >= kTwoPi || WrapTo2Pi(angle_rad - start_rad) < width_rad; }
};

}  // namespace lookout
