#include "lab/sim/navigation.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
namespace format = vlp16::format;
using namespace std::chrono_literals;

constexpr std::uint64_t kGnssStream = 4;
constexpr std::uint64_t kAttitudeStream = 7;
constexpr std::uint64_t kLatencyStream = 8;

// All measurements are made at multiples of the first period, the IMU's.
constexpr microseconds kEpochPeriod = Imu::kPeriod;
constexpr microseconds kAttitudePeriod = 20ms;
constexpr microseconds kHeadingPeriod = 50ms;
// Captures of a real VLP-16: 57 position packets in 0.39 s.
constexpr microseconds kPositionPacketPeriod = 7100us;

constexpr microseconds kLatencyJitter = 2ms;
constexpr microseconds kPositionPacketLatency = 60us;

constexpr double kHeaveSdM = 0.01;
constexpr double kRateSdDegpmin = 6.0;       // 0.1 deg/s: the rate gyro of a compass
constexpr double kGeoidSeparationM = -28.0;  // EGM96 in New Hampshire, rounded

// For derivatives of the motion.
constexpr double kDifferenceStepS = 0.01;

// A receiver with RTK, with a differential correction, alone.
constexpr int kQualityRtk = 4;
int QualityOf(double gnss_sd_m) { return gnss_sd_m <= 0.1 ? kQualityRtk : gnss_sd_m <= 1.0 ? 2 : 1; }

// First multiple of `period` at or after `time`.
Utime CeilTo(Utime time, microseconds period) {
  const auto count = time.time_since_epoch() / period;
  const Utime floor = Utime(count * period);
  return floor < time ? floor + period : floor;
}

bool IsMultiple(Utime time, microseconds period) { return time.time_since_epoch() % period == microseconds(0); }

}  // namespace

NavigationParams StandaloneNavigation() {
  NavigationParams params;
  params.gnss_sd_m = 1.5;
  params.gnss_time_constant_s = 60.0;  // satellites, ionosphere and reflections change over minutes
  params.velocity_sd_mps = 0.05;       // Doppler of a receiver without corrections
  params.heading_sd_deg = 2.0;
  params.heading_time_constant_s = 30.0;  // a compass is off by its deviation, which changes as the boat turns
  return params;
}

Navigation::Navigation(const Scene& scene, const config::BoatFacts& boat, const NavigationParams& params, const FaultPlan& plan, Utime start,
                       std::uint64_t seed)
    : own_motion_(scene.own_motion),
      boat_(boat),
      params_(params),
      plan_(plan),
      clock_(plan),
      map_(MapFrame(boat)),
      start_(start),
      gnss_random_(seed, kGnssStream),
      attitude_random_(seed, kAttitudeStream),
      latency_random_(seed, kLatencyStream),
      heading_error_deg_(params.heading_sd_deg, params.heading_time_constant_s),
      imu_(scene.own_motion, boat, params.imu, start, seed),
      next_epoch_(CeilTo(start, kEpochPeriod)),
      next_position_packet_(start + 500us) {
  gnss_error_m_.fill(MeasurementError(params.gnss_sd_m, params.gnss_time_constant_s));
  // The RMC that the lidar had when the simulation began, and the one that was on its way.
  for (Utime second = std::chrono::floor<std::chrono::seconds>(start - kLidarRmcLatency); second < next_epoch_; second += 1s) {
    whole_seconds_.push_back(MeasureGnss(second, 1s));
  }
}

OwnState Navigation::StateAfter(Utime time, double offset_s) const {
  return StateAt(own_motion_, boat_.reference_point_above_water_m, ToSeconds(time - start_) + offset_s);
}

Utime Navigation::next_time() const { return std::min(next_epoch_, next_position_packet_); }

std::vector<Datagram> Navigation::Next() {
  std::vector<Datagram> datagrams;
  if (next_position_packet_ < next_epoch_) {
    if (auto packet = PositionPacket()) datagrams.push_back(std::move(*packet));
    next_position_packet_ += kPositionPacketPeriod;
    return datagrams;
  }
  if (params_.has_heading) {
    if (next_epoch_ >= start_ + Imu::kFirst) AddImu(datagrams);
    if (IsMultiple(next_epoch_, kHeadingPeriod)) {
      const auto heading = MeasureHeading(next_epoch_);
      datagrams.push_back(Line(20ms, Hdt(heading.heading_deg)));
      datagrams.push_back(Line(22ms, Rot(heading.rate_degpmin)));
    }
    if (IsMultiple(next_epoch_, kAttitudePeriod)) {
      datagrams.push_back(Line(15ms, Pashr(MeasureAttitude(next_epoch_), params_.tilt_sd_deg, params_.heading_sd_deg)));
    }
  }
  if (IsMultiple(next_epoch_, microseconds(1s) / params_.gnss_rate_hz)) AddGnss(datagrams);
  std::ranges::stable_sort(datagrams, {}, &Datagram::time);
  next_epoch_ += kEpochPeriod;
  return datagrams;
}

GnssMeasurement Navigation::MeasureGnss(Utime time, microseconds since_last) {
  // With the antenna's swing in the waves.
  const auto antenna_m = [&](double offset_s) -> Eigen::Vector3d { return StateAfter(time, offset_s).T_map_vessel() * boat_.p_vessel_antenna_m; };
  Eigen::Vector3d position_m = antenna_m(0.0);
  Eigen::Vector3d velocity_mps = (antenna_m(kDifferenceStepS) - antenna_m(-kDifferenceStepS)) / (2.0 * kDifferenceStepS);
  for (std::size_t axis = 0; axis < gnss_error_m_.size(); ++axis) {
    const auto index = static_cast<Eigen::Index>(axis);
    position_m[index] += gnss_error_m_[axis].Next(ToSeconds(since_last), gnss_random_);
    velocity_mps[index] += params_.velocity_sd_mps * gnss_random_.Normal();
  }
  position_m.x() += plan_.ValueAt(TimedFaultKind::kGnssJump, time);
  GnssMeasurement result{};
  double ellipsoid_height_m = 0.0;
  map_.Reverse(position_m.x(), position_m.y(), position_m.z(), result.latitude_deg, result.longitude_deg, ellipsoid_height_m);
  result.time = time;
  result.msl_height_m = ellipsoid_height_m - kGeoidSeparationM;
  result.geoid_separation_m = kGeoidSeparationM;
  result.speed_mps = std::hypot(velocity_mps.x(), velocity_mps.y());
  result.course_deg = RadToDeg(WrapTo2Pi(std::atan2(velocity_mps.x(), velocity_mps.y())));
  result.quality = plan_.At(TimedFaultKind::kGnssGap, time) != nullptr ? 0 : QualityOf(params_.gnss_sd_m);
  result.sd_m = params_.gnss_sd_m;
  return result;
}

Navigation::Heading Navigation::MeasureHeading(Utime time) {
  const double error_deg = heading_error_deg_.Next(ToSeconds(kHeadingPeriod), attitude_random_);
  const double rate_error_degpmin = kRateSdDegpmin * attitude_random_.Normal();
  if (plan_.At(TimedFaultKind::kFrozenHeading, time) != nullptr && frozen_heading_) return *frozen_heading_;
  const auto heading_rad = [&](double offset_s) { return StateAfter(time, offset_s).heading_rad; };
  const double rate_radps = WrapToPi(heading_rad(kDifferenceStepS) - heading_rad(-kDifferenceStepS)) / (2.0 * kDifferenceStepS);
  Heading heading;
  heading.heading_deg = RadToDeg(WrapTo2Pi(heading_rad(0.0) + DegToRad(error_deg - params_.heading_offset_deg)));
  heading.rate_degpmin = 60.0 * RadToDeg(rate_radps) + rate_error_degpmin;
  frozen_heading_ = heading;
  return heading;
}

AttitudeMeasurement Navigation::MeasureAttitude(Utime time) {
  const auto state = StateAfter(time, 0.0);
  AttitudeMeasurement result{};
  result.time = time;
  // Between two headings of the compass the gyroscopes of the attitude sensor carry the heading, and with it the error of the compass.
  const bool is_frozen = plan_.At(TimedFaultKind::kFrozenHeading, time) != nullptr && frozen_heading_;
  result.heading_deg = is_frozen ? frozen_heading_->heading_deg
                                 : RadToDeg(WrapTo2Pi(state.heading_rad + DegToRad(heading_error_deg_.value() - params_.heading_offset_deg)));
  result.roll_deg = RadToDeg(state.roll_rad) + params_.tilt_sd_deg * attitude_random_.Normal() - params_.roll_offset_deg;
  result.pitch_deg = RadToDeg(state.pitch_rad) + params_.tilt_sd_deg * attitude_random_.Normal() - params_.pitch_offset_deg;
  result.heave_m = state.heave_m + kHeaveSdM * attitude_random_.Normal();
  result.has_rtk = QualityOf(params_.gnss_sd_m) == kQualityRtk;
  return result;
}

// Latency from measurement to arrival: a receiver computes and sends by serial line, one sentence after the other; a compass and an attitude sensor
// are quicker; an IMU's 118 characters take 1.3 ms at 921 600 baud.
Datagram Navigation::Line(microseconds latency, const std::string& sentence) {
  const auto jitter = microseconds(static_cast<std::int64_t>(static_cast<double>(kLatencyJitter.count()) * latency_random_.Uniform()));
  return {next_epoch_ + latency + jitter, params_.nmea_port, {sentence.begin(), sentence.end()}};
}

void Navigation::AddGnss(std::vector<Datagram>& datagrams) {
  const auto measurement = MeasureGnss(next_epoch_, microseconds(1s) / params_.gnss_rate_hz);
  datagrams.push_back(Line(100ms, Rmc(measurement)));
  datagrams.push_back(Line(102ms, Gga(measurement)));
  datagrams.push_back(Line(104ms, Vtg(measurement)));
  datagrams.push_back(Line(106ms, Gst(measurement)));
  if (!IsMultiple(next_epoch_, 1s)) return;
  datagrams.push_back(Line(108ms, Zda(next_epoch_)));
  whole_seconds_.push_back(measurement);
  if (whole_seconds_.front().time < next_epoch_ - LidarClock::kOldestRmc - 1s) whole_seconds_.pop_front();
}

void Navigation::AddImu(std::vector<Datagram>& datagrams) {
  auto datagram = Line(2ms, VnImu(imu_.Measure(next_epoch_)));
  if (plan_.At(TimedFaultKind::kImuStop, next_epoch_) == nullptr) datagrams.push_back(std::move(datagram));
}

// The sentence in a position packet: the last RMC that has come, empty before the first.
std::string Navigation::LidarSentence(Utime time) const {
  const auto second = clock_.SecondOfRmc(time);
  const auto found = second ? std::ranges::find(whole_seconds_, *second, &GnssMeasurement::time) : whole_seconds_.end();
  if (found == whole_seconds_.end()) return {};
  auto told = *found;
  told.time += clock_.RmcError(*second);
  return Rmc(told);
}

std::optional<Datagram> Navigation::PositionPacket() {
  const Utime time = next_position_packet_;
  if (!clock_.IsOn(time)) return std::nullopt;
  Datagram packet{time + kPositionPacketLatency, params_.position_port, std::vector<std::uint8_t>(format::kPositionPacketSizeBytes)};
  WriteU32LittleEndian(packet.payload, format::kPositionStampOffset, clock_.StampUs(time));
  packet.payload[format::kPpsOffset] = clock_.Pps(time);
  std::ranges::copy(LidarSentence(time), packet.payload.begin() + static_cast<std::ptrdiff_t>(format::kSentenceOffset));
  return packet;
}

}  // namespace lookout::sim
