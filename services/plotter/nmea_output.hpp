// NMEA 0183 for one receiver.
#pragma once

#include <optional>
#include <span>

#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "services/plotter/output.hpp"

namespace lookout::plotter {

class NmeaOutput : public Output {
 public:
  NmeaOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period)
      : Output(params, std::move(link)), targets_(target_period) {}

 private:
  void SendOwnShip(const Told& told) override;
  void SendTargets(const Told& told) override;
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  /// They would not be there when a process that is begun again gives their numbers to others.
  void FinishTargets(const Told& told) override;
  std::vector<std::int64_t> Read(const std::string& message, const Told& told) override;

  std::string Line(const Told& told, const Target& target, int number) const;
  void SendEnded(const Told& told, std::span<const Target> targets);

  TargetSchedule targets_;
  NoticeSchedule notices_;
  int sequence_ = 0;  // of ALF
  std::optional<std::chrono::microseconds> own_ship_sent_;
  std::optional<std::chrono::microseconds> repeat_sent_;
};

}  // namespace lookout::plotter
