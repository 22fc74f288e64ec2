#include "lab/sim/scene_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "common/config/text_config.hpp"
#include "lab/sim/family.hpp"
#include "lab/sim/heads.hpp"
#include "lab/sim/scene_maker.hpp"

namespace lookout::sim {
namespace {

namespace fs = std::filesystem;
using File = config::Scene;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr std::string_view kExtension = ".txtpb";
constexpr const char* kScenes = "scenes";
constexpr std::string_view kFamilies = "families";  // the folder of theirs among the scenes

// Empty where the kernel does not tell.
fs::path ThisProgram() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

// By name; what lies in a folder hides a scene of that name in those behind it.
std::map<std::string, fs::path> SceneFiles(const std::vector<fs::path>& scene_folders, const fs::path& subfolder) {
  std::map<std::string, fs::path> files;
  for (const auto& scenes : scene_folders) {
    const fs::path folder = subfolder.empty() ? scenes : scenes / subfolder;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == kExtension) files.emplace(entry.path().stem().string(), entry.path());
    }
  }
  return files;
}

std::map<std::string, fs::path> SceneFiles(const fs::path& config_folder, const fs::path& subfolder) {
  return SceneFiles(SceneFolders(config_folder, ThisProgram()), subfolder);
}

bool IsLand(File::Kind kind) {
  return kind == File::SHORE || kind == File::ISLAND || kind == File::COAST || kind == File::QUAY || kind == File::BREAKWATER;
}

// Whether the sizes of an object are free: sizes of land, or sizes drawn by its maker.
bool HasFreeSizes(const File::Object& object) {
  return object.kind() == File::PILE_PIER || object.kind() == File::BRIDGE || (IsLand(object.kind()) && !object.land().has_mean_radius_m());
}

// From its landward end out into the water.
bool IsDock(File::Kind kind) {
  constexpr std::array kDocks{File::DOCK, File::PIER, File::JETTY, File::PONTOON, File::DOCK_BAYS, File::ANY_DOCK};
  return std::ranges::find(kDocks, kind) != kDocks.end();
}

// Checks one message of the file.
class Checker {
 public:
  // @param path  of the message in the file, with a dot behind it
  Checker(const Message& message, std::string path, SceneFaults& faults) : message_(message), path_(std::move(path)), faults_(faults) {}

  void Refuse(const std::string& field, const std::string& reason) { faults_.Add(path_ + field, reason); }

  void RefuseIf(bool is_wrong, const std::string& field, const std::string& reason) {
    if (is_wrong) Refuse(field, reason);
  }

  // For each of the fields that the file sets.
  void Forbid(std::initializer_list<const char*> fields, const std::string& reason) {
    const auto* reflection = message_.GetReflection();
    for (const char* name : fields) {
      const auto* field = message_.GetDescriptor()->FindFieldByName(name);
      RefuseIf(field->is_repeated() ? reflection->FieldSize(message_, field) > 0 : reflection->HasField(message_, field), name, reason);
    }
  }

 private:
  const Message& message_;
  std::string path_;
  SceneFaults& faults_;
};

// Every repeated number of the schema is "value or range".
void CheckRanges(const Message& message, const std::string& path, SceneFaults& faults) {
  const auto* reflection = message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const auto* field : fields) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      for (int i = 0; field->is_repeated() && i < reflection->FieldSize(message, field); ++i) {
        CheckRanges(reflection->GetRepeatedMessage(message, field, i), path + field->name() + "[" + std::to_string(i) + "].", faults);
      }
      if (!field->is_repeated()) CheckRanges(reflection->GetMessage(message, field), path + field->name() + ".", faults);
    } else if (field->is_repeated() && field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
      const int num_values = reflection->FieldSize(message, field);
      if (num_values > 2) faults.Add(path + field->name(), "must be a value or a range of two values");
      if (num_values == 2 && reflection->GetRepeatedDouble(message, field, 0) > reflection->GetRepeatedDouble(message, field, 1)) {
        faults.Add(path + field->name(), "the range must run from the lesser to the greater value");
      }
    }
  }
}

void CheckNameAndSize(const File::Object& object, Checker& check) {
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  check.RefuseIf(object.has_name() && (object.name().empty() || !std::ranges::all_of(object.name(), is_allowed)), "name",
                 "must consist of lower case letters, digits and _ (is \"" + object.name() + "\")");
  check.RefuseIf(object.name() == kOwnBoatName || object.name() == kOwnSidesName, "name", "is that of the own boat");
  if (HasFreeSizes(object)) return;
  const KindOfObject* kind = FindKind(object.kind());
  const Size usual = kind == nullptr ? Size{} : kind->usual;
  const std::string reason = "a " + NameOf(object.kind()) + " has none";
  if (usual.length_m == 0.0) check.Forbid({"length_m"}, reason);
  if (usual.width_m == 0.0) check.Forbid({"width_m"}, reason);
  if (usual.height_m == 0.0) check.Forbid({"height_m"}, reason);
  if (usual.reflectance == 0.0) check.Forbid({"reflectance"}, reason);
}

void CheckLand(const File::Object& object, Checker& check) {
  if (!IsLand(object.kind())) return check.Forbid({"land"}, "only a shore or an island has it");
  if (!object.has_land()) return check.Refuse("land", "must be set");
  const bool is_ring = object.kind() == File::SHORE || (object.kind() == File::ISLAND && object.land().edge().empty());
  check.RefuseIf(is_ring && !object.land().has_mean_radius_m(), "land.mean_radius_m", "must be set");
  check.RefuseIf(!is_ring && object.land().has_mean_radius_m(), "land.mean_radius_m", "land with edges has length_m");
  check.RefuseIf(is_ring && !object.land().edge().empty(), "land.edge", "a coast has edges");
  if (!is_ring) return;
  check.RefuseIf(object.land().roughness_m() >= object.land().mean_radius_m(), "land.roughness_m", "must be less than mean_radius_m");
  check.Forbid({"heading_deg"}, "land has none");
  if (object.kind() != File::ISLAND) return;
  check.RefuseIf(object.land().has_from_bearing_deg(), "land.from_bearing_deg", "an island goes all round");
  check.RefuseIf(object.land().has_width_deg(), "land.width_deg", "an island goes all round");
}

void CheckPlace(const File::Object& object, bool has_shore_before, Checker& check) {
  if (object.has_on_shore_bearing_deg()) {
    check.RefuseIf(!IsDock(object.kind()), "on_shore_bearing_deg", "only a dock or a pier has it");
    check.RefuseIf(!has_shore_before, "on_shore_bearing_deg", "there is no shore before it");
    check.Forbid({"east_m", "north_m", "heading_deg"}, "the shore says it");
    check.RefuseIf(object.count() > 1, "count", "must be 1 on a shore");
  }
  if (object.has_row()) {
    check.RefuseIf(object.row().gap_m().empty(), "row.gap_m", "must be set");
    check.RefuseIf(object.count() < 2 && object.number().empty(), "row", "needs a count of two or more");
  }
}

void CheckPath(const File::Object& object, Checker& check) {
  if (!object.has_path()) return;
  const KindOfObject* kind = FindKind(object.kind());
  const auto& path = object.path();
  const bool has_waypoints = path.waypoint_size() > 0;
  check.RefuseIf(kind == nullptr || !kind->is_afloat, "path", "a " + NameOf(object.kind()) + " cannot move");
  check.RefuseIf(object.kind() == File::ANY_BUOY, "path", "some of its kinds stand on the ground; name one that floats");
  check.RefuseIf(path.speed_mps().empty(), "path.speed_mps", "must be set");
  check.RefuseIf(path.has_circle() && has_waypoints, "path.circle", "not with waypoints");
  check.RefuseIf(object.has_row() && has_waypoints, "row", "not with waypoints");
  check.RefuseIf(path.is_closed() && path.waypoint_size() < 2, "path.is_closed", "needs two waypoints or more");
  if (path.has_circle() || has_waypoints) check.Forbid({"heading_deg"}, "the path says it");
}

// Ranges from the lesser to the greater value, fields that suit the kind, paths that can be followed, names that fit into a table.
void CheckScene(const File& scene, SceneFaults& faults) {
  CheckRanges(scene, "", faults);
  const auto is_printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (scene.description().empty() || !std::ranges::all_of(scene.description(), is_printable)) {
    faults.Add("description", "must be one line of printable ASCII");
  }
  if (const auto names = HeadNames(); scene.has_lidar() && std::ranges::find(names, scene.lidar()) == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    faults.Add("lidar", "there is no such head; there are: " + known);
  }
  Checker own_boat_to(scene.own_boat_to(), "own_boat_to.", faults);
  own_boat_to.Forbid({"east_m", "north_m", "heading_deg", "speed_mps", "turn_rate_degps", "ellipse", "beside"},
                     "own_boat says it, as a range where it is drawn");
  // Michell, "The highest waves in water", 1893: no wave is higher than about a seventh of its length.
  if (scene.has_sea() && scene.sea().significant_height_m() > scene.sea().wavelength_m() / 7.0) {
    faults.Add("sea.significant_height_m", "must be at most a seventh of wavelength_m, or the waves break");
  }
  std::set<std::string> names;
  const auto check_beside = [&names, &faults](const auto& place, const std::string& path) {
    if (!names.contains(place.object())) faults.Add(path + ".object", "there is no object of this name before it");
  };
  const auto check_own_boat = [&](const File::OwnBoat& own_boat, const std::string& path) {
    Checker check(own_boat, path + ".", faults);
    if (own_boat.has_ellipse()) check.Forbid({"heading_deg", "speed_mps", "turn_rate_degps", "beside"}, "the ellipse says it");
    if (!own_boat.has_free_by_m()) check.Forbid({"beside", "before"}, "only with free_by_m");
    const auto& objects = scene.object();
    const auto before = std::ranges::find(objects, own_boat.before(), &File::Object::name);
    check.RefuseIf(own_boat.has_before() && before == objects.end(), "before", "there is no object of this name");
    if (!own_boat.has_beside()) return;
    for (auto object = objects.begin(); object != (own_boat.has_before() ? before : objects.end()); ++object) names.insert(object->name());
    check_beside(own_boat.beside(), path + ".beside");
    check.RefuseIf(own_boat.beside().gap_m().empty(), "beside.gap_m", "must be set");
    names.clear();
  };
  check_own_boat(scene.own_boat(), "own_boat");
  std::set<std::string> layouts;
  for (int i = 0; i < scene.layout_size(); ++i) {
    const auto& layout = scene.layout(i);
    const std::string path = "layout[" + std::to_string(i) + "]";
    if (!layouts.insert(layout.name()).second) faults.Add(path + ".name", "there are two layouts of the name " + layout.name());
    Checker(layout.own_boat(), path + ".own_boat.", faults).Forbid({"free_by_m", "before"}, "own_boat says it");
    check_own_boat(OwnBoatIn(layout, scene.own_boat()), path + ".own_boat");
  }
  bool has_shore = false;
  for (int i = 0; i < scene.object_size(); ++i) {
    const std::string path = "object[" + std::to_string(i) + "]";
    const auto check_one = [&](const File::Object& object, const std::string& one_path) {
      Checker check(object, one_path + ".", faults);
      if (!object.has_kind()) return faults.Add(one_path, "kind: must be set");
      CheckNameAndSize(object, check);
      CheckLand(object, check);
      CheckPlace(object, has_shore, check);
      CheckPath(object, check);
      check.RefuseIf(object.is_passed_under() && object.kind() != File::PILE_PIER && object.kind() != File::BRIDGE, "is_passed_under",
                     "only a pier on piles or a bridge has it");
      if (object.has_beside()) check_beside(object.beside(), one_path + ".beside");
      check.RefuseIf(object.has_beside() && object.beside().gap_m().empty(), "beside.gap_m", "must be set");
      if (object.has_opposite()) check_beside(object.opposite(), one_path + ".opposite");
      check.RefuseIf(object.has_opposite() && object.opposite().distance_m().empty(), "opposite.distance_m", "must be set");
      check.RefuseIf(object.has_opposite() && object.kind() != File::COAST && object.kind() != File::QUAY, "opposite",
                     "only a coast or a quay has it");
      has_shore = has_shore || object.kind() == File::SHORE;
    };
    const auto& object = scene.object(i);
    if (scene.own_boat().has_before() && object.name() == scene.own_boat().before()) {
      names.insert({std::string(kOwnBoatName), std::string(kOwnSidesName)});
    }
    for (int k = 0; k < object.layout_size(); ++k) {
      const std::string layout_path = path + ".layout[" + std::to_string(k) + "]";
      if (!layouts.contains(object.layout(k))) faults.Add(layout_path, "there is no layout of the name " + object.layout(k));
    }
    if (object.one_of().empty()) check_one(object, path);
    for (int k = 0; k < object.one_of_size(); ++k) {
      Checker one(object.one_of(k), path + ".one_of[" + std::to_string(k) + "].", faults);
      one.Forbid({"name", "count", "number", "chance", "one_of", "layout"}, "the object around it says it");
    }
    for (int k = 0; k < object.one_of_size(); ++k) check_one(MergedWith(object, object.one_of(k)), path + ".one_of[" + std::to_string(k) + "]");
    names.insert(object.name());
  }
}

}  // namespace

SceneFaults::SceneFaults(const std::string& text, std::string name) : name_(std::move(name)) {
  File scene;
  google::protobuf::TextFormat::Parser parser;
  parser.WriteLocationsTo(&positions_);
  parser.ParseFromString(text, &scene);
}

void SceneFaults::Add(const std::string& field, const std::string& reason) {
  faults_.push_back(name_ + ":" + std::to_string(LineOf(field)) + ": " + field + ": " + reason);
}

void SceneFaults::ThrowIfAny() const {
  if (!faults_.empty()) throw config::ConfigError(faults_);
}

int SceneFaults::LineOf(const std::string& field) const {
  const auto* tree = &positions_;
  const auto* message = File::descriptor();
  int line = 0;
  std::istringstream parts(field);
  for (std::string part; tree != nullptr && message != nullptr && std::getline(parts, part, '.');) {
    const std::size_t bracket = part.find('[');
    const auto* descriptor = message->FindFieldByName(part.substr(0, bracket));
    if (descriptor == nullptr) break;
    int index = descriptor->is_repeated() ? 0 : -1;
    if (bracket != std::string::npos) index = std::stoi(part.substr(bracket + 1));
    const int found = tree->GetLocation(descriptor, index).line;
    if (found < 0) break;
    line = found;
    message = descriptor->message_type();
    tree = message == nullptr ? nullptr : tree->GetTreeForNested(descriptor, index);
  }
  return line + 1;
}

std::string NameOf(File::Kind kind) {
  std::string name = File::Kind_Name(kind);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

const KindOfObject* FindKind(File::Kind kind) {
  const auto found = std::ranges::find(Kinds(), NameOf(kind), &KindOfObject::name);
  return found == Kinds().end() ? nullptr : &*found;
}

std::vector<fs::path> SceneFolders(const fs::path& config_folder, const fs::path& program) {
  std::vector<fs::path> folders;
  const auto add = [&folders](const fs::path& folder) {
    if (std::ranges::find(folders, folder) == folders.end()) folders.push_back(folder);
  };
  // "config/demo/" has an empty last part.
  const fs::path boat = (config_folder / "").lexically_normal().parent_path();
  add(boat / kScenes);
  add(boat.parent_path() / kScenes);
  std::error_code error;
  for (auto parent = fs::absolute(boat, error).lexically_normal().parent_path(); parent.has_relative_path(); parent = parent.parent_path()) {
    add(parent / kScenes);
    add(parent / "config" / kScenes);
  }
  // A source tree that was moved after it was built, or a package elsewhere than below /usr.
  for (auto parent = program.parent_path(); parent.has_relative_path(); parent = parent.parent_path()) {
    add(parent / "config" / kScenes);
    add(parent / "share/lookout/config" / kScenes);
  }
  add(LOOKOUT_SCENE_FOLDER);
  add(LOOKOUT_INSTALLED_SCENE_FOLDER);
  return folders;
}

fs::path FindScene(const std::string& name_or_path, const fs::path& config_folder) {
  if (name_or_path.ends_with(kExtension)) return name_or_path;
  const auto folders = SceneFolders(config_folder, ThisProgram());
  std::string names;
  for (const auto& folder : {fs::path(), fs::path(kFamilies)}) {
    const auto files = SceneFiles(folders, folder);
    const auto found = files.find(name_or_path);
    if (found != files.end()) return found->second;
    for (const auto& [name, file] : files) names += (names.empty() ? "" : ", ") + name;
  }
  std::string looked;
  for (const auto& folder : folders) looked += (looked.empty() ? "" : ", ") + folder.string();
  const auto there_are = names.empty() ? "there is no scene" : "there are: " + names;
  throw config::ConfigError({"--scene: no such scene: " + name_or_path + " (" + there_are + "; looked in " + looked +
                             "); give the path of a scene's file, NAME.txtpb, or put it into the folder scenes beside the boat's config"});
}

std::vector<SceneSummary> Summaries(const std::map<std::string, fs::path>& files) {
  std::vector<SceneSummary> summaries;
  for (const auto& [name, file] : files) {
    config::Scene scene;
    config::LoadText(file, scene);
    summaries.push_back({name, scene.description()});
  }
  return summaries;
}

std::vector<SceneSummary> ListScenes(const fs::path& config_folder) { return Summaries(SceneFiles(config_folder, {})); }

std::vector<SceneSummary> ListFamilies(const fs::path& config_folder) { return Summaries(SceneFiles(config_folder, kFamilies)); }

Scene LoadScene(const fs::path& file, std::uint64_t seed) { return ParseScene(config::ReadConfigFile(file), file.string(), seed); }

Scene ParseScene(const std::string& text, const std::string& name, std::uint64_t seed) {
  config::Scene scene;
  config::ParseText(text, name, scene);
  SceneFaults faults(text, name);
  CheckScene(scene, faults);
  faults.ThrowIfAny();
  return DrawScene(scene, seed, faults);
}

}  // namespace lookout::sim
