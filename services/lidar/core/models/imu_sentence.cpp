#include "services/lidar/core/models/imu_sentence.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "common/core/angles.hpp"
#include "common/core/sentence.hpp"

namespace lookout::lidar {

namespace {

// Never "-0.0000".
double Rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit + 0.0; }

}  // namespace

std::string ImuSentence(const OusterImu& sample, const Eigen::Matrix3d& R_vessel_imu) {
  constexpr double kGravityMps2 = 9.80665;  // standard gravity: the maker states accelerations in multiples of it
  Eigen::Vector3d force_mps2;
  Eigen::Vector3d rate_radps;
  for (int axis = 0; axis < 3; ++axis) {
    force_mps2(axis) = kGravityMps2 * double{sample.acceleration_g.at(static_cast<std::size_t>(axis))};
    rate_radps(axis) = DegToRad(double{sample.rate_degps.at(static_cast<std::size_t>(axis))});
  }
  // Starboard is against port, down against up.
  const Eigen::DiagonalMatrix<double, 3> to_starboard_and_down(1.0, -1.0, -1.0);
  const Eigen::Vector3d force = to_starboard_and_down * (R_vessel_imu * force_mps2);
  const Eigen::Vector3d rate = to_starboard_and_down * (R_vessel_imu * rate_radps);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "VNIMU,0,0,0,%+.4f,%+.4f,%+.4f,%+.6f,%+.6f,%+.6f,0,0", Rounded(force.x(), 1e4), Rounded(force.y(), 1e4),
                Rounded(force.z(), 1e4), Rounded(rate.x(), 1e6), Rounded(rate.y(), 1e6), Rounded(rate.z(), 1e6));
  return WithChecksum(text.data());
}

}  // namespace lookout::lidar
