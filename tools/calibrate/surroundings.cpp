#include "tools/calibrate/surroundings.hpp"

#include <algorithm>

#include "services/odometer/core/registration.hpp"

namespace lookout::calibrate {

namespace {

constexpr double kMapSampleM = 0.5;
constexpr double kSampleM = 1.0;
constexpr std::size_t kMaxSample = 400;
// A pair counts where so many returns of the one fit what the other saw, and they are so large a part of those near something.
constexpr int kLeastMatched = 60;
constexpr double kLeastShareOfNear = 0.5;
// Deviations of a direction that nothing shows: so large that it does not count, and the matrix can be inverted.
constexpr double kUnseenM = 10.0;
constexpr double kUnseenRad = 1.0;

struct Moment {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();  // at the end of its scan
  std::vector<odometer::MapPoint> points;                          // of its scan
  std::vector<odometer::MapPoint> sample;
};

std::vector<odometer::MapPoint> SampleOf(const std::vector<odometer::MapPoint>& points) {
  std::vector<Eigen::Vector3d> places_m;
  places_m.reserve(points.size());
  for (const auto& point : points) places_m.push_back(point.p_m);
  const auto first = odometer::FirstOfEachCube(places_m, kSampleM);
  const std::size_t num = std::min(first.size(), kMaxSample);
  std::vector<odometer::MapPoint> sample;
  sample.reserve(num);
  for (std::size_t i = 0; i < num; ++i) sample.push_back(points[first[i * first.size() / num]]);
  return sample;
}

// A vessel-frame point along the axes of the map, from `origin_m`.
odometer::MapPoint Placed(const odometer::MapPoint& point, const Eigen::Isometry3d& T_map_vessel, const Eigen::Vector3d& origin_m) {
  return {T_map_vessel * point.p_m - origin_m, T_map_vessel.linear() * point.normal, point.shape};
}

class MotionFinder {
 public:
  MotionFinder(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed, const PairParams& params)
      : scans_(scans), track_(track), assumed_(assumed), params_(params) {}

  std::vector<RelativeMotion> Find() {
    FillMoments();
    std::vector<RelativeMotion> motions;
    for (std::size_t key = 0; key * params_.key_scans < scans_.size(); ++key) {
      const std::size_t begin = key * params_.key_scans;
      if (!moments_[begin]) continue;
      odometer::LocalMap map;
      const Eigen::Vector3d origin_m = moments_[begin]->T_map_vessel.translation();
      AddSurroundings(begin, origin_m, map);
      // Both ways: things that are seen from one moment may be hidden from the other.
      for (const auto lag : params_.lags) {
        const std::size_t end = begin + lag * params_.key_scans;
        if (end < scans_.size()) AddMotion(begin, end, origin_m, map, motions);
        if (params_.both_ways && begin >= lag * params_.key_scans) AddMotion(begin, begin - lag * params_.key_scans, origin_m, map, motions);
      }
    }
    return motions;
  }

 private:
  // Scans near a moment that is compared, others stay empty.
  void FillMoments() {
    moments_.resize(scans_.size());
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      const std::size_t from_key = i % params_.key_scans;
      if (std::min(from_key, params_.key_scans - from_key) > params_.half_scans) continue;
      const auto pose = track_.At(scans_[i].end_time, assumed_.latency);
      if (!pose) continue;
      Moment moment;
      moment.T_map_vessel = pose->T_map_vessel;
      moment.points = StandingIn(scans_[i], track_, assumed_);
      if (from_key == 0) moment.sample = SampleOf(moment.points);
      moments_[i] = std::move(moment);
    }
  }

  // The scan of the moment comes first: a place of the map keeps its first points, and the points of other scans are placed by POSE.
  void AddSurroundings(std::size_t middle, const Eigen::Vector3d& origin_m, odometer::LocalMap& map) const {
    AddPoints(middle, origin_m, map);
    for (std::size_t off = 1; off <= params_.half_scans; ++off) {
      if (off <= middle) AddPoints(middle - off, origin_m, map);
      if (middle + off < scans_.size()) AddPoints(middle + off, origin_m, map);
    }
  }

  void AddPoints(std::size_t scan, const Eigen::Vector3d& origin_m, odometer::LocalMap& map) const {
    if (!moments_[scan]) return;
    for (const auto& point : moments_[scan]->points) map.Add(Placed(point, moments_[scan]->T_map_vessel, origin_m));
  }

  void AddMotion(std::size_t begin, std::size_t end, const Eigen::Vector3d& origin_m, const odometer::LocalMap& map,
                 std::vector<RelativeMotion>& motions) const {
    if (!moments_[end] || moments_[end]->sample.size() < static_cast<std::size_t>(kLeastMatched)) return;
    odometer::Expected expected;
    expected.T_map_vessel = moments_[end]->T_map_vessel;
    expected.T_map_vessel.translation() -= origin_m;
    expected.T_map_begin = expected.T_map_vessel;
    expected.search_m = params_.search_m;
    for (int i = 0; i < 3; ++i) {
      expected.information(i, i) = 1.0 / (kUnseenM * kUnseenM);
      expected.information(i + 3, i + 3) = 1.0 / (kUnseenRad * kUnseenRad);
    }
    const auto fit = odometer::Register(moments_[end]->sample, expected, map);
    if (fit.num_matched < kLeastMatched || fit.num_matched < kLeastShareOfNear * fit.num_near) return;
    Eigen::Isometry3d T_map_begin = moments_[begin]->T_map_vessel;
    T_map_begin.translation() -= origin_m;
    Matrix6 to_begin = Matrix6::Zero();
    to_begin.topLeftCorner<3, 3>() = to_begin.bottomRightCorner<3, 3>() = T_map_begin.linear().transpose();
    RelativeMotion motion;
    motion.begin = scans_[begin].end_time;
    motion.end = scans_[end].end_time;
    motion.T_begin_end = T_map_begin.inverse() * fit.T_map_vessel;
    motion.information = to_begin * fit.information * to_begin.transpose();
    motions.push_back(motion);
  }

  const std::vector<odometer::Scan>& scans_;
  const PoseTrack& track_;
  const Assumed& assumed_;
  const PairParams& params_;
  std::vector<std::optional<Moment>> moments_;  // [scans]
};

}  // namespace

std::vector<odometer::MapPoint> StandingIn(const odometer::Scan& scan, const PoseTrack& track, const Assumed& assumed) {
  std::vector<odometer::MapPoint> straightened;
  const auto begin = track.At(scan.time, assumed.latency);
  const auto end = track.At(scan.end_time, assumed.latency);
  if (!begin || !end) return straightened;
  odometer::StandingParams params;
  params.min_range_m = assumed.min_range_m;
  params.max_range_m = assumed.max_range_m;
  constexpr double kAnyHeightM = -1e6;
  params.min_height_m = kAnyHeightM;  // told below, by the boat's roll and pitch
  params.T_vessel_lidar = assumed.T_vessel_lidar;
  if (assumed.min_height_m) params.own_vessel_box_m = assumed.own_vessel_box_m;
  const double scan_s = ToSeconds(scan.end_time - scan.time);
  if (scan_s <= 0.0) return straightened;
  const Eigen::Isometry3d T_end_begin = end->T_map_vessel.inverse() * begin->T_map_vessel;
  const Eigen::Vector3d turn_rad = RotationVectorOf(T_end_begin.linear());
  const auto points = odometer::StandingPoints(scan, kMapSampleM, params);
  straightened.reserve(points.size());
  for (const auto& point : points) {
    const double share = point.before_end_s / scan_s;
    const Eigen::Matrix3d R_end_shot = RotationBy(share * turn_rad);
    const Eigen::Vector3d p_end_m = R_end_shot * point.p_vessel_m + share * T_end_begin.translation();
    if (assumed.min_height_m) {
      const double above_m = (end->T_map_vessel.linear() * p_end_m).z() + assumed.reference_point_above_water_m + end->heave_m;
      if (above_m < *assumed.min_height_m) continue;
    }
    straightened.push_back({p_end_m, R_end_shot * point.normal, point.shape});
  }
  return straightened;
}

std::vector<RelativeMotion> MotionsPast(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed,
                                        const PairParams& params) {
  return MotionFinder(scans, track, assumed, params).Find();
}

}  // namespace lookout::calibrate
