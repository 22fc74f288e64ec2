#include "lab/sim/family.hpp"

#include <algorithm>
#include <cmath>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <limits>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using File = config::Scene;

constexpr std::uint64_t kNumbersStream = 103;
constexpr std::uint64_t kLayoutStream = 104;
constexpr double kRowRetryM = 0.7;  // further along after a place in a row was not free

// Numbers that may also be ranges are left to those who draw them.
void DrawBetween(const Message& to, Random& random, Message& from) {
  std::vector<const FieldDescriptor*> fields;
  to.GetReflection()->ListFields(to, &fields);
  for (const auto* field : fields) {
    if (field->is_repeated() || field->cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE) continue;
    const double low = from.GetReflection()->GetDouble(from, field);
    from.GetReflection()->SetDouble(&from, field, random.Uniform(low, to.GetReflection()->GetDouble(to, field)));
  }
}

// Clears the lists of `merged` that `one` has, as a list that is merged would grow.
void ClearListsOf(const Message& one, Message& merged) {
  std::vector<const FieldDescriptor*> fields;
  one.GetReflection()->ListFields(one, &fields);
  for (const auto* field : fields) {
    const auto* reflection = merged.GetReflection();
    if (field->is_repeated()) {
      reflection->ClearField(&merged, field);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && reflection->HasField(merged, field)) {
      ClearListsOf(one.GetReflection()->GetMessage(one, field), *reflection->MutableMessage(&merged, field));
    }
  }
}

// @return number of one of them, by weight
template <typename Weighted>
int DrawByWeight(const google::protobuf::RepeatedPtrField<Weighted>& all, Random& random) {
  double sum = 0.0;
  for (const auto& one : all) sum += one.weight();
  double rest = random.Uniform(0.0, sum);
  int drawn = 0;
  while (drawn + 1 < all.size() && rest >= all[drawn].weight()) rest -= all[drawn++].weight();
  return drawn;
}

double DrawOf(const google::protobuf::RepeatedField<double>& numbers, Random& random) {
  return numbers.size() == 1 ? numbers[0] : random.Uniform(numbers[0], numbers[1]);
}

}  // namespace

File WithDrawnNumbers(const File& scene, std::uint64_t seed) {
  // Michell, "The highest waves in water", 1893: no wave is higher than about a seventh of its length.
  constexpr double kLeastLengthOfHeight = 7.0;
  File drawn = scene;
  Random random(seed, kNumbersStream);
  if (scene.has_own_boat_to()) DrawBetween(scene.own_boat_to(), random, *drawn.mutable_own_boat());
  if (scene.has_sea_to()) {
    auto& sea = *drawn.mutable_sea();
    DrawBetween(scene.sea_to(), random, sea);
    sea.set_wavelength_m(std::max(sea.wavelength_m(), kLeastLengthOfHeight * sea.significant_height_m()));
  }
  const int num_effects = scene.effects_to_size();
  const int effects = num_effects > 1 ? static_cast<int>(random.Uniform() * num_effects) : 0;
  if (num_effects > 0) DrawBetween(scene.effects_to(effects), random, *drawn.mutable_effects());
  return drawn;
}

File::OwnBoat OwnBoatIn(const File::Layout& layout, const File::OwnBoat& own_boat) {
  File::OwnBoat merged = own_boat;
  ClearListsOf(layout.own_boat(), merged);
  merged.MergeFrom(layout.own_boat());
  return merged;
}

File WithDrawnLayout(const File& scene, std::uint64_t seed) {
  if (scene.layout().empty()) return scene;
  Random random(seed, kLayoutStream);
  const auto& layout = scene.layout(DrawByWeight(scene.layout(), random));
  File drawn = scene;
  *drawn.mutable_own_boat() = OwnBoatIn(layout, scene.own_boat());
  for (auto& object : *drawn.mutable_object()) {
    const auto& names = object.layout();
    if (!names.empty() && std::ranges::find(names, layout.name()) == names.end()) object.set_chance(0.0);
  }
  return drawn;
}

File::Object MergedWith(const File::Object& object, const File::Object& one) {
  File::Object merged = object;
  merged.clear_one_of();
  ClearListsOf(one, merged);
  merged.MergeFrom(one);
  return merged;
}

File::Object DrawMember(const File::Object& object, Random& random) {
  if (object.one_of().empty()) return object;
  return MergedWith(object, object.one_of(DrawByWeight(object.one_of(), random)));
}

void Edges::Add(const std::string& name, std::size_t object, std::vector<Vector2d> edge_m, bool is_closed, std::vector<double> reach_m) {
  Edge edge{object, std::move(edge_m), std::move(reach_m)};
  if (is_closed) edge.points_m.push_back(edge.points_m.front());
  if (is_closed && !edge.reach_m.empty()) edge.reach_m.push_back(edge.reach_m.front());
  for (std::size_t i = 0; i + 1 < edge.points_m.size(); ++i) edge.length_m += (edge.points_m[i + 1] - edge.points_m[i]).norm();
  edges_[name].push_back(std::move(edge));
}

std::optional<Edges::Found> Edges::Draw(const File::Beside& beside, const std::vector<Vector2d>& outline_m, double heading_rad, int member, Row& row,
                                        Random& random) const {
  const auto& edges = edges_.at(beside.object());
  const bool is_row = !beside.row_gap_m().empty();
  if (row.along_m < 0.0 || !is_row) {
    row.edge = static_cast<std::size_t>(random.Uniform() * static_cast<double>(edges.size()));
    if (beside.is_each()) row.edge = static_cast<std::size_t>(member);
    if (row.edge >= edges.size()) return std::nullopt;
    row.along_m = random.Uniform(0.0, edges[row.edge].length_m * (is_row ? 0.4 : 1.0));
  }
  const Edge& edge = edges[row.edge];
  if (row.along_m >= edge.length_m) return std::nullopt;

  std::size_t segment = 0;
  double before_m = 0.0;
  for (; segment + 2 < edge.points_m.size(); ++segment) {
    const double length_m = (edge.points_m[segment + 1] - edge.points_m[segment]).norm();
    if (before_m + length_m > row.along_m) break;
    before_m += length_m;
  }
  const Vector2d along = (edge.points_m[segment + 1] - edge.points_m[segment]).normalized();
  const Vector2d out(along.y(), -along.x());
  const double out_rad = std::atan2(out.x(), out.y());
  const auto turned =
      beside.turned().empty() ? File::ANY : static_cast<File::Turned>(beside.turned(static_cast<int>(random.Uniform() * beside.turned_size())));
  const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
  Placement placement;
  placement.heading_rad = turned == File::ANY     ? heading_rad
                          : turned == File::ALONG ? out_rad + side * kPi / 2.0
                          : turned == File::OUT   ? out_rad
                                                  : out_rad + kPi;
  placement.heading_rad += DegToRad(beside.askew_deg()) * random.Uniform(-1.0, 1.0);

  double nearest_m = std::numeric_limits<double>::infinity();  // towards the edge
  double first_m = nearest_m;
  double last_m = -nearest_m;
  for (const auto& p_m : outline_m) {
    const Vector2d turned_m = placement.ToMap(p_m);
    nearest_m = std::min(nearest_m, out.dot(turned_m));
    first_m = std::min(first_m, along.dot(turned_m));
    last_m = std::max(last_m, along.dot(turned_m));
  }
  const double gap_m = DrawOf(beside.gap_m(), random);
  const double shift_m = is_row ? -first_m : 0.0;
  placement.position_map_m = edge.points_m[segment] + (row.along_m - before_m + shift_m) * along + (gap_m - nearest_m) * out;
  const double next_m = row.along_m + last_m - first_m + (is_row ? DrawOf(beside.row_gap_m(), random) : 0.0);
  row.along_m += kRowRetryM;
  const bool is_built_out = turned == File::OUT && gap_m == 0.0 && !edge.reach_m.empty();
  const double to_land_m = is_built_out ? std::max(edge.reach_m[segment], edge.reach_m[segment + 1]) : 0.0;
  return Found{placement, edge.object, 0.8 * beside.gap_m(0), next_m, to_land_m};
}

}  // namespace lookout::sim
