#include "lab/eval/methods/outcome.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>

namespace lookout::eval {
namespace {

// Returns of a segment, by their object.
struct Shares {
  std::int64_t own = 0;
  std::int64_t land = 0;
  std::int64_t things = 0;  // others
  std::int64_t clutter = 0;
};

Shares SharesOf(int id, const Confusion::Segment& segment, const std::map<std::int32_t, data::ScanObject>& objects) {
  Shares shares;
  for (const auto& [object, count] : segment.returns_by_object) {
    auto& share = object == id ? shares.own : object <= 0 ? shares.clutter : IsLand(objects.at(object)) ? shares.land : shares.things;
    share += count;
  }
  return shares;
}

Outcome OutcomeOfForeign(const Shares& shares) {
  if (shares.land >= std::max(shares.things, shares.clutter)) return Outcome::kIntoLand;
  return shares.things >= shares.clutter ? Outcome::kIntoThing : Outcome::kWithClutter;
}

}  // namespace

bool IsLand(const data::ScanObject& object) {
  constexpr std::array<std::string_view, 4> kBuiltIntoTheWater{"dock", "pier", "jetty", "pontoon"};
  const auto is_part_of_kind = [&object](std::string_view word) { return object.kind.find(word) != std::string::npos; };
  return !object.is_in_water && std::ranges::none_of(kBuiltIntoTheWater, is_part_of_kind);
}

Fate FateOf(int id, const Confusion::Matches& matches, const std::map<std::int32_t, data::ScanObject>& objects) {
  const auto& object = matches.objects.at(id);
  Fate fate;
  std::int64_t num_in_segments = 0;
  std::int64_t num_held = 0;  // returns of the object that fate.segment holds
  const auto rank = [&](int label) {
    const auto& segment = matches.segments.at(label);
    const auto shares = SharesOf(id, segment, objects);
    return std::tuple(shares.own, -segment.num_returns, -segment.majority_object, shares.land, shares.things);
  };
  for (const auto& [label, segment] : matches.segments) {
    const auto held = segment.returns_by_object.find(id);
    if (held == segment.returns_by_object.end()) continue;
    num_in_segments += held->second;
    if (fate.segment != 0 && rank(label) <= rank(fate.segment)) continue;
    fate.segment = label;
    fate.held_by = segment.majority_object;
    num_held = held->second;
  }
  if (object.iou >= kFoundIou) {
    fate.outcome = Outcome::kFound;
  } else if (object.num_returns - num_in_segments > num_held) {
    fate.outcome = Outcome::kMissed;
  } else {
    const auto shares = SharesOf(id, matches.segments.at(fate.segment), objects);
    const std::int64_t foreign = shares.land + shares.things + shares.clutter;
    const bool is_own = shares.own >= std::max({shares.land, shares.things, shares.clutter});
    fate.outcome = is_own && object.num_returns - shares.own >= foreign ? Outcome::kCut : OutcomeOfForeign(shares);
  }
  return fate;
}

void Outcomes::Add(const Outcomes& other) {
  for (std::size_t i = 0; i < count.size(); ++i) count[i] += other.count[i];
}

std::int64_t Outcomes::num_things() const { return std::accumulate(count.begin(), count.end(), std::int64_t{0}); }

double Outcomes::Share(Outcome outcome) const {
  const auto all = num_things();
  if (all == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(count[static_cast<std::size_t>(outcome)]) / static_cast<double>(all);
}

}  // namespace lookout::eval
