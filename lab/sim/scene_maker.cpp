#include "lab/sim/scene_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/hash.hpp"
#include "lab/sim/built.hpp"
#include "lab/sim/coast.hpp"
#include "lab/sim/family.hpp"
#include "lab/sim/random.hpp"
#include "lab/sim/traffic.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Numbers = google::protobuf::RepeatedField<double>;
using File = config::Scene;

// Streams of random numbers: a change of one part of a file leaves the others as they were.
constexpr std::uint64_t kSceneStream = 1;  // the own boat's waves and the land
constexpr std::uint64_t kSeaStream = 101;
constexpr std::uint64_t kOwnBoatStream = 102;
constexpr std::uint64_t kRedrawStream = 200;        // first of the streams of redraws
constexpr std::uint64_t kFirstObjectStream = 1000;  // first of the streams of objects, one for each object of the file

constexpr double kOwnBoatClearanceM = 1.5;
// M. Jeong, A. Quattrini Li, IROS 2021: Catabot, 2.4 m x 1.4 m.
const std::vector<Vector2d> kOwnOutline = Rectangle(-1.2, 1.2, -0.7, 0.7);
constexpr int kMaxTries = 200;      // for an object to find a place
constexpr int kMaxOwnTries = 3000;  // for the own boat of a family
constexpr int kMaxLayouts = 10;     // of a family, until the own boat has a place
constexpr std::size_t kOwnBoatEdge = static_cast<std::size_t>(-1);

// One message of the truth holds all objects and the own boat: below bus::kMaxMessageBytes (120 kB) with 400 bytes for its head and the own boat.
constexpr std::size_t kMaxBytesOfObjects = 119'600;

// As sim_object_t.lcm has it: numbers and flags, two texts with their lengths, and the outline.
std::size_t BytesInTruth(const SceneObject& object) {
  constexpr std::size_t kBytesOfNumbers = 58;
  constexpr std::size_t kBytesAroundText = 5;  // length before the text, a zero behind it
  return kBytesOfNumbers + 2 * kBytesAroundText + object.name.size() + object.kind.size() + 16 * object.outline_m.size();
}

Vector2d PlaceAtBearing(double bearing_rad, double radius_m) { return radius_m * Vector2d(std::sin(bearing_rad), std::cos(bearing_rad)); }

double Draw(const Numbers& numbers, double usual, Random& random) {
  if (numbers.empty()) return usual;
  return numbers.size() == 1 ? numbers[0] : random.Uniform(numbers[0], numbers[1]);
}

// Two waves each of roll, pitch and heave, as a light boat of some 2.5 m has them in a small chop: periods of 2 to 6 s.
void AddWaves(const File::OwnBoat& boat, Random& random, OwnMotion& motion) {
  const auto add = [&random](std::vector<Wave>& waves, double amplitude, double low_s, double high_s) {
    const double period_s = random.Uniform(low_s, high_s);
    const double phase_rad = random.Uniform(0.0, kTwoPi);
    if (amplitude > 0.0) waves.push_back({amplitude, period_s, phase_rad});
  };
  // Shares of the long and the short wave.
  add(motion.roll_rad, DegToRad(boat.roll_deg() * (2.0 / 2.8)), 2.5, 3.5);
  add(motion.roll_rad, DegToRad(boat.roll_deg() * (0.8 / 2.8)), 1.8, 2.4);
  add(motion.pitch_rad, DegToRad(boat.pitch_deg() * (1.2 / 1.7)), 2.8, 4.0);
  add(motion.pitch_rad, DegToRad(boat.pitch_deg() * (0.5 / 1.7)), 2.0, 2.6);
  add(motion.heave_m, boat.heave_m() * (0.04 / 0.06), 2.5, 4.0);
  add(motion.heave_m, boat.heave_m() * (0.02 / 0.06), 1.8, 2.4);
  add(motion.leeway_rad, DegToRad(boat.leeway_deg()), 7.0, 12.0);
}

// @param waves_random  of its waves
OwnMotion DrawOwnMotion(const File::OwnBoat& boat, Random& random, Random& waves_random) {
  OwnMotion motion;
  const double east_m = Draw(boat.east_m(), 0.0, random);
  const double north_m = Draw(boat.north_m(), 0.0, random);
  if (boat.has_ellipse()) {
    const auto& ellipse = boat.ellipse();
    motion.center_map_m = {east_m, north_m};
    motion.semi_axes_m = {ellipse.semi_axis_east_m(), ellipse.semi_axis_north_m()};
    motion.period_s = ellipse.period_s();
    motion.start_rad = DegToRad(ellipse.start_deg());
  } else {
    const double heading_rad = DegToRad(Draw(boat.heading_deg(), 0.0, random));
    const double speed_mps = Draw(boat.speed_mps(), 0.0, random);
    motion.track = Track{{{east_m, north_m}, heading_rad}, speed_mps, DegToRad(Draw(boat.turn_rate_degps(), 0.0, random))};
  }
  AddWaves(boat, waves_random, motion);
  return motion;
}

bool IsLand(File::Kind kind) {
  return kind == File::SHORE || kind == File::ISLAND || kind == File::COAST || kind == File::QUAY || kind == File::BREAKWATER;
}

// From its landward end on.
bool IsBuiltOut(File::Kind kind) {
  constexpr std::array kKinds{File::DOCK, File::PIER, File::JETTY, File::PONTOON, File::DOCK_BAYS, File::ANY_DOCK, File::PILE_PIER, File::BRIDGE};
  return std::ranges::find(kKinds, kind) != kKinds.end();
}

// Makes land with edges. Where the file says nothing else a quay is a wall with fenders, and a breakwater boulders.
Coast MakeLand(const File::Object& file, const Line* along_m, Random& random) {
  const bool is_closed = file.kind() == File::ISLAND || file.kind() == File::BREAKWATER;
  const double length_m = Draw(file.length_m(), is_closed ? 30.0 : 200.0, random);
  config::Scene::Land land = file.land();
  if (land.edge().empty()) land.add_edge(file.kind() == File::QUAY ? File::FENDERED : file.kind() == File::BREAKWATER ? File::RIPRAP : File::BANK);
  const std::string name = file.kind() == File::COAST ? "shore" : NameOf(file.kind());
  if (along_m != nullptr) return MakeCoastAlong(name, land, *along_m, random);
  if (!is_closed) return MakeCoast(name, land, length_m, random);
  // Breakwaters are narrow, islands are about as wide as long.
  const double width_m = file.kind() == File::BREAKWATER ? 6.0 : length_m * random.Uniform(0.4, 1.0);
  return MakeIslandOf(name, land, length_m, Draw(file.width_m(), width_m, random), random);
}

// A waypoint at which the path would stand still or turn back.
bool IsBadCorner(const Vector2d& before_m, const Vector2d& at_m, const Vector2d& after_m) {
  const Vector2d in_m = at_m - before_m;
  const Vector2d out_m = after_m - at_m;
  if (in_m.isZero() || out_m.isZero()) return true;
  return std::abs(std::atan2(in_m.x() * out_m.y() - in_m.y() * out_m.x(), in_m.dot(out_m))) > kMaxRouteTurnRad;
}

// Families that begin alike would draw the same things from the same seed. Scenes with a fixed structure keep theirs.
std::uint64_t SeedOf(const File& file, std::uint64_t seed) {
  if (!file.own_boat().has_free_by_m()) return seed;
  return seed ^ Fnv1a(file.description());
}

class Drawing {
 public:
  Drawing(const File& file, std::uint64_t seed, SceneFaults& faults)
      : file_(WithDrawnNumbers(file, seed)),
        seed_(seed),
        faults_(faults),
        land_random_(seed_, kSceneStream),
        own_boat_random_(seed_, kOwnBoatStream),
        traffic_(file.lasts_s()) {}

  // @return nullopt when a family's own boat has no place; why says no_place
  std::optional<Scene> Run() {
    DrawWithoutObjects();
    const auto& own_boat = file_.own_boat();
    bool is_to_place = own_boat.has_free_by_m();
    for (int i = 0; i < file_.object_size(); ++i) {
      if (is_to_place && own_boat.has_before() && file_.object(i).name() == own_boat.before()) {
        if (!PlaceOwnBoat()) return std::nullopt;
        is_to_place = false;
        LetThingsLieBesideOwnBoat();
      }
      AddObjects(file_.object(i), i);
    }
    if (is_to_place && !PlaceOwnBoat()) return std::nullopt;
    return std::move(scene_);
  }

  const std::string& no_place() const { return no_place_; }

 private:
  struct ShoreOnMap {
    Vector2d middle_m;
    Waterline waterline_m;
  };

  void DrawWithoutObjects() {
    if (!file_.own_boat().has_free_by_m()) {
      scene_.own_motion = DrawOwnMotion(file_.own_boat(), own_boat_random_, land_random_);
      traffic_.SetOwnBoat(scene_.own_motion);
    }
    scene_.effects = file_.effects();
    if (file_.has_lidar()) scene_.lidar = file_.lidar();
    if (file_.has_lasts_s()) scene_.lasts_s = file_.lasts_s();
    Random sea_random(seed_, kSeaStream);
    scene_.sea = Sea::Draw(file_.sea(), sea_random);
  }

  // Where it keeps clear of everything there is. @return whether there is such a place
  bool PlaceOwnBoat() {
    const auto& boat = file_.own_boat();
    std::optional<Approach> too_near;
    for (int num_tries = 0; num_tries < kMaxOwnTries; ++num_tries) {
      OwnMotion motion = DrawOwnMotion(boat, own_boat_random_, land_random_);
      // Else anywhere in its ranges: there happens to be none.
      if (boat.has_beside() && edges_.Has(boat.beside().object())) {
        Edges::Row row;
        // As large as a boat: the distance is kept from its hull.
        const auto found = edges_.Draw(boat.beside(), kOwnOutline, motion.track.start.heading_rad, 0, row, own_boat_random_);
        if (!found) break;
        motion.track.start = found->placement;
      }
      too_near = traffic_.OfOwnBoat(motion, boat.free_by_m());
      if (too_near) continue;
      scene_.own_motion = motion;
      return true;
    }
    const std::string at_last = too_near ? fmt::format(": at the last it comes to {:.2f} m of {}", too_near->distance_m, too_near->name) : "";
    no_place_ = fmt::format("no place in {} tries{}", kMaxOwnTries, at_last);
    return false;
  }

  void LetThingsLieBesideOwnBoat() {
    const OwnState start = StateAt(scene_.own_motion, 0.0, 0.0);
    const Placement placement{start.position_map_m.head<2>(), start.heading_rad};
    std::vector<Vector2d> edge_m;
    edge_m.reserve(kOwnOutline.size());
    for (const auto& p_m : kOwnOutline) edge_m.push_back(placement.ToMap(p_m));
    // Starboard and port, from corner to corner of the outline, which begins at the stern to starboard.
    edges_.Add(std::string(kOwnSidesName), kOwnBoatEdge, {edge_m[0], edge_m[1]}, false);
    edges_.Add(std::string(kOwnSidesName), kOwnBoatEdge, {edge_m[2], edge_m[3]}, false);
    edges_.Add(std::string(kOwnBoatName), kOwnBoatEdge, edge_m, true);
    traffic_.SetOwnBoat(scene_.own_motion);
  }

  [[noreturn]] void Stop(const std::string& field, const std::string& reason) {
    faults_.Add(field, reason);
    faults_.ThrowIfAny();
    throw std::logic_error("a fault was lost");
  }

  SceneObject DrawBody(const File::Object& file, const std::string& field, Random& random) try {
    num_front_ = 0;  // the old number was of land which found no place
    reach_m_.clear();
    if (file.kind() == File::PILE_PIER || file.kind() == File::BRIDGE) {
      const bool is_pier = file.kind() == File::PILE_PIER;
      const Size size{Draw(file.length_m(), is_pier ? 30.0 : 80.0, random), Draw(file.width_m(), is_pier ? 3.0 : 8.0, random),
                      Draw(file.height_m(), 0.0, random), Draw(file.reflectance(), 0.0, random)};
      return is_pier ? MakePilePier(size, random) : MakeBridge(size, random);
    }
    if (IsLand(file.kind()) && !file.land().has_mean_radius_m()) {
      Line along_m;
      if (file.has_opposite()) along_m = Opposite(lines_.at(file.opposite().object()), Draw(file.opposite().distance_m(), 0.0, random));
      Coast coast = MakeLand(file, file.has_opposite() ? &along_m : nullptr, random);
      line_m_ = coast.line_m;
      num_front_ = coast.num_front;
      reach_m_ = std::move(coast.reach_m);
      return std::move(coast.object);
    }
    const KindOfObject* kind = FindKind(file.kind());
    if (kind != nullptr) {
      const Size usual = kind->is_drawn() ? Size{} : kind->usual;
      Size size;
      size.length_m = Draw(file.length_m(), usual.length_m, random);
      size.width_m = Draw(file.width_m(), usual.width_m, random);
      size.height_m = Draw(file.height_m(), usual.height_m, random);
      size.reflectance = Draw(file.reflectance(), usual.reflectance, random);
      return MakeObject(*kind, size, random);
    }
    if (file.kind() == File::ISLAND) return MakeIsland(file.land(), land_random_);
    Shore shore = MakeShore(file.land(), land_random_);
    shore_ = ShoreOnMap{Vector2d::Zero(), shore.waterline_m};
    return std::move(shore.object);
  } catch (const std::length_error& error) {
    Stop(field + ".land", error.what());
  }

  Placement DrawPlace(const File::Object& file, Random& random) {
    if (file.has_on_shore_bearing_deg()) {
      // A metre into the land, so that no gap is seen between them.
      const double bearing_rad = DegToRad(file.on_shore_bearing_deg());
      return {shore_->middle_m + PlaceAtBearing(bearing_rad, shore_->waterline_m(bearing_rad) + 1.0), bearing_rad + kPi};
    }
    const double east_m = Draw(file.east_m(), 0.0, random);
    const double north_m = Draw(file.north_m(), 0.0, random);
    return {{east_m, north_m}, DegToRad(Draw(file.heading_deg(), 0.0, random))};
  }

  Track DrawTrack(const File::Object& file, const std::string& field, const Placement& place, Random& random) {
    if (!file.has_path()) return Track{place};
    const auto& path = file.path();
    const double speed_mps = Draw(path.speed_mps(), 0.0, random);
    if (path.has_circle()) {
      const double bearing_rad = DegToRad(Draw(path.circle().from_bearing_deg(), 0.0, random));
      const double side = path.circle().is_clockwise() ? 1.0 : -1.0;
      const double radius_m = path.circle().radius_m();
      return {{place.position_map_m + PlaceAtBearing(bearing_rad, radius_m), WrapTo2Pi(bearing_rad + side * kPi / 2.0)},
              speed_mps,
              side * speed_mps / radius_m};
    }
    if (path.waypoint().empty()) return Track{place, speed_mps};
    std::vector<Vector2d> points_m{place.position_map_m};
    for (const auto& waypoint : path.waypoint()) points_m.emplace_back(waypoint.east_m(), waypoint.north_m());
    const std::size_t num_points = points_m.size();
    if (num_points == 2 && (points_m[1] - points_m[0]).isZero()) Stop(field + ".path.waypoint[0]", "is where the object starts");
    for (std::size_t i = path.is_closed() ? 0 : 1; num_points > 2 && i < (path.is_closed() ? num_points : num_points - 1); ++i) {
      if (IsBadCorner(points_m[(i + num_points - 1) % num_points], points_m[i], points_m[(i + 1) % num_points])) {
        std::string waypoint = field + ".path.waypoint";
        if (i > 0) waypoint += "[" + std::to_string(i - 1) + "]";
        Stop(waypoint, "the path stands still here, or turns back on the spot");
      }
    }
    return MakeRoute(points_m, speed_mps, path.turn_radius_m(), path.is_closed());
  }

  // Moves an object along the row until the asked-for gap lies between it and the object before.
  void PutInRow(const File::Object& file, const SceneObject& before, Random& random, SceneObject& object) {
    const Vector2d along = PlaceAtBearing(DegToRad(file.row().bearing_deg()), 1.0);
    const auto reach_m = [&along](const SceneObject& of, double sign) {
      double greatest_m = -1e9;
      for (const auto& p_m : of.outline_m) greatest_m = std::max(greatest_m, sign * along.dot(of.track.start.ToMap(p_m)));
      return sign * greatest_m;
    };
    const double from_m = reach_m(before, 1.0) + Draw(file.row().gap_m(), 0.0, random);
    object.track.start.position_map_m += (from_m - reach_m(object, -1.0)) * along;
  }

  // Whether another try may find another place.
  static bool IsDrawn(const File::Object& file) {
    if (file.has_on_shore_bearing_deg()) return false;
    const auto is_range = [](const Numbers& numbers) { return numbers.size() == 2; };
    return is_range(file.east_m()) || is_range(file.north_m()) || is_range(file.heading_deg()) || is_range(file.length_m()) ||
           is_range(file.width_m()) || is_range(file.path().speed_mps()) || is_range(file.path().circle().from_bearing_deg()) ||
           is_range(file.row().gap_m()) || file.has_beside();
  }

  std::string NameOfObject(const File::Object& file, const std::string& field, int member) {
    std::string name = file.name();
    if (name.empty()) {
      name = NameOf(file.kind()) + "_" + std::to_string(++num_unnamed_[file.kind()]);
    } else if (file.count() > 1 || !file.number().empty()) {
      name += "_" + std::to_string(member + 1);
    }
    if (!names_.insert(name).second) Stop(field + ".name", "there are two objects of the name " + name);
    return name;
  }

  // Beside another object, or as the file says.
  std::optional<Edges::Found> DrawBeside(const File::Object& file, const SceneObject& object, int member, Edges::Row& row, Random& random) {
    const double heading_rad = file.heading_deg().empty() ? random.Uniform(0.0, kTwoPi) : DegToRad(Draw(file.heading_deg(), 0.0, random));
    return edges_.Draw(file.beside(), object.outline_m, heading_rad, member, row, random);
  }

  // Adds the edges of an object beside which others may lie, also across the water.
  void AddEdges(const std::string& name, const SceneObject& object) {
    const auto to_map = [&object](const std::vector<Vector2d>& line_m) {
      std::vector<Vector2d> map_m;
      map_m.reserve(line_m.size());
      for (const auto& p_m : line_m) map_m.push_back(object.track.start.ToMap(p_m));
      return map_m;
    };
    const bool is_open = num_front_ > 0 && num_front_ < object.outline_m.size();
    const auto front_m = is_open ? std::vector<Vector2d>(object.outline_m.begin(), object.outline_m.begin() + static_cast<std::ptrdiff_t>(num_front_))
                                 : object.outline_m;
    edges_.Add(name, scene_.objects.size(), to_map(front_m), !is_open, std::exchange(reach_m_, {}));
    if (is_open) lines_[name] = to_map(line_m_);
    num_front_ = 0;
  }

  // Why an object cannot be where it is.
  std::optional<Approach> IsInTheWay(const File::Object& file, const SceneObject& object, const std::optional<Edges::Found>& found, bool is_drawn,
                                     std::size_t num_before) const {
    const bool is_in_row = file.has_row();
    if (auto near = traffic_.ToOwnBoat(object, file_.own_boat().has_free_by_m() ? file_.own_boat().free_by_m() : kOwnBoatClearanceM)) return near;
    if (found && found->least_gap_m > 0.0 && found->object != kOwnBoatEdge) {
      if (auto near = traffic_.ToOne(object, found->least_gap_m, found->object)) return near;
    }
    // Neighbours in a row are as near as its gaps say, and exact places as near as they are written; but no two hulls are in one place.
    if (is_drawn) {
      const auto skipped = found ? std::optional<std::size_t>(found->object) : std::nullopt;
      if (auto near = traffic_.ToOthers(object, file.min_distance_m(), is_in_row ? num_before : traffic_.num_objects(), skipped)) return near;
    }
    return traffic_.Overlapping(object);
  }

  void AddObjects(const File::Object& entry, int index) {
    const std::string field = "object[" + std::to_string(index) + "]";
    Random random(seed_, kFirstObjectStream + static_cast<std::uint64_t>(index));
    if (entry.has_chance() && random.Uniform() >= entry.chance()) return;
    const bool is_family = !entry.number().empty();
    const int count = is_family ? static_cast<int>(std::lround(Draw(entry.number(), 0.0, random))) : entry.count();
    const std::size_t num_before = traffic_.num_objects();
    Edges::Row row;
    for (int member = 0; member < count; ++member) {
      const File::Object file = DrawMember(entry, random);
      const bool is_drawn = IsDrawn(file);
      const std::string name = NameOfObject(file, field, member);
      // There happens to be none.
      if (file.has_beside() && !edges_.Has(file.beside().object())) continue;
      if (file.has_opposite() && !edges_.Has(file.opposite().object())) continue;
      if (file.has_on_shore_bearing_deg() && !shore_) continue;
      if (file.has_opposite() && !lines_.contains(file.opposite().object())) {
        Stop(field + ".opposite.object", file.opposite().object() + " is no coast and no quay");
      }
      for (int num_tries = 1;; ++num_tries) {
        SceneObject object = DrawBody(file, field, random);
        object.name = name;
        std::optional<Edges::Found> found;
        if (file.has_beside()) {
          found = DrawBeside(file, object, member, row, random);
          if (!found) break;
        }
        const Placement place = found ? found->placement : file.has_opposite() ? Placement{{0.0, 0.0}, kPi / 2.0} : DrawPlace(file, random);
        if (file.kind() == File::SHORE) shore_->middle_m = place.position_map_m;
        object.track = DrawTrack(file, field, place, random);
        if (file.has_row() && traffic_.num_objects() > num_before) PutInRow(file, scene_.objects.back(), random, object);
        const auto too_near = IsInTheWay(file, object, found, is_drawn, num_before);
        if (!too_near) {
          object.id = static_cast<int>(scene_.objects.size()) + 1;
          bytes_in_truth_ += BytesInTruth(object);
          if (bytes_in_truth_ > kMaxBytesOfObjects) Stop(field, "too many objects, or too long an outline: all must fit into one message of 120 kB");
          AddEdges(entry.name(), object);
          if (found) row.along_m = found->next_along_m;
          traffic_.Add(object, file.is_passed_under());
          // It would end at the border of the reeds. Nothing else lies there: all keep clear of the outline of the land.
          constexpr double kIntoLandM = 0.5;
          if (found && found->to_land_m > 0.0 && IsBuiltOut(file.kind())) ProlongToLand(found->to_land_m + kIntoLandM, object);
          scene_.objects.push_back(std::move(object));
          break;
        }
        if (is_drawn && num_tries < kMaxTries) continue;
        if (is_family) break;
        const std::string reason = too_near->limit_m == 0.0
                                       ? fmt::format("{} and {} are in one place within {:.0f} s", name, too_near->name, file_.lasts_s())
                                       : fmt::format("{} comes to {:.2f} m of {} within {:.0f} s, must stay {:.2f} m away", name,
                                                     too_near->distance_m, too_near->name, file_.lasts_s(), too_near->limit_m);
        Stop(field, is_drawn ? fmt::format("no place in {} tries: at the last {}", kMaxTries, reason) : reason);
      }
    }
  }

  const File file_;
  std::uint64_t seed_;
  SceneFaults& faults_;
  Random land_random_;
  Random own_boat_random_;
  Scene scene_{};
  Traffic traffic_;
  std::optional<ShoreOnMap> shore_;
  Edges edges_;
  std::map<std::string, Line> lines_;  // of coasts, in the map
  Line line_m_;                        // of the body drawn last
  std::size_t num_front_ = 0;          // of it; 0: its whole outline
  std::vector<double> reach_m_;        // of these vertices
  std::size_t bytes_in_truth_ = 0;
  std::string no_place_;
  std::map<File::Kind, int> num_unnamed_;
  std::set<std::string> names_;
};

}  // namespace

Scene DrawScene(const File& scene, std::uint64_t seed, SceneFaults& faults) {
  const std::uint64_t first_seed = SeedOf(scene, seed);
  const File of_layout =
      WithDrawnLayout(scene, first_seed);  // drawn once, so that layouts in which a place is hard to find come as often as they should
  for (std::uint64_t i = 0;; ++i) {
    Drawing drawing(of_layout, i == 0 ? first_seed : Random(first_seed, kRedrawStream + i).Next(), faults);
    if (auto drawn = drawing.Run()) return std::move(*drawn);
    if (i + 1 < kMaxLayouts) continue;
    faults.Add("own_boat", fmt::format("seed {}: {}, in the last of {} layouts", seed, drawing.no_place(), kMaxLayouts));
    faults.ThrowIfAny();
  }
}

}  // namespace lookout::sim
