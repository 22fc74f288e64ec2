#include "services/plotter/core/scene.hpp"

#include <tuple>

#include "common/core/angles.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/printable.hpp"

namespace lookout::plotter {

namespace {

// As the tracker clears an alert: below it a close approach is unlikely.
constexpr double kLikely = 0.2;

bool ComesNear(const Target& target) { return target.cpa_probability >= kLikely; }

LocalFrame FrameAt(const Position& position) { return LocalFrame({position.latitude_deg, position.longitude_deg, 0.0}); }

}  // namespace

const std::string& AsciiNameOf(const Target& target, std::size_t max_bytes) {
  const auto& given = target.given_name;
  return !given.empty() && given.size() <= max_bytes && given == Printable(given) ? given : target.name;
}

bool IsDangerous(const Target& target) { return target.level != Level::kNone || ComesNear(target); }

bool IsMoreDangerous(const Target& one, const Target& other) {
  // Unknown values come last.
  const auto known = [](double value) { return std::isnan(value) ? 1e9 : value; };
  const auto key = [&known](const Target& target) {
    return std::tuple(-static_cast<int>(target.level), ComesNear(target) ? 0 : 1, ComesNear(target) ? known(target.tcpa_s) : 0.0,
                      known(target.distance_m), target.id);
  };
  return key(one) < key(other);
}

Position Propagated(const Position& position, double velocity_east_mps, double velocity_north_mps, double duration_s) {
  if (velocity_east_mps == 0.0 && velocity_north_mps == 0.0) return position;
  const auto place = FrameAt(position).Reverse({velocity_east_mps * duration_s, velocity_north_mps * duration_s, 0.0});
  return {place.latitude_deg, place.longitude_deg};
}

RangeAndBearing RangeAndBearingOf(const Position& from, const Position& to) {
  const Eigen::Vector3d there_m = FrameAt(from).Forward({to.latitude_deg, to.longitude_deg, 0.0});
  return {Hypot(there_m.x(), there_m.y()), WrapTo2Pi(Atan2(there_m.x(), there_m.y()))};
}

}  // namespace lookout::plotter
