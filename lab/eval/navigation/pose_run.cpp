#include "lab/eval/navigation/pose_run.hpp"

#include <Eigen/LU>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/core/angles.hpp"
#include "common/messages/pose_message.hpp"
#include "lab/sim/motion.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"

namespace lookout::eval {

namespace {

constexpr double kEllipse95 = 5.991;  // chi-square of two degrees of freedom
// From the last shot of a scan's packets to the motion on the bus.
constexpr std::chrono::milliseconds kProcessing{20};

template <typename Value>
void Append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

class Judge {
 public:
  Judge(const sim::Scene& scene, const config::BoatFacts& boat, const PoseCase& pose_case)
      : scene_(scene), boat_(boat), case_(pose_case), map_(sim::MapFrame(boat)) {}

  void OnPose(const pose_t& pose) {
    const double time_s = 1e-6 * static_cast<double>(pose.utime_us - ToUtimeUs(kSimulationStart));
    const bool is_judged = case_.has_gap() ? time_s > case_.gap_begin_s && time_s <= case_.gap_end_s : time_s > PoseScores::kSettleS;
    if (is_judged) ++scores_.num_poses;
    const bool is_placed = messages::IsOnEarth(pose);
    if (case_.has_gap() && time_s <= case_.gap_end_s) {
      end_m_ = end_heading_rad_ = kNan;
    }
    if (!is_placed) {
      last_error_m_.reset();
      return;
    }
    const auto truth = sim::StateAt(scene_.own_motion, boat_.reference_point_above_water_m, time_s);
    Eigen::Vector3d p_m;
    map_.Forward(pose.latitude_deg, pose.longitude_deg, 0.0, p_m.x(), p_m.y(), p_m.z());
    const Eigen::Vector2d error_m = (p_m - truth.position_map_m).head<2>();
    const double heading_error_rad = std::abs(WrapToPi(pose.heading_rad - truth.heading_rad));
    if (is_judged) {
      scores_.heading_errors_rad.push_back(heading_error_rad);
      scores_.position_errors_m.push_back(error_m.norm());
      const Eigen::Vector2d velocity_mps(pose.velocity_map_mps[0], pose.velocity_map_mps[1]);
      scores_.velocity_errors_mps.push_back((velocity_mps - truth.velocity_map_mps).norm());
      Eigen::Matrix2d covariance_m2;
      covariance_m2 << pose.covariance[0][0], pose.covariance[0][1], pose.covariance[1][0], pose.covariance[1][1];
      scores_.num_in_ellipse += error_m.dot(covariance_m2.inverse() * error_m) <= kEllipse95 ? 1 : 0;
    }
    if (case_.has_gap() && time_s <= case_.gap_end_s) {
      end_m_ = error_m.norm();
      end_heading_rad_ = heading_error_rad;
    }
    if (case_.has_gap() && time_s > case_.gap_end_s && time_s < case_.gap_end_s + PoseScores::kBehindGapS && last_error_m_) {
      jump_m_ = std::max(jump_m_, (error_m - *last_error_m_).norm());
    }
    last_error_m_ = error_m;
  }

  PoseScores Finish() {
    if (case_.has_gap()) {
      if (!std::isnan(end_m_)) scores_.end_errors_m.push_back(end_m_);
      if (!std::isnan(end_heading_rad_)) scores_.end_headings_rad.push_back(end_heading_rad_);
      scores_.jumps_m.push_back(jump_m_);
    }
    return std::move(scores_);
  }

 private:
  const sim::Scene& scene_;
  const config::BoatFacts& boat_;
  const PoseCase& case_;
  GeographicLib::LocalCartesian map_;
  PoseScores scores_;
  std::optional<Eigen::Vector2d> last_error_m_;
  double end_m_ = kNan;
  double end_heading_rad_ = kNan;
  double jump_m_ = 0.0;
};

bool IsOfImu(const std::vector<std::uint8_t>& payload) {
  constexpr std::string_view kImu = "$VNIMU";
  return std::string_view(reinterpret_cast<const char*>(payload.data()), payload.size()).starts_with(kImu);
}

}  // namespace

double PercentileOf(std::vector<double> values, double share) {
  if (values.empty()) return kNan;
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

double RmsOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? kNan : std::sqrt(sum / static_cast<double>(values.size()));
}

void PoseScores::Add(const PoseScores& other) {
  Append(heading_errors_rad, other.heading_errors_rad);
  Append(position_errors_m, other.position_errors_m);
  Append(velocity_errors_mps, other.velocity_errors_mps);
  num_poses += other.num_poses;
  num_in_ellipse += other.num_in_ellipse;
  Append(end_errors_m, other.end_errors_m);
  Append(end_headings_rad, other.end_headings_rad);
  Append(jumps_m, other.jumps_m);
  num_gated += other.num_gated;
  num_renewed += other.num_renewed;
  num_gated_odometry += other.num_gated_odometry;
}

PoseScores RunPose(const std::filesystem::path& config_folder, const sim::Scene& scene, const config::BoatFacts& boat, std::uint64_t seed,
                   double seconds, const std::vector<OdometryMessage>& motions, const PoseCase& pose_case) {
  const sim::FaultPlan plan;
  sim::Navigation navigation(scene, boat, pose_case.navigation, plan, kSimulationStart, seed);
  const Utime end = kSimulationStart + std::chrono::microseconds(std::llround(seconds * 1e6));
  auto params = navigator::LoadParams(config_folder);
  params.use_lidar_nmea = false;
  params.navigator.use_lidar_odometry = pose_case.has_odometry;
  bus::MemoryBus bus;
  Judge judge(scene, boat, pose_case);
  bus.SubscribeAll([&judge](std::string_view channel, Bytes bytes) {
    if (channel == bus::kPose.name) judge.OnPose(bus::Decode<pose_t>(bytes).value());
  });
  navigator::Service service(bus, params);
  const auto handle = [&bus] {
    while (bus.HandleOnce()) continue;
  };
  const auto is_heard = [&pose_case](const sim::Datagram& datagram) {
    if (datagram.port != pose_case.navigation.nmea_port) return false;
    if (IsOfImu(datagram.payload)) return pose_case.has_imu;
    const double time_s = ToSeconds(datagram.time - kSimulationStart);
    return !pose_case.has_gap() || time_s < pose_case.gap_begin_s || time_s >= pose_case.gap_end_s;
  };
  std::size_t num_motions = 0;
  const auto send_motions = [&](Utime until) {
    for (; num_motions < motions.size() && motions[num_motions].time + kProcessing <= until; ++num_motions) {
      service.AdvanceTo(motions[num_motions].time + kProcessing);
      bus::Publish(bus, bus::kLidarOdometry, motions[num_motions].message);
      handle();
    }
  };
  std::vector<sim::Datagram> waiting;
  while (navigation.next_time() < end) {
    const Utime now = navigation.next_time();
    for (auto& datagram : navigation.Next()) waiting.push_back(std::move(datagram));
    std::ranges::stable_sort(waiting, {}, &sim::Datagram::time);
    auto datagram = waiting.begin();
    for (; datagram != waiting.end() && datagram->time <= now; ++datagram) {
      send_motions(datagram->time);
      service.AdvanceTo(datagram->time);
      if (is_heard(*datagram)) service.OnDatagram(datagram->time, datagram->payload);
      handle();
    }
    waiting.erase(waiting.begin(), datagram);
  }
  service.Finish(end);
  handle();
  auto scores = judge.Finish();
  for (const auto& counter : service.Report().counters) {
    if (counter.name == "gated_fix" || counter.name == "gated_attitude") scores.num_gated += counter.count;
    if (counter.name == "renewed_position" || counter.name == "renewed_attitude") scores.num_renewed += counter.count;
    if (counter.name == "gated_odometry") scores.num_gated_odometry += counter.count;
  }
  return scores;
}

}  // namespace lookout::eval
