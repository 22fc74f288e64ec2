#include "lab/sim/breakers.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/foam.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kBreakerShotStream = 20;
constexpr std::uint64_t kBreakerStream = 21;

// Born by tile of the map and slot of time, so that the same wave breaks at the same place whatever was looked at before.
constexpr double kTileM = 20.0;
constexpr double kSlotS = 4.0;
constexpr double kLeastLifeS = 1.5;
constexpr double kGreatestLifeS = 4.5;
constexpr double kMeanLifeS = (kLeastLifeS + kGreatestLifeS) / 2.0;
constexpr double kSquareMetresPerHectare = 10'000.0;

constexpr double kGreatestHeightM = 0.45;
constexpr double kFrontCosine = 0.6;  // of the incidence on a steep, rough front

std::uint64_t StreamOf(std::int64_t column, std::int64_t row, std::int64_t slot) {
  const auto bits = [](std::int64_t number) { return static_cast<std::uint64_t>(number) & 0xFFFF; };
  return kBreakerStream << 48 | bits(column) << 32 | bits(row) << 16 | bits(slot);
}

}  // namespace

Breakers::Breakers(double per_hectare, const Sea& sea, std::uint64_t seed)
    : per_hectare_(per_hectare), sea_(sea), seed_(seed), random_(seed, kBreakerShotStream), towards_(sea.Towards()) {
  if (!towards_.isZero()) return;
  Random random(seed, kBreakerStream);
  const double angle_rad = random.Uniform(0.0, kTwoPi);
  towards_ = {std::cos(angle_rad), std::sin(angle_rad)};
}

// Sizes: from a crest that a gust makes on a lake to a breaker that a small boat avoids.
void Breakers::AddBornIn(std::int64_t column, std::int64_t row, std::int64_t slot, double time_s) {
  Random random(seed_, StreamOf(column, row, slot));
  const double mean = per_hectare_ * (kTileM * kTileM / kSquareMetresPerHectare) * (kSlotS / kMeanLifeS);
  const int count = static_cast<int>(mean + random.Uniform());
  for (int i = 0; i < count; ++i) {
    const double east_m = (static_cast<double>(column) + random.Uniform()) * kTileM;
    const double north_m = (static_cast<double>(row) + random.Uniform()) * kTileM;
    const double born_s = (static_cast<double>(slot) + random.Uniform()) * kSlotS;
    const double life_s = random.Uniform(kLeastLifeS, kGreatestLifeS);
    const double half_length_m = 0.4 + 3.6 * random.Uniform() * random.Uniform();
    const double bend_m = half_length_m * random.Uniform(-0.1, 0.4);
    const double full_height_m = random.Uniform(0.1, kGreatestHeightM);
    const double thickness_m = random.Uniform(0.1, 0.7);
    const double strength = random.Uniform(0.3, 0.95);
    const double speed_mps = random.Uniform(0.8, 3.5);
    const double turn_rad = random.Uniform(-0.4, 0.4);
    const double age_s = time_s - born_s;
    if (age_s < 0.0 || age_s > life_s + kFoamEndsS) continue;
    const double broke_s = std::min(age_s, life_s);
    const Vector2d towards(std::cos(turn_rad) * towards_.x() - std::sin(turn_rad) * towards_.y(),
                           std::sin(turn_rad) * towards_.x() + std::cos(turn_rad) * towards_.y());
    const double height_m = age_s < life_s ? full_height_m * std::sin(kPi * age_s / life_s) : 0.0;
    breakers_.push_back({Vector2d(east_m, north_m) + speed_mps * broke_s * towards, towards, half_length_m, bend_m, height_m, thickness_m, strength,
                         speed_mps, speed_mps * broke_s, age_s - broke_s});
  }
}

void Breakers::MoveTo(double time_s, const Vector2d& eye_m) {
  breakers_.clear();
  if (is_off()) return;
  time_s_ = time_s;
  const auto tile = [](double at_m) { return static_cast<std::int64_t>(std::floor(at_m / kTileM)); };
  const auto slot = static_cast<std::int64_t>(std::floor(time_s / kSlotS));
  constexpr auto kSlotsBack = static_cast<std::int64_t>((kGreatestLifeS + kFoamEndsS) / kSlotS) + 1;
  for (std::int64_t column = tile(eye_m.x() - kReachM); column <= tile(eye_m.x() + kReachM); ++column) {
    for (std::int64_t row = tile(eye_m.y() - kReachM); row <= tile(eye_m.y() + kReachM); ++row) {
      for (std::int64_t back = 0; back <= kSlotsBack; ++back) AddBornIn(column, row, slot - back, time_s);
    }
  }
}

// Seen from above an arc is a parabola over its crest: ahead = bend (1 - (along / half length)^2).
std::optional<Echo> Breakers::FirstEcho(const Ray& ray, double max_range_m) {
  // Level beams and those that rise are over all of them.
  if (breakers_.empty() || (ray.direction.z() >= 0.0 && ray.origin_m.z() > sea_.max_height_m() + kGreatestHeightM)) return std::nullopt;
  double nearest_m = max_range_m;
  const Breaker* met = nullptr;
  for (const Breaker& breaker : breakers_) {
    if (breaker.height_m <= 0.0) continue;
    const Vector2d from_m = ray.origin_m.head<2>() - breaker.middle_m;
    const Vector2d direction = ray.direction.head<2>();
    const Vector2d crest(-breaker.towards.y(), breaker.towards.x());
    const double along_m = crest.dot(from_m);
    const double along_rate = crest.dot(direction);
    const double curve = breaker.bend_m / (breaker.half_length_m * breaker.half_length_m);
    const double a = curve * along_rate * along_rate;
    const double b = breaker.towards.dot(direction) + 2.0 * curve * along_m * along_rate;
    const double c = breaker.towards.dot(from_m) - breaker.bend_m + curve * along_m * along_m;
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) continue;
    const double root = std::sqrt(discriminant);
    // Both roots, in the form that does not divide by a small `a`.
    const double q = -0.5 * (b + (b < 0.0 ? -root : root));
    for (const double range_m : {q != 0.0 ? c / q : -1.0, a != 0.0 ? q / a : -1.0}) {
      if (range_m <= 0.5 || range_m >= nearest_m) continue;
      const double share = (along_m + range_m * along_rate) / breaker.half_length_m;
      if (std::abs(share) > 1.0) continue;
      const Vector3d p_m = ray.origin_m + range_m * ray.direction;
      const double over_water_m = p_m.z() - sea_.HeightM(p_m.head<2>(), time_s_);
      if (over_water_m < -0.05 || over_water_m > breaker.height_m * (1.0 - share * share)) continue;
      nearest_m = range_m;
      met = &breaker;
    }
  }
  if (met == nullptr || random_.Uniform() >= met->strength) return std::nullopt;
  const double range_m = nearest_m + met->thickness_m * random_.Uniform();
  if (range_m >= max_range_m) return std::nullopt;
  return Echo{{range_m, kFrontCosine}, kNoObject, {kFoamReflectance}, ReturnReason::kCrest};
}

double Breakers::FoamAt(const Vector2d& p_map_m) const {
  double most = 0.0;
  for (const Breaker& breaker : breakers_) {
    const Vector2d from_m = p_map_m - breaker.middle_m;
    const double share = (breaker.towards.x() * from_m.y() - breaker.towards.y() * from_m.x()) / breaker.half_length_m;
    if (std::abs(share) > 1.0) continue;
    const double behind_m = breaker.bend_m * (1.0 - share * share) - breaker.towards.dot(from_m);
    if (behind_m < 0.0 || behind_m > breaker.way_m) continue;
    most = std::max(most, breaker.strength * std::exp(-(breaker.foam_age_s + behind_m / breaker.speed_mps) / kFoamFadesS));
  }
  return most;
}

}  // namespace lookout::sim
