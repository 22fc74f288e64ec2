#include "services/tracker/core/surface_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

constexpr std::size_t kMostPoints = 64;
// The longer the time between two looks, the less their errors count; a boat that turns by 20 deg/s or changes its speed needs it short.
constexpr double kLongestS = 1.05;
constexpr double kShortestS = 0.35;
constexpr double kLeastStepS = 0.08;  // between two looks that are kept
// Roughness of a hull and range of a return. A part that is met now may be met beside it next.
constexpr double kPointSdM = 0.1;
constexpr double kLoneSdM = 0.4;
// Points nearer than kBesideM tell how the surface lies; of a surface that is seen coarsely the nearest ones, up to kLoneM. Along a wall a
// counterpart lies anywhere, also at its end, which is mostly where the visible part ends. A smaller thing, as a person or a post, is met somewhere
// in itself.
constexpr double kBesideM = 0.8;
constexpr double kLoneM = 3.0;
constexpr std::size_t kLeastBeside = 4;
constexpr double kWallSdM = 0.17;
constexpr double kAlongWallM2 = 1e3;
constexpr double kAlongTimes = 100.0;
// What is farther off has no counterpart.
constexpr double kMostOff2 = 9.0;
constexpr double kFarthestM = 1.0;
constexpr double kLeastShare = 0.6;
constexpr double kGoodShare = 0.8;
// Errors of neighbouring returns are alike: so many count as independent of each other. All share the errors of roll and pitch.
constexpr double kNumIndependent = 8.0;
constexpr double kCommonSdM = 0.08;

// By the spread of the points beside it.
Eigen::Matrix2d WeightOf(const Eigen::Matrix2d& spread_m2) {
  const double mean_m2 = 0.5 * spread_m2.trace();
  const double half_m2 = 0.5 * (spread_m2(0, 0) - spread_m2(1, 1));
  const double cross_m2 = spread_m2(0, 1);
  const double root_m2 = Hypot(half_m2, cross_m2);
  Eigen::Matrix2d along = Eigen::Matrix2d::Zero();  // twice the projection onto the longer axis, less 1
  if (root_m2 > 0.0) along << half_m2 / root_m2, cross_m2 / root_m2, cross_m2 / root_m2, -half_m2 / root_m2;
  const double across_m2 = kPointSdM * kPointSdM + std::max(0.0, mean_m2 - root_m2);
  const double longer_m2 = mean_m2 + root_m2;
  const double along_m2 = longer_m2 > kWallSdM * kWallSdM ? kAlongWallM2 : kPointSdM * kPointSdM + kAlongTimes * longer_m2;
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  return 0.5 * (one - along) / across_m2 + 0.5 * (one + along) / along_m2;
}

struct Mean {
  Eigen::Vector3d sum_m;
  double count;

  Eigen::Vector3d place_m() const { return sum_m / count; }
};

// The means of the returns by cells, of cells so large that kMostPoints are left at the most. They depend neither on the order of the returns nor on
// the side from which they are counted.
std::vector<Mean> Thinned(std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m) {
  constexpr double kLeastCellM = 0.1;
  constexpr double kLarger = 1.4;
  std::vector<Mean> means;
  means.reserve(places_m.size());
  for (std::size_t i = 0; i < places_m.size(); ++i) means.push_back({{places_m[i].x(), places_m[i].y(), heights_m[i]}, 1.0});
  for (double cell_m = kLeastCellM; means.size() > kMostPoints; cell_m *= kLarger) {
    std::map<std::array<std::int64_t, 3>, Mean> cells;
    for (const auto& mean : means) {
      const Eigen::Vector3d place_m = mean.place_m();
      const auto at = [&](int axis) { return static_cast<std::int64_t>(std::floor(place_m[axis] / cell_m)); };
      auto& cell = cells.try_emplace({at(0), at(1), at(2)}, Mean{Eigen::Vector3d::Zero(), 0.0}).first->second;
      cell.sum_m += mean.sum_m;
      cell.count += mean.count;
    }
    means.clear();
    for (const auto& [at, mean] : cells) means.push_back(mean);
  }
  return means;
}

}  // namespace

struct SurfaceMotion::Match {
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  double cost = std::numeric_limits<double>::infinity();
  double off2 = 0.0;  // sum over the points found again
  std::size_t num_found = 0;
  std::size_t num_points = 0;

  bool IsFound(double share) const {
    return num_found >= kLeastReturns / 2 && static_cast<double>(num_found) >= share * static_cast<double>(num_points);
  }
};

SurfaceMotion::Look SurfaceMotion::LookOf(Utime time, std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m) {
  Look look{time, {}};
  for (const auto& mean : Thinned(places_m, heights_m)) {
    look.points.push_back({mean.place_m(), Eigen::Matrix2d::Identity() / (kLoneSdM * kLoneSdM)});
  }
  const std::size_t num = look.points.size();
  if (num < kLeastBeside) return look;
  std::vector<Eigen::Vector3d> off_m(num);
  for (auto& point : look.points) {
    for (std::size_t k = 0; k < num; ++k) off_m[k] = look.points[k].place_m - point.place_m;
    std::ranges::nth_element(off_m, off_m.begin() + (kLeastBeside - 1), {}, [](const Eigen::Vector3d& off) { return off.squaredNorm(); });
    const double nearest_m2 = off_m[kLeastBeside - 1].squaredNorm();
    if (nearest_m2 > kLoneM * kLoneM) continue;
    const double beside_m2 = std::max(kBesideM * kBesideM, nearest_m2);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d sum2 = Eigen::Matrix2d::Zero();
    double count = 0.0;
    for (const auto& other : look.points) {
      const Eigen::Vector3d off = other.place_m - point.place_m;
      if (off.squaredNorm() > beside_m2) continue;
      sum += off.head<2>();
      sum2 += off.head<2>() * off.head<2>().transpose();
      count += 1.0;
    }
    const Eigen::Vector2d mean = sum / count;
    point.weight = WeightOf(sum2 / count - mean * mean.transpose());
  }
  return look;
}

SurfaceMotion::Match SurfaceMotion::MatchFrom(const Look& before, const Look& now, const Eigen::Vector2d& start_m) {
  constexpr int kMostSteps = 8;
  constexpr double kArrivedM2 = 1e-6;
  constexpr double kDamping = 1e-3;  // of the information: no step along a plain wall
  Match match;
  match.shift_m = start_m;
  match.num_points = now.points.size();
  for (int step = 0; step < kMostSteps; ++step) {
    match.information.setZero();
    match.cost = match.off2 = 0.0;
    match.num_found = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const auto& point : now.points) {
      const Eigen::Vector3d place_m = point.place_m - Eigen::Vector3d(match.shift_m.x(), match.shift_m.y(), 0.0);
      double least_m2 = kFarthestM * kFarthestM;
      const Point* nearest = nullptr;
      for (const auto& other : before.points) {
        const double m2 = (other.place_m - place_m).squaredNorm();
        if (m2 >= least_m2) continue;
        least_m2 = m2;
        nearest = &other;
      }
      const Eigen::Vector2d off_m = nearest == nullptr ? Eigen::Vector2d::Zero() : Eigen::Vector2d((place_m - nearest->place_m).head<2>());
      const double off2 = nearest == nullptr ? kMostOff2 : off_m.dot(nearest->weight * off_m);
      match.cost += std::min(off2, kMostOff2);
      if (off2 >= kMostOff2) continue;
      match.information += nearest->weight;
      sum += nearest->weight * off_m;
      match.off2 += off2;
      ++match.num_found;
    }
    if (match.num_found < kLeastReturns / 2) break;
    const Eigen::Matrix2d damped = match.information + kDamping * match.information.trace() * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d change_m = damped.inverse() * sum;
    match.shift_m += change_m;
    if (change_m.squaredNorm() < kArrivedM2) break;
  }
  return match;
}

// The first of equals.
SurfaceMotion::Match SurfaceMotion::BestOf(const Look& before, const Look& now, std::span<const Eigen::Vector2d> velocities_mps) {
  constexpr double kSameMps = 0.1;
  const double over_s = ToSeconds(now.time - before.time);
  Match best;
  for (std::size_t i = 0; i < velocities_mps.size(); ++i) {
    const auto is_same = [&](const Eigen::Vector2d& other_mps) { return (other_mps - velocities_mps[i]).norm() < kSameMps; };
    if (std::ranges::any_of(velocities_mps.first(i), is_same)) continue;
    auto match = MatchFrom(before, now, velocities_mps[i] * over_s);
    if (match.cost < best.cost) best = match;
  }
  return best;
}

SurfaceMotion::Match SurfaceMotion::MatchWith(const Look& before, const Look& now, const std::optional<Eigen::Vector2d>& velocity_mps) const {
  const std::array<Eigen::Vector2d, 3> all_mps{Eigen::Vector2d(0.0, 0.0), velocity_mps.value_or(Eigen::Vector2d(0.0, 0.0)), last_mps_};
  const auto velocities_mps = std::span(all_mps).first(velocity_mps ? 3 : 1);
  auto best = BestOf(before, now, velocities_mps);
  if (best.IsFound(kGoodShare)) return best;
  // What moves fast is found by way of the last look, since which it has not gone far.
  const auto& last = looks_.back();
  const auto lately = BestOf(last, now, velocities_mps.first(velocity_mps ? 2 : 1));
  const std::array<Eigen::Vector2d, 1> lately_mps{Eigen::Vector2d(lately.shift_m / ToSeconds(now.time - last.time))};
  auto other = BestOf(before, now, lately_mps);
  return other.cost < best.cost ? other : best;
}

std::optional<SurfaceShift> SurfaceMotion::Update(Utime time, std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m,
                                                  const std::optional<Eigen::Vector2d>& velocity_mps) {
  while (!looks_.empty() && (time <= looks_.back().time || ToSeconds(time - looks_.front().time) > kLongestS)) looks_.pop_front();
  if (looks_.empty()) Clear();
  if (places_m.size() < kLeastReturns || heights_m.size() != places_m.size()) return std::nullopt;
  auto now = LookOf(time, places_m, heights_m);
  std::optional<SurfaceShift> shift;
  if (!looks_.empty() && ToSeconds(time - looks_.front().time) >= kShortestS) {
    const auto& before = looks_.front();
    const double over_s = ToSeconds(time - before.time);
    const auto match = MatchWith(before, now, velocity_mps);
    if (match.IsFound(kLeastShare)) {
      constexpr double kNothing = 1e-3;  // 1/m2, along a plain wall
      constexpr double kLeastNewS = 0.01;
      const auto num = static_cast<double>(match.num_found);
      const double times = std::max(1.0, 0.5 * match.off2 / num) * std::max(1.0, num / kNumIndependent);
      const Eigen::Matrix2d information = match.information + kNothing * Eigen::Matrix2d::Identity();
      shift = {.shift_m = match.shift_m,
               .covariance_m2 = times * information.inverse() + kCommonSdM * kCommonSdM * Eigen::Matrix2d::Identity(),
               .over_s = over_s,
               .new_s = matched_ > before.time ? std::clamp(ToSeconds(time - matched_), kLeastNewS, over_s) : over_s};
      last_mps_ = match.shift_m / over_s;
      matched_ = time;
    }
  }
  if (looks_.empty() || ToSeconds(time - looks_.back().time) >= kLeastStepS) looks_.push_back(std::move(now));
  return shift;
}

void SurfaceMotion::Clear() {
  looks_.clear();
  matched_ = Utime::min();
  last_mps_.setZero();
}

void SurfaceMotion::Translate(const Eigen::Vector2d& by_m) {
  for (auto& look : looks_) {
    for (auto& point : look.points) point.place_m.head<2>() += by_m;
  }
}

}  // namespace lookout::tracker
