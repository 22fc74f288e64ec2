// NMEA 2000 as text for one receiver.
#pragma once

#include "services/plotter/core/nmea2000.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "services/plotter/output.hpp"

namespace lookout::plotter {

class N2kOutput : public Output {
 public:
  N2kOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period)
      : Output(params, std::move(link)), targets_(target_period) {}

 private:
  void SendOwnShip(const Told& told) override;
  void SendTargets(const Told& told) override;
  void SendNotices(const Told& /*told*/) override {}  // NMEA 2000's alerts want an answering device on the network
  void SendAnew() override { targets_.Forget(); }

  std::string Text(const N2kMessage& message, Utime time);

  TargetSchedule targets_;
  int sequence_ = 0;  // of fast packets
};

}  // namespace lookout::plotter
