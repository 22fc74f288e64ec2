// The AIS process without its clock: NAV_RAW, TRACKS and POSE in, AIS out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/health.hpp"
#include "common/core/input_watch.hpp"
#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "common/messages/pose_message.hpp"
#include "services/ais/core/gatherer.hpp"
#include "services/ais/core/watcher.hpp"
#include "services/ais/params.hpp"
#include "services/ais/wire.hpp"

namespace lookout::ais {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// Live only: host time has come so far. Ten times a second or more.
  void AdvanceTo(Utime host_time);

  /// End of input: waiting scans are used as they are. A live process that is stopped does not call it.
  void Finish();

  std::int64_t num_waiting() const { return gatherer_.num_waiting(); }

  /// @return degraded while TRACKS do not come although AIS does. No AIS at all is no fault
  HealthReport Report() const;

 private:
  void OnNavRaw(const nav_raw_t& message);
  void OnTracks(const tracks_t& message);
  void OnPose(const pose_t& message);
  void Use(const Gatherer::Steps& steps);

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"nav_raw_bad_time", "tracks_incomplete", "parts_duplicate", "parts_inconsistent", "ships_told",
                                       "ships_tracked", "ships_unsure", "ships_ais_only"});

  bus::Bus& bus_;
  Gatherer gatherer_;
  Watcher watcher_;
  messages::PartAssembler<tracks_t> parts_;
  std::int64_t seq_ = 0;
  std::optional<Utime> now_;
  Status status_ = Status::kOk;  // of the last message
  Counts<kCountNames> counts_;   // ships_...: in the last message
  Counts<kTracksFaults> tracks_refused_;
  Counts<messages::kPoseFaults> poses_refused_;
  InputWatch tracks_watch_{bus::kTracks.name};
};

}  // namespace lookout::ais
