// What config says of one source of sentences, as far as its sentences are read by it.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace lookout::navigator {

/// What is taken of a source. All of it is recorded, whatever the role.
enum class Role {
  kAll,
  kGnss,      // positions and velocities
  kHeading,   // headings and rates of turn
  kAttitude,  // headings, roll, pitch, rates of turn
  kImu,       // raw angular velocity and specific force
  kNothing,   // recorded only
};

struct SourceParams {
  std::string name;  // as in NAV_RAW
  Role role = Role::kAll;
  bool requires_checksum = true;
  // From the instant of a measurement to the arrival of its sentence, where the sentence has no time of its own; nullopt: not known, 0 counts, and
  // the source tells nothing of the computer's clock below max_sentence_latency.
  std::optional<std::chrono::microseconds> latency;
  // Factors that turn the sensor's signs into ours: +1 where roll is positive starboard down, and pitch positive bow up.
  double roll_sign = 1.0;
  double pitch_sign = 1.0;
  // Of the compass, where the sentence says none; positive east.
  std::optional<double> deviation_rad;
  std::optional<double> declination_rad;
};

}  // namespace lookout::navigator
