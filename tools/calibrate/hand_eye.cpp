#include "tools/calibrate/hand_eye.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lookout::calibrate {

namespace {

using Numbers = Correction::Numbers;
using Normal = Eigen::Matrix<double, Correction::kNumNumbers, Correction::kNumNumbers>;
constexpr int kLatency = 3;
constexpr int kTiltLatency = 4;

// Steps of the numerical derivative.
constexpr double kStepRad = 1e-4;
constexpr double kStepS = 1e-3;
constexpr double kStepM = 1e-3;
constexpr int kMaxIterations = 20;
// Weights are told by the residuals of the first so many steps.
constexpr int kWeighings = 4;
// Cauchy's scale, in deviations of a pair (root of its squares over 6): what is farther off counts for less.
constexpr double kCauchy = 2.0;
constexpr std::size_t kLeastMotions = 10;
// No deviation of the latency is known before anything is seen; it holds an unobservable one where it was.
constexpr double kLatencySdS = 0.3;
constexpr double kRotationSdRad = 0.5;

Numbers StepsOf() {
  Numbers steps;
  steps << kStepRad, kStepRad, kStepRad, kStepS, kStepS, kStepM, kStepM, kStepM;
  return steps;
}

// One pair, linear about the present correction: residual(x + dx) = residual + jacobian dx.
struct Row {
  Vector6 residual = Vector6::Zero();
  Eigen::Matrix<double, 6, Correction::kNumNumbers> jacobian = Eigen::Matrix<double, 6, Correction::kNumNumbers>::Zero();
  Matrix6 registration = Matrix6::Zero();  // covariance of the motion by the lidar
  Matrix6 weight = Matrix6::Zero();
  std::size_t lag = 0;  // group of pairs that are as far apart in time
  Utime begin;
  Utime end;
};

// Pairs 1, 2, 4, 8 ... seconds apart: 0, 1, 2, 3 ...
constexpr std::size_t kNumLags = 12;
std::size_t LagOf(const RelativeMotion& motion) {
  const double apart_s = std::abs(ToSeconds(motion.end - motion.begin));
  return static_cast<std::size_t>(std::clamp(std::log2(std::max(apart_s, 1e-3)) + 0.5, 0.0, static_cast<double>(kNumLags - 1)));
}

// Variances of the change of POSE over a lag: displacement (m2), rotation (rad2). The covariances of two poses do not tell them: their errors are
// nearly the same where the poses are near in time.
using Variances = std::array<Vector6, kNumLags>;

std::optional<Row> Linearised(const RelativeMotion& motion, const PoseTrack& track, const Eigen::Vector3d& p_vessel_lidar_m, const Correction& at) {
  const auto residual = Residual(motion, track, p_vessel_lidar_m, at);
  if (!residual) return std::nullopt;
  Row row;
  row.residual = *residual;
  row.begin = motion.begin;
  row.end = motion.end;
  const Numbers here = at.ToNumbers();
  const Numbers steps = StepsOf();
  for (int k = 0; k < Correction::kNumNumbers; ++k) {
    Numbers up = here;
    Numbers down = here;
    up[k] += steps[k];
    down[k] -= steps[k];
    const auto above = Residual(motion, track, p_vessel_lidar_m, Correction::FromNumbers(up));
    const auto below = Residual(motion, track, p_vessel_lidar_m, Correction::FromNumbers(down));
    if (!above || !below) return std::nullopt;
    row.jacobian.col(k) = (*above - *below) / (2.0 * steps[k]);
  }
  row.registration = motion.information.ldlt().solve(Matrix6::Identity());
  row.lag = LagOf(motion);
  return row;
}

void SetWeights(const Variances& variances, std::vector<Row>& rows) {
  for (auto& row : rows) {
    Matrix6 covariance = row.registration;
    covariance.diagonal() += variances.at(row.lag);
    row.weight = covariance.ldlt().solve(Matrix6::Identity());
  }
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Variances of POSE for each lag: those of the residuals less the part that the registration explains. With few pairs the variance stays as before.
Variances VariancesOf(const std::vector<Row>& rows, const Variances& before) {
  constexpr std::size_t kLeastOfLag = 10;
  // Median of the square of a normal number.
  constexpr double kMedianSquare = 0.4549;
  // The difference of two poses is not known better than this.
  constexpr double kLeastM2 = 0.005 * 0.005;
  constexpr double kLeastRad2 = 1e-4 * 1e-4;
  Variances variances = before;
  for (std::size_t lag = 0; lag < kNumLags; ++lag) {
    for (int i = 0; i < 6; ++i) {
      std::vector<double> squares;
      std::vector<double> explained;
      for (const auto& row : rows) {
        if (row.lag != lag) continue;
        squares.push_back(row.residual[i] * row.residual[i]);
        explained.push_back(row.registration(i, i));
      }
      if (squares.size() < kLeastOfLag) continue;
      variances.at(lag)[i] = std::max(i < 3 ? kLeastM2 : kLeastRad2, MedianOf(std::move(squares)) / kMedianSquare - MedianOf(std::move(explained)));
    }
  }
  return variances;
}

// Before the residuals are known: what two poses say that know nothing of each other.
Variances FirstVariances(const std::vector<RelativeMotion>& motions, const PoseTrack& track, const Correction& start) {
  std::array<std::array<std::vector<double>, 6>, kNumLags> of_lags;
  for (const auto& motion : motions) {
    const auto begin = track.At(motion.begin, start.latency);
    const auto end = track.At(motion.end, start.latency);
    if (!begin || !end) continue;
    const Vector6 sum = begin->covariance.diagonal() + end->covariance.diagonal();
    for (std::size_t i = 0; i < 6; ++i) of_lags.at(LagOf(motion)).at(i).push_back(sum[static_cast<Eigen::Index>(i)]);
  }
  Variances variances;
  for (std::size_t lag = 0; lag < kNumLags; ++lag) {
    for (std::size_t i = 0; i < 6; ++i) variances.at(lag)[static_cast<Eigen::Index>(i)] = MedianOf(of_lags.at(lag).at(i));
  }
  return variances;
}

double SquaresOf(const Row& row, const Numbers& step) {
  const Vector6 rest = row.residual + row.jacobian * step;
  return rest.dot(row.weight * rest) / 6.0;
}

double RobustWeight(double squares) { return 1.0 / (1.0 + squares / (kCauchy * kCauchy)); }

Numbers PriorInformation(const HandEyeParams& params) {
  Numbers information;
  const double place = 1.0 / (params.place_sd_m * params.place_sd_m);
  const double rotation = 1.0 / (kRotationSdRad * kRotationSdRad);
  const double latency = 1.0 / (kLatencySdS * kLatencySdS);
  information << rotation, rotation, rotation, latency, latency, place, place, place;
  return information;
}

struct Step {
  Numbers step = Numbers::Zero();
  Normal information = Normal::Zero();
};

// The best step for these rows with weights that are refined: the rows are linear, so this is a fit by itself.
Step Solve(const std::vector<const Row*>& rows, const Numbers& here, const HandEyeParams& params) {
  const Numbers prior = PriorInformation(params);
  // The latency's prior is about where it began, the others' about 0.
  Numbers about = here;
  about[kLatency] = about[kTiltLatency] = 0.0;
  Step best;
  constexpr int kReweightings = 5;
  for (int i = 0; i < kReweightings; ++i) {
    Normal information = prior.asDiagonal();
    Numbers gradient = prior.cwiseProduct(about);
    for (const auto* row : rows) {
      const Eigen::Matrix<double, Correction::kNumNumbers, 6> weighted =
          RobustWeight(SquaresOf(*row, best.step)) * (row->jacobian.transpose() * row->weight);
      information += weighted * row->jacobian;
      gradient += weighted * row->residual;
    }
    best.information = information;
    best.step = -information.ldlt().solve(gradient);
  }
  return best;
}

// How much larger the residuals are than stated, as a factor of the variance; not below 1.
double VarianceFactor(const std::vector<Row>& rows) {
  double squares = 0.0;
  double weights = 0.0;
  for (const auto& row : rows) {
    const double square = SquaresOf(row, Numbers::Zero());
    const double weight = RobustWeight(square);
    squares += weight * square;
    weights += weight;
  }
  return std::max(1.0, squares / std::max(weights, 1e-9));
}

// Each block of time is left out once, with all pairs that touch it.
Numbers JackknifeSd(const std::vector<Row>& rows, const Numbers& here, const HandEyeParams& params) {
  Utime first = rows.front().begin;
  Utime last = rows.front().end;
  for (const auto& row : rows) {
    first = std::min({first, row.begin, row.end});
    last = std::max({last, row.begin, row.end});
  }
  const double span_s = std::max(1e-3, ToSeconds(last - first));
  const auto block_of = [&](Utime time) {
    return std::min(params.num_blocks - 1, static_cast<int>(ToSeconds(time - first) / span_s * params.num_blocks));
  };
  std::vector<Numbers> steps;
  steps.reserve(static_cast<std::size_t>(params.num_blocks));
  for (int block = 0; block < params.num_blocks; ++block) {
    std::vector<const Row*> kept;
    kept.reserve(rows.size());
    for (const auto& row : rows) {
      if (block_of(row.begin) != block && block_of(row.end) != block) kept.push_back(&row);
    }
    if (kept.size() == rows.size()) continue;  // the block holds no pairs
    steps.push_back(Solve(kept, here, params).step);
  }
  Numbers mean = Numbers::Zero();
  for (const auto& step : steps) mean += step / static_cast<double>(steps.size());
  Numbers variance = Numbers::Zero();
  for (const auto& step : steps) variance += (step - mean).cwiseAbs2();
  const auto count = static_cast<double>(steps.size());
  return (variance * ((count - 1.0) / std::max(count, 1.0))).cwiseSqrt();
}

}  // namespace

Correction::Numbers Correction::ToNumbers() const {
  Numbers numbers;
  numbers << rotation_rad, latency.heading_s, latency.tilt_s, place_m;
  return numbers;
}

Correction Correction::FromNumbers(const Numbers& numbers) {
  Correction correction;
  correction.rotation_rad = numbers.head<3>();
  correction.latency = {numbers[kLatency], numbers[kTiltLatency]};
  correction.place_m = numbers.tail<3>();
  return correction;
}

Eigen::Vector3d RotationVectorOf(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

std::optional<Vector6> Residual(const RelativeMotion& motion, const PoseTrack& track, const Eigen::Vector3d& p_vessel_lidar_m,
                                const Correction& correction) {
  const auto begin = track.At(motion.begin, correction.latency);
  const auto end = track.At(motion.end, correction.latency);
  if (!begin || !end) return std::nullopt;
  // p_vessel = D p_assumed: turns about the lidar, and moves it.
  Eigen::Isometry3d D = Eigen::Isometry3d::Identity();
  D.linear() = RotationBy(correction.rotation_rad);
  D.translation() = p_vessel_lidar_m + correction.place_m - D.linear() * p_vessel_lidar_m;
  const Eigen::Isometry3d expected = D.inverse() * (begin->T_map_vessel.inverse() * end->T_map_vessel) * D;
  Vector6 residual;
  residual << motion.T_begin_end.translation() - expected.translation(),
      RotationVectorOf(motion.T_begin_end.linear() * expected.linear().transpose());
  return residual;
}

std::optional<HandEyeResult> SolveHandEye(const std::vector<RelativeMotion>& motions, const PoseTrack& track, const Eigen::Vector3d& p_vessel_lidar_m,
                                          const Correction& start, const HandEyeParams& params) {
  HandEyeResult result;
  result.correction = start;
  std::vector<Row> rows;
  Normal information = Normal::Identity();
  Variances variances = FirstVariances(motions, track, start);
  for (int i = 0; i < kMaxIterations; ++i) {
    rows.clear();
    rows.reserve(motions.size());
    for (const auto& motion : motions) {
      if (const auto row = Linearised(motion, track, p_vessel_lidar_m, result.correction)) rows.push_back(*row);
    }
    if (rows.size() < kLeastMotions) return std::nullopt;
    if (i > 0 && i <= kWeighings) variances = VariancesOf(rows, variances);
    SetWeights(variances, rows);
    std::vector<const Row*> all;
    all.reserve(rows.size());
    for (const auto& row : rows) all.push_back(&row);
    const Numbers here = result.correction.ToNumbers();
    const auto [step, of_step] = Solve(all, here, params);
    information = of_step;
    result.correction = Correction::FromNumbers(here + step);
    constexpr double kStill = 1e-6;
    if (i > kWeighings && step.cwiseAbs().maxCoeff() < kStill) break;
  }
  result.num_pairs = rows.size();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Matrix6 covariance = motions[i].information.ldlt().solve(Matrix6::Identity());
    covariance.diagonal() += variances.at(LagOf(motions[i]));
    result.weights.emplace_back(covariance.ldlt().solve(Matrix6::Identity()));
  }
  double weights = 0.0;
  for (const auto& row : rows) {
    const double weight = RobustWeight(SquaresOf(row, Numbers::Zero()));
    weights += weight;
    result.displacement_rms_m += weight * row.residual.head<3>().squaredNorm();
    result.rotation_rms_rad += weight * row.residual.tail<3>().squaredNorm();
  }
  result.displacement_rms_m = std::sqrt(result.displacement_rms_m / weights);
  result.rotation_rms_rad = std::sqrt(result.rotation_rms_rad / weights);
  if (!params.wants_deviations) return result;
  const Normal covariance = information.ldlt().solve(Normal::Identity());
  result.formal_sd = (covariance.diagonal() * VarianceFactor(rows)).cwiseSqrt();
  result.sd = result.formal_sd.cwiseMax(JackknifeSd(rows, result.correction.ToNumbers(), params));
  const Numbers scale = result.sd.cwiseQuotient(covariance.diagonal().cwiseSqrt());
  result.rotation_covariance = scale.head<3>().asDiagonal() * covariance.topLeftCorner<3, 3>() * scale.head<3>().asDiagonal();
  return result;
}

}  // namespace lookout::calibrate
