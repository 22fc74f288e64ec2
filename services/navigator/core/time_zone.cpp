#include "services/navigator/core/time_zone.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

constexpr microseconds kDay = std::chrono::days(1);
using QuarterHours = std::chrono::duration<std::int64_t, std::ratio<900>>;

int RankOf(const Sentence& sentence) {
  if (sentence.date) return sentence.type == SentenceType::kZda ? 3 : 4;
  return sentence.type == SentenceType::kGga || sentence.type == SentenceType::kGns ? 2 : 1;
}

}  // namespace

bool TimeZoneCheck::IsLocal(Utime now, const Sentence& sentence) const {
  if (!sentence.time_of_day || !known_ || RankOf(sentence) >= known_->rank) return false;
  const auto ahead = *sentence.time_of_day - known_->time_of_day - (now - known_->now);
  const auto quarters = std::chrono::round<QuarterHours>(ahead);
  // Midnight lies between them where they differ by a whole day.
  return quarters % kDay != microseconds(0) && std::chrono::abs(ahead - quarters) <= kMostOff;
}

bool TimeZoneCheck::SaysAsMuch(const Sentence& sentence) const { return sentence.time_of_day && (!known_ || RankOf(sentence) >= known_->rank); }

void TimeZoneCheck::Know(Utime now, const Sentence& sentence) {
  const int rank = RankOf(sentence);
  if (!sentence.time_of_day || (known_ && rank < known_->rank)) return;
  known_ = {rank, now, *sentence.time_of_day};
}

}  // namespace lookout::navigator
