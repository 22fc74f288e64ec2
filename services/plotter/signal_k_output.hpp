// Signal K for one receiver.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/core/signal_k.hpp"
#include "services/plotter/core/target_places.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "services/plotter/output.hpp"

namespace lookout::plotter {

class SignalKOutput : public Output {
 public:
  /// Also of standing targets: a display drops targets that come no more.
  static constexpr std::chrono::seconds kTargetPeriod{1};

  SignalKOutput(const OutputParams& params, std::unique_ptr<Link> link, const std::string& boat);

 private:
  void SendOwnShip(const Told& told) override;
  void SendTargets(const Told& told) override;
  void EndTargets(const Told& told) override;
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  Commands Read(const std::string& message, const Told& told) override;

  void EndTarget(const TargetSchedule::Sent& ended, const Told& told);
  void EndLeftover(const NoticeEcho& echo, const Told& told);

  std::string boat_;
  TargetSchedule targets_{kTargetPeriod};
  TargetPlaces places_;
  NoticeSchedule notices_;
  // A notice in the state that was told last.
  struct Raised {
    std::string word;
    Notice notice;
    bool is_heard_loud =
        false;  // the notification came back with sound since it was last told so; if it comes back without sound now, a person silenced it
  };
  static constexpr std::size_t kMostRaised = 1000;
  std::map<RaisedKey, Raised> raised_;
  std::set<std::string> ended_words_;  // words of notices of earlier processes that were ended
  bool was_placed_ = false;
};

}  // namespace lookout::plotter
