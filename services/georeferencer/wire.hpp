// Between the messages of georeferencer and its own types.
#pragma once

#include <variant>
#include <vector>

#include "common/messages/checks.hpp"
#include "lookout/obstacles_t.hpp"
#include "services/georeferencer/core/obstacle.hpp"
#include "services/georeferencer/core/placement.hpp"

namespace lookout::georeferencer {

/// Why a message was refused: the name of a counter; of SEGMENTS one of messages::kSegmentsFaults.
using Refusal = messages::Fault;

/// Encoded sizes: obstacles_t without obstacles, obstacle_t without outline and waterline, a corner of them in both frames.
inline constexpr std::size_t kHeadBytes = 80;
inline constexpr std::size_t kObstacleBytes = 188;
inline constexpr std::size_t kVertexBytes = 16;

/// The whole message is valid, or it is refused.
std::variant<SegmentPart, Refusal> ToSegmentPart(const segments_t& message, int max_message_bytes);

/// @return OBSTACLES of one SEGMENTS message: one message, or two where the obstacles of the scan may not fit into one each (see README.md);
///         part_index and num_parts count them through the scan
std::vector<obstacles_t> ToMessages(const ObstaclePart& part, int max_message_bytes);

}  // namespace lookout::georeferencer
