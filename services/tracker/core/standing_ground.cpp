#include "services/tracker/core/standing_ground.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

namespace lookout::tracker {

namespace {

constexpr std::int64_t kForgottenEach = 16;  // half seconds

std::int64_t HalfSecondOf(Utime time) {
  constexpr std::int64_t kUsPerHalfSecond = 500'000;
  return ToUtimeUs(time) / kUsPerHalfSecond;
}

std::uint32_t NumberOf(double place_m) {
  constexpr double kMost = 1e9;
  const double number = std::floor(place_m / StandingGround::kCellM);
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(number > -kMost && number < kMost ? number : kMost));
}

std::int64_t KeyOf(std::uint32_t x, std::uint32_t y) { return static_cast<std::int64_t>(static_cast<std::uint64_t>(x) << 32U | y); }

// The same half seconds, as so many before a later one.
std::uint64_t AsOf(std::uint64_t is_met, std::int64_t later) {
  return later < 0 || later >= StandingGround::kKept ? 0 : is_met << static_cast<unsigned>(later);
}

}  // namespace

void StandingGround::Begin(Utime time) {
  const auto now = HalfSecondOf(time);
  const bool forgets = now / kForgottenEach != now_ / kForgottenEach;
  now_ = now;
  if (!forgets) return;
  for (auto& layer : layers_) std::erase_if(layer, [now](const auto& cell) { return now - cell.second.last >= kKept; });
}

void StandingGround::Add(std::span<const Eigen::Vector2d> places_m, std::span<const double> heights_m) {
  std::optional<std::pair<std::size_t, std::int64_t>> last;  // many returns in a row are in one cell
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    const auto number = LayerOf(heights_m.empty() ? 0.0 : heights_m[i]);
    const auto key = KeyOf(NumberOf(places_m[i].x()), NumberOf(places_m[i].y()));
    if (last == std::pair(number, key)) continue;
    last.emplace(number, key);
    auto& layer = layers_.at(number);
    if (layer.size() >= kMostCells && !layer.contains(key)) continue;
    auto& cell = layer[key];
    cell.is_met = AsOf(cell.is_met, now_ - cell.last) | 1U;
    cell.last = now_;
  }
}

int StandingGround::TimesMet(const Eigen::Vector2d& place_m, double height_m, Utime before) const {
  const auto& layer = layers_.at(LayerOf(height_m));
  const std::uint32_t x = NumberOf(place_m.x());
  const std::uint32_t y = NumberOf(place_m.y());
  constexpr std::uint32_t kBeside = 1;
  std::uint64_t is_met = 0;
  for (std::uint32_t i = 0; i <= 2 * kBeside; ++i) {
    for (std::uint32_t j = 0; j <= 2 * kBeside; ++j) {
      const auto found = layer.find(KeyOf(x - kBeside + i, y - kBeside + j));
      if (found != layer.end()) is_met |= AsOf(found->second.is_met, now_ - found->second.last);
    }
  }
  const auto ago = std::max<std::int64_t>(0, now_ - HalfSecondOf(before)) + 1;
  return ago >= kKept ? 0 : std::popcount(is_met >> static_cast<unsigned>(ago));
}

}  // namespace lookout::tracker
