#include "tools/sim/scene_check.hpp"

#include <algorithm>
#include <cctype>

namespace lookout::sim {
namespace {

using File = config::Scene;
using Numbers = google::protobuf::RepeatedField<double>;

// Of an object's path in the file, with what is asked of its fields.
class Checker {
 public:
  Checker(std::string path, SceneFaults& faults) : path_(std::move(path)), faults_(faults) {}

  void Refuse(const std::string& field, const std::string& reason) { faults_.Add(path_ + field, reason); }

  void Range(const std::string& field, const Numbers& numbers) {
    if (numbers.size() > 2) {
      Refuse(field, "must be a value or a range of two values");
    } else if (numbers.size() == 2 && numbers[0] > numbers[1]) {
      Refuse(field, "the range must run from the lesser to the greater value");
    }
  }

  void NeedRange(const std::string& field, const Numbers& numbers) {
    if (numbers.empty()) Refuse(field, "must be set");
    Range(field, numbers);
  }

  // @param reason  why it must not be set
  void Forbid(const std::string& field, bool is_set, const std::string& reason) {
    if (is_set) Refuse(field, reason);
  }

 private:
  std::string path_;
  SceneFaults& faults_;
};

bool IsLand(File::Kind kind) { return kind == File::SHORE || kind == File::ISLAND; }

void CheckOwnBoat(const File::OwnBoat& boat, SceneFaults& faults) {
  Checker check("own_boat.", faults);
  check.Range("east_m", boat.east_m());
  check.Range("north_m", boat.north_m());
  check.Range("heading_deg", boat.heading_deg());
  check.Range("speed_mps", boat.speed_mps());
  check.Range("turn_rate_degps", boat.turn_rate_degps());
  if (!boat.has_ellipse()) return;
  check.Forbid("heading_deg", boat.heading_deg_size() > 0, "the ellipse says it");
  check.Forbid("speed_mps", boat.speed_mps_size() > 0, "the ellipse says it");
  check.Forbid("turn_rate_degps", boat.turn_rate_degps_size() > 0, "the ellipse says it");
}

void CheckName(const File::Object& object, Checker& check) {
  if (!object.has_name()) return;
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (object.name().empty() || !std::ranges::all_of(object.name(), is_allowed)) {
    check.Refuse("name", "must consist of lower case letters, digits and _ (is \"" + object.name() + "\")");
  }
}

void CheckSize(const File::Object& object, Checker& check) {
  check.Range("length_m", object.length_m());
  check.Range("width_m", object.width_m());
  check.Range("height_m", object.height_m());
  check.Range("reflectance", object.reflectance());
  const KindOfObject* kind = FindKind(object.kind());
  const Size usual = kind == nullptr ? Size{} : kind->usual;
  const std::string reason = "a " + NameOf(object.kind()) + " has none";
  check.Forbid("length_m", object.length_m_size() > 0 && usual.length_m == 0.0, reason);
  check.Forbid("width_m", object.width_m_size() > 0 && usual.width_m == 0.0, reason);
  check.Forbid("height_m", object.height_m_size() > 0 && usual.height_m == 0.0, reason);
  check.Forbid("reflectance", object.reflectance_size() > 0 && usual.reflectance == 0.0, reason);
}

void CheckLand(const File::Object& object, Checker& check) {
  if (!IsLand(object.kind())) {
    check.Forbid("land", object.has_land(), "only a shore or an island has it");
    return;
  }
  if (!object.has_land()) {
    check.Refuse("land", "must be set");
    return;
  }
  if (object.land().roughness_m() >= object.land().mean_radius_m()) check.Refuse("land.roughness_m", "must be less than mean_radius_m");
  check.Forbid("heading_deg", object.heading_deg_size() > 0, "land has none");
  if (object.kind() == File::ISLAND) {
    check.Forbid("land.from_bearing_deg", object.land().has_from_bearing_deg(), "an island goes all round");
    check.Forbid("land.width_deg", object.land().has_width_deg(), "an island goes all round");
  }
}

void CheckPlace(const File::Object& object, bool has_shore_before, Checker& check) {
  check.Range("east_m", object.east_m());
  check.Range("north_m", object.north_m());
  check.Range("heading_deg", object.heading_deg());
  if (object.has_on_shore_bearing_deg()) {
    if (object.kind() != File::DOCK && object.kind() != File::PIER) check.Refuse("on_shore_bearing_deg", "only a dock or a pier has it");
    if (!has_shore_before) check.Refuse("on_shore_bearing_deg", "there is no shore before it");
    check.Forbid("east_m", object.east_m_size() > 0, "the shore says it");
    check.Forbid("north_m", object.north_m_size() > 0, "the shore says it");
    check.Forbid("heading_deg", object.heading_deg_size() > 0, "the shore says it");
    check.Forbid("count", object.count() > 1, "must be 1 on a shore");
  }
  if (object.has_row()) {
    check.NeedRange("row.gap_m", object.row().gap_m());
    if (object.count() < 2) check.Refuse("row", "needs a count of two or more");
  }
}

void CheckPath(const File::Object& object, Checker& check) {
  if (!object.has_path()) return;
  const KindOfObject* kind = FindKind(object.kind());
  if (kind == nullptr || !kind->is_afloat) check.Refuse("path", "a " + NameOf(object.kind()) + " cannot move");
  const auto& path = object.path();
  check.NeedRange("path.speed_mps", path.speed_mps());
  if (path.has_circle()) check.Range("path.circle.from_bearing_deg", path.circle().from_bearing_deg());
  check.Forbid("path.circle", path.has_circle() && path.waypoint_size() > 0, "not with waypoints");
  check.Forbid("row", object.has_row() && path.waypoint_size() > 0, "not with waypoints");
  check.Forbid("path.is_closed", path.is_closed() && path.waypoint_size() < 2, "needs two waypoints or more");
  check.Forbid("heading_deg", object.heading_deg_size() > 0 && (path.has_circle() || path.waypoint_size() > 0), "the path says it");
}

}  // namespace

std::string NameOf(File::Kind kind) {
  std::string name = File::Kind_Name(kind);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

const KindOfObject* FindKind(File::Kind kind) {
  const auto found = std::ranges::find(Kinds(), NameOf(kind), &KindOfObject::name);
  return found == Kinds().end() ? nullptr : &*found;
}

void CheckScene(const File& scene, SceneFaults& faults) {
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (scene.description().empty() || !std::ranges::all_of(scene.description(), is_printable)) {
    faults.Add("description", "must be one line of printable ASCII");
  }
  CheckOwnBoat(scene.own_boat(), faults);
  // Michell, "The highest waves in water", 1893: no wave is higher than about a seventh of its length.
  if (scene.has_sea() && scene.sea().significant_height_m() > scene.sea().wavelength_m() / 7.0) {
    faults.Add("sea.significant_height_m", "must be at most a seventh of wavelength_m, or the waves break");
  }
  bool has_shore = false;
  for (int i = 0; i < scene.object_size(); ++i) {
    const auto& object = scene.object(i);
    Checker check("object[" + std::to_string(i) + "].", faults);
    CheckName(object, check);
    CheckSize(object, check);
    CheckLand(object, check);
    CheckPlace(object, has_shore, check);
    CheckPath(object, check);
    has_shore = has_shore || object.kind() == File::SHORE;
  }
}

}  // namespace lookout::sim
