// What makes a scene a family: numbers drawn between two of the file, members drawn from several kinds, places at the edge of others.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/schema/scene.pb.h"
#include "lab/sim/random.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// @return the scene with its own boat and objects as in one of its layouts, drawn by weight: objects of others have the chance 0
config::Scene WithDrawnLayout(const config::Scene& scene, std::uint64_t seed);

/// @return own_boat with what the layout says of it
config::Scene::OwnBoat OwnBoatIn(const config::Scene::Layout& layout, const config::Scene::OwnBoat& own_boat);

/// @return the scene with each number of own_boat_to, sea_to and effects_to (of several one) drawn between that of own_boat, sea and effects and it
config::Scene WithDrawnNumbers(const config::Scene& scene, std::uint64_t seed);

/// @return one of `one_of`, drawn by weight, with what the object says besides; the object itself where it has no one_of
config::Scene::Object DrawMember(const config::Scene::Object& object, Random& random);

/// Each of `one_of` with what the object says besides; the object itself where it has none.
config::Scene::Object MergedWith(const config::Scene::Object& object, const config::Scene::Object& one);

/// By which things lie beside the own boat, or abeam of it, where it is placed before them.
inline constexpr std::string_view kOwnBoatName = "own_boat";
inline constexpr std::string_view kOwnSidesName = "own_sides";

/// Edges of things at which others may lie. All in the map.
class Edges {
 public:
  /// @param name  of the object in the file: its members share it
  /// @param edge_m  water on its starboard side
  /// @param reach_m  of its points: how far they lie before the waterline; empty: on it
  void Add(const std::string& name, std::size_t object, std::vector<Eigen::Vector2d> edge_m, bool is_closed, std::vector<double> reach_m = {});

  bool Has(const std::string& name) const { return edges_.contains(name); }

  /// Where the members of one object of the file have come to along the edge.
  struct Row {
    std::size_t edge = 0;
    double along_m = -1.0;  // -1: has not begun
  };
  struct Found {
    Placement placement;
    std::size_t object = 0;     // beside which it lies, as given to Add
    double least_gap_m = 0.0;   // to keep from it
    double next_along_m = 0.0;  // of the row, when it may lie here
    double to_land_m = 0.0;     // of an object that begins at the edge and runs out from it: how far the waterline lies behind that, at most
  };

  /// A try: whether something else lies there is not looked at.
  ///
  /// @param outline_m    of what is to lie there, its own frame
  /// @param heading_rad  of Turned ANY
  /// @param member       which of a count it is, for is_each
  /// @return nullopt where the row has come to its end, or there is no edge for this member
  std::optional<Found> Draw(const config::Scene::Beside& beside, const std::vector<Eigen::Vector2d>& outline_m, double heading_rad, int member,
                            Row& row, Random& random) const;

 private:
  struct Edge {
    std::size_t object = 0;
    std::vector<Eigen::Vector2d> points_m;  // the first again at the end of a closed one
    std::vector<double> reach_m;            // of each, or none
    double length_m = 0.0;
  };
  std::map<std::string, std::vector<Edge>> edges_;
};

}  // namespace lookout::sim
