// Probabilities of the closest approach against Monte Carlo runs, and against what then happens.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/encounter.hpp"

namespace lookout::tracker {
namespace {

using Hull = std::vector<Eigen::Vector2d>;

// "states x samples" of the Monte Carlo runs.
struct Size {
  int num_states = 40;
  int num_samples = 40'000;
};
Size SizeOfRun() {
  if (std::getenv("LOOKOUT_ENCOUNTER_SAMPLES") == nullptr) return {};
  return {1000, std::stoi(std::getenv("LOOKOUT_ENCOUNTER_SAMPLES"))};
}

struct Case {
  Moving own;
  Moving other;
  Eigen::Matrix4d own_covariance;  // position, velocity
  Eigen::Matrix4d other_covariance;
  EncounterParams params;
};

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double Uniform(double from, double to) { return from + (to - from) * std::uniform_real_distribution<double>()(random_); }
  double Normal() { return normal_(random_); }
  Eigen::Vector2d Direction() {
    const double angle_rad = Uniform(0.0, kTwoPi);
    return {std::cos(angle_rad), std::sin(angle_rad)};
  }

  // One to twelve corners on an ellipse.
  Hull HullOf(double greatest_length_m) {
    const double length_m = Uniform(0.3, greatest_length_m);
    const double width_m = length_m * Uniform(0.2, 0.8);
    std::vector<double> angles(1 + random_() % 12);
    for (auto& angle_rad : angles) angle_rad = Uniform(0.0, kTwoPi);
    std::sort(angles.begin(), angles.end());
    const Eigen::Vector2d along = Direction();
    Hull hull;
    for (const double angle_rad : angles) {
      hull.emplace_back(0.5 * (length_m * std::cos(angle_rad) * along + width_m * std::sin(angle_rad) * Eigen::Vector2d(-along.y(), along.x())));
    }
    return hull;
  }

  // Neither round nor of independent members.
  Eigen::Matrix4d CovarianceOf(double position_sd_m, double velocity_sd_mps) {
    Eigen::Matrix4d root = Eigen::Matrix4d::Identity();
    for (double& value : root.reshaped()) value += 0.4 * Normal();
    const Eigen::Vector4d scale(position_sd_m, position_sd_m * Uniform(0.4, 1.4), velocity_sd_mps, velocity_sd_mps * Uniform(0.4, 1.4));
    root = scale.asDiagonal() * root;
    return root * root.transpose();
  }

  // Two of ten stand; seven of ten others aim near the own boat.
  Case Encounter() {
    Case drawn;
    drawn.params = {.limit_m = Uniform(0.5, 9.5), .look_ahead_s = Uniform(5.0, 45.0)};
    const Eigen::Vector2d position = 100.0 * Uniform(0.0, 1.0) * Uniform(0.0, 1.0) * Direction();
    drawn.own = {HullOf(8.0), Uniform(0.0, 1.0) < 0.2 ? Eigen::Vector2d(0.0, 0.0) : Eigen::Vector2d(Uniform(0.0, 4.0) * Direction())};
    drawn.other = {HullOf(Uniform(0.0, 1.0) < 0.1 ? 60.0 : 15.0), Eigen::Vector2d::Zero()};
    for (auto& corner : drawn.other.hull_m) corner += position;
    if (Uniform(0.0, 1.0) > 0.2) drawn.other.velocity_mps = Uniform(0.0, 5.0) * Direction();
    if (Uniform(0.0, 1.0) < 0.7) {
      const double time_s = std::max(0.1 + 35.0 * Uniform(0.0, 1.0) * Uniform(0.0, 1.0), position.norm() / 8.0);
      drawn.other.velocity_mps = drawn.own.velocity_mps + (8.0 * Eigen::Vector2d(Normal(), Normal()) - position) / time_s;
    }
    drawn.own_covariance = CovarianceOf(0.05 * std::exp(Uniform(0.0, 1.0)), 0.02 * std::exp(Uniform(0.0, 1.5)));
    drawn.other_covariance = CovarianceOf(0.07 * std::exp(Uniform(0.0, 3.0)), 0.03 * std::exp(Uniform(0.0, 3.0)));
    return drawn;
  }

  // Of position and velocity.
  Eigen::Vector4d Deviation(const Eigen::Matrix4d& root) { return root * Eigen::Vector4d(Normal(), Normal(), Normal(), Normal()); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

// Whether two hulls, each moved by its own deviations, come nearer than the limit. Nothing of the code under test: edges against edges, in the frame
// of the first hull, where the second draws its edges along a line.
class Truth {
 public:
  explicit Truth(const Case& drawn) : case_(drawn) {
    for (const auto& a : drawn.own.hull_m) {
      for (const auto& b : drawn.other.hull_m) differences_.push_back(a - b);
    }
    // Convex hull by gift wrapping.
    std::size_t at = 0;
    for (std::size_t i = 1; i < differences_.size(); ++i) {
      if (differences_[i].x() < differences_[at].x()) at = i;
    }
    const std::size_t first = at;
    do {
      region_.push_back(differences_[at]);
      std::size_t next = at == 0 && differences_.size() > 1 ? 1 : 0;
      for (std::size_t i = 0; i < differences_.size(); ++i) {
        const Eigen::Vector2d a = differences_[next] - differences_[at];
        const Eigen::Vector2d b = differences_[i] - differences_[at];
        const double side = Turn(a, b);
        if (side < 0.0 || (side == 0.0 && b.squaredNorm() > a.squaredNorm())) next = i;
      }
      at = next;
    } while (at != first && region_.size() < differences_.size());
    for (const auto& corner : region_) middle_ += corner / static_cast<double>(region_.size());
    for (const auto& corner : region_) outer_m_ = std::max(outer_m_, (corner - middle_).norm());
  }

  // @param shift  of the other against the own hull, and of its velocity
  bool ComesNearer(const Eigen::Vector4d& shift) const {
    const Eigen::Vector2d from = shift.head<2>();
    const Eigen::Vector2d to = from + case_.params.look_ahead_s * (case_.other.velocity_mps - case_.own.velocity_mps + shift.tail<2>());
    const double limit2 = case_.params.limit_m * case_.params.limit_m;
    const double middle2 = ToSegment2(middle_, from, to);
    if (middle2 <= limit2) return true;
    if (middle2 > (outer_m_ + case_.params.limit_m) * (outer_m_ + case_.params.limit_m)) return false;
    bool is_inside = region_.size() > 2;
    for (std::size_t i = 0; i < region_.size(); ++i) {
      const auto& a = region_[i];
      const auto& b = region_[(i + 1) % region_.size()];
      is_inside = is_inside && Turn(b - a, from - a) >= 0.0;
      if (ToSegment2(a, from, to) <= limit2 || ToSegment2(from, a, b) <= limit2 || ToSegment2(to, a, b) <= limit2) return true;
      if (Turn(b - a, from - a) * Turn(b - a, to - a) < 0.0 && Turn(to - from, a - from) * Turn(to - from, b - from) < 0.0) return true;
    }
    return is_inside;
  }

 private:
  static double Turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
  static double ToSegment2(const Eigen::Vector2d& point, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d along = to - from;
    const double length2 = along.squaredNorm();
    const double share = length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (from + share * along - point).squaredNorm();
  }

  const Case& case_;
  std::vector<Eigen::Vector2d> differences_;
  std::vector<Eigen::Vector2d> region_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double outer_m_ = 0.0;
};

ClosestApproach Stated(const Case& drawn) {
  return ClosestApproachOf(drawn.own, drawn.other, drawn.own_covariance + drawn.other_covariance, drawn.params);
}

TEST(EncounterProbability, IsThatOfAMonteCarloRun) {
  const auto size = SizeOfRun();
  const double greatest_sampling_error = 4.0 * 0.5 / std::sqrt(static_cast<double>(size.num_samples));  // four deviations of a share of one half
  Draw cases(1);
  Draw samples(2);
  int num_doubtful = 0;
  double worst = 0.0;
  double sum = 0.0;
  for (int i = 0; i < size.num_states; ++i) {
    const auto drawn = cases.Encounter();
    const Truth truth(drawn);
    const Eigen::Matrix4d own_root = drawn.own_covariance.llt().matrixL();
    const Eigen::Matrix4d other_root = drawn.other_covariance.llt().matrixL();
    int num_near = 0;
    for (int k = 0; k < size.num_samples; ++k) num_near += truth.ComesNearer(samples.Deviation(other_root) - samples.Deviation(own_root)) ? 1 : 0;
    const double share = static_cast<double>(num_near) / size.num_samples;
    const double stated = Stated(drawn).probability;
    num_doubtful += share > 0.01 && share < 0.99 ? 1 : 0;
    worst = std::max(worst, std::fabs(share - stated));
    sum += std::fabs(share - stated);
    EXPECT_NEAR(stated, share, 0.01 + (size.num_samples < 1'000'000 ? greatest_sampling_error : 0.0)) << "state " << i;
  }
  EXPECT_GT(num_doubtful, size.num_states / 6);
  std::printf("%d states of %d samples, %d in doubt: worst error %.4f, mean %.5f\n", size.num_states, size.num_samples, num_doubtful, worst,
              sum / size.num_states);
}

// 10 000 encounters, each of which comes out as one draw of its covariance.
TEST(EncounterProbability, ComesTrueAsOftenAsItSays) {
  Draw cases(3);
  Draw outcomes(4);
  std::vector<int> num_stated(5, 0);
  std::vector<int> num_true(5, 0);
  for (int i = 0; i < 10'000; ++i) {
    const auto drawn = cases.Encounter();
    const Eigen::Matrix4d own_root = drawn.own_covariance.llt().matrixL();
    const Eigen::Matrix4d other_root = drawn.other_covariance.llt().matrixL();
    const auto bin = std::min<std::size_t>(static_cast<std::size_t>(5.0 * Stated(drawn).probability), 4);
    ++num_stated[bin];
    num_true[bin] += Truth(drawn).ComesNearer(outcomes.Deviation(other_root) - outcomes.Deviation(own_root)) ? 1 : 0;
  }
  for (std::size_t bin = 0; bin < 5; ++bin) {
    const double share = static_cast<double>(num_true[bin]) / num_stated[bin];
    std::printf("stated %.1f to %.1f: %5d encounters, %.3f came true\n", 0.2 * static_cast<double>(bin), 0.2 * static_cast<double>(bin + 1),
                num_stated[bin], share);
    EXPECT_GE(num_stated[bin], 200);
    EXPECT_GE(share, 0.2 * static_cast<double>(bin));
    EXPECT_LE(share, 0.2 * static_cast<double>(bin + 1));
  }
}

// The same as a mirrored, turned and shifted world: nothing depends on the frame.
TEST(EncounterProbability, DoesNotDependOnTheFrame) {
  Draw cases(5);
  for (int i = 0; i < 500; ++i) {
    const auto drawn = cases.Encounter();
    Case turned = drawn;
    const Eigen::Vector2d along = cases.Direction();
    Eigen::Matrix2d rotation;
    rotation << along.x(), -along.y(), along.y(), along.x();
    Eigen::Matrix4d both = Eigen::Matrix4d::Zero();
    both.topLeftCorner<2, 2>() = rotation;
    both.bottomRightCorner<2, 2>() = rotation;
    for (auto* moving : {&turned.own, &turned.other}) {
      for (auto& corner : moving->hull_m) corner = rotation * corner + Eigen::Vector2d(3000.0, -2000.0);
      moving->velocity_mps = rotation * moving->velocity_mps + Eigen::Vector2d(0.5, 1.0);
    }
    turned.own_covariance = both * drawn.own_covariance * both.transpose();
    turned.other_covariance = both * drawn.other_covariance * both.transpose();
    const auto one = Stated(drawn);
    const auto same = Stated(turned);
    EXPECT_NEAR(one.probability, same.probability, 0.01) << i;
    EXPECT_NEAR(one.cpa_m, same.cpa_m, 1e-6) << i;
    EXPECT_NEAR(one.tcpa_s, same.tcpa_s, 1e-6) << i;
  }
}

}  // namespace
}  // namespace lookout::tracker
