// Own ship, targets and alerts made up, for tests.
#pragma once

#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <string_view>

#include "common/core/sentence.hpp"
#include "services/plotter/core/scene.hpp"

namespace lookout::plotter::test {

/// 2026-07-01 10:20:30.456789 UTC.
inline constexpr Utime kTime{std::chrono::microseconds(1'782'901'230'456'789)};

inline constexpr double Deg(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }

/// In Dublin Bay, heading 45 deg, 2 m/s over ground to 90 deg.
inline OwnShip MakeOwnShip() { return {.time = kTime, .position = {53.3, -6.1}, .heading_rad = Deg(45), .speed_mps = 2.0, .course_rad = Deg(90)}; }

/// 100 m to the north-east of it, 1 m/s to the south.
inline Target MakeTarget(std::int64_t id = 17) {
  Target target;
  target.id = id;
  target.name = "boat " + std::to_string(id);
  target.first = kTime;
  target.position = Propagated({53.3, -6.1}, 70.71067811865476, 70.71067811865476, 1.0);
  target.velocity_north_mps = -1.0;
  target.speed_mps = 1.0;
  target.course_rad = Deg(180);
  target.length_m = 6.0;
  target.width_m = 2.0;
  target.length_bearing_rad = 0.0;
  target.distance_m = 97.0;
  target.cpa_m = 12.5;
  target.tcpa_s = 33.0;
  target.cpa_probability = 0.0;
  return target;
}

inline Notice MakeNotice(std::int64_t id = 3) {
  return {.id = id,
          .cause = Cause::kClosestApproach,
          .level = Level::kWarning,
          .state = NoticeState::kActive,
          .track_id = 17,
          .raised = kTime,
          .changed = kTime,
          .text = "boat 17: closest approach 3 m in 21 s, 40 deg to starboard"};
}

/// One sentence without checksum and CR LF, which must be right.
inline std::string Line(const std::string& sentence) {
  EXPECT_TRUE(sentence.ends_with("\r\n"));
  EXPECT_EQ(Frame(std::string_view(sentence).substr(0, sentence.size() - 2)).fault, SentenceFault::kNone);
  return sentence.substr(0, sentence.size() - 5);
}

}  // namespace lookout::plotter::test
