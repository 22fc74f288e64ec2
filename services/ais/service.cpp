#include "services/ais/service.hpp"

#include <variant>

namespace lookout::ais {

Service::Service(bus::Bus& bus, const Params& params) : bus_(bus), gatherer_(params.wait_timeout), watcher_(params.watcher) {
  bus::Subscribe<nav_raw_t>(bus_, bus::kNavRaw, [this](const nav_raw_t& message) { OnNavRaw(message); });
  bus::Subscribe<tracks_t>(bus_, bus::kTracks, [this](const tracks_t& message) { OnTracks(message); });
  bus::Subscribe<pose_t>(bus_, bus::kPose, [this](const pose_t& message) { OnPose(message); });
}

void Service::OnNavRaw(const nav_raw_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  if (!time) {
    ++counts_["nav_raw_bad_time"];
    return;
  }
  const bool is_sentence = message.kind == nav_raw_t::KIND_SENTENCE && message.sentence.starts_with('!');
  if (is_sentence || message.kind == nav_raw_t::KIND_START) return Use(gatherer_.Add(ToItem(message, *time)));
  Use(gatherer_.AddTime(*time));
}

void Service::OnPose(const pose_t& message) {
  const auto result = messages::ToPose(message);
  if (const auto* fault = std::get_if<messages::Fault>(&result)) return poses_refused_.Add(*fault);
  Use(gatherer_.Add(std::get<Pose>(result)));
}

void Service::OnTracks(const tracks_t& message) {
  if (const auto fault = FaultOf(message); !fault.empty()) return tracks_refused_.Add(fault);
  tracks_watch_.Note();
  // A scan that lacks a part is left out: a track that is not told would seem to have ended.
  const auto parts = parts_.Add(message).whole;
  if (parts.empty()) return;
  auto scan = ToScan(parts);
  if (const auto* fault = std::get_if<Fault>(&scan)) return tracks_refused_.Add(*fault);
  Use(gatherer_.Add(std::get<TracksOfScan>(std::move(scan))));
}

void Service::AdvanceTo(Utime host_time) {
  now_ = host_time;
  tracks_watch_.AdvanceTo(host_time);
  Use(gatherer_.AdvanceTo(host_time));
}

void Service::Finish() { Use(gatherer_.Finish()); }

void Service::Use(const Gatherer::Steps& steps) {
  for (const auto& step : steps) {
    if (step.item) {
      if (step.item->is_start) seq_ = 0;
      watcher_.Consume(*step.item);
      continue;
    }
    const auto picture = watcher_.Update(*step.scan, step.own);
    status_ = picture.status;
    // Where there is no AIS nothing is said.
    if (!watcher_.has_heard()) continue;
    bus::Publish(bus_, bus::kAis, ToMessage(*step.scan, picture, seq_++));
    counts_["ships_told"] = static_cast<std::int64_t>(picture.ships.size());
    counts_["ships_tracked"] = counts_["ships_unsure"] = counts_["ships_ais_only"] = 0;
    for (const auto& ship : picture.ships) {
      if (ship.state == ShipState::kTracked) ++counts_["ships_tracked"];
      if (ship.state == ShipState::kUnsure) ++counts_["ships_unsure"];
      if (ship.state == ShipState::kAisOnly) ++counts_["ships_ais_only"];
    }
  }
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = watcher_.counters();
  for (const auto& counter : gatherer_.counters()) report.counters.push_back(counter);
  auto counts = counts_;
  counts["tracks_incomplete"] = parts_.counts().incomplete_scans;
  counts["parts_duplicate"] = parts_.counts().duplicate_parts;
  counts["parts_inconsistent"] = parts_.counts().inconsistent_parts;
  counts.AppendTo(report.counters);
  tracks_refused_.AppendTo(report.counters);
  poses_refused_.AppendTo(report.counters);
  if (!watcher_.has_heard()) return report;
  if (const auto text = tracks_watch_.Complaint(); !text.empty()) report.Degrade(text);
  if (status_ != Status::kOk) report.Degrade("position or heading are not known: no track can be told by AIS");
  if (now_ && gatherer_.last_timeout() && *now_ - *gatherer_.last_timeout() < kInputSilence) {
    report.Degrade("NAV_RAW or POSE do not come with TRACKS: ships are told late");
  }
  return report;
}

}  // namespace lookout::ais
