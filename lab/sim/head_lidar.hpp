// A lidar of the table of heads that looks at a scene: whole scans as LIDAR_SCAN holds them, with the truth about each return. Its packets are not
// made.
#pragma once

#include <cstdint>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "lab/sim/heads.hpp"
#include "lab/sim/lidar.hpp"
#include "lab/sim/rotor.hpp"
#include "lab/sim/scene.hpp"
#include "lab/sim/shots.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::sim {

/// From azimuth 0 round to azimuth 0.
struct HeadScan {
  segmenter::Scan scan;             // seq from 0
  std::vector<int> object_id;       // [cells]; kNoObject also where there is no return
  std::vector<TrueReturn> returns;  // column by column, ring by ring; slot: its cell
};

class HeadLidar {
 public:
  /// @param scene  outlives this
  /// @param head   outlives this
  /// @param start  the scene's time 0; the first scan begins when the head passes azimuth 0 then
  HeadLidar(const Scene& scene, const config::BoatFacts& boat, const Head& head, double rotation_rpm, const Sector& field_of_view, Utime start,
            std::uint64_t seed);

  HeadLidar(const HeadLidar&) = delete;
  HeadLidar& operator=(const HeadLidar&) = delete;

  HeadScan Next();

 private:
  // When the rotor has turned by so much since time 0, seconds since the start.
  double TimeAt(double azimuth_rad) const;
  void FireColumn(double time_s, double column_azimuth_rad, double rate_radps, HeadScan& made);

  const Head& head_;
  const Effects& effects_;
  Sector field_of_view_;
  Rotor rotor_;
  Shots shots_;
  Utime start_;
  std::int64_t next_turn_ = 0;    // azimuth 0 of which the next scan begins with
  std::int64_t next_column_ = 0;  // of heads with a period: in periods since the start
  std::int64_t seq_ = 0;
};

}  // namespace lookout::sim
