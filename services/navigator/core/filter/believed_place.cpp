#include "services/navigator/core/filter/believed_place.hpp"

#include <algorithm>
#include <cmath>

namespace lookout::navigator {

namespace {

// A fix that is older than the last by more is of another time scale.
constexpr std::chrono::seconds kMostLate(60);

double SecondsApart(Utime a, Utime b) { return std::abs(std::chrono::duration<double>(a - b).count()); }

}  // namespace

// In a straight line: through the earth it is shorter, but never for near places.
double BelievedPlace::DistanceM(const Run& run, const GeodeticPlace& place) { return LocalFrame(run.place).Forward(place).norm(); }

bool BelievedPlace::IsWithinReach(const Run& run, Utime time, const GeodeticPlace& place, double sd_m) {
  const double reach_m = kMostSpeedMps * SecondsApart(time, run.last) + kSlackM + kSlackInSds * (sd_m + run.sd_m);
  return DistanceM(run, place) <= reach_m;
}

void BelievedPlace::Add(Utime time, const GeodeticPlace& place, double sd_m, Run& run) {
  // Several sentences of an epoch are one fix.
  if (run.count == 0 || time != run.last) ++run.count;
  // A late fix says nothing of where the boat is now.
  if (time < run.last && run.last - time <= kMostLate) return;
  run.last = time;
  run.place = place;
  run.sd_m = sd_m;
}

BelievedPlace::Verdict BelievedPlace::Judge(Utime time, const GeodeticPlace& antenna, double sd_m) {
  const GeodeticPlace place = OnEllipsoid(antenna);
  const Run first{time, time, place, sd_m, 0};
  if (!believed_) believed_ = first;
  const bool is_doubted = doubted_ && IsWithinReach(*doubted_, time, place, sd_m);
  // Reach grows while fixes are held. That does not make a fix right that is farther off than a boat gets in the shortest hold; a nearer one may be
  // the step of a receiver that had stood still, which the gates of the filter handle.
  const bool is_far = DistanceM(*believed_, place) > kMostSpeedMps * ToSeconds(kLeastHold);
  const bool is_nearer = is_far && is_doubted && DistanceM(*doubted_, place) < DistanceM(*believed_, place);
  if (!is_nearer && IsWithinReach(*believed_, time, place, sd_m)) {
    Add(time, place, sd_m, *believed_);
    doubted_.reset();
    return Verdict::kBelieved;
  }
  if (!is_doubted) doubted_ = first;
  Add(time, place, sd_m, *doubted_);
  const auto hold = std::clamp<std::chrono::microseconds>(believed_->last - believed_->first, kLeastHold, kMostHold);
  const auto held_for = doubted_->last - doubted_->first;
  if (held_for >= hold && doubted_->count >= kLeastFixes) {
    believed_ = doubted_;
    doubted_.reset();
    held_.reset();
    return Verdict::kNewPlace;
  }
  held_ = {time, DistanceM(*believed_, place), SecondsApart(time, believed_->last),
           std::chrono::duration<double>(std::max<std::chrono::microseconds>(hold - held_for, std::chrono::microseconds(0))).count()};
  return Verdict::kHeld;
}

}  // namespace lookout::navigator
