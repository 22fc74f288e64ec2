#include "tools/sim/navigation.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "services/vlp16/core/packet_format.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
namespace format = vlp16::format;
using namespace std::chrono_literals;

constexpr std::uint64_t kNavigationStream = 4;

constexpr microseconds kEpochPeriod = 50ms;  // PASHR at 20 Hz; all others at divisors of it
constexpr microseconds kHeadingPeriod = 100ms;
// Captures of a real VLP-16: 57 position packets in 0.39 s.
constexpr microseconds kPositionPacketPeriod = 7100us;

// From measurement to arrival: a receiver computes for some 50 ms and sends by serial line; an attitude sensor is quicker.
constexpr microseconds kRmcLatency = 60ms;
constexpr microseconds kGgaLatency = 65ms;
constexpr microseconds kVtgLatency = 68ms;
constexpr microseconds kHdtLatency = 20ms;
constexpr microseconds kPashrLatency = 15ms;
constexpr microseconds kLatencyJitter = 2ms;
// The lidar's line has 9600 baud: 80 characters take 83 ms.
constexpr microseconds kLidarRmcLatency = 150ms;
constexpr microseconds kPositionPacketLatency = 60us;

constexpr double kHeadingSdDeg = 0.1;  // two antennas a metre apart
constexpr double kTiltSdDeg = 0.05;
constexpr double kHeaveSdM = 0.01;
constexpr double kVelocitySdMps = 0.02;
constexpr double kGeoidSeparationM = -28.0;  // EGM96 in New Hampshire, rounded

// A receiver with RTK, with a differential correction, alone.
int QualityOf(double gnss_sd_m) { return gnss_sd_m <= 0.1 ? 4 : gnss_sd_m <= 1.0 ? 2 : 1; }

// First multiple of `period` at or after `time`.
Utime CeilTo(Utime time, microseconds period) {
  const auto count = time.time_since_epoch() / period;
  const Utime floor = Utime(count * period);
  return floor < time ? floor + period : floor;
}

bool IsMultiple(Utime time, microseconds period) { return time.time_since_epoch() % period == microseconds(0); }

}  // namespace

GeographicLib::LocalCartesian MapFrame(const config::BoatFacts& boat) {
  const auto datum = boat.datum.value_or(kLakeDatum);
  return {datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m};
}

Navigation::Navigation(const Scene& scene, const config::BoatFacts& boat, const NavigationParams& params, Utime start, std::uint64_t seed)
    : own_motion_(scene.own_motion),
      boat_(boat),
      params_(params),
      map_(MapFrame(boat)),
      start_(start),
      random_(seed, kNavigationStream),
      next_epoch_(CeilTo(start, kEpochPeriod)),
      next_position_packet_(start + 500us) {
  // The RMC that the lidar had when the simulation began.
  const Utime second = std::chrono::floor<std::chrono::seconds>(start - kLidarRmcLatency);
  next_rmc_ = second + kLidarRmcLatency;
}

double Navigation::SceneTimeS(Utime time) const { return ToSeconds(time - start_); }

Utime Navigation::next_time() const { return std::min(next_epoch_, next_position_packet_); }

std::vector<Datagram> Navigation::Next() {
  std::vector<Datagram> datagrams;
  if (next_position_packet_ < next_epoch_) {
    datagrams.push_back(PositionPacket());
    next_position_packet_ += kPositionPacketPeriod;
    return datagrams;
  }
  AddAttitude(datagrams);
  AddGnss(datagrams);
  std::ranges::stable_sort(datagrams, {}, &Datagram::time);
  next_epoch_ += kEpochPeriod;
  return datagrams;
}

GnssMeasurement Navigation::MeasureGnss(Utime time) {
  constexpr double kStepS = 0.01;  // for the antenna's velocity, with its swing in the waves
  const auto antenna_m = [&](double time_s) -> Eigen::Vector3d {
    return StateAt(own_motion_, boat_.reference_point_above_water_m, time_s).T_map_vessel() * boat_.p_vessel_antenna_m;
  };
  const double time_s = SceneTimeS(time);
  Eigen::Vector3d position_m = antenna_m(time_s);
  Eigen::Vector3d velocity_mps = (antenna_m(time_s + kStepS) - antenna_m(time_s - kStepS)) / (2.0 * kStepS);
  for (int axis = 0; axis < 3; ++axis) {
    position_m[axis] += params_.gnss_sd_m * random_.Normal();
    velocity_mps[axis] += kVelocitySdMps * random_.Normal();
  }
  GnssMeasurement result{};
  double ellipsoid_height_m = 0.0;
  map_.Reverse(position_m.x(), position_m.y(), position_m.z(), result.latitude_deg, result.longitude_deg, ellipsoid_height_m);
  result.time = time;
  result.msl_height_m = ellipsoid_height_m - kGeoidSeparationM;
  result.geoid_separation_m = kGeoidSeparationM;
  result.speed_mps = std::hypot(velocity_mps.x(), velocity_mps.y());
  result.course_deg = RadToDeg(WrapTo2Pi(std::atan2(velocity_mps.x(), velocity_mps.y())));
  result.quality = QualityOf(params_.gnss_sd_m);
  return result;
}

AttitudeMeasurement Navigation::MeasureAttitude(Utime time) {
  const auto state = StateAt(own_motion_, boat_.reference_point_above_water_m, SceneTimeS(time));
  AttitudeMeasurement result{};
  result.time = time;
  result.heading_deg = RadToDeg(WrapTo2Pi(state.heading_rad + DegToRad(kHeadingSdDeg * random_.Normal() - params_.heading_offset_deg)));
  result.roll_deg = RadToDeg(state.roll_rad) + kTiltSdDeg * random_.Normal() - params_.roll_offset_deg;
  result.pitch_deg = RadToDeg(state.pitch_rad) + kTiltSdDeg * random_.Normal() - params_.pitch_offset_deg;
  result.heave_m = state.heave_m + kHeaveSdM * random_.Normal();
  return result;
}

Datagram Navigation::Line(Utime measured, microseconds latency, const std::string& sentence) {
  const auto jitter = microseconds(static_cast<std::int64_t>(static_cast<double>(kLatencyJitter.count()) * random_.Uniform()));
  return {measured + latency + jitter, params_.nmea_port, {sentence.begin(), sentence.end()}};
}

void Navigation::AddGnss(std::vector<Datagram>& datagrams) {
  if (!IsMultiple(next_epoch_, microseconds(1s) / params_.gnss_rate_hz)) return;
  const auto measurement = MeasureGnss(next_epoch_);
  datagrams.push_back(Line(next_epoch_, kRmcLatency, Rmc(measurement)));
  datagrams.push_back(Line(next_epoch_, kGgaLatency, Gga(measurement)));
  datagrams.push_back(Line(next_epoch_, kVtgLatency, Vtg(measurement)));
}

void Navigation::AddAttitude(std::vector<Datagram>& datagrams) {
  if (!params_.has_heading) return;
  const auto measurement = MeasureAttitude(next_epoch_);
  datagrams.push_back(Line(next_epoch_, kPashrLatency, Pashr(measurement, kTiltSdDeg, kHeadingSdDeg)));
  if (IsMultiple(next_epoch_, kHeadingPeriod)) datagrams.push_back(Line(next_epoch_, kHdtLatency, Hdt(measurement.heading_deg)));
}

Datagram Navigation::PositionPacket() {
  while (next_rmc_ <= next_position_packet_) {
    lidar_rmc_ = Rmc(MeasureGnss(next_rmc_ - kLidarRmcLatency));
    next_rmc_ += 1s;
  }
  Datagram packet{next_position_packet_ + kPositionPacketLatency, params_.position_port, std::vector<std::uint8_t>(format::kPositionPacketSizeBytes)};
  const auto past_hour = next_position_packet_ - std::chrono::floor<std::chrono::hours>(next_position_packet_);
  WriteU32LittleEndian(packet.payload, format::kPositionStampOffset, static_cast<std::uint32_t>(past_hour / 1us));
  packet.payload[format::kPpsOffset] = format::kPpsLocked;
  std::ranges::copy(lidar_rmc_, packet.payload.begin() + static_cast<std::ptrdiff_t>(format::kSentenceOffset));
  return packet;
}

}  // namespace lookout::sim
