// The judge of packets of the VLP-16 family.
#pragma once

#include "services/lidar/core/driver/packet_judge.hpp"
#include "services/lidar/core/vlp16/model.hpp"

namespace lookout::vlp16 {

lidar::JudgeMaker MakeJudgeOf(ModelChoice model);

}  // namespace lookout::vlp16
