#include "lab/sim/simulation.hpp"

#include <algorithm>

#include "common/config/text_config.hpp"
#include "config/schema/lidar.pb.h"
#include "config/schema/navigator.pb.h"
#include "services/lidar/core/vlp16/packet_format.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;
namespace format = vlp16::format;

constexpr std::uint64_t kNetworkStream = 5;
constexpr std::uint64_t kSecondNetworkStream = 6;
constexpr std::uint64_t kSecondSeed = 1'000'003;  // added to the first lidar's seed

// From the last shot of a packet to its arrival: sending takes 100 us at 100 Mbit/s, and the kernel some more.
constexpr std::chrono::microseconds kDataLatency = 120us;
constexpr double kDataJitterUs = 60.0;

}  // namespace

SimulationParams ParamsOfConfig(const std::filesystem::path& config_folder, SimulationParams params) {
  const auto lidar_config = config::Load<config::Lidar>(config_folder, "lidar.txtpb");
  const auto navigator = config::Load<config::Navigator>(config_folder, "navigator.txtpb");
  params.lidar.use_vertical_origin_offsets = lidar_config.use_vertical_origin_offsets();
  params.navigation.nmea_port = navigator.nmea_port();
  params.navigation.position_port = lidar_config.position_port();
  params.navigation.heading_offset_deg = navigator.heading_offset_deg();
  params.navigation.pitch_offset_deg = navigator.pitch_offset_deg();
  params.navigation.roll_offset_deg = navigator.roll_offset_deg();
  params.data_port = lidar_config.data_port();
  if (std::filesystem::exists(config_folder / "lidar_2.txtpb")) {
    params.second_data_port = config::Load<config::Lidar>(config_folder, "lidar_2.txtpb").data_port();
  }
  return params;
}

Simulation::Simulation(const Scene& scene, const config::BoatFacts& boat, const SimulationParams& params, TruthWriter* truth)
    : params_(params),
      truth_(truth),
      plan_(params.faults, params.start),
      clock_(plan_),
      lidar_(scene, boat, params.lidar, params.start, params.seed),
      navigation_(scene, boat, params.navigation, plan_, params.start, params.seed),
      random_(params.seed, kNetworkStream),
      second_random_(params.seed, kSecondNetworkStream) {
  if (params.second_data_port == 0 || !boat.lidar_2) return;
  config::BoatFacts of_second = boat;
  of_second.lidar = *boat.lidar_2;
  of_second.T_vessel_lidar = TransformVesselSensor(of_second.lidar);
  second_.emplace(scene, of_second, params.lidar, params.start, params.seed + kSecondSeed);
}

// Its packets are in no truth: what the boat sees is told by the first.
void Simulation::FillSecond() {
  while (second_ && !second_datagram_) {
    LidarPacket packet = second_->Next();
    const auto jitter = std::chrono::microseconds(static_cast<std::int64_t>(kDataJitterUs * second_random_.Uniform()));
    const Utime arrival = packet.end_time + kDataLatency + jitter;
    const bool is_sent = clock_.IsOn(packet.stamp) && clock_.IsOn(packet.end_time);
    if (is_sent) WriteU32LittleEndian(packet.payload, format::kStampOffset, clock_.StampUs(packet.stamp));
    if (is_sent || arrival > params_.start + params_.duration) {
      second_datagram_ = Datagram{arrival, params_.second_data_port, {packet.payload.begin(), packet.payload.end()}};
    }
  }
}

void Simulation::Fill() {
  while (!lidar_datagram_) {
    LidarPacket packet = lidar_.Next();
    const auto jitter = std::chrono::microseconds(static_cast<std::int64_t>(kDataJitterUs * random_.Uniform()));
    const Utime arrival = packet.end_time + kDataLatency + jitter;
    const bool has_ended = arrival > params_.start + params_.duration;
    const bool is_sent = clock_.IsOn(packet.stamp) && clock_.IsOn(packet.end_time);
    // In place of the right stamp.
    if (is_sent) WriteU32LittleEndian(packet.payload, format::kStampOffset, clock_.StampUs(packet.stamp));
    if (truth_ != nullptr && !has_ended) {
      if (is_sent) truth_->AddPacket(packet);
      truth_->AdvanceTo(packet.end_time);
    }
    if (params_.on_packet && is_sent && !has_ended) params_.on_packet(packet);
    // Past the end one that is not sent is as good as one that is: it is not given to anybody.
    if (is_sent || has_ended) lidar_datagram_ = Datagram{arrival, params_.data_port, {packet.payload.begin(), packet.payload.end()}};
  }
  // Measurements that are made later also arrive later.
  while (navigation_.next_time() <= lidar_datagram_->time) {
    for (auto& datagram : navigation_.Next()) {
      const auto place = std::ranges::upper_bound(navigation_datagrams_, datagram.time, {}, &Datagram::time);
      navigation_datagrams_.insert(place, std::move(datagram));
    }
  }
}

std::optional<Datagram> Simulation::Next() {
  Fill();
  FillSecond();
  Datagram next;
  const auto is_before_second = [this](Utime time) { return !second_datagram_ || time <= second_datagram_->time; };
  const auto first_time = std::min(lidar_datagram_->time, navigation_datagrams_.empty() ? lidar_datagram_->time : navigation_datagrams_.front().time);
  if (!is_before_second(first_time)) {
    next = std::move(*second_datagram_);
    second_datagram_.reset();
  } else if (!navigation_datagrams_.empty() && navigation_datagrams_.front().time < lidar_datagram_->time) {
    next = std::move(navigation_datagrams_.front());
    navigation_datagrams_.erase(navigation_datagrams_.begin());
  } else {
    next = std::move(*lidar_datagram_);
    lidar_datagram_.reset();
  }
  if (next.time > params_.start + params_.duration) return std::nullopt;
  return next;
}

}  // namespace lookout::sim
