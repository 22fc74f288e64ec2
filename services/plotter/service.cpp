#include "services/plotter/service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include "services/plotter/core/notice_schedule.hpp"

namespace lookout::plotter {

namespace {

using namespace std::chrono_literals;

// Between POSE and TRACKS: farther apart they are not of one time.
constexpr auto kMostApart = 2s;
// An acknowledgement that was sent takes effect with the next scan: the same one again is none.
constexpr auto kAcknowledgedFor = 1s;
constexpr auto kNoticePeriod = 100ms;
// A caution of the plotter's own, as the tracker's.
constexpr auto kSoundsOnce = 1s;

bool Holds(const Notice& notice) { return notice.state == NoticeState::kActive || notice.state == NoticeState::kAcknowledged; }

}  // namespace

Service::Service(bus::Bus& bus, const Params& params, std::vector<std::unique_ptr<Output>> outputs)
    : bus_(bus), params_(params), outputs_(std::move(outputs)), numbers_(params.number_quarantine) {
  bus::Subscribe<tracks_t>(bus_, bus::kTracks, [this](const tracks_t& message) { OnTracks(message); });
  bus::Subscribe<alerts_t>(bus_, bus::kAlerts, [this](const alerts_t& message) { OnAlerts(message); });
  bus::Subscribe<pose_t>(bus_, bus::kPose, [this](const pose_t& message) { OnPose(message); });
  bus::Subscribe<ais_t>(bus_, bus::kAis, [this](const ais_t& message) { OnAis(message); });
  if (params_.surroundings) SubscribeSurroundings();
}

// Large messages, and nobody else here wants them.
void Service::SubscribeSurroundings() {
  surroundings_.emplace(*params_.surroundings);
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan, [this](const lidar_scan_t& message) { surroundings_->OnScan(0, message); });
  bus::Subscribe<segments_t>(bus_, bus::kSegments, [this](const segments_t& message) { surroundings_->OnLabels(0, message); });
  if (params_.surroundings->lidars.size() < 2) return;
  bus::Subscribe<lidar_scan_t>(bus_, bus::kLidarScan2, [this](const lidar_scan_t& message) { surroundings_->OnScan(1, message); });
  bus::Subscribe<segments_t>(bus_, bus::kSegments2, [this](const segments_t& message) { surroundings_->OnLabels(1, message); });
}

bool Service::IsFresh(std::optional<std::chrono::microseconds> seen) const { return seen && passed_.passed() - *seen < kFresh; }

bool Service::MayTellTargets() const {
  return IsFresh(alerts_seen_) && IsFresh(tracks_seen_) && IsFresh(pose_seen_) && own_.is_placed() &&
         std::chrono::abs(own_.time - tracks_time_) <= kMostApart;
}

// Distances need no place on the earth.
bool Service::MayTellLook() const {
  const auto says_nobody_looks = [](const Notice& notice) { return notice.cause == Cause::kWatch && Holds(notice); };
  return surroundings_ && has_pose_ && IsFresh(alerts_seen_) && IsFresh(tracks_seen_) && IsFresh(pose_seen_) &&
         std::chrono::abs(own_.time - tracks_time_) <= kMostApart && std::ranges::none_of(alerts_, says_nobody_looks);
}

// An autopilot gets distances, and no targets.
bool Service::TellsTargets() const {
  return std::ranges::any_of(outputs_, [](const auto& output) { return output->params().format != Format::kMavlink; });
}

Told Service::ToldNow() const {
  return {.passed = passed_.passed(),
          .own = own_,
          .targets = targets_,
          .numbers = numbers_,
          .notices = notices_,
          .host_time = now_.value_or(Utime()),
          .somebody_looks = MayTellLook() && IsFresh(look_told_) && (!sight_lost_ || IsFresh(sight_lost_))};
}

void Service::TellLook(std::span<const tracks_t> parts) {
  if (!MayTellLook()) return;
  look_told_ = passed_.passed();
  const auto look = surroundings_->LookAt(parts);
  if (std::ranges::find(look.is_looked, true) != look.is_looked.end()) {
    sight_lost_.reset();
  } else if (!sight_lost_) {
    sight_lost_ = passed_.passed();
  }
  auto told = ToldNow();
  told.look = &look;
  told.look_time = tracks_time_;
  for (const auto& output : outputs_) output->TellLook(told);
}

void Service::OnTracks(const tracks_t& message) {
  if (const auto part = ToTracksPart(message); const auto* refusal = std::get_if<Fault>(&part)) return tracks_refused_.Add(*refusal);
  if (message.num_parts == 1 && parts_.is_empty()) return UseTracks({&message, 1});
  const auto ended = parts_.Add(message);
  if (!ended.incomplete.empty()) ++counts_["tracks_incomplete"];
  if (!ended.whole.empty()) UseTracks(ended.whole);
}

void Service::UseTracks(std::span<const tracks_t> parts) {
  std::vector<Target> tracks;
  std::optional<Utime> begin;
  Utime time;
  for (const auto& message : parts) {
    auto part = std::get<TracksPart>(ToTracksPart(message));
    const bool is_behind = tracks.empty() || part.targets.empty() || tracks.back().id < part.targets.front().id;
    if (!is_behind || (begin && *begin != part.begin)) {
      ++counts_["tracks_inconsistent"];
      return;
    }
    begin = part.begin;
    time = part.time;
    std::ranges::move(part.targets, std::back_inserter(tracks));
  }
  // TRACKS that came before say nothing about the present.
  if (time == tracks_time_ && begin == begin_) return;
  tracks_seen_ = passed_.passed();
  if (begin_ && begin != begin_) {
    // Another process of the tracker: its ids are of other things.
    ++counts_["runs_begun"];
    tracks_.clear();
    names_.clear();
    ComposeTargets();
    for (const auto& output : outputs_) output->TellTargets(ToldNow());
  }
  begin_ = begin;
  tracks_time_ = time;
  tracks_ = std::move(tracks);
  TellLook(parts);
  if (!MayTellTargets()) return;
  are_told_ = true;
  ComposeTargets();
  for (const auto& output : outputs_) output->TellTargets(ToldNow());
}

void Service::ComposeTargets() {
  std::map<std::int64_t, Level> levels;
  for (const auto& notice : alerts_) {
    if (Holds(notice)) levels[notice.track_id] = std::max(levels[notice.track_id], notice.level);
  }
  std::vector<Target> targets;
  const double ahead_s = ToSeconds(own_.time - tracks_time_);
  for (const auto& track : tracks_) {
    if (track.state == TargetState::kLost || (track.state == TargetState::kAcquiring && !params_.takes_tentative)) continue;
    Target& target = targets.emplace_back(track);
    target.position = Propagated(track.position, track.velocity_east_mps, track.velocity_north_mps, ahead_s);
    const auto* ship = ShipOf(track.id);
    if (const auto name = names_.find(track.id); name != names_.end()) {
      target.given_name = name->second;
    } else if (ship != nullptr) {
      target.given_name = *ship;
    }
    if (target.tcpa_s > 0.0) target.tcpa_s = std::max(0.0, target.tcpa_s - ahead_s);
    if (const auto level = levels.find(track.id); level != levels.end() && track.id != 0) target.level = level->second;
    // The receiver has a ship on air by AIS, so the target is left out. Dangerous targets, and ships that AIS may have dropped, are told all the
    // same.
    const bool is_on_air = ship != nullptr && ships_->on_air.contains(track.id);
    if (is_on_air && !params_.sends_ais_targets && !IsDangerous(target)) targets.pop_back();
  }
  std::set<std::int64_t> ids;
  for (const auto& target : targets) ids.insert(target.id);
  for (const auto& before : targets_) {
    if (!ids.contains(before.id)) numbers_.Release(before.id, passed_.passed());
  }
  std::ranges::sort(targets, IsMoreDangerous);
  targets_ = std::move(targets);
  numbers_.Assign(targets_, passed_.passed());
}

void Service::OnAlerts(const alerts_t& message) {
  auto notices = ToNotices(message);
  if (const auto* refusal = std::get_if<Fault>(&notices)) return alerts_refused_.Add(*refusal);
  // An alert is worth more than how a thing is called.
  auto names = ToGivenNames(message);
  if (!names) ++counts_["names_refused"];
  names_ = std::move(names).value_or(GivenNames{});
  alerts_seen_ = passed_.passed();
  alerts_ = std::get<std::vector<Notice>>(std::move(notices));
  TellNotices();
}

void Service::TellNotices() {
  notices_told_ = passed_.passed();
  ComposeNotices();
  for (const auto& output : outputs_) output->TellNotices(ToldNow());
}

void Service::OnAis(const ais_t& message) {
  auto ships = ToShipNames(message);
  if (!ships) {
    ++counts_["ais_refused"];
    return;
  }
  ships_ = std::move(ships);
}

// Her name, where AIS of these tracks or of those shortly before says which ship the track is.
const std::string* Service::ShipOf(std::int64_t track_id) const {
  if (!ships_ || ships_->tracks_begin != begin_ || std::chrono::abs(tracks_time_ - ships_->time) > kMostApart) return nullptr;
  const auto found = ships_->name_of_track.find(track_id);
  return found == ships_->name_of_track.end() ? nullptr : &found->second;
}

void Service::OnPose(const pose_t& message) {
  const auto pose = messages::ToPose(message);
  if (const auto* refusal = std::get_if<Fault>(&pose)) return poses_refused_.Add(*refusal);
  const auto own = ToOwnShip(message);
  if (has_pose_ && own.time == own_.time) return;  // the same again says nothing of now
  if (surroundings_) surroundings_->OnPose(std::get<Pose>(pose));
  own_ = own;
  has_pose_ = true;
  pose_seen_ = passed_.passed();
  if (own_told_ && passed_.passed() - *own_told_ < params_.own_ship_period) return;
  own_told_ = passed_.passed();
  for (const auto& output : outputs_) output->TellOwnShip(ToldNow());
}

// The plotter's own. As long as it holds it was raised when it was.
std::optional<Notice> Service::OwnNotice() const {
  if (!now_) return std::nullopt;
  Notice notice;
  notice.raised = *now_;
  notice.changed = *now_;
  if (!IsFresh(alerts_seen_)) {
    notice.cause = Cause::kWatch;
    notice.level = Level::kWarning;
    notice.text = "no look-out: the tracker is silent";
  } else if (!IsFresh(pose_seen_) || (has_pose_ && !own_.is_placed())) {
    notice.cause = Cause::kPosition;
    notice.level = Level::kCaution;
    notice.text = "no own position: targets are not shown";
  } else {
    return std::nullopt;
  }
  if (own_notice_ && own_notice_->cause == notice.cause) notice = *own_notice_;
  // One sounds: while ALERTS come theirs.
  const bool is_new = *now_ - notice.raised < kSoundsOnce && *now_ >= notice.raised;
  const bool sounds = notice.level == Level::kWarning || (is_new && std::ranges::find(alerts_, Sound::kSounds, &Notice::sound) == alerts_.end());
  notice.sound = sounds ? Sound::kSounds : Sound::kQuiet;
  return notice;
}

void Service::ComposeNotices() {
  own_notice_ = OwnNotice();
  notices_ = alerts_;
  for (auto& notice : notices_) notice.is_old = !IsFresh(alerts_seen_);
  if (own_notice_) notices_.push_back(*own_notice_);
  std::map<std::pair<std::int64_t, Utime>, std::chrono::microseconds> since;
  for (auto& notice : notices_) {
    const std::pair key(KeyOf(notice), notice.changed);
    const auto known = unchanged_since_.find(key);
    // A notice that was there before this process is as old as the host's clock says.
    const auto age = now_ ? std::chrono::duration_cast<std::chrono::microseconds>(*now_ - notice.changed) : 0us;
    const auto begin = known != unchanged_since_.end() ? known->second : passed_.passed() - std::max(age, 0us);
    if (now_) since.emplace(key, begin);
    notice.unchanged_for = passed_.passed() - begin;
  }
  unchanged_since_ = std::move(since);
}

void Service::StopTargets() {
  are_told_ = false;
  for (const auto& output : outputs_) output->StopTargets(ToldNow());
}

void Service::AdvanceTo(Utime host_time) {
  // This process, or the computer, stood still: earlier messages are of then.
  if (now_ && host_time - *now_ > kFresh) tracks_seen_ = alerts_seen_ = pose_seen_ = passed_.passed() - kFresh;
  now_ = host_time;
  const bool is_first = passed_.passed() == 0us;
  passed_.Advance(host_time);
  // Waiting begins with the first call.
  if (is_first) {
    for (auto* seen : {&tracks_seen_, &alerts_seen_, &pose_seen_}) *seen = seen->value_or(passed_.passed());
  }
  if (!MayTellLook()) sight_lost_.reset();
  const bool is_watched = IsFresh(alerts_seen_);
  if (was_watched_ && !is_watched) ++counts_["times_unwatched"];
  was_watched_ = is_watched;
  if (!notices_told_ || passed_.passed() - *notices_told_ >= kNoticePeriod) {
    TellNotices();
    // Again and again: an output that is closed now learns it when it is opened.
    if (!MayTellTargets()) StopTargets();
  }
  TakeCommands();
}

void Service::TakeCommands() {
  std::erase_if(acknowledged_, [this](const auto& one) { return passed_.passed() - one.second >= kAcknowledgedFor; });
  for (const auto& output : outputs_) {
    const auto commands = output->TakeCommands(ToldNow());
    for (const auto key : commands.acknowledged) Acknowledge(key);
    if (commands.silences) Silence();
  }
}

void Service::Acknowledge(std::int64_t key) {
  const auto notice = std::ranges::find_if(alerts_, [key](const Notice& one) { return one.id == key; });
  const bool is_wanted = notice != alerts_.end() && (notice->state == NoticeState::kActive || notice->state == NoticeState::kRectified);
  if (!is_wanted || !now_) {
    ++counts_["acks_of_no_alert"];
    return;
  }
  if (!acknowledged_.emplace(key, passed_.passed()).second) return;
  bus::Publish(bus_, bus::kAlertAck, ToMessage(*notice, *now_, ack_seq_++));
  ++counts_["acks_sent"];
}

void Service::Silence() {
  if (!now_ || (silenced_ && passed_.passed() - *silenced_ < kAcknowledgedFor)) return;
  silenced_ = passed_.passed();
  bus::Publish(bus_, bus::kOrders, ToSilence(*now_, order_seq_++));
  ++counts_["silences_sent"];
}

void Service::Finish() {
  for (const auto& output : outputs_) output->Finish(ToldNow());
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = {{"targets", static_cast<std::int64_t>(targets_.size())},
                     {"targets_told", are_told_ ? 1 : 0},
                     {"numbers_used", numbers_.num_used()},
                     {"targets_without_number", numbers_.num_without()},
                     {"number_overflows", numbers_.num_overflows()}};
  counts_.AppendTo(report.counters);
  tracks_refused_.AppendTo(report.counters);
  alerts_refused_.AppendTo(report.counters);
  poses_refused_.AppendTo(report.counters);
  if (surroundings_) surroundings_->AppendTo(report.counters);
  std::int64_t num_refused = 0;
  std::int64_t num_dropped = 0;
  for (const auto& output : outputs_) {
    const auto counters = output->counters();
    report.counters.insert(report.counters.end(), counters.begin(), counters.end());
    num_refused += output->num_refused();
    num_dropped += output->num_dropped();
  }
  report.counters.push_back({"lines_refused", num_refused});
  report.counters.push_back({"lines_dropped", num_dropped});
  if (outputs_.empty()) return report;

  if (!now_) return report;
  const auto silence_s = [this](std::optional<std::chrono::microseconds> seen) {
    return std::chrono::floor<std::chrono::seconds>(passed_.passed() - seen.value_or(0us)).count();
  };
  if (!IsFresh(alerts_seen_)) report.Degrade(fmt::format("no ALERTS for {} s: no look-out, no targets are sent", silence_s(alerts_seen_)));
  if (!IsFresh(tracks_seen_)) report.Degrade(fmt::format("no TRACKS for {} s: no targets are sent", silence_s(tracks_seen_)));
  if (!IsFresh(pose_seen_)) {
    report.Degrade(fmt::format("no POSE for {} s: neither own ship nor targets are sent", silence_s(pose_seen_)));
  } else if (has_pose_ && !own_.is_placed() && TellsTargets()) {
    report.Degrade("the own position is not known: no targets are sent");
  } else if (IsFresh(tracks_seen_) && std::chrono::abs(own_.time - tracks_time_) > kMostApart) {
    report.Degrade("POSE and TRACKS are not of one time: no targets are sent");
  }
  if (MayTellLook() && sight_lost_ && !IsFresh(sight_lost_)) {
    report.Degrade("LIDAR_SCAN and SEGMENTS of TRACKS do not come, or POSE does not reach over them: no distances are sent");
  }
  if (numbers_.num_without() > 0) report.Degrade(fmt::format("{} targets without a number: 00 to 99 are used up", numbers_.num_without()));
  for (const auto& output : outputs_) {
    if (const auto fault = output->fault(); !fault.empty()) report.Degrade(fmt::format("output '{}': {}", output->params().name, fault));
  }
  return report;
}

std::vector<std::string> Service::TakeRemarks() {
  std::set<std::string> remarks;
  std::vector<std::string> news;
  for (const auto& output : outputs_) {
    const auto remark = output->link().remark();
    if (remark.empty()) continue;
    const auto line = fmt::format("output '{}': {}", output->params().name, remark);
    if (!remarks_.contains(line)) news.push_back(line);
    remarks.insert(line);
  }
  remarks_ = std::move(remarks);
  return news;
}

}  // namespace lookout::plotter
