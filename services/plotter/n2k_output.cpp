#include "services/plotter/n2k_output.hpp"

namespace lookout::plotter {

int N2kOutput::NextSequence() {
  constexpr int kSequences = 8;
  sequence_ = (sequence_ + 1) % kSequences;
  return sequence_;
}

std::string N2kOutput::Text(const N2kMessage& message, Utime time) {
  if (params().format == Format::kN2kActisense) return ActisenseLine(message, time);
  return YdenLines(message, time, message.is_fast_packet ? NextSequence() : 0);
}

void N2kOutput::SendOwnShip(const Told& told) {
  if (!IsReady() || !params().sends_own_ship || !told.own.is_placed() || told.own.is_estimated) return;
  Send(Text(PositionMessage(told.own), told.own.time));
  Send(Text(CourseMessage(told.own), told.own.time));
}

void N2kOutput::SendTargets(const Told& told) {
  if (!IsReady()) return;
  for (const auto& ended : targets_.TakeEnded(told.targets)) {
    SendSurely(Text(TargetMessage(told.own, EndedAt(ended, told.own.time), ended.number), told.own.time));
  }
  for (const auto* target : targets_.Due(told.targets, told.passed)) {
    const auto number = told.numbers.Of(target->id);
    if (!number) continue;
    if (!Send(Text(TargetMessage(told.own, *target, *number), told.own.time))) return;
    targets_.NoteSent(*target, told.own.time, *number, told.passed);
  }
}

}  // namespace lookout::plotter
