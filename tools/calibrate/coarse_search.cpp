#include "tools/calibrate/coarse_search.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "services/odometer/core/local_map.hpp"
#include "tools/calibrate/orientation.hpp"

namespace lookout::calibrate {

namespace {

constexpr double kWindowS = 12.0;
constexpr std::size_t kNumMoments = 24;
constexpr double kViewSampleM = 1.0;
constexpr double kMaxRangeM = 60.0;
constexpr std::size_t kLeastReturns = 1000;
constexpr int kNumYaws = 24;
constexpr std::size_t kNumRefined = 8;
constexpr double kWideM = 2.0;
constexpr double kNarrowM = 1.0;
const double kApartRad = DegToRad(45.0);
// A recording tells mountings apart where the best mounting fills at most this share of the cubes of the next best.
constexpr double kClear = 0.95;

// The points of one scan, and the pose from which it saw them.
struct View {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3d> points_lidar_m;
};

double TurnBetween(const PoseTrack& track, Utime from, Utime to) {
  const auto begin = track.At(from, 0.0);
  const auto end = track.At(to, 0.0);
  if (!begin || !end) return -1.0;
  return AngleOf(begin->T_map_vessel.linear().transpose() * end->T_map_vessel.linear());
}

// The first scan of the window in which the boat turns most.
std::size_t FirstOfWindow(const std::vector<odometer::Scan>& scans, const PoseTrack& track) {
  std::size_t best = 0;
  double best_rad = -1.0;
  std::size_t last = 0;
  for (std::size_t first = 0; first < scans.size(); first += 5) {
    while (last + 1 < scans.size() && ToSeconds(scans[last].end_time - scans[first].end_time) < kWindowS) ++last;
    const double turn_rad = TurnBetween(track, scans[first].end_time, scans[last].end_time);
    if (turn_rad > best_rad) {
      best_rad = turn_rad;
      best = first;
    }
    if (last + 1 == scans.size()) break;
  }
  return best;
}

std::vector<View> ViewsOf(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed) {
  std::vector<View> views;
  odometer::StandingParams params;
  params.min_range_m = assumed.min_range_m;
  params.max_range_m = std::min(assumed.max_range_m, kMaxRangeM);
  constexpr double kAnyHeightM = -1e6;
  params.min_height_m = kAnyHeightM;
  const std::size_t first = FirstOfWindow(scans, track);
  const Utime start = scans[first].end_time;
  for (std::size_t i = first; i < scans.size() && views.size() < kNumMoments; ++i) {
    const double wanted_s = static_cast<double>(views.size()) * kWindowS / kNumMoments;
    if (ToSeconds(scans[i].end_time - start) < wanted_s) continue;
    const auto pose = track.At(scans[i].end_time, assumed.latency);
    if (!pose) continue;
    View view;
    view.T_map_vessel = pose->T_map_vessel;
    for (const auto& point : odometer::StandingPoints(scans[i], kViewSampleM, params)) view.points_lidar_m.push_back(point.p_vessel_m);
    views.push_back(std::move(view));
  }
  return views;
}

// Cubes that are filled, as a share of those that are filled by each view alone.
class Sharpness {
 public:
  Sharpness(const std::vector<View>& views, const Eigen::Vector3d& p_vessel_lidar_m) : views_(views), p_vessel_lidar_m_(p_vessel_lidar_m) {}

  double ShareOf(const Eigen::Matrix3d& R_vessel_lidar, double side_m) const {
    odometer::CubeIndex all;
    std::size_t sum = 0;
    const Eigen::Vector3d origin_m = views_.front().T_map_vessel.translation();
    for (const auto& view : views_) {
      odometer::CubeIndex own;
      const Eigen::Matrix3d R = view.T_map_vessel.linear() * R_vessel_lidar;
      const Eigen::Vector3d t_m = view.T_map_vessel * p_vessel_lidar_m_ - origin_m;
      for (const auto& p_m : view.points_lidar_m) {
        const auto cube = odometer::CubeOf(R * p_m + t_m, side_m);
        own.Insert(cube);
        all.Insert(cube);
      }
      sum += own.size();
    }
    return static_cast<double>(all.size()) / static_cast<double>(std::max<std::size_t>(1, sum));
  }

 private:
  const std::vector<View>& views_;
  Eigen::Vector3d p_vessel_lidar_m_;
};

struct Candidate {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double share = 1.0;
};

// Steps about the three axes, halved until they are a degree.
Candidate Refined(Candidate candidate, const Sharpness& sharpness) {
  candidate.share = sharpness.ShareOf(candidate.R, kNarrowM);
  for (double step_rad = DegToRad(8.0); step_rad > DegToRad(0.6); step_rad /= 2.0) {
    for (int round = 0; round < 4; ++round) {
      const double before = candidate.share;
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          const Eigen::Matrix3d R = RotationAbout(axis, sign * step_rad) * candidate.R;
          const double share = sharpness.ShareOf(R, kNarrowM);
          if (share < candidate.share) candidate = {R, share};
        }
      }
      if (candidate.share == before) break;
    }
  }
  return candidate;
}

}  // namespace

std::optional<CoarseResult> SearchCoarsely(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed) {
  if (scans.empty()) return std::nullopt;
  const auto views = ViewsOf(scans, track, assumed);
  std::size_t num_returns = 0;
  for (const auto& view : views) num_returns += view.points_lidar_m.size();
  if (views.size() < 2 || num_returns < kLeastReturns) return std::nullopt;
  const Sharpness sharpness(views, assumed.T_vessel_lidar.translation());
  // Where the lidar's axes point: one of each direction of its z axis, and yaws of it.
  std::vector<Candidate> candidates;
  std::vector<Eigen::Vector3d> axes;
  for (const auto& cube : CubeRotations()) {
    const Eigen::Vector3d up = cube.col(2);
    if (std::ranges::any_of(axes, [&up](const Eigen::Vector3d& other) { return other.dot(up) > 0.5; })) continue;
    axes.push_back(up);
    for (int i = 0; i < kNumYaws; ++i) {
      const Eigen::Matrix3d turned = cube * RotationAboutZ(kTwoPi * i / kNumYaws);
      const Eigen::Matrix3d R = turned * assumed.T_vessel_lidar.linear();
      candidates.push_back({R, sharpness.ShareOf(R, kWideM)});
    }
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::share);
  std::vector<Candidate> refined;
  refined.reserve(kNumRefined);
  for (std::size_t i = 0; i < kNumRefined; ++i) refined.push_back(Refined(candidates[i], sharpness));
  const auto best = std::ranges::min_element(refined, {}, &Candidate::share);
  CoarseResult result;
  result.R_vessel_lidar = best->R;
  result.share = best->share;
  const auto is_apart = [&](const Candidate& other) { return AngleOf(best->R.transpose() * other.R) > kApartRad; };
  for (const auto& other : candidates) {
    if (is_apart(other)) result.next_share = std::min(result.next_share, sharpness.ShareOf(other.R, kNarrowM));
  }
  for (const auto& other : refined) {
    if (is_apart(other)) result.next_share = std::min(result.next_share, other.share);
  }
  result.is_clear = result.share < kClear * result.next_share;
  return result;
}

}  // namespace lookout::calibrate
