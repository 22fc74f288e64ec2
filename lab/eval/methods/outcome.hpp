// The outcome of a thing in a scan: found, or how it was lost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>

#include "lab/data/labelled_scan.hpp"
#include "lab/eval/metrics.hpp"

namespace lookout::eval {

/// IoU from which an object counts as found.
inline constexpr double kFoundIou = 0.5;

/// Shores, islands, walls, what grows and stands there: all that is not in the water, but for docks, piers, jetties and pontoons. All else is a
/// thing.
bool IsLand(const data::ScanObject& object);

enum class Outcome {
  kFound,        // IoU >= kFoundIou
  kIntoLand,     // the segment that holds most of the thing is mostly land
  kIntoThing,    // mostly of other things
  kCut,          // the segment is mostly the thing's, and at least as many returns of the thing are elsewhere as foreign returns are in the segment
  kWithClutter,  // mostly of no object
  kMissed,       // more returns of the thing are in no segment than in any segment
};
inline constexpr std::array<std::string_view, 6> kOutcomeNames{"found", "into_land", "into_thing", "cut", "with_clutter", "missed"};
constexpr std::string_view NameOf(Outcome outcome) { return kOutcomeNames[static_cast<std::size_t>(outcome)]; }

struct Fate {
  Outcome outcome = Outcome::kMissed;
  int segment = 0;  // label of the segment that holds most returns of the object; 0 = none
  int held_by = 0;  // the object, or none, of most of that segment's returns
};

/// The fate of an object that is a thing or land.
///
/// Of segments that hold equally much of it, the smallest counts, then the order of their objects and shares decides; the ids of segments decide
/// nothing but `segment`. Precondition: `id` is of matches.objects.
Fate FateOf(int id, const Confusion::Matches& matches, const std::map<std::int32_t, data::ScanObject>& objects);

/// How many things had which outcome.
struct Outcomes {
  std::array<std::int64_t, kOutcomeNames.size()> count{};

  void Add(Outcome outcome) { ++count[static_cast<std::size_t>(outcome)]; }
  void Add(const Outcomes& other);
  std::int64_t num_things() const;
  /// From 0 to 1; NaN when there is no thing.
  double Share(Outcome outcome) const;
  double ShareLost() const { return 1.0 - Share(Outcome::kFound); }

  bool operator==(const Outcomes&) const = default;
};

}  // namespace lookout::eval
