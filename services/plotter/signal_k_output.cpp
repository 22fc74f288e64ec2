#include "services/plotter/signal_k_output.hpp"

#include <algorithm>
#include <utility>

namespace lookout::plotter {

SignalKOutput::SignalKOutput(const OutputParams& params, std::unique_ptr<Link> link, const std::string& boat)
    : Output(params, std::move(link)), boat_(BoatWord(boat)) {}

// The boat may have other sources of its position: one null where ours is not known any more, and then nothing.
void SignalKOutput::SendOwnShip(const Told& told) {
  if (!params().sends_own_ship || told.own.is_estimated) return;
  if (!told.own.is_placed() && !was_placed_) return;
  if (Send(OwnShipDelta(told.own))) was_placed_ = told.own.is_placed();
}

void SignalKOutput::SendTargets(const Told& told) {
  for (const auto& ended : targets_.TakeEnded(told.targets)) EndTarget(ended, told);
  places_.Keep(told.targets, told.passed);
  for (const auto* target : targets_.Due(told.targets, told.passed)) {
    const int place = places_.Of(target->id, told.passed);
    if (!Send(TargetDelta(TargetContext(boat_, place), *target, told.own.time))) return;
    if (params().targets_as_vessels && !Send(TargetDelta(VesselContext(boat_, place), *target, told.own.time))) return;
    targets_.NoteSent(*target, told.own.time, place, told.passed);
  }
}

// Freeboard-SK takes no null for a position, and draws the vessel for minutes where it was last: by its name it says that it is gone.
void SignalKOutput::EndTarget(const TargetSchedule::Sent& ended, const Told& told) {
  SendSurely(TargetEndDelta(TargetContext(boat_, ended.number), told.own.time));
  if (!params().targets_as_vessels) return;
  SendSurely(TargetEndDelta(VesselContext(boat_, ended.number), told.own.time, "lost: " + TargetName(ended.target)));
}

// A server shows the last values until it is told otherwise.
void SignalKOutput::EndTargets(const Told& told) {
  for (const auto& ended : targets_.TakeEnded({})) EndTarget(ended, told);
}

void SignalKOutput::SendNotices(const Told& told) {
  std::vector<Notice> notices(told.notices.begin(), told.notices.end());
  for (auto& notice : notices) {
    if (notice.sound == Sound::kSilenced) notice.sound = Sound::kQuiet;
    notice.escalation = EscalationOf(notice);
  }
  for (const auto& [notice, revision, is_repeat] : notices_.Take(notices, told.passed)) {
    const auto key = RaisedKeyOf(notice);
    const auto [raised, is_new] = raised_.try_emplace(key, Raised{NoticeWord(notice), notice});
    const Notice& last = raised->second.notice;
    const bool is_graver = notice.level > last.level || notice.escalation != last.escalation;
    if (!is_new && notice.state == NoticeState::kActive && (last.state != NoticeState::kActive || is_graver)) {
      auto ended = last;
      ended.state = NoticeState::kCleared;
      SendSurely(NoticeDelta(ended, raised->second.word, told.host_time), raised->second.word);
      raised->second.word = NoticeWord(notice);
      raised->second.is_heard_loud = false;
    }
    if (notice.sound != last.sound) raised->second.is_heard_loud = false;
    raised->second.notice = notice;
    SendSurely(NoticeDelta(notice, raised->second.word, told.host_time), raised->second.word);
  }
  // An ended notice is told again for a while, under its own word.
  if (raised_.size() > kMostRaised) std::erase_if(raised_, [](const auto& one) { return one.second.notice.state == NoticeState::kCleared; });
}

void SignalKOutput::SendAnew() {
  targets_.SendAnew();
  notices_.SendAnew();
  ended_words_.clear();
  // A server tells first what it has kept, which may be from before.
  for (auto& [key, raised] : raised_) raised.is_heard_loud = false;
  // Where something comes back.
  const auto kind = params().destination.kind;
  if (kind == Destination::Kind::kWebSocket || kind == Destination::Kind::kTcpClient) SendSurely(NoticeSubscription());
}

// A server keeps notifications of an earlier process.
void SignalKOutput::EndLeftover(const NoticeEcho& echo, const Told& told) {
  const bool is_known = std::ranges::any_of(raised_, [&echo](const auto& one) { return one.second.word == echo.word; });
  if (is_known || !echo.is_raised || ended_words_.size() >= kMostRaised || !ended_words_.insert(echo.word).second) return;
  Notice ended;
  ended.state = NoticeState::kCleared;
  ended.text = "told by a process that has ended";
  SendSurely(NoticeDelta(ended, echo.word, told.host_time), echo.word);
}

Commands SignalKOutput::Read(const std::string& message, const Told& told) {
  const auto read = ReadDelta(message);
  if (read.is_wrong) CountRefused();
  for (const auto& echo : read.echoes) EndLeftover(echo, told);
  Commands commands;
  for (const auto& notice : told.notices) {
    const auto raised = raised_.find(RaisedKeyOf(notice));
    // A notice that was told as acknowledged or over went out without sound, and comes back so.
    if (notice.id == 0 || raised == raised_.end() || raised->second.notice.state != notice.state) continue;
    const bool is_active = notice.state == NoticeState::kActive;
    if (!is_active && notice.state != NoticeState::kRectified) continue;
    // So did an active one that is not the one that sounds; and one that a server has kept from before.
    const bool is_loud = raised->second.notice.sound == Sound::kSounds && raised->second.is_heard_loud;
    const bool is_acknowledged = std::ranges::any_of(read.echoes, [&](const NoticeEcho& echo) {
      const bool is_quiet = echo.is_quiet && (is_loud || !echo.is_raised);
      return echo.word == raised->second.word && (echo.is_acknowledged || (is_active && is_quiet));
    });
    if (is_acknowledged) commands.acknowledged.push_back(KeyOf(notice));
    for (const auto& echo : read.echoes) {
      if (echo.word == raised->second.word && echo.is_raised && !echo.is_quiet) raised->second.is_heard_loud = true;
    }
  }
  return commands;
}

}  // namespace lookout::plotter
