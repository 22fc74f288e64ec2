#include "services/odometer/core/odometer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"

namespace lookout::odometer {

namespace {

// Sides of the cubes of which one return each enters the map (kMapSampleM), and of which one of these each is registered (kSampleM).
constexpr double kMapSampleM = 0.5;
constexpr double kSampleM = 1.0;
constexpr std::size_t kMaxSample = 600;
constexpr double kMapRadiusM = 130.0;
constexpr std::int64_t kForgetEvery = 20;

// Before anything is known: any speed of a boat in a harbour.
constexpr double kUnknownSpeedSdMps = 5.0;
constexpr double kUnknownTurnSdRadps = 0.5;
// Deviations of attitude and height against calm water: a small boat in waves.
constexpr double kTiltSdRad = 0.06;
constexpr double kHeaveSdM = 0.3;
constexpr double kTiltSmoothing = 0.5;

constexpr double kLeastSearchM = 0.5;
constexpr double kMostSearchM = 2.0;

// Until the speed is known a scan cannot be straightened, so each of the first scans replaces the map.
constexpr int kFirstScans = 5;
// After so many scans without a known motion the map begins anew.
constexpr int kMaxUnknown = 5;

constexpr int kLeastMatched = 60;
constexpr double kLeastShareOfNear = 0.5;
constexpr double kLeastShareOfAll = 0.15;
// Matched returns must show more than one ship, of which the largest on canals and rivers is 110 m long (CEMT class Va): they lie in at least this
// many squares, or in at least this many things apart from each other.
constexpr std::size_t kLeastSquares = 22;
constexpr std::size_t kLeastThings = 5;
// Or the returns are all around the boat, as in a lock: in at least this many of 12 sectors. A boat alongside takes 6 at most.
constexpr int kNumSectors = 12;
constexpr int kLeastSectors = 8;
// The rates are known where their deviations are below.
constexpr double kMaxSpeedSdMps = 0.7;
constexpr double kMaxTurnSdRadps = 0.05;

Eigen::Isometry3d Planar(const Eigen::Vector2d& p_m, double turn_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = RotationAboutZ(turn_rad);
  T.translation().head<2>() = p_m;
  return T;
}

// Bearing of the bow against the map's x axis, counter-clockwise.
double BearingOf(const Eigen::Isometry3d& T_map_vessel) { return Atan2(T_map_vessel.linear()(1, 0), T_map_vessel.linear()(0, 0)); }

constexpr std::array<int, 3> kPlanar{0, 1, 5};  // of Vector6: east, north, rotation about up

Eigen::Matrix3d PlanarOf(const Matrix6& matrix) {
  Eigen::Matrix3d part;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) part(i, k) = matrix(kPlanar[static_cast<std::size_t>(i)], kPlanar[static_cast<std::size_t>(k)]);
  }
  return part;
}

// Covariance of the place after the fit and the prediction. The noise of normals adds spurious information: along a straight quay, normals that are
// wrong by degrees seem to tell the way. The information matrix of the fit is therefore reduced by the one that is expected of this noise.
//
// The eigenvectors make both matrices diagonal, with 1 for the fit and the share m for the noise. The fit divides its gradient by 1 in place of 1 -
// m, so the variance of its error is 1 / (1 - m)^2. Along each of them the place is not known worse than it was predicted; a bound in all directions
// made the drift of the heading twice as large on the lake.
//
// @param distorted  covariance of the place by a distorted scan
Eigen::Matrix3d PlaceCovarianceOf(const Fit& fit, const Eigen::Matrix3d& predicted, const Eigen::Matrix3d& distorted) {
  const Eigen::Matrix3d seen = PlanarOf(fit.information.ldlt().solve(Matrix6::Identity()));
  const Eigen::Matrix3d added = distorted + PlanarOf(fit.covariance_of_things);
  const Eigen::Matrix3d information = seen.ldlt().solve(Eigen::Matrix3d::Identity());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(PlanarOf(fit.information_spurious), information);
  const Eigen::Matrix3d& directions = solver.eigenvectors();
  const Eigen::Matrix3d scaled = information * directions;
  Eigen::Matrix3d along = scaled.transpose() * added * scaled;
  for (int i = 0; i < 3; ++i) {
    const double rest = 1.0 - solver.eigenvalues()[i];
    const double most = 1.0 / directions.col(i).dot(predicted.ldlt().solve(directions.col(i)));
    along(i, i) += rest > 0.0 ? 1.0 / (rest * rest) : most;
    // Correlations stay.
    const double factor = std::sqrt(std::min(along(i, i), most) / along(i, i));
    along.row(i) *= factor;
    along.col(i) *= factor;
  }
  return directions * along * directions.transpose();
}

// Squares of the water in which points lie, and groups of squares that touch, corners too.
struct Spread {
  std::size_t num_squares = 0;
  std::size_t num_things = 0;
  int num_sectors = 0;  // seen from the boat
};

Spread SpreadOf(const std::vector<Eigen::Vector3d>& points_m) {
  std::array<bool, kNumSectors> is_met{};
  CubeIndex index;
  std::vector<Eigen::Vector3i> squares;
  for (const auto& p_m : points_m) {
    auto square = CubeOf(p_m, kSquareM);
    square.z() = 0;
    const double bearing_rad = WrapTo2Pi(Atan2(p_m.y(), p_m.x()));
    is_met[static_cast<std::size_t>(std::clamp(static_cast<int>(bearing_rad / kTwoPi * kNumSectors), 0, kNumSectors - 1))] = true;
    if (index.Insert(square).second) squares.push_back(square);
  }
  std::vector<bool> is_counted(squares.size(), false);
  std::size_t num_things = 0;
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < squares.size(); ++first) {
    if (is_counted[first]) continue;
    ++num_things;
    is_counted[first] = true;
    open.assign(1, first);
    while (!open.empty()) {
      const auto square = squares[open.back()];
      open.pop_back();
      for (int k = 0; k < 9; ++k) {
        const auto number = index.Find(square + Eigen::Vector3i(k % 3 - 1, k / 3 - 1, 0));
        if (number == CubeIndex::kNone || is_counted[static_cast<std::size_t>(number)]) continue;
        is_counted[static_cast<std::size_t>(number)] = true;
        open.push_back(static_cast<std::size_t>(number));
      }
    }
  }
  return {squares.size(), num_things, static_cast<int>(std::ranges::count(is_met, true))};
}

// At most kMaxSample, evenly out of all.
std::vector<std::size_t> Thinned(const std::vector<std::size_t>& sample) {
  if (sample.size() <= kMaxSample) return sample;
  std::vector<std::size_t> thinned;
  thinned.reserve(kMaxSample);
  for (std::size_t i = 0; i < kMaxSample; ++i) thinned.push_back(sample[i * sample.size() / kMaxSample]);
  return thinned;
}

}  // namespace

void Odometer::Reset() { *this = Odometer(params_); }

void Odometer::Begin(const Scan& scan) {
  map_.Clear();
  time_ = scan.end_time;
  T_map_vessel_ = Eigen::Isometry3d::Identity();
  rates_.setZero();
  tilt_rates_radps_.setZero();
  uncertainty_.Begin({kUnknownSpeedSdMps, kUnknownSpeedSdMps, kUnknownTurnSdRadps});
  num_known_ = num_unknown_ = 0;
}

// In the vessel frame at the end of the scan.
std::vector<MapPoint> Odometer::Straightened(const std::vector<TimedPoint>& points) const {
  std::vector<MapPoint> straightened;
  straightened.reserve(points.size());
  for (const auto& point : points) {
    // The vessel frame of the shot lies behind by the way since.
    const double turned_rad = -rates_[2] * point.before_end_s;
    const Eigen::Vector2d way_m = -rates_.head<2>() * point.before_end_s;
    const auto [sin, cos] = SinCosOf(turned_rad);
    const auto& p_m = point.p_vessel_m;
    const auto& normal = point.normal;
    // By the small angles through which the boat rolls and pitches meanwhile.
    const Eigen::Vector3d tilt_rad(-tilt_rates_radps_.x() * point.before_end_s, -tilt_rates_radps_.y() * point.before_end_s, 0.0);
    const Eigen::Vector3d by_tilt_m = tilt_rad.cross(p_m);
    straightened.push_back({{cos * p_m.x() - sin * p_m.y() + way_m.x() + by_tilt_m.x(), sin * p_m.x() + cos * p_m.y() + way_m.y() + by_tilt_m.y(),
                             p_m.z() + by_tilt_m.z()},
                            {cos * normal.x() - sin * normal.y(), sin * normal.x() + cos * normal.y(), normal.z()},
                            point.shape,
                            point.normal_sd_rad});
  }
  return straightened;
}

// Where the boat is if it goes on as it did, level.
Odometer::Prediction Odometer::Predict(double since_s) {
  Prediction predicted;
  auto& expected = predicted.expected;
  predicted.are_rates_known = IsDetermined();
  const double turn_rad = rates_[2] * since_s;
  // Along the bearing in the middle of the time.
  const Eigen::Matrix3d R_middle = RotationAboutZ(BearingOf(T_map_vessel_) + 0.5 * turn_rad);
  const double bearing_rad = BearingOf(T_map_vessel_) + turn_rad;
  const Eigen::Vector2d p_m = T_map_vessel_.translation().head<2>() + R_middle.topLeftCorner<2, 2>() * rates_.head<2>() * since_s;
  // The search begins with the last attitude and height; the expected attitude and height are those on calm water.
  expected.T_map_begin = T_map_vessel_;
  const Eigen::Vector3d tilt_rad(tilt_rates_radps_.x() * since_s, tilt_rates_radps_.y() * since_s, 0.0);
  expected.T_map_begin.linear() = RotationAboutZ(turn_rad) * T_map_vessel_.linear() * RotationBy(tilt_rad);
  expected.T_map_begin.translation().head<2>() = p_m;
  expected.T_map_vessel = Planar(p_m, bearing_rad);
  uncertainty_.Predict(since_s, R_middle);
  // The returns are half a scan old on average, so an error of the rates displaces the fit by half of the displacement in a scan.
  if (!predicted.are_rates_known) predicted.distortion = 0.25 * since_s * since_s * R_middle * uncertainty_.rates() * R_middle.transpose();
  const Eigen::Matrix3d& planar = uncertainty_.expected_place();
  const Eigen::Matrix3d information = planar.ldlt().solve(Eigen::Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      expected.information(kPlanar[static_cast<std::size_t>(i)], kPlanar[static_cast<std::size_t>(k)]) = information(i, k);
    }
  }
  expected.information(2, 2) = 1.0 / (kHeaveSdM * kHeaveSdM);
  expected.information(3, 3) = expected.information(4, 4) = 1.0 / (kTiltSdRad * kTiltSdRad);
  expected.search_m = std::clamp(kLeastSearchM + 3.0 * std::sqrt(std::max(planar(0, 0), planar(1, 1))), kLeastSearchM, kMostSearchM);
  return predicted;
}

Reason Odometer::Judge(const std::vector<MapPoint>& points, const Fit& fit) const {
  if (static_cast<int>(points.size()) < kLeastMatched) return Reason::kFewReturns;
  if (fit.num_matched < kLeastShareOfNear * fit.num_near || fit.num_matched < kLeastShareOfAll * static_cast<double>(points.size())) {
    return Reason::kNoFit;
  }
  if (fit.num_matched < kLeastMatched) return Reason::kFewReturns;
  std::vector<Eigen::Vector3d> matched_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.is_matched[i]) matched_m.push_back(points[i].p_m);
  }
  const auto spread = SpreadOf(matched_m);
  if (spread.num_squares < kLeastSquares && spread.num_things < kLeastThings && spread.num_sectors < kLeastSectors) return Reason::kOneThing;
  return Reason::kNone;
}

// A point that lies near known points and does not fit them belongs to a moving thing, and stays out of the map.
void Odometer::AddToMap(const std::vector<MapPoint>& points, const std::vector<std::size_t>& sample, const Fit* fit) {
  std::vector<bool> moves(points.size(), false);
  for (std::size_t i = 0; fit != nullptr && i < sample.size(); ++i) moves[sample[i]] = fit->is_near[i] && !fit->is_matched[i];
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!moves[i]) map_.Add({T_map_vessel_ * points[i].p_m, T_map_vessel_.linear() * points[i].normal, points[i].shape, points[i].normal_sd_rad});
  }
  if (++num_scans_ % kForgetEvery == 0) map_.Forget(T_map_vessel_.translation(), kMapRadiusM);
}

// The motion of the fit, and the rates after it.
void Odometer::Follow(const Fit& fit, const Prediction& predicted, double since_s, Motion& motion) {
  const auto& expected = predicted.expected;
  const double end_rad = BearingOf(fit.T_map_vessel);
  const Eigen::Vector3d moved_m = fit.T_map_vessel.translation() - expected.T_map_vessel.translation();
  const Eigen::Vector3d correction(moved_m.x(), moved_m.y(), WrapToPi(end_rad - BearingOf(expected.T_map_vessel)));
  // After scans without a fit the motion begins at an expected place, which this fit corrects too.
  const Eigen::Vector3d begin_correction =
      uncertainty_.Correct(correction, PlaceCovarianceOf(fit, uncertainty_.expected_place(), predicted.distortion));
  const Eigen::Vector2d begin_m = T_map_vessel_.translation().head<2>() + begin_correction.head<2>();
  const double begin_rad = BearingOf(T_map_vessel_) + begin_correction[2];
  const double turn_rad = WrapToPi(end_rad - begin_rad);
  motion.displacement_m = RotationAboutZ(-begin_rad).topLeftCorner<2, 2>() * (fit.T_map_vessel.translation().head<2>() - begin_m);
  motion.turn_rad = -turn_rad;
  rates_.head<2>() = RotationAboutZ(-0.5 * turn_rad).topLeftCorner<2, 2>() * motion.displacement_m / since_s;
  rates_[2] = turn_rad / since_s;
  Eigen::Matrix3d R_begin_middle = RotationAboutZ(0.5 * turn_rad);
  R_begin_middle(2, 2) = -1.0;  // a turn is told clockwise
  motion.covariance = since_s * since_s * R_begin_middle * uncertainty_.rates() * R_begin_middle.transpose();
  const Eigen::Vector3d rotation_rad = RotationVector(T_map_vessel_.linear().transpose() * fit.T_map_vessel.linear());
  tilt_rates_radps_ = kTiltSmoothing * tilt_rates_radps_ + (1.0 - kTiltSmoothing) * rotation_rad.head<2>() / since_s;
  T_map_vessel_ = fit.T_map_vessel;
}

bool Odometer::IsDetermined() const {
  const Eigen::Matrix3d rates = uncertainty_.rates();
  // A fit that is less sure than what was expected can leave no covariance at all.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> whole(rates, Eigen::EigenvaluesOnly);
  if (!(whole.eigenvalues()[0] > 0.0)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(rates.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[1] <= kMaxSpeedSdMps * kMaxSpeedSdMps && rates(2, 2) <= kMaxTurnSdRadps * kMaxTurnSdRadps;
}

// Without a fit the boat is expected to go on as before.
void Odometer::LoseSight(const Scan& scan, const std::vector<MapPoint>& points, const Expected& expected) {
  tilt_rates_radps_.setZero();
  T_map_vessel_ = expected.T_map_begin;
  if (++num_unknown_ < kMaxUnknown) return;
  Begin(scan);
  AddToMap(points, {}, nullptr);
}

// While the speed is known, the next motion is measured from this place, which has no error by definition. While the speed is unknown, the error of
// the place in the map grows; beyond the distance that is searched the map is of no use.
void Odometer::KeepPlace(bool is_first, const Motion& motion) {
  // The speed, by which scans are straightened, settles.
  if (is_first) map_.Clear();
  if (is_first || motion.is_known()) {
    uncertainty_.BeginAtPlace();
    return;
  }
  uncertainty_.LimitRates(kUnknownSpeedSdMps, kUnknownTurnSdRadps);
  if (uncertainty_.place().topLeftCorner<2, 2>().trace() < kMostSearchM * kMostSearchM) return;
  map_.Clear();
  uncertainty_.BeginAtPlace();
}

Motion Odometer::Consume(const Scan& scan) {
  Motion motion{time_.value_or(scan.end_time), scan.end_time};
  const double since_s = time_ ? ToSeconds(scan.end_time - *time_) : 0.0;
  const bool begins = !time_ || since_s <= 0.0 || since_s > kMaxGapS;
  if (begins) {
    motion.reason = time_ ? Reason::kGap : Reason::kFirstScan;
    motion.begin = motion.end;
    Begin(scan);
  }
  const auto points = Straightened(StandingPoints(scan, kMapSampleM, params_.standing));
  if (begins) {
    AddToMap(points, {}, nullptr);
    return motion;
  }
  std::vector<Eigen::Vector3d> points_m;
  points_m.reserve(points.size());
  for (const auto& point : points) points_m.push_back(point.p_m);
  const auto sample = Thinned(FirstOfEachCube(points_m, kSampleM));
  std::vector<MapPoint> sampled;
  sampled.reserve(sample.size());
  for (const auto i : sample) sampled.push_back(points[i]);

  const auto predicted = Predict(since_s);
  const auto fit = Register(sampled, predicted.expected, map_);
  motion.num_returns = static_cast<int>(sampled.size());
  motion.num_matched = fit.num_matched;
  motion.residual_m = fit.residual_m;
  motion.reason = Judge(sampled, fit);
  time_ = scan.end_time;

  if (!motion.is_known()) {
    LoseSight(scan, points, predicted.expected);
    return motion;
  }
  Follow(fit, predicted, since_s, motion);
  num_unknown_ = 0;
  const bool is_first = num_known_ < kFirstScans;
  ++num_known_;
  if (is_first || !predicted.are_rates_known || !IsDetermined()) motion.reason = Reason::kUndetermined;
  KeepPlace(is_first, motion);
  // After lost scans the first scan is distorted by the error of the rates: it stays out of the map.
  if (is_first || predicted.are_rates_known || !IsDetermined()) AddToMap(points, sample, is_first ? nullptr : &fit);
  return motion;
}

}  // namespace lookout::odometer
