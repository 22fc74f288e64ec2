// Scenes that are families: numbers are drawn between two numbers of the file, members from several kinds, places at the edges of other objects.
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

/// @return own_boat with the layout's values for it
config::Scene::OwnBoat OwnBoatIn(const config::Scene::Layout& layout, const config::Scene::OwnBoat& own_boat);

/// @return the scene with each number of own_boat_to, sea_to and effects_to (of several one) drawn between the number of own_boat, sea or effects and
///         this number
config::Scene WithDrawnNumbers(const config::Scene& scene, std::uint64_t seed);

/// @return one of `one_of`, drawn by weight, merged with the object's other fields; the object itself where it has no one_of
config::Scene::Object DrawMember(const config::Scene::Object& object, Random& random);

/// Each of `one_of`, merged with the object's other fields; the object itself where it has no one_of.
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
    std::size_t object = 0;     // object beside which the member lies, as given to Add
    double least_gap_m = 0.0;   // least gap to that object
    double next_along_m = 0.0;  // next free place along the row, if the member may lie here
    double to_land_m = 0.0;     // of an object that begins at the edge and runs out from it: how far the waterline lies behind that, at most
  };

  /// One try: whether something else lies there is not checked.
  ///
  /// @param outline_m    of the object to be placed, in its own frame
  /// @param heading_rad  of Turned ANY
  /// @param member       number of the member in its count, for is_each
  /// @return nullopt where the row has come to its end, or there is no edge for this member
  std::optional<Found> Draw(const config::Scene::Beside& beside, const std::vector<Eigen::Vector2d>& outline_m, double heading_rad, int member,
                            Row& row, Random& random) const;

 private:
  struct Edge {
    std::size_t object = 0;
    std::vector<Eigen::Vector2d> points_m;  // a closed line ends with its first point
    std::vector<double> reach_m;            // of each, or none
    double length_m = 0.0;
  };
  std::map<std::string, std::vector<Edge>> edges_;
};

}  // namespace lookout::sim
