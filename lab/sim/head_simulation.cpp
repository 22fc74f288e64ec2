#include "lab/sim/head_simulation.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

namespace lookout::sim {
namespace {

// From the last shot of a scan until it has been put together.
constexpr std::chrono::milliseconds kScanLatency{1};

void RefuseFaultsOfLidar(const std::vector<TimedFault>& faults, const Head& head) {
  for (const TimedFault& fault : faults) {
    switch (fault.kind) {
      case TimedFaultKind::kGnssGap:
      case TimedFaultKind::kGnssJump:
      case TimedFaultKind::kFrozenHeading:
      case TimedFaultKind::kImuStop:
        continue;
      default:
        throw std::invalid_argument("fault '" + std::string(FormOf(fault.kind).name) + "': is of packets and clock of a VLP-16; " +
                                    std::string(head.name) + " has whole scans");
    }
  }
}

}  // namespace

HeadSimulation::HeadSimulation(const Scene& scene, const config::BoatFacts& boat, const Head& head, const SimulationParams& params,
                               TruthWriter* truth)
    : params_(params),
      truth_(truth),
      plan_(params.faults, params.start),
      lidar_(scene, boat, head, params.lidar.rotation_rpm, params.lidar.field_of_view, params.start, params.seed),
      navigation_(scene, boat, params.navigation, plan_, params.start, params.seed) {
  RefuseFaultsOfLidar(params.faults, head);
}

std::optional<HeadSimulation::Event> HeadSimulation::Next() {
  const Utime end = params_.start + params_.duration;
  if (!scan_) {
    scan_ = lidar_.Next();
    // A scan past the end is not given, and nothing after it.
    if (truth_ != nullptr && scan_->scan.head.end_time + kScanLatency <= end) {
      truth_->AddReturns(scan_->returns);
      truth_->AdvanceTo(scan_->scan.head.end_time);
    }
  }
  const Utime arrival = scan_->scan.head.end_time + kScanLatency;
  // Measurements that are made later also arrive later.
  while (navigation_.next_time() <= arrival) {
    for (auto& datagram : navigation_.Next()) {
      const auto place = std::ranges::upper_bound(datagrams_, datagram.time, {}, &Datagram::time);
      datagrams_.insert(place, std::move(datagram));
    }
  }
  std::optional<Event> next;
  if (!datagrams_.empty() && datagrams_.front().time < arrival) {
    next = Event{datagrams_.front().time, std::move(datagrams_.front())};
    datagrams_.erase(datagrams_.begin());
  } else {
    next = Event{arrival, std::move(*scan_)};
    scan_.reset();
  }
  if (next->time > end) return std::nullopt;
  return next;
}

}  // namespace lookout::sim
