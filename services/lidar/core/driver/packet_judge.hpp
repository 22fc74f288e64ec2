// Whether payloads are packets of the lidar that was asked for. The senders of a stream have a judge each.
#pragma once

#include <functional>
#include <memory>

#include "common/core/bytes.hpp"

namespace lookout::lidar {

enum class Stream { kData, kPosition };

enum class Verdict {
  kValid,
  kInvalid,
  kUndecided,  // more packets of this sender are needed
  kOther,      // the sender is another lidar, whatever comes
};

class PacketJudge {
 public:
  virtual ~PacketJudge() = default;
  virtual Verdict Judge(Stream stream, Bytes payload) = 0;
};

using JudgeMaker = std::function<std::unique_ptr<PacketJudge>()>;

}  // namespace lookout::lidar
