// A person's answers about the boat, checked and in the frame of the vessel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/schema/answers.pb.h"
#include "tools/setup/hearing.hpp"

namespace lookout::setup {

/// A fault of one answer.
struct AnswerFault {
  std::string field;
  std::string reason;
};

/// Faults of fields that contradict each other, the boat's size, or the sensors that were heard; each field by itself was checked before.
std::vector<AnswerFault> FaultsOf(const config::Answers& answers, const Heard& heard);

/// Why a number must not be the value of this field, by the options of the schema; empty: it may.
std::string RangeFault(const google::protobuf::Message& message, const std::string& field, double value);

/// @throws config::ConfigError with every fault, by line
config::Answers LoadAnswers(const std::filesystem::path& file, const Heard& heard);

/// A place in the vessel frame of a file that lookout-setup writes: origin in the middle of the hull at the height of the water, metres.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
};

Place LidarPlace(const config::Answers& answers);
Place AntennaPlace(const config::Answers& answers);  // of the lidar where there is none

/// Box around hull, lidar and what stands on the hull.
struct OwnBox {
  Place min;
  Place max;
};
OwnBox BoxOf(const config::Answers& answers);

/// 0: there is none.
double GuardZoneM(const config::Answers& answers);

/// The lidar to use; nullptr: none was heard.
const lidar::Speaker* ChosenLidar(const config::Answers& answers, const Heard& heard);

}  // namespace lookout::setup
