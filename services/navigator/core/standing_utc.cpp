#include "services/navigator/core/standing_utc.hpp"

#include <algorithm>

namespace lookout::navigator {

bool StandingUtc::Stands(Utime arrival, const Sentence& sentence) {
  auto& said = said_[static_cast<std::size_t>(sentence.type)];
  if (!said || said->time_of_day != *sentence.time_of_day || arrival < said->since) {
    said = Said{*sentence.time_of_day, arrival, *sentence.position};
    return false;
  }
  const bool moves = LocalFrame(OnEllipsoid(said->place)).Forward(OnEllipsoid(*sentence.position)).norm() > kLeastMoveM;
  const auto stand = arrival - said->since;
  const bool has_stood = longest_stand_ > std::chrono::microseconds(0);
  if (stand < (has_stood ? kLeastStandAgain : kLeastStand)) return false;
  if (moves) longest_stand_ = std::max<std::chrono::microseconds>(longest_stand_, stand);
  return moves || stand <= longest_stand_;
}

}  // namespace lookout::navigator
