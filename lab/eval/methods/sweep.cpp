#include "lab/eval/methods/sweep.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <google/protobuf/descriptor.h>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/config/text_config.hpp"
#include "config/schema/segmenter.pb.h"
#include "lab/eval/methods/method_comparison.hpp"
#include "lab/eval/methods/methods.hpp"
#include "lab/eval/table.hpp"
#include "services/segmenter/params.hpp"

namespace lookout::eval {
namespace {

using google::protobuf::FieldDescriptor;

bool IsNumeric(const FieldDescriptor& field) {
  return !field.is_repeated() && (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE || field.cpp_type() == FieldDescriptor::CPPTYPE_INT32);
}

const FieldDescriptor& FieldOf(const std::string& name) {
  static const std::map<std::string, std::string> kShortNames{{"e1", "e1_cosine"}, {"e2", "e2_angle_deg"}, {"e3", "e3_distance_m"}};
  const auto short_name = kShortNames.find(name);
  const auto& schema = *config::Segmenter::descriptor();
  const auto* field = schema.FindFieldByName(short_name == kShortNames.end() ? name : short_name->second);
  if (field != nullptr && IsNumeric(*field)) return *field;
  std::string names = "e1, e2, e3";
  for (int i = 0; i < schema.field_count(); ++i) {
    if (IsNumeric(*schema.field(i))) names += ", " + schema.field(i)->name();
  }
  throw std::invalid_argument("--sweep: no such number in the segmenter's config: " + name + " (there are: " + names + ")");
}

// Fields of the paper's method count for nothing in ours: they are swept with the paper's.
bool IsOfThePaper(const std::string& field) {
  static const std::set<std::string> kFields{"image_columns", "bfs_angle_deg", "bfs_distance_m",   "e1_cosine",
                                             "e2_angle_deg",  "e3_distance_m", "e2_max_distance_m"};
  return kFields.contains(field);
}

double ToNumber(const std::string& sweep, const std::string& text) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw std::invalid_argument("--sweep " + sweep + ": not a number: " + text);
  }
  return value;
}

// Six digits are more than any step needs, and hide that 0.6 + 0.05 + 0.05 is not quite 0.7.
std::string ValueText(double value) { return fmt::format("{}", std::round(value * 1e6) / 1e6); }

double ValueOfBoat(const Boat& boat, const std::string& field) {
  const auto message = config::Load<config::Segmenter>(boat.config_folder, "segmenter.txtpb");
  const auto& descriptor = *config::Segmenter::descriptor()->FindFieldByName(field);
  const auto& reflection = *message.GetReflection();
  if (descriptor.cpp_type() == FieldDescriptor::CPPTYPE_INT32) return reflection.GetInt32(message, &descriptor);
  return reflection.GetDouble(message, &descriptor);
}

}  // namespace

Sweep ParseSweep(const std::string& text) {
  const auto equals = text.find('=');
  const auto first_colon = text.find(':', equals);
  const auto second_colon = first_colon == std::string::npos ? first_colon : text.find(':', first_colon + 1);
  if (equals == std::string::npos || second_colon == std::string::npos) {
    throw std::invalid_argument("--sweep " + text + ": must be FIELD=FROM:TO:STEP");
  }
  Sweep sweep;
  const auto& field = FieldOf(text.substr(0, equals));
  sweep.field = field.name();
  const double from = ToNumber(text, text.substr(equals + 1, first_colon - equals - 1));
  const double to = ToNumber(text, text.substr(first_colon + 1, second_colon - first_colon - 1));
  const double step = ToNumber(text, text.substr(second_colon + 1));
  if (!(step > 0.0) || to < from) throw std::invalid_argument("--sweep " + text + ": FROM must not be above TO, and STEP must be above 0");
  constexpr double kRounding = 1e-9;  // of a step, so that 0.95 is reached from 0.6 in steps of 0.05
  const double count = std::floor((to - from) / step + kRounding) + 1.0;
  if (count > kMaxSweepValues) throw std::invalid_argument("--sweep " + text + ": more than " + std::to_string(kMaxSweepValues) + " values");
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const double value = from + i * step;
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_INT32 && value != std::round(value)) {
      throw std::invalid_argument("--sweep " + text + ": " + field.name() + " takes whole numbers only");
    }
    sweep.values.push_back(value);
  }
  return sweep;
}

segmenter::Params ParamsWith(const Boat& boat, const std::string& field, double value) {
  const auto file = boat.config_folder / "segmenter.txtpb";
  auto message = config::Load<config::Segmenter>(boat.config_folder, "segmenter.txtpb");
  if (IsOfThePaper(field)) message.set_method(config::Segmenter::PAPER);
  const auto* descriptor = config::Segmenter::descriptor()->FindFieldByName(field);
  message.GetReflection()->ClearField(&message, descriptor);
  // By way of the text, so that the loader checks the value as it would check a file.
  config::Segmenter checked;
  config::ParseText(message.ShortDebugString() + " " + field + ": " + ValueText(value), "--sweep " + field + "=" + ValueText(value), checked);
  return segmenter::ToParams(checked, boat.facts, file);
}

Curve RunSweep(const Sweep& sweep, const RunPlan& plan, const Boat& boat, std::FILE* progress) {
  Methods methods;
  for (const double value : sweep.values) {
    methods.push_back(std::make_unique<SegmenterMethod>(ValueText(value), ParamsWith(boat, sweep.field, value)));
  }
  MethodComparison comparison(methods);
  ForEachScan(plan, boat, progress, [&comparison](const ScanPlace& place, const LabelledScan& truth) { comparison.Add(place, truth); });

  // The curve is of all segments; results are in the order of the values, with the sure ones of a method that knows doubt between them.
  std::vector<const MethodResult*> all_segments;
  for (const auto& result : comparison.results()) {
    if (!result.method.ends_with(kSureOnly)) all_segments.push_back(&result);
  }

  Curve curve{"Sweep of " + sweep.field, sweep.field, "mIoU of all segments, %", {}, ""};
  curve.value_of_boat = ValueText(ValueOfBoat(boat, sweep.field));
  curve.scans_from = "seeds " + std::to_string(plan.first_seed) + " to " +
                     std::to_string(plan.first_seed + static_cast<std::uint64_t>(plan.num_seeds) - 1) + ", " + ValueText(plan.seconds) + " s each";
  double best_percent = -1.0;
  std::string best;
  for (const auto& scene : plan.scenes) {
    Curve::Line line{SceneLabel(scene), {}};
    for (std::size_t i = 0; i < sweep.values.size(); ++i) {
      const auto& by_scene = all_segments[i]->by_scene;
      const auto found = by_scene.find(line.name);
      if (found != by_scene.end() && found->second.iou.count > 0) {
        line.points.emplace_back(sweep.values[i], 100.0 * found->second.iou.value());
      }
    }
    if (!line.points.empty()) curve.lines.push_back(std::move(line));
  }
  for (std::size_t i = 0; i < sweep.values.size() && !curve.lines.empty(); ++i) {
    Mean percent;
    for (const auto& line : curve.lines) percent.Add(line.points[i].second);
    if (percent.value() <= best_percent) continue;
    best_percent = percent.value();
    best = ValueText(sweep.values[i]);
  }
  if (!best.empty()) curve.note = "Best on the mean of the scenes at " + best + ": " + Number(best_percent, 1) + " %.";
  return curve;
}

}  // namespace lookout::eval
