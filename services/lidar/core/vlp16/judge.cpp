#include "services/lidar/core/vlp16/judge.hpp"

#include <memory>

#include "services/lidar/core/vlp16/data_packet.hpp"
#include "services/lidar/core/vlp16/position_packet.hpp"

namespace lookout::vlp16 {

namespace {

using lidar::Verdict;

Verdict VerdictOf(ModelVerdict verdict) {
  switch (verdict) {
    case ModelVerdict::kVlp16:
    case ModelVerdict::kPuckHiRes:
      return Verdict::kValid;
    case ModelVerdict::kUndecided:
      return Verdict::kUndecided;
    case ModelVerdict::kHdl32e:
      return Verdict::kOther;
    default:
      return Verdict::kInvalid;
  }
}

class FamilyJudge final : public lidar::PacketJudge {
 public:
  explicit FamilyJudge(ModelChoice model) : detector_(model) {}

  Verdict Judge(lidar::Stream stream, Bytes payload) override {
    if (stream == lidar::Stream::kPosition) {
      const auto fault = ParsePositionPacket(payload).fault;
      return fault == PositionFault::kNone || fault == PositionFault::kSentence ? Verdict::kValid : Verdict::kInvalid;
    }
    const auto result = ParseDataPacket(payload);
    return result.fault == DataFault::kNone ? VerdictOf(detector_.Detect(result.packet)) : Verdict::kInvalid;
  }

 private:
  ModelDetector detector_;
};

}  // namespace

lidar::JudgeMaker MakeJudgeOf(ModelChoice model) {
  return [model] { return std::make_unique<FamilyJudge>(model); };
}

}  // namespace lookout::vlp16
