// One receiver: its messages, in its language, over its link.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/plotter/core/scene.hpp"
#include "services/plotter/core/sectors.hpp"
#include "services/plotter/core/target_numbers.hpp"
#include "services/plotter/io/link.hpp"
#include "services/plotter/params.hpp"

namespace lookout::plotter {

/// The scene now. Views into the service.
struct Told {
  std::chrono::microseconds passed{0};  // host time, as of PassedTime
  const OwnShip& own;
  std::span<const Target> targets;  // the most dangerous first, propagated to own.time
  const TargetNumbers& numbers;
  std::span<const Notice> notices;
  Utime host_time;
  bool somebody_looks = false;  // ALERTS, TRACKS and POSE are fresh, and no alert says otherwise; known where there is an output of MAVLink
  const Look* look = nullptr;   // of the last TRACKS, in TellLook alone
  Utime look_time = {};         // end of the look's scan
};

/// Commands of people in messages that came back over an output.
struct Commands {
  std::vector<std::int64_t> acknowledged = {};  // notices by KeyOf
  bool silences = false;                        // no sound for a while; alerts stay as they are
};

class Output {
 public:
  Output(OutputParams params, std::unique_ptr<Link> link) : params_(std::move(params)), link_(std::move(link)) {}
  virtual ~Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  const OutputParams& params() const { return params_; }
  const Link& link() const { return *link_; }

  /// Once each own_ship_period, while POSE comes: told.own may say that the position is not known.
  void TellOwnShip(const Told& told);
  /// After each TRACKS, while targets may be told: sends due targets, and once the end of each target that is there no more.
  void TellTargets(const Told& told);
  /// Targets may be told no more: their state is not known. Must be called until they may be told again.
  void StopTargets(const Told& told);
  /// After each TRACKS, while somebody looks, whether or not the boat's place on the earth is known.
  void TellLook(const Told& told);
  /// The process ends in order: targets are ended, notices stay.
  void Finish(const Told& told);
  /// Ten times a second or more: due notices.
  void TellNotices(const Told& told);

  /// Commands received since the last call; empty where this output accepts none.
  Commands TakeCommands(const Told& told);

  /// Why nothing can be sent now; empty = nothing is known to be wrong.
  virtual std::string fault() const { return link_->fault(); }
  virtual std::vector<Counter> counters() const { return link_->counters(); }

  /// Lines that could not be read.
  std::int64_t num_refused() const { return num_refused_; }
  /// Messages that must not be lost but were, as the link accepted too few.
  std::int64_t num_dropped() const { return num_dropped_; }

 protected:
  virtual void SendOwnShip(const Told& told) = 0;
  virtual void SendTargets(const Told& told) = 0;
  virtual void EndTargets(const Told& /*told*/) {}
  virtual void FinishTargets(const Told& told) { EndTargets(told); }
  virtual void SendLook(const Told& /*told*/) {}
  virtual void SendNotices(const Told& told) = 0;
  /// There is a receiver that knows nothing yet: makes all due again.
  virtual void SendAnew() = 0;
  /// A received message, whether or not commands are accepted.
  virtual Commands Read(const std::string& /*message*/, const Told& /*told*/) { return {}; }

  /// Most messages that are read at once: a flood holds nobody up.
  virtual int most_read() const { return 8; }

  /// @return false where the link has no room now, or a message that must not be lost waits: try again
  bool Send(const std::string& message);
  /// A message that must not be lost waits for room. Beyond kMostWaiting the oldest is dropped and counted.
  ///
  /// @param subject  a waiting message of this subject is replaced; empty: of none
  void SendSurely(std::string message, const std::string& subject = {});
  /// Drops waiting messages whose subject begins so.
  void DropWaiting(std::string_view subject_begin);
  static constexpr std::size_t kMostWaiting = 2000;
  std::size_t room_bytes() const { return link_->room_bytes(); }
  std::chrono::microseconds delay() const { return link_->delay(); }
  void CountRefused() { ++num_refused_; }

 private:
  bool IsOpen(std::chrono::microseconds passed);
  void SendWaiting();

  OutputParams params_;
  std::unique_ptr<Link> link_;
  std::int64_t num_openings_ = 0;
  std::int64_t num_refused_ = 0;
  std::int64_t num_dropped_ = 0;
  struct WaitingMessage {
    std::string subject;
    std::string message;
  };
  std::deque<WaitingMessage> waiting_;
  // A receiver that connects again and again must not make everything be sent again and again.
  static constexpr std::chrono::seconds kAnewPeriod{2};
  bool owes_anew_ = false;
  std::optional<std::chrono::microseconds> anew_;
};

}  // namespace lookout::plotter
