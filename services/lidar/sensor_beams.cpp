#include "services/lidar/sensor_beams.hpp"

#include <chrono>
#include <stop_token>

#include "services/lidar/io/sensor_request.hpp"

namespace lookout::lidar {

namespace {

// A sensor answers within some tenths of a second.
constexpr std::chrono::seconds kTimeLimit(3);
constexpr std::chrono::seconds kAskPeriod(10);

}  // namespace

SensorBeams::SensorBeams(const Params& params, Service& service) : service_(service) {
  const bool is_live = params.sources.kind == Sources::Kind::kUdp || params.sources.kind == Sources::Kind::kInterface;
  if (!is_live || !params.other || params.other->sensor_address.empty()) return;
  const SensorAddress sensor{params.other->sensor_address, params.other->sensor_port};
  origin_ = "the sensor at " + sensor.host;
  const auto request = params.other->model == OtherModel::kOuster ? &RequestOusterMetadata : &RequestHesaiAngles;
  fetcher_.emplace([sensor, request](const std::stop_token& stop) { return request(sensor, kTimeLimit, stop); });
}

std::string SensorBeams::Poll(Utime now) {
  if (!fetcher_) return {};
  if (const auto text = fetcher_->Take()) {
    refusal_ = service_.UseBeams(now, *text, origin_);
    asked_ = now;
  }
  // A sensor that starts has other beams, or none yet.
  const bool may_ask = !asked_ || now < *asked_ || now - *asked_ >= kAskPeriod;
  if (may_ask && service_.WantsBeams()) {
    asked_ = now;
    fetcher_->AskAgain();
  }
  auto fault = fetcher_->fault();
  if (fault.empty() && !refusal_.empty()) fault = origin_ + ": " + refusal_;
  if (fault == told_) return {};
  told_ = fault;
  return fault.empty() ? "" : "the beams of the lidar cannot be fetched from " + fault;
}

void SensorBeams::AddTo(HealthReport& report) const {
  if (!fetcher_) return;
  report.counters.push_back({"beam_requests_failed", fetcher_->num_failures()});
  if (!told_.empty() && service_.WantsBeams()) report.Degrade("the beams of the lidar cannot be fetched from " + told_);
}

}  // namespace lookout::lidar
