#include "tools/sim/simulation.hpp"

#include <algorithm>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kNetworkStream = 5;

// From the last shot of a packet to its arrival: sending takes 100 us at 100 Mbit/s, and the kernel some more.
constexpr std::chrono::microseconds kDataLatency = 120us;
constexpr double kDataJitterUs = 60.0;

}  // namespace

Simulation::Simulation(const Scene& scene, const config::BoatFacts& boat, const SimulationParams& params, TruthWriter* truth)
    : params_(params),
      truth_(truth),
      lidar_(scene, boat, params.lidar, params.start, params.seed),
      navigation_(scene, boat, params.navigation, params.start, params.seed),
      random_(params.seed, kNetworkStream) {}

void Simulation::Fill() {
  if (!lidar_datagram_) {
    const LidarPacket packet = lidar_.Next();
    const auto jitter = std::chrono::microseconds(static_cast<std::int64_t>(kDataJitterUs * random_.Uniform()));
    lidar_datagram_ = Datagram{packet.end_time + kDataLatency + jitter, params_.data_port, {packet.payload.begin(), packet.payload.end()}};
    if (truth_ != nullptr && lidar_datagram_->time <= params_.start + params_.duration) {
      truth_->AddReturns(packet.returns);
      truth_->AdvanceTo(packet.end_time);
    }
  }
  // Whatever is measured later also arrives later.
  while (navigation_.next_time() <= lidar_datagram_->time) {
    for (auto& datagram : navigation_.Next()) {
      const auto place = std::ranges::upper_bound(navigation_datagrams_, datagram.time, {}, &Datagram::time);
      navigation_datagrams_.insert(place, std::move(datagram));
    }
  }
}

std::optional<Datagram> Simulation::Next() {
  Fill();
  Datagram next;
  if (!navigation_datagrams_.empty() && navigation_datagrams_.front().time < lidar_datagram_->time) {
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
