#include "services/tracker/service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "services/tracker/alert_text.hpp"

namespace lookout::tracker {

namespace {

// Acknowledgements that wait for a scan: people do not press buttons more often.
constexpr std::size_t kMaxAcknowledgements = 100;
constexpr std::size_t kMaxOrders = 20;
// Room in ALERTS for the words on the guard zone.
constexpr int kZoneTextBytes = 4096;
constexpr std::int32_t kFlagsOfSecond = std::int32_t{obstacles_t::FLAG_SECOND_HOLE} | std::int32_t{obstacles_t::FLAG_SECOND_SILENT};

}  // namespace

Service::Service(bus::Bus& bus, const Params& params, RunContext context)
    : bus_(bus), params_(params), context_(std::move(context)), gatherer_(context_.sources, params.wait_timeout) {
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan, [this](const lidar_scan_t& message) { OnBeams(message); });
  bus::Subscribe<segments_t>(bus_, bus::kSegments, [this](const segments_t& message) { OnLabels(message); });
  bus::Subscribe<pose_t>(bus_, bus::kPose, [this](const pose_t& message) { OnPose(message); });
  bus::Subscribe<obstacles_t>(bus_, bus::kObstacles, [this](const obstacles_t& message) { OnObstacles(message); });
  bus::Subscribe<alert_ack_t>(bus_, bus::kAlertAck, [this](const alert_ack_t& message) { OnAcknowledgement(message); });
  bus::Subscribe<order_t>(bus_, bus::kOrders, [this](const order_t& message) { OnOrder(message); });
}

void Service::OnObstacles(const obstacles_t& message) {
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return obstacles_refused_.Add(*fault);
  obstacles_watch_.Note();
  if (message.num_parts == 1 && obstacles_parts_.is_empty()) return AddObstacles({&message, 1});
  const auto ended = obstacles_parts_.Add(message);
  if (!ended.incomplete.empty()) AddObstacles(ended.incomplete);
  if (!ended.whole.empty()) AddObstacles(ended.whole);
}

void Service::AddObstacles(std::span<const obstacles_t> parts) {
  LeftOut left_out;
  auto obstacles = ToObstacles(parts, left_out);
  if (!obstacles) {
    ++counts_["obstacles_inconsistent"];
    return;
  }
  counts_["obstacles_not_placed"] += left_out.num_not_placed;
  counts_["obstacles_without_covariance"] += left_out.num_without_covariance;
  counts_["obstacles_over_limit"] += left_out.num_over_limit;
  Use(gatherer_.Add(std::move(*obstacles)));
}

void Service::OnBeams(const lidar_scan_t& message) {
  if (!context_.sources.has_beams) return;
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return beams_refused_.Add(*fault);
  other_watches_[0].Note();
  if (message.num_parts == 1 && beams_parts_.is_empty()) return AddBeams({&message, 1}, true);
  const auto ended = beams_parts_.Add(message);
  if (!ended.incomplete.empty()) AddBeams(ended.incomplete, false);
  if (!ended.whole.empty()) AddBeams(ended.whole, true);
}

void Service::AddBeams(std::span<const lidar_scan_t> parts, bool is_whole) {
  std::optional<ScanBeams> beams;
  if (is_whole) beams = ToBeams(parts);
  if (!beams) {
    if (is_whole) ++counts_["beams_inconsistent"];
    beams.emplace();
    beams->key = KeyOf(parts.front());
    beams->is_whole = false;
  }
  Use(gatherer_.Add(std::move(*beams)));
}

void Service::OnLabels(const segments_t& message) {
  if (!context_.sources.has_labels) return;
  const bool is_fitting = messages::IsWellFormed(message);
  if (const auto fault = messages::FaultOf(message, bus::kMaxMessageBytes)) return labels_refused_.Add(*fault);
  if (!is_fitting) return labels_refused_.Add(messages::kSegmentsCount);
  other_watches_[1].Note();
  if (message.num_parts == 1 && labels_parts_.is_empty()) return AddLabels({&message, 1}, true);
  const auto ended = labels_parts_.Add(message);
  if (!ended.incomplete.empty()) AddLabels(ended.incomplete, false);
  if (!ended.whole.empty()) AddLabels(ended.whole, true);
}

void Service::AddLabels(std::span<const segments_t> parts, bool is_whole) {
  std::optional<ScanLabels> labels;
  if (is_whole) labels = ToLabels(parts);
  if (!labels) {
    labels.emplace();
    labels->key = KeyOf(parts.front());
    labels->is_whole = is_whole;  // without labels they do not fit, and are counted so
  }
  Use(gatherer_.Add(std::move(*labels)));
}

void Service::OnPose(const pose_t& message) {
  const auto pose = messages::ToPose(message);
  if (const auto* fault = std::get_if<messages::Fault>(&pose)) return poses_refused_.Add(*fault);
  other_watches_[2].Note();
  const bool is_new_run = pose_seq_ && message.seq < *pose_seq_;
  pose_seq_ = message.seq;
  Use(gatherer_.Add(std::get<Pose>(pose), is_new_run));
}

void Service::OnAcknowledgement(const alert_ack_t& message) {
  if (const auto fault = messages::FaultOf(message)) return acknowledgements_refused_.Add(*fault);
  if (context_.script) return;  // it says when each was taken
  const auto acknowledgement = ToAcknowledgement(message);
  if (acknowledgement.alert_id < 0) {
    counts_.Add(watch_.Acknowledge(acknowledgement) ? "acks_taken" : "acks_of_no_alert");
  } else if (acknowledgements_.size() >= kMaxAcknowledgements) {
    ++counts_["acks_dropped"];
  } else {
    acknowledgements_.push_back(acknowledgement);
  }
}

void Service::OnOrder(const order_t& message) {
  if (const auto fault = messages::FaultOf(message)) return orders_refused_.Add(*fault);
  if (context_.script) return;
  // Silence is of what sounds now. Where no scan comes it would wait, and begin with the look-out.
  const bool is_late = message.kind == order_t::KIND_SILENCE && watch_.is_failing();
  if (is_late || orders_.size() >= kMaxOrders) {
    ++counts_["orders_dropped"];
  } else {
    orders_.push_back(ToOrder(message));
  }
}

void Service::AdvanceTo(Utime host_time) {
  now_ = host_time;
  obstacles_watch_.AdvanceTo(host_time);
  for (auto& watch : other_watches_) watch.AdvanceTo(host_time);
  Use(gatherer_.AdvanceTo(host_time));
  watch_.AdvanceTo(host_time);
  if (watch_.TakeTurn()) SendWatch();
}

bool Service::TakeWatchChange() { return std::exchange(reported_failing_, watch_.is_failing()) != watch_.is_failing(); }

void Service::Finish() {
  for (auto& scan : gatherer_.Finish()) {
    if (context_.script && context_.script->stretches.back().last < scan.key()) {
      ++counts_["scans_not_of_the_live_run"];  // its process was stopped while this one waited
    } else {
      Use(scan);
    }
  }
}

void Service::Use(std::vector<GatheredScan> scans) {
  for (auto& scan : scans) Use(scan);
}

void Service::Use(GatheredScan& scan) {
  if (!FollowScript(scan.key())) {
    ++counts_["scans_not_of_the_live_run"];
    return;
  }
  if (!memory_) {
    Begin(scan.key());
    if (const auto& before = context_.before) {
      memory_->kept.Keep(before->time, before->datum, before->alerts, before->tracks);
      memory_->kept_names.Keep(before->time, before->datum, before->names, before->tracks);
    }
  } else if (scan.is_anew && memory_->picture != nullptr) {
    Keep(label_->datum, Eigen::Vector2d::Zero());
    memory_->tracker.Reset();
    memory_->look_out.ForgetTracks();
  } else if (memory_->tracker.BeginsAnewWith(scan.input) && memory_->picture != nullptr) {
    KeepBesideBoat(scan.input);
    memory_->look_out.ForgetTracks();
  }
  auto& look_out = memory_->look_out;
  if (label_ && (scan.is_anew || !scan.input.datum.IsSameAs(label_->datum))) look_out.ForgetMap();
  const auto& input = scan.input;
  // The look-out goes on without the second lidar; but what that saw may still be there.
  watch_.NoteScan(input.time, (input.flags & ~kFlagsOfSecond) == 0);
  WatchForCovers(scan.input);
  const bool is_whole = input.flags == 0 && !memory_->cover.covers_anew();
  is_placed_ = input.own.has_value();
  if (input.own) memory_->own = input.own;

  const auto orders = TakeOrders(input);
  memory_->tracker.SetEncounter({look_out.Begin(input.own).cpa_limit_m, params_.tracker.encounter.look_ahead_s});
  const Picture& picture = memory_->tracker.Update(input);
  look_out.Rename(picture, input.end_time);
  const auto acknowledged = TakeAcknowledgements(input, picture);
  const auto& alerts = look_out.Update(input.end_time, is_whole, picture, scan.outlines, input.own, LookForUnseen(input));

  const double own_up_m = input.own ? input.own->position_map_m.z() : label_ ? label_->own_up_m : 0.0;
  label_ = {scan.key(), memory_->begin, input.end_time, scan.raw_seq, input.flags, input.datum, own_up_m};
  for (const auto& message : ToMessages(*label_, picture, bus::kMaxMessageBytes)) bus::Publish(bus_, bus::kTracks, message);
  auto message =
      ToMessage(*label_, {alerts, acknowledged, orders, look_out.sounding(), look_out.silenced_until(), look_out.limits(), look_out.names().All()},
                picture, bus::kMaxMessageBytes - kZoneTextBytes);
  TellOfUnseen(message);
  counts_["alerts_untold"] += static_cast<std::int64_t>(alerts.size()) - message.num_alerts;
  bus::Publish(bus_, bus::kAlerts, message);
  HandOver(message, picture);

  memory_->picture = &picture;
  num_alerts_ = std::ranges::count_if(alerts, [](const Alert& alert) { return alert.state != AlertState::kCleared; });
}

// Before all tracks are forgotten.
// @param shift_m  by which everything lies elsewhere on the map of the datum
void Service::Keep(const Datum& datum, const Eigen::Vector2d& shift_m) {
  const auto& look_out = memory_->look_out;
  auto tracks = memory_->picture->tracks;
  for (auto& track : tracks) track.position_m += shift_m;
  memory_->kept.Keep(label_->end_time, datum, look_out.alerts(), tracks);
  memory_->kept_names.Keep(label_->end_time, datum, look_out.names().All(), tracks);
}

// The own position jumped, or the map has another datum: things lie from the boat as they did. Axes of a frame that is not on the earth lie otherwise
// than those of any other map: another thing may be where the acknowledged one would be.
void Service::KeepBesideBoat(const ScanInput& input) {
  if (!input.datum.IsSameAs(label_->datum) && (input.datum.IsRelative() || label_->datum.IsRelative())) return;
  const auto& own = memory_->own;
  if (!own || !input.own) return;
  Eigen::Vector2d shift_m = (input.own->position_map_m - own->position_map_m).head<2>();
  if (own->velocity_map_mps.allFinite()) shift_m -= ToSeconds(input.own->time - own->time) * own->velocity_map_mps;
  Keep(input.datum, shift_m);
}

void Service::Begin(const ScanKey& begin) {
  memory_ = std::make_unique<Memory>(params_);
  memory_->begin = begin;
}

// @return whether the live run used this scan too, as far as is known
bool Service::FollowScript(const ScanKey& key) {
  if (!context_.script) return true;
  const auto& stretches = context_.script->stretches;
  const auto is_reached = [&](std::size_t i) {
    if (key == stretches[i].first) return true;
    // Where it begins in the past of the one before, with its very first scan alone.
    const bool is_later = i == 0 || stretches[i - 1].last < stretches[i].first;
    return is_later && stretches[i].first < key;
  };
  for (; next_stretch_ < stretches.size() && is_reached(next_stretch_); ++next_stretch_) {
    const auto& begin = stretches[next_stretch_].begin;
    if (memory_ && memory_->begin == begin) continue;
    Begin(begin);
  }
  if (next_stretch_ == 0) return false;  // before the first
  // Else between the end of one process and the begin of the next.
  const auto& now = stretches[next_stretch_ - 1];
  return next_stretch_ == stretches.size() || stretches[next_stretch_].begin == now.begin || !(key < now.first || now.last < key);
}

// Of people, and such as people gave before the lidar, the navigator or this process began anew. A script has both.
std::vector<Acknowledgement> Service::TakeAcknowledgements(const ScanInput& input, const Picture& picture) {
  if (context_.script) {
    const auto found = context_.script->acknowledged.find({input.time, input.seq});
    if (found != context_.script->acknowledged.end()) acknowledgements_.assign(found->second.begin(), found->second.end());
  } else {
    const auto kept = memory_->kept.Take(input.end_time, input.datum, memory_->look_out.alerts(), picture.tracks);
    acknowledgements_.insert(acknowledgements_.end(), kept.begin(), kept.end());
  }
  std::vector<Acknowledgement> taken;
  for (const auto& acknowledgement : std::exchange(acknowledgements_, {})) {
    if (memory_->look_out.Acknowledge(acknowledgement, input.end_time)) {
      ++counts_["acks_taken"];
      taken.push_back(acknowledgement);
    } else {
      ++counts_["acks_of_no_alert"];
    }
  }
  return taken;
}

std::vector<Order> Service::TakeOrders(const ScanInput& input) {
  if (context_.script) {
    const auto found = context_.script->orders.find({input.time, input.seq});
    if (found != context_.script->orders.end()) orders_ = found->second;
  } else if (memory_->picture != nullptr) {
    const auto kept = memory_->kept_names.Take(label_->end_time, label_->datum, memory_->picture->tracks, memory_->look_out.names());
    // The alerts that the process before left come from a file.
    std::ranges::copy_if(kept, std::back_inserter(orders_), [](const Order& order) { return !messages::FaultOf(ToMessage(order)); });
  }
  auto taken = std::exchange(orders_, {});
  for (const auto& order : taken) memory_->look_out.Take(order, input.end_time);
  if (std::ranges::any_of(taken, [](const Order& order) { return order.kind == OrderKind::kSettings; })) {
    memory_->zone_sight.SetZone(memory_->look_out.WholeZone());
  }
  counts_["orders_taken"] += static_cast<std::int64_t>(taken.size());
  return taken;
}

// Beams of a covered sector that show nothing end at the lidar: nobody knows what is behind.
void Service::WatchForCovers(ScanInput& input) {
  auto& cover = memory_->cover;
  if (!input.sweep) return cover.Skip(input.end_time);
  auto& sweep = *input.sweep;
  const std::size_t num_rings = sweep.elevation_rad.size();
  cover.Begin();
  for (std::size_t column = 0; column < sweep.azimuth_rad.size(); ++column) {
    const auto range_m = std::span(sweep.range_m).subspan(column * num_rings, num_rings);
    cover.AddColumn(static_cast<double>(sweep.azimuth_rad[column]), sweep.azimuth_offset_rad, sweep.elevation_rad, range_m);
  }
  cover.End(input.end_time);
  if (!cover.covers_any()) return;
  for (std::size_t cell = 0; cell < sweep.range_m.size(); ++cell) {
    const double azimuth_rad =
        static_cast<double>(sweep.azimuth_rad[cell / num_rings]) + static_cast<double>(sweep.azimuth_offset_rad[cell % num_rings]);
    sweep.range_m[cell] = cover.EndOf(azimuth_rad, sweep.range_m[cell]);
  }
}

// A part of the guard zone that nobody looks into, a lidar that is covered, and a second lidar that is silent, are alerts like others: decided by the
// scans, so that a replay gives the same.
std::vector<Danger> Service::LookForUnseen(const ScanInput& input) {
  std::vector<Danger> unseen;
  const auto add = [&unseen](std::int64_t thing, double bearing_rad = kNan, bool is_grave = false) {
    unseen.push_back(
        {.cause = AlertCause::kWatch, .thing = thing, .probability = 1.0, .distance_m = kNan, .bearing_rad = bearing_rad, .is_grave = is_grave});
  };
  memory_->is_second_silent = (input.flags & obstacles_t::FLAG_SECOND_SILENT) != 0;
  if (memory_->is_second_silent) add(kUnseenBySecond);
  const auto& cover = memory_->cover;
  if (const auto parts = cover.parts(); !parts.empty() && cover.num_told() > 0) {
    memory_->cover_text = TextOf(parts);
    const auto& bearing = parts.front().bearing;
    const bool is_one = parts.size() == 1 && bearing.width_rad < kTwoPi;
    add(kSeesNothing - cover.num_told(), is_one ? WrapTo2Pi(bearing.start_rad + bearing.width_rad / 2.0) : kNan, cover.is_all_round());
  }
  if (cover.sees_nothing()) add(kSeesNothing);
  auto& zone_sight = memory_->zone_sight;
  if (input.sweep) zone_sight.Update(input.end_time, *input.sweep);
  if (const auto danger = zone_sight.danger()) {
    memory_->zone_text = TextOf(zone_sight.parts(), zone_sight.is_whole());
    unseen.push_back(*danger);
  }
  return unseen;
}

// Words on what is not seen, which no alert holds.
void Service::TellOfUnseen(alerts_t& message) const {
  const auto& alerts = memory_->look_out.alerts();
  for (auto& alert : message.alerts) {
    const auto of_look_out = std::ranges::find(alerts, alert.id, &Alert::id);
    if (of_look_out == alerts.end() || of_look_out->cause != AlertCause::kWatch) continue;
    const auto thing = of_look_out->thing;
    if (thing == kUnseenBySecond || thing == kSeesNothing) continue;
    const bool is_of_cover = thing < kSeesNothing;
    const bool is_seen = is_of_cover ? memory_->cover.num_lasting() == 0 : memory_->zone_sight.parts().empty();
    const bool is_over = alert.state >= alert_t::STATE_RECTIFIED && is_seen;
    if (is_of_cover) {
      alert.text = is_over ? "nothing covers the lidar any more" : memory_->cover_text;
    } else {
      alert.text = is_over ? "look-out in all of the guard zone again" : memory_->zone_text;
    }
  }
}

// Live only: for the process that is started when this one is gone.
void Service::HandOver(const alerts_t& message, const Picture& picture) const {
  if (!context_.hand_over) return;
  Picture some;
  std::ranges::copy_if(picture.tracks, std::back_inserter(some.tracks), [&message](const Track& track) {
    return std::ranges::binary_search(message.named_track_id, track.id) || std::ranges::any_of(message.alerts, [&track](const alert_t& alert) {
             return alert.track_id == track.id && alert.state == alert_t::STATE_ACKNOWLEDGED;
           });
  });
  context_.hand_over(message, ToMessages(*label_, some, bus::kMaxMessageBytes).front());
}

// With the number of the last scan, and the alerts as they were.
void Service::SendWatch() {
  if (!label_ || !memory_) return;
  auto alerts = memory_->look_out.alerts();
  std::erase_if(alerts, [](const Alert& one) { return one.state == AlertState::kCleared; });  // that was told once
  const auto& look_out = memory_->look_out;
  auto message = ToMessage(*label_, {alerts, {}, {}, look_out.sounding(), look_out.silenced_until(), look_out.limits(), look_out.names().All()},
                           memory_->picture != nullptr ? *memory_->picture : Picture{}, bus::kMaxMessageBytes / 2);
  TellOfUnseen(message);
  auto alert = ToMessage(*watch_.alert(), std::nullopt);
  alert.text = alert.state == alert_t::STATE_CLEARED ? "look-out again" : "no look-out: " + watch_.Complaint();
  message.is_watch = true;
  if (alert.state == alert_t::STATE_ACTIVE) message.sounding_alert_id = alert.id;
  message.alerts.insert(message.alerts.begin(), std::move(alert));
  message.num_alerts = messages::CountOf(message.alerts);
  bus::Publish(bus_, bus::kAlerts, message);
}

HealthReport Service::Report() const {
  HealthReport report;
  if (memory_) report.counters = memory_->tracker.counters();
  report.counters.push_back({"alerts", num_alerts_});
  report.counters.push_back({"names_of_no_track", memory_ ? memory_->look_out.num_names_of_no_track() : 0});
  report.counters.push_back({"names_over_limit", memory_ ? memory_->look_out.names().num_over_limit() : 0});
  report.counters.push_back({"names_merged", memory_ ? memory_->look_out.names().num_merged() : 0});
  report.counters.push_back({"names_beside", memory_ ? memory_->look_out.names().num_beside() : 0});
  report.counters.push_back({"newcomers_over_limit", memory_ ? memory_->look_out.num_newcomers_over_limit() : 0});
  for (const auto& counter : gatherer_.counters()) report.counters.push_back(counter);
  auto counts = counts_;
  const auto add_parts = [&counts](const auto& assembler) {
    counts["parts_duplicate"] += assembler.counts().duplicate_parts;
    counts["parts_inconsistent"] += assembler.counts().inconsistent_parts;
  };
  add_parts(obstacles_parts_);
  add_parts(beams_parts_);
  add_parts(labels_parts_);
  counts.AppendTo(report.counters);
  report.counters.push_back({"times_unwatched", watch_.num_failures()});
  report.counters.push_back({"lidar_covered_deg", memory_ ? memory_->cover.num_lasting() * 360 / std::int64_t{CoverWatch::kNumSectors} : 0});
  report.counters.push_back({"guard_zone_unseen_deg", memory_ ? memory_->zone_sight.unseen_deg() : 0});
  obstacles_refused_.AppendTo(report.counters);
  beams_refused_.AppendTo(report.counters);
  labels_refused_.AppendTo(report.counters);
  poses_refused_.AppendTo(report.counters);
  acknowledgements_refused_.AppendTo(report.counters);
  orders_refused_.AppendTo(report.counters);

  if (const auto complaint = watch_.Complaint(); !complaint.empty()) report.Degrade("no look-out: " + complaint);
  if (memory_ && memory_->is_second_silent) report.Degrade("no look-out by the second lidar");
  if (memory_ && memory_->cover.num_lasting() > 0) report.Degrade(memory_->cover_text);
  if (memory_ && memory_->cover.sees_nothing()) report.Degrade(std::string(kSeesNothingText));
  if (memory_ && !memory_->zone_sight.parts().empty()) report.Degrade(memory_->zone_text);
  if (!is_placed_) report.Degrade("no position or heading: what is seen is not tracked");
  if (const auto text = obstacles_watch_.Complaint(); !text.empty()) report.Degrade(text);
  if (const auto text = InputWatch::Complaint(other_watches_); !text.empty()) report.Degrade(text);
  if (now_ && gatherer_.last_timeout() && *now_ - *gatherer_.last_timeout() < kInputSilence) {
    report.Degrade("LIDAR_SCAN, SEGMENTS or POSE do not come with OBSTACLES: nothing is held against a track that is not seen");
  }
  return report;
}

}  // namespace lookout::tracker
