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

/// Of a look, in centimetres rounded down: distances below MavSectors::min_distance_cm are that, as receivers take no nearer ones. A sector in which
/// nothing is within the distance is clear (max_distance + 1) where somebody looked, else unknown.
MavSectors ToMavSectors(const Look& look, Utime time, double max_distance_m);

/// Of a look in which somebody looked: the nearest place of each sector, nearest first; where none is within the distance, one beyond it, which
/// empties a receiver's fence.
std::vector<MavPoint> ToMavPoints(const Look& look, Utime time, double max_distance_m);

class MavlinkOutput : public Output {
 public:
  static constexpr std::chrono::seconds kHeartbeatPeriod{1};

  MavlinkOutput(const OutputParams& params, std::unique_ptr<Link> link)
      : Output(params, std::move(link)),
        writer_(params.mavlink.system_id, params.mavlink.component_id),
        heartbeats_name_("output_" + params.name + "_heartbeats") {}

  /// Those of the link; output_NAME_heartbeats: of an autopilot, that came back.
  std::vector<Counter> counters() const override;

 private:
  void SendOwnShip(const Told& /*told*/) override {}
  void SendTargets(const Told& /*told*/) override {}
  /// Nothing where nobody looked into any direction. Of points as many as leave a serial port within 0.1 s, what waits there included. Before the
  /// first distances goes the text that the look-out begins or is back.
  void SendLook(const Told& told) override;
  /// And the heartbeat.
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  Commands Read(const std::string& message, const Told& told) override;
  int most_read() const override { return 64; }  // all that waits: an autopilot sends its state by itself

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
