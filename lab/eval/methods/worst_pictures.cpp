#include "lab/eval/methods/worst_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>

#include "common/core/printable.hpp"
#include "common/io/output_file.hpp"
#include "lab/eval/methods/scoring.hpp"
#include "lab/eval/methods/spots.hpp"
#include "tools/export/colour.hpp"

namespace lookout::eval {
namespace {

constexpr int kScansOfSecond = 10;

// In pixels.
constexpr double kPlan = 760.0;  // width and height
constexpr double kTop = 40.0;
constexpr double kGap = 20.0;
constexpr double kLine = 18.0;

// Half of the plan's width. Without anything lost: the range within which a VLP-16 sees small boats.
constexpr double kUsualReachM = 50.0;
constexpr double kLeastReachM = 15.0;
constexpr double kReachBeyondLost = 1.25;
constexpr double kGridM = 10.0;

constexpr const char* kNoColour = "#b8b8b8";
constexpr const char* kLandColour = "#8a6d3b";

std::string ColourOf(std::int32_t id) {
  const auto colour = exporter::ColourOfSegment(id);
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char letter : PrintableLines(text)) {
    if (letter == '<') {
      escaped += "&lt;";
    } else if (letter == '&') {
      escaped += "&amp;";
    } else {
      escaped += letter;
    }
  }
  return escaped;
}

struct Plan {
  double left = 0.0;
  double reach_m = kUsualReachM;

  double X(double right_m) const { return left + kPlan / 2.0 * (1.0 + right_m / reach_m); }
  double Y(double forward_m) const { return kTop + kPlan / 2.0 * (1.0 - forward_m / reach_m); }
  double Length(double length_m) const { return kPlan / 2.0 * length_m / reach_m; }
  bool Holds(const Spot& spot) const { return std::max(std::abs(spot.right_m), std::abs(spot.forward_m)) < reach_m; }
};

// Dots of one colour are one path: strokes without length, with round ends. Returns that fall on one pixel are one dot.
std::string DotsOf(const Plan& plan, const std::vector<Spot>& spots, const std::function<std::string(const Spot&)>& colour_of) {
  std::map<std::string, std::set<std::pair<long, long>>> by_colour;
  for (const auto& spot : spots) {
    if (plan.Holds(spot)) by_colour[colour_of(spot)].emplace(std::lround(plan.X(spot.right_m)), std::lround(plan.Y(spot.forward_m)));
  }
  std::string svg;
  for (const auto& [colour, places] : by_colour) {
    svg += fmt::format("<path stroke=\"{}\" stroke-width=\"3\" stroke-linecap=\"round\" d=\"", colour);
    for (const auto& [x, y] : places) fmt::format_to(std::back_inserter(svg), "M{} {}h0", x, y);
    svg += "\"/>\n";
  }
  return svg;
}

std::string GridOf(const Plan& plan) {
  auto svg = fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\n", plan.left, kTop, kPlan, kPlan);
  for (double radius_m = kGridM; radius_m < plan.reach_m; radius_m += kGridM) {
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"none\" stroke=\"#e4e4e4\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\" "
        "fill=\"#999\">{:.0f} m</text>\n",
        plan.X(0), plan.Y(0), plan.Length(radius_m), plan.X(0) + 3, plan.Y(radius_m) - 3, radius_m);
  }
  svg += fmt::format("<path d=\"M{0:.1f} {1:.1f}m-4 6l4 -14l4 14z\" fill=\"#000\"/>\n", plan.X(0), plan.Y(0));
  return svg;
}

struct Circle {
  double right_m = 0.0;
  double forward_m = 0.0;
  double radius_m = 0.0;
};

// Around all returns of an object.
Circle CircleOf(std::int32_t object, const std::vector<Spot>& spots) {
  Circle circle;
  double count = 0.0;
  for (const auto& spot : spots) {
    if (spot.object != object) continue;
    circle.right_m += spot.right_m;
    circle.forward_m += spot.forward_m;
    count += 1.0;
  }
  circle.right_m /= count;
  circle.forward_m /= count;
  for (const auto& spot : spots) {
    if (spot.object == object)
      circle.radius_m = std::max(circle.radius_m, std::hypot(spot.right_m - circle.right_m, spot.forward_m - circle.forward_m));
  }
  return circle;
}

std::string FileNameOf(const std::string& text) {
  std::string name;
  for (const char letter : text) name += std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '.' || letter == '-' ? letter : '_';
  return name;
}

// Removes the pictures of an earlier run: names depend on the failures, so old pictures would stand among the new.
void RemovePictures(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".svg") files.push_back(entry.path());
  }
  for (const auto& file : files) std::filesystem::remove(file);
}

}  // namespace

std::string PictureOf(const std::string& title, const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  const auto spots = SpotsOf(truth, label);
  const auto lost = LostThingsOf(truth, label);
  double reach_m = lost.empty() ? kUsualReachM : kLeastReachM;
  std::vector<Circle> circles;
  for (const auto& thing : lost) {
    circles.push_back(CircleOf(thing.object, spots));
    const auto& circle = circles.back();
    reach_m = std::max(reach_m, kReachBeyondLost * (std::hypot(circle.right_m, circle.forward_m) + circle.radius_m));
  }
  const Plan left{0.0, reach_m};
  const Plan right{kPlan + kGap, reach_m};
  const double height = kTop + kPlan + kLine * (static_cast<double>(lost.size()) + 1.5);
  auto svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1:.0f}\" viewBox=\"0 0 {0} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<text x=\"6\" y=\"16\">{2}</text>\n<text x=\"6\" y=\"34\">truth</text>\n<text x=\"{3}\" y=\"34\">segments</text>\n",
      2.0 * kPlan + kGap, height, Escaped(title), right.left + 6.0);
  svg += GridOf(left) + GridOf(right);
  svg += DotsOf(left, spots, [&truth](const Spot& spot) {
    if (spot.object == 0) return std::string(kNoColour);
    return IsLand(truth.objects.at(spot.object)) ? std::string(kLandColour) : ColourOf(spot.object);
  });
  svg += DotsOf(right, spots, [](const Spot& spot) { return spot.segment == 0 ? std::string(kNoColour) : ColourOf(spot.segment); });
  for (std::size_t i = 0; i < lost.size(); ++i) {
    for (const auto& plan : {left, right}) {
      const double x = plan.X(circles[i].right_m);
      const double y = plan.Y(circles[i].forward_m);
      const double radius = plan.Length(circles[i].radius_m) + 6.0;
      svg += fmt::format(
          "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\" fill=\"none\" stroke=\"#d00\"/>\n<text x=\"{3:.1f}\" y=\"{1:.1f}\" "
          "fill=\"#d00\">{4}</text>\n",
          x, y, radius, x + radius + 2.0, i + 1);
    }
    const auto& thing = lost[i];
    const auto& about = truth.objects.at(thing.object);
    const auto holder = truth.objects.find(thing.fate.held_by);
    svg += fmt::format("<text x=\"6\" y=\"{:.0f}\">{}: {} ({}), {} returns at {:.1f} m, IoU {:.2f}: {}{}</text>\n",
                       kTop + kPlan + kLine * (static_cast<double>(i) + 1.0), i + 1, Escaped(about.name), Escaped(about.kind), thing.num_returns,
                       thing.range_m, thing.iou, NameOf(thing.fate.outcome),
                       holder != truth.objects.end() && holder->first != thing.object ? Escaped(fmt::format(", with {}", holder->second.name)) : "");
  }
  return svg + "</svg>\n";
}

void WorstPictures::Add(const std::string& method, const ScanPlace& place, const LabelledScan& truth, const std::vector<std::int32_t>& label,
                        const Score& score) {
  if (score.iou.count == 0) return;
  const double iou = score.iou.value();
  auto& pictures = pictures_[{method, place.scene}];
  const auto is_same_second = [&place](const Picture& picture) {
    return picture.seed == place.seed && picture.index / kScansOfSecond == place.index / kScansOfSecond;
  };
  auto replaced = std::ranges::find_if(pictures, is_same_second);
  if (replaced == pictures.end() && pictures.size() >= num_per_scene_) replaced = std::prev(pictures.end());
  if (replaced != pictures.end()) {
    if (replaced->iou <= iou) return;
    pictures.erase(replaced);
  }
  const auto title = fmt::format("{}: {}, seed {}, scan {}, mIoU {:.1f} %", method, place.scene, place.seed, place.index, 100.0 * iou);
  pictures.insert(std::ranges::upper_bound(pictures, iou, {}, &Picture::iou), {place.seed, place.index, iou, PictureOf(title, truth, label)});
}

void WorstPictures::Write(const std::filesystem::path& folder, bool force) const {
  for (const auto& [key, pictures] : pictures_) {
    const auto folder_of_scene = folder / FileNameOf(key.first) / FileNameOf(key.second);
    std::filesystem::create_directories(folder_of_scene);
    if (force) RemovePictures(folder_of_scene);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const auto name = fmt::format("{:02}-seed-{}-scan-{}.svg", i + 1, pictures[i].seed, pictures[i].index);
      io::OutputFile file(folder_of_scene / name, {.force = force});
      file.Write(pictures[i].svg);
      file.Commit();
    }
  }
}

}  // namespace lookout::eval
