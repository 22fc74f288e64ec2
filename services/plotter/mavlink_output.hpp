// MAVLink 2 for one autopilot.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/plotter/core/mavlink.hpp"
#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/output.hpp"

namespace lookout::plotter {

/// The distances of a look, in centimetres rounded down. Distances below MavSectors::min_distance_cm are raised to it, as receivers ignore nearer
/// ones. A sector with nothing within `max_distance_m` is clear (max_distance + 1) where somebody looked, else unknown.
MavSectors ToMavSectors(const Look& look, Utime time, double max_distance_m);

/// The nearest place of each sector within `max_distance_m`, nearest first; where there is none, one place beyond that distance, which empties a
/// receiver's fence. Precondition: somebody looked in some direction.
std::vector<MavPoint> ToMavPoints(const Look& look, Utime time, double max_distance_m);

class MavlinkOutput : public Output {
 public:
  static constexpr std::chrono::seconds kHeartbeatPeriod{1};

  MavlinkOutput(const OutputParams& params, std::unique_ptr<Link> link)
      : Output(params, std::move(link)),
        writer_(params.mavlink.system_id, params.mavlink.component_id),
        heartbeats_name_("output_" + params.name + "_heartbeats") {}

  /// Counters of the link; output_NAME_heartbeats: heartbeats of an autopilot that came back.
  std::vector<Counter> counters() const override;

 private:
  void SendOwnShip(const Told& /*told*/) override {}
  void SendTargets(const Told& /*told*/) override {}
  /// Sends nothing where nobody looked in any direction. Sends as many points as leave a serial port within 0.1 s, including the bytes that wait
  /// there. Before the first distances goes the text that the look-out begins or is back.
  void SendLook(const Told& told) override;
  /// Sends due notices and the heartbeat.
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  Commands Read(const std::string& message, const Told& told) override;
  int most_read() const override { return 64; }  // all waiting messages: an autopilot sends its state unasked

  void SendText(MavSeverity severity, std::string_view text);
  void TellWhetherSomebodyLooks(const Told& told);

  MavlinkWriter writer_;
  NoticeSchedule notices_;
  std::optional<std::chrono::microseconds> heartbeat_sent_;
  std::optional<bool> told_looks_;
  MavlinkReader reader_;
  std::string heartbeats_name_;
  std::int64_t num_heartbeats_ = 0;
};

}  // namespace lookout::plotter
