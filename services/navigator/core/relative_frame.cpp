#include "services/navigator/core/relative_frame.hpp"

#include <algorithm>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::navigator {

namespace {

constexpr std::size_t kMaxNodes = 64;
// At the begin of a frame place and heading are exact by definition.
constexpr double kBeginVariance = 1e-8;
// Motion that is only propagated: a boat changes speed by so much in a second, and its rate of turn.
constexpr double kAccelerationSdMps2 = 0.5;
constexpr double kTurnAccelerationSdRadps2 = 0.1;
// An error of heading that is older turns the map and all that lies on it alike: between what is seen now and a moment ago there is none.
constexpr std::chrono::seconds kHeadingMemory{3};
// A boat that coasts may turn by more, but a greater deviation would take what stands at 50 m for anything within several metres.
constexpr double kMostHeadingSdRad = DegToRad(3.0);

// A heading that comes back differs from the frame's by how far the frame has turned meanwhile. Standing things must not turn at once: the frame
// turns back to north within a minute.
constexpr double kTurnBackTimeS = 30.0;

double Seconds(std::chrono::microseconds duration) { return static_cast<double>(duration.count()) * 1e-6; }

// From forward and port to the frame's x and y, for a heading clockwise from y.
Eigen::Matrix2d RotationFrameVessel(double heading_rad) {
  const auto [sin, cos] = SinCosOf(heading_rad);
  Eigen::Matrix2d rotation;
  rotation << sin, -cos, cos, sin;
  return rotation;
}

// A number that differs in each frame, also in frames of other runs of the process.
double NumberOf(Utime begin) {
  const auto since_1970 = std::chrono::duration_cast<std::chrono::milliseconds>(begin.time_since_epoch()).count();
  return static_cast<double>(std::max<std::int64_t>(1, since_1970));  // readers refuse less
}

}  // namespace

void RelativeFrame::Begin(Utime start) {
  *this = RelativeFrame();
  start_ = start;
}

bool RelativeFrame::MayBegin(Utime time) const {
  if (!start_) return false;
  if (last_earth_) {
    const std::chrono::microseconds known_for = *last_earth_ - *first_earth_;
    return time - *last_earth_ >= std::clamp<std::chrono::microseconds>(known_for, kWaits, kBeginsAfterEarth);
  }
  return time - *start_ >= (has_sentence_ || !has_motion_ ? std::chrono::microseconds(kWaits) : std::chrono::microseconds(kBeginsSilent));
}

// A little earlier, so that the speed is known when it begins.
bool RelativeFrame::Wants(Utime time) const {
  constexpr std::chrono::milliseconds kEarlier{300};
  return is_active_ || MayBegin(time + kEarlier);
}

RelativeFrame::Node RelativeFrame::Moved(const Node& from, Utime time, const Eigen::Vector2d& displacement_m, double turn_rad,
                                         const Eigen::Matrix3d& covariance) {
  const auto rotation = RotationFrameVessel(from.heading_rad);
  const Eigen::Vector2d way_m = rotation * displacement_m;
  Node node{time, from.p_m + way_m, WrapTo2Pi(from.heading_rad + turn_rad)};
  Eigen::Matrix3d by_before = Eigen::Matrix3d::Identity();
  // A heading that is clockwise too far turns the way clockwise: (x, y) to (y, -x).
  by_before(0, 2) = way_m.y();
  by_before(1, 2) = -way_m.x();
  Eigen::Matrix3d by_motion = Eigen::Matrix3d::Identity();
  by_motion.topLeftCorner<2, 2>() = rotation;
  node.covariance = by_before * from.covariance * by_before.transpose() + by_motion * covariance * by_motion.transpose();
  node.covariance = (0.5 * (node.covariance + node.covariance.transpose())).eval();
  return node;
}

RelativeFrame::Node RelativeFrame::Extrapolated(Utime time) const {
  const Node& last = nodes_.back();
  if (!last_known_) return {time, last.p_m, last.heading_rad, last.covariance};
  // Beyond the last known motion and the time of coasting the boat stays where it is.
  const auto from = std::max(last.time, *last_known_);
  const double for_s = std::clamp(Seconds(std::min(time, *last_known_ + kCoasts) - from), 0.0, Seconds(kCoasts));
  const double half_turn_rad = 0.5 * rates_[2] * for_s;
  const auto [sin, cos] = SinCosOf(half_turn_rad);
  const Eigen::Vector2d way_m = rates_.head<2>() * for_s;
  // Along the heading in the middle: clockwise from that at the begin.
  const Eigen::Vector2d displacement_m(cos * way_m.x() + sin * way_m.y(), -sin * way_m.x() + cos * way_m.y());
  const Eigen::Vector3d step(kAccelerationSdMps2, kAccelerationSdMps2, kTurnAccelerationSdRadps2);
  const Eigen::Matrix3d growth = (0.5 * for_s * for_s * step).cwiseAbs2().asDiagonal();
  auto node = Moved(last, time, displacement_m, rates_[2] * for_s, rates_covariance_ * (for_s * for_s) + growth);
  return node;
}

RelativeFrame::Node RelativeFrame::NodeAt(Utime time) const {
  if (time >= nodes_.back().time) return Extrapolated(time);
  const auto after = std::ranges::lower_bound(nodes_, time, {}, &Node::time);
  if (after == nodes_.begin()) return {time, after->p_m, after->heading_rad, after->covariance};
  const Node& before = *std::prev(after);
  const double share = Seconds(time - before.time) / Seconds(after->time - before.time);
  return {time, before.p_m + share * (after->p_m - before.p_m),
          WrapTo2Pi(before.heading_rad + share * WrapToPi(after->heading_rad - before.heading_rad)),
          before.covariance + share * (after->covariance - before.covariance)};
}

void RelativeFrame::Add(const OdometryMotion& motion) {
  NoteMotion();
  if (!motion.is_known) return;
  if (nodes_.empty()) nodes_.push_back({motion.begin});
  // Time went back: what was known of the motion is void, the place stays.
  if (motion.end <= nodes_.back().time) {
    if (motion.end > nodes_.back().time - kCoasts) return;
    Node last = nodes_.back();
    last.time = motion.begin;
    nodes_.assign(1, last);
    last_known_.reset();
  }
  const Node begin = NodeAt(motion.begin);
  if (begin.time > nodes_.back().time) nodes_.push_back(begin);
  const double for_s = Seconds(motion.end - motion.begin);
  nodes_.push_back(Moved(begin, motion.end, motion.displacement_m, motion.turn_rad, motion.covariance));
  // Rates are along the heading at the end of the motion; the mean direction of the way is the heading in the middle of the motion.
  const auto [sin, cos] = SinCosOf(0.5 * motion.turn_rad);
  const auto& way_m = motion.displacement_m;
  rates_ = Eigen::Vector3d(cos * way_m.x() - sin * way_m.y(), sin * way_m.x() + cos * way_m.y(), motion.turn_rad) / for_s;
  rates_covariance_ = motion.covariance / (for_s * for_s);
  last_known_ = motion.end;
  while (nodes_.size() > kMaxNodes) nodes_.pop_front();
}

void RelativeFrame::Activate(const Pose& earth) {
  is_active_ = true;
  ++num_frames_;
  number_ = NumberOf(earth.time);
  if (nodes_.empty()) nodes_.push_back({earth.time});
  const Node here = NodeAt(earth.time);
  const bool has_heading = earth.status == PoseStatus::kNoPosition;
  has_followed_ = has_heading;
  off_north_rad_ = 0.0;
  heading_source_ = has_heading ? earth.heading_source : HeadingSource::kNone;
  const double heading_rad = has_heading ? earth.heading_rad : 0.0;
  const Eigen::Matrix2d turned = RotationFrameVessel(heading_rad) * RotationFrameVessel(here.heading_rad).transpose();
  for (auto& node : nodes_) {
    node.p_m = (turned * (node.p_m - here.p_m)).eval();
    node.heading_rad = WrapTo2Pi(node.heading_rad - here.heading_rad + heading_rad);
    node.covariance = Eigen::Vector3d(kBeginVariance, kBeginVariance, has_heading ? earth.covariance(8, 8) : kBeginVariance).asDiagonal();
  }
}

// Where north is known the filter tells the heading, by compass and motions. The boat keeps its way so far, and goes on along that heading.
void RelativeFrame::FollowHeading(const Pose& earth) {
  if (heading_source_ == HeadingSource::kNone || earth.status != PoseStatus::kNoPosition) {
    has_followed_ = false;
    return;
  }
  const double shown_rad = NodeAt(earth.time).heading_rad;
  if (!has_followed_) off_north_rad_ = IsByLidar(earth.time) ? WrapToPi(shown_rad - earth.heading_rad) : 0.0;
  has_followed_ = true;
  if (last_shown_ && earth.time > *last_shown_) off_north_rad_ *= Exp(-Seconds(earth.time - *last_shown_) / kTurnBackTimeS);
  const double by_rad = WrapToPi(earth.heading_rad + off_north_rad_ - shown_rad);
  for (auto& node : nodes_) node.heading_rad = WrapTo2Pi(node.heading_rad + by_rad);
}

void RelativeFrame::Skip(std::chrono::microseconds duration) {
  for (auto* from : {&start_, &first_earth_, &last_earth_}) {
    if (*from) **from += duration;
  }
}

Pose RelativeFrame::At(const Pose& earth, double tilt_sd_rad) {
  auto pose = Shown(earth, tilt_sd_rad);
  last_shown_ = earth.time;
  return pose;
}

Pose RelativeFrame::Shown(const Pose& earth, double tilt_sd_rad) {
  if (earth.status == PoseStatus::kOk || earth.status == PoseStatus::kCoasting) {
    if (is_active_ || !first_earth_) first_earth_ = earth.time;
    last_earth_ = earth.time;
    is_active_ = false;
    nodes_.clear();
    last_known_.reset();
    return earth;
  }
  if (!is_active_) {
    if (!MayBegin(earth.time)) return earth;
    Activate(earth);
  } else if (heading_source_ == HeadingSource::kNone && earth.status == PoseStatus::kNoPosition && !IsByLidar(earth.time)) {
    // The frame turned with the boat: it begins anew. A frame that has north stands.
    Activate(earth);
  }
  FollowHeading(earth);
  const Node node = NodeAt(earth.time);
  const auto since = last_known_ ? earth.time - *last_known_ : std::chrono::microseconds::max();
  Pose pose = earth;
  pose.status = since <= kFresh ? PoseStatus::kRelative : since <= kCoasts ? PoseStatus::kRelativeCoasting : PoseStatus::kRelativeToBoat;
  pose.heading_source = heading_source_;
  pose.datum = {kNan, kNan, number_};
  // A receiver alone still says where the boat is, but not which way the map lies.
  if (earth.status != PoseStatus::kNoHeading) pose.latitude_deg = pose.longitude_deg = pose.ellipsoid_height_m = kNan;
  pose.p_map_m = {node.p_m.x(), node.p_m.y(), 0.0};
  pose.heading_rad = node.heading_rad;
  pose.velocity_map_mps = Eigen::Vector3d::Constant(kNan);
  pose.covariance = PoseCovariance::Zero();
  pose.covariance.topLeftCorner<2, 2>() = node.covariance.topLeftCorner<2, 2>();
  const double turned_variance = node.covariance(2, 2) - NodeAt(earth.time - kHeadingMemory).covariance(2, 2);
  pose.covariance(8, 8) = std::clamp(turned_variance, kBeginVariance, kMostHeadingSdRad * kMostHeadingSdRad);
  // The map turns with the slow error of a compass.
  if (has_followed_) pose.covariance(8, 8) = std::max(pose.covariance(8, 8), earth.covariance(8, 8));
  for (const int tilt : {6, 7}) pose.covariance(tilt, tilt) = earth.has_attitude ? earth.covariance(tilt, tilt) : tilt_sd_rad * tilt_sd_rad;
  const auto set_unknown = [&pose](int number) {
    pose.covariance.row(number).setConstant(kNan);
    pose.covariance.col(number).setConstant(kNan);
  };
  for (const int height : {2, 5}) set_unknown(height);
  if (pose.status == PoseStatus::kRelativeToBoat) {
    for (const int velocity : {3, 4}) set_unknown(velocity);
    return pose;
  }
  const auto rotation = RotationFrameVessel(node.heading_rad);
  const Eigen::Vector2d velocity_mps = rotation * rates_.head<2>();
  pose.velocity_map_mps = {velocity_mps.x(), velocity_mps.y(), 0.0};
  pose.covariance.block<2, 2>(3, 3) = rotation * rates_covariance_.topLeftCorner<2, 2>() * rotation.transpose();
  return pose;
}

}  // namespace lookout::navigator
