// NMEA 2000 as text for one receiver: programs that read what a gateway hears.
#pragma once

#include "services/plotter/core/nmea2000.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "services/plotter/output.hpp"

namespace lookout::plotter {

class N2kOutput : public Output {
 public:
  N2kOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period)
      : Output(params, std::move(link)), targets_(target_period) {}

 protected:
  void SendNotices(const Told& /*told*/) override {}  // NMEA 2000's alerts want a device that answers their group functions
  void SendAnew() override { targets_.Forget(); }
  /// The message as text to be sent: whole lines.
  virtual std::string Text(const N2kMessage& message, Utime time);
  /// Whether messages may be sent now.
  virtual bool IsReady() const { return true; }
  /// Sequence number of the next fast packet, 0 to 7.
  int NextSequence();

 private:
  void SendOwnShip(const Told& told) override;
  void SendTargets(const Told& told) override;

  TargetSchedule targets_;
  int sequence_ = 0;
};

}  // namespace lookout::plotter
