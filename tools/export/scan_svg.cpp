#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "common/messages/heading_history.hpp"
#include "common/messages/returns.hpp"
#include "common/messages/words.hpp"
#include "lookout/pose_t.hpp"
#include "tools/export/boat_of_log.hpp"
#include "tools/export/colour.hpp"
#include "tools/export/merge_rounds.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The page, in pixels: a round view at the left, the legend at the right.
constexpr double kMiddleX = 500.0;
constexpr double kMiddleY = 535.0;
constexpr double kRadius = 430.0;
constexpr double kLegendX = 985.0;
constexpr double kLegendTop = 96.0;
constexpr double kLegendLine = 22.0;
constexpr double kLegendBottom = 960.0;
constexpr const char* kDark = "#1c2b3a";
constexpr const char* kGrey = "#5b6b7b";
constexpr const char* kHull = "#31465a";

// Returns of one colour. Points are in metres to the right of and above the middle of the view, here and below.
struct Dots {
  Rgb colour{};
  std::string legend;  // empty = none
  std::vector<Vector2d> points;
};

// A segment or an obstacle.
struct Outline {
  int id = 0;
  bool is_tentative = false;
  bool is_line = false;           // open, not filled
  double distance_m = 0.0;        // of the nearest point
  std::string facts;              // stands in the legend
  std::vector<Vector2d> corners;  // one corner is drawn as a point, two as a line
  std::string why;                // shown where the pointer rests on the outline

  bool IsFinite() const {
    return !corners.empty() && std::ranges::all_of(corners, [](const Vector2d& corner) { return corner.allFinite(); });
  }
};

// Two pieces that were merged, or were not.
struct Link {
  std::array<Vector2d, 2> ends;
  bool is_merged = false;
  double log_odds = 0.0;
  std::string why;
};

std::string Css(const Rgb& colour) { return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue); }

class Picture {
 public:
  std::string title;
  std::array<std::string, 2> subtitles;
  std::string outlines_title;     // stands over the outlines in the legend
  std::string up;                 // what is above: "N", "bow", "lidar x"
  std::optional<double> bow_rad;  // clockwise from above; nullopt: only the lidar is known
  std::optional<Eigen::AlignedBox3d> own_vessel_box_m;
  std::vector<Dots> dots;         // in the order of drawing
  std::vector<Outline> outlines;  // by Rank
  std::vector<Link> links;

  // Nearest first, tentative ones behind all sure ones: in rain they would else fill the legend. A value that is not finite counts as farthest, so
  // that the order stays one. @return "3 obstacles, 1 of them tentative"
  std::string Rank(const char* things) {
    std::ranges::stable_sort(outlines, {}, [](const Outline& outline) {
      return std::pair(outline.is_tentative, std::isfinite(outline.distance_m) ? outline.distance_m : 1e9);
    });
    const auto num_tentative = std::ranges::count(outlines, true, &Outline::is_tentative);
    return fmt::format("{} {}", outlines.size(), things) + (num_tentative > 0 ? fmt::format(", {} of them tentative", num_tentative) : "");
  }

  std::string Draw() {
    ChooseRings();
    Add(R"(<svg xmlns="http://www.w3.org/2000/svg" width="1320" height="1000" viewBox="0 0 1320 1000" )"
        R"(font-family="DejaVu Sans, Helvetica, Arial, sans-serif">)"
        "\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        "<clipPath id=\"view\"><circle cx=\"{}\" cy=\"{}\" r=\"{}\"/></clipPath>\n",
        kMiddleX, kMiddleY, kRadius);
    Text({40, 44}, title, 24, kDark, "font-weight=\"bold\"");
    Text({40, 68}, subtitles[0], 14, kGrey);
    Text({40, 88}, subtitles[1], 14, kGrey);
    DrawWater();
    svg_ += "<g clip-path=\"url(#view)\">\n";
    DrawBoat();
    for (const auto& of_colour : dots) DrawDots(of_colour);
    for (const auto& outline : outlines) DrawOutline(outline);
    for (const auto& link : links) DrawLink(link);
    svg_ += "</g>\n";
    DrawRingNames();
    Add("<path d=\"M{0} {1}l9 22l-9 -6l-9 6Z\" fill=\"#b3261e\"/>\n", kMiddleX, kMiddleY - kRadius - 24.0);
    Text({kMiddleX + 16.0, kMiddleY - kRadius - 8.0}, up, 18, "#b3261e", "font-weight=\"bold\"");
    DrawNames();
    DrawLegend();
    return std::move(svg_) + "</svg>\n";
  }

 private:
  template <typename... Values>
  void Add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
  }

  void Text(const Vector2d& at, const std::string& text, int size, const std::string& colour, const std::string& style = "") {
    Add("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" fill=\"{}\" {}>{}</text>\n", at.x(), at.y(), size, colour, style, text);
  }

  Vector2d ToPixel(const Vector2d& point_m) const { return {kMiddleX + point_m.x() * pixels_per_m_, kMiddleY - point_m.y() * pixels_per_m_}; }

  static Vector2d OnCircle(double radius, double clockwise_rad) {
    return {kMiddleX + radius * std::sin(clockwise_rad), kMiddleY - radius * std::cos(clockwise_rad)};
  }

  std::string PathOf(const std::vector<Vector2d>& corners) const {
    std::string path;
    for (const auto& corner : corners) {
      const auto pixel = ToPixel(corner);
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', pixel.x(), pixel.y());
    }
    return path;
  }

  // So that the obstacles fill the view.
  void ChooseRings() {
    double far_m = 0.0;
    const auto reach = [&far_m](const std::vector<Vector2d>& points) {
      for (const auto& point : points) far_m = point.allFinite() ? std::max(far_m, point.norm()) : far_m;
    };
    for (const auto& outline : outlines) reach(outline.corners);
    if (far_m == 0.0) {
      for (const auto& of_colour : dots) reach(of_colour.points);
    }
    constexpr std::array kStepsM{0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0, 200.0, 500.0, 1000.0};
    constexpr int kMaxRings = 5;
    const auto* step_m = std::ranges::find_if(kStepsM, [far_m](double candidate_m) { return far_m <= candidate_m * kMaxRings; });
    ring_step_m_ = step_m == kStepsM.end() ? kStepsM.back() : *step_m;
    num_rings_ = std::clamp(static_cast<int>(std::ceil(std::min(far_m, 1e6) / ring_step_m_)), 2, kMaxRings);
    pixels_per_m_ = kRadius / (ring_step_m_ * num_rings_);
  }

  void DrawWater() {
    for (int ring = num_rings_; ring >= 1; --ring) {
      Add("<circle cx=\"{}\" cy=\"{}\" r=\"{:.1f}\" fill=\"{}\" stroke=\"#bccbd8\"/>\n", kMiddleX, kMiddleY, kRadius * ring / num_rings_,
          ring == num_rings_ ? "#f1f6fa" : "none");
    }
    for (int spoke = 0; spoke < 12; ++spoke) {
      const auto from = OnCircle(kRadius / num_rings_, spoke * kPi / 6.0);
      const auto to = OnCircle(kRadius, spoke * kPi / 6.0);
      Add("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#dbe5ed\"/>\n", from.x(), from.y(), to.x(), to.y());
    }
  }

  void DrawBoat() {
    if (!bow_rad) {
      Add("<circle cx=\"{}\" cy=\"{}\" r=\"6\" fill=\"{}\"/>\n", kMiddleX, kMiddleY, kHull);
      return;
    }
    // A hull in its box, in pixels to starboard and ahead; a mark of 10 x 26 pixels where the box is not known or too small to be seen.
    Vector2d least(-5.0, -13.0), greatest(5.0, 13.0);
    if (const auto& box_m = own_vessel_box_m; box_m && box_m->sizes().x() * pixels_per_m_ >= 26.0) {
      least = pixels_per_m_ * Vector2d(-box_m->max().y(), box_m->min().x());
      greatest = pixels_per_m_ * Vector2d(-box_m->min().y(), box_m->max().x());
    }
    const double shoulder = greatest.y() - 0.35 * (greatest.y() - least.y());
    Add("<g transform=\"translate({} {}) rotate({:.2f})\"><path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}V{:.1f}H{:.1f}V{:.1f}Z\" fill=\"{}\"/>"
        "<path d=\"M0 {:.1f}V{}\" stroke=\"{}\" stroke-dasharray=\"7 6\" stroke-opacity=\"0.6\"/></g>\n",
        kMiddleX, kMiddleY, RadToDeg(*bow_rad), (least.x() + greatest.x()) / 2.0, -greatest.y(), greatest.x(), -shoulder, -least.y(), least.x(),
        -shoulder, kHull, -greatest.y() - 4.0, -kRadius, kHull);
  }

  void DrawDots(const Dots& of_colour) {
    std::string path;
    for (const auto& point : of_colour.points) {
      if (point.allFinite() && point.norm() <= ring_step_m_ * num_rings_) path += PathOf({point}) + "h0";
    }
    if (path.empty()) return;
    Add("<path d=\"{}\" stroke=\"{}\" stroke-width=\"3.2\" stroke-linecap=\"round\"/>\n", path, Css(of_colour.colour));
  }

  void DrawOutline(const Outline& outline) {
    if (!outline.IsFinite()) return;
    const std::string path = PathOf(outline.corners) + (outline.corners.size() == 1 ? "h0" : outline.is_line ? "" : "Z");
    const std::string colour = Css(ColourOfSegment(outline.id));
    Add("<g>{}\n", outline.why.empty() ? "" : "<title>" + outline.why + "</title>");
    // A wide stroke around the returns themselves, so that the line does not cover them.
    const std::string fill = outline.is_line ? "none" : colour + "\" fill-opacity=\"" + (outline.is_tentative ? "0.05" : "0.14");
    Add("<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"9\" stroke-opacity=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n",
        path, fill, colour, outline.is_tentative ? "0.08" : "0.18");
    Add("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-linecap=\"round\" stroke-width=\"{}\"/>\n", path, colour,
        outline.is_tentative ? "0.8\" stroke-dasharray=\"2 3\" stroke-opacity=\"0.6"
        : outline.is_line    ? "2.4"
                             : "1.2");
    svg_ += "</g>\n";
  }

  // The more certain, the darker; why is said where the pointer rests on it.
  void DrawLink(const Link& link) {
    Add("<path d=\"{}\" stroke=\"{}\" stroke-opacity=\"{:.2f}\" stroke-width=\"2\" stroke-linecap=\"round\"><title>{}</title></path>\n",
        PathOf({link.ends.begin(), link.ends.end()}), link.is_merged ? "#1a7f37" : "#b3261e", std::min(0.9, 0.3 + std::abs(link.log_odds) / 10.0),
        link.why);
  }

  void DrawRingNames() {
    for (int ring = 1; ring <= num_rings_; ++ring) {
      // Along 120 degrees, where neither the bow nor the arrow above stand.
      const auto place = OnCircle(kRadius * ring / num_rings_, DegToRad(120.0));
      Text({place.x(), place.y() + 4.0}, fmt::format("{} m", ring_step_m_ * ring), 12, kGrey,
           "text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"4\" paint-order=\"stroke\"");
    }
  }

  // Numbers beside their outlines; one that would cover another is left to the legend.
  void DrawNames() {
    constexpr double kTextHeight = 13.0;
    constexpr double kGap = 8.0;
    std::vector<Eigen::AlignedBox2d> occupied;
    for (const auto& outline : outlines) {
      if (!outline.IsFinite()) continue;
      Eigen::AlignedBox2d box;
      for (const auto& corner : outline.corners) box.extend(ToPixel(corner));
      const std::string name = std::to_string(outline.id);
      const double width = 9.0 * static_cast<double>(name.size());
      const Vector2d middle = box.center();
      // To the right, left, above, below.
      const std::array<Vector2d, 4> places{Vector2d(box.max().x() + kGap, middle.y() + 5.0), Vector2d(box.min().x() - kGap - width, middle.y() + 5.0),
                                           Vector2d(middle.x() - width / 2.0, box.min().y() - kGap),
                                           Vector2d(middle.x() - width / 2.0, box.max().y() + kGap + kTextHeight)};
      for (const auto& place : places) {
        const Eigen::AlignedBox2d needed(Vector2d(place.x() - 2.0, place.y() - kTextHeight), Vector2d(place.x() + width + 2.0, place.y() + 3.0));
        const bool is_in_view = std::hypot(place.x() + width / 2.0 - kMiddleX, place.y() - kMiddleY) < kRadius - 14.0;
        if (!is_in_view || std::ranges::any_of(occupied, [&needed](const auto& other) { return needed.intersects(other); })) continue;
        occupied.push_back(needed);
        Text(place, name, 13, Css(ColourOfSegment(outline.id)),
             fmt::format("{} stroke=\"#ffffff\" stroke-width=\"3.5\" paint-order=\"stroke\"",
                         outline.is_tentative ? "fill-opacity=\"0.7\"" : "font-weight=\"bold\""));
        break;
      }
    }
  }

  void DrawLegend() {
    double y = kLegendTop;
    const auto mark = [&](const Rgb& colour, const char* opacity = "1") {
      Add("<circle cx=\"{}\" cy=\"{}\" r=\"6\" fill=\"{}\" fill-opacity=\"{}\"/>\n", kLegendX + 6.0, y - 5.0, Css(colour), opacity);
    };
    for (const auto& of_colour : dots) {
      if (of_colour.legend.empty()) continue;
      mark(of_colour.colour);
      Text({kLegendX + 22.0, y}, of_colour.legend, 14, kDark);
      y += kLegendLine;
    }
    if (outlines.empty()) return;
    y += 12.0;
    Text({kLegendX, y}, outlines_title, 13, kGrey);
    y += kLegendLine;
    for (std::size_t i = 0; i < outlines.size(); ++i, y += kLegendLine) {
      if (y + kLegendLine > kLegendBottom && i + 1 < outlines.size()) {
        Text({kLegendX + 22.0, y}, fmt::format("and {} more", outlines.size() - i), 13, kGrey);
        return;
      }
      mark(ColourOfSegment(outlines[i].id), outlines[i].is_tentative ? "0.4" : "1");
      Text({kLegendX + 22.0, y}, std::to_string(outlines[i].id), 14, kDark, "font-weight=\"bold\"");
      Text({kLegendX + 60.0, y}, outlines[i].facts, 14, kDark);
    }
  }

  double ring_step_m_ = 0.0;
  int num_rings_ = 0;
  double pixels_per_m_ = 0.0;
  std::string svg_;
};

// "2026-11-21 12:18:05.250 UTC"
std::string UtcText(std::int64_t utime_us) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} UTC", fmt::gmtime(static_cast<std::time_t>(utime_us / 1'000'000)), utime_us / 1000 % 1000);
}

// From a frame whose x axis is forward and y axis left to the picture; `heading_rad` rotates it so that north is up.
Vector2d SeenFromAbove(const Vector2d& point_m, double heading_rad) {
  const double sine = std::sin(heading_rad);
  const double cosine = std::cos(heading_rad);
  return {point_m.x() * sine - point_m.y() * cosine, point_m.x() * cosine + point_m.y() * sine};
}

// Precondition: both lists of coordinates belong to the same corners.
template <typename ToPicture>
std::vector<Vector2d> Corners(const std::vector<float>& x_m, const std::vector<float>& y_m, ToPicture to_picture) {
  std::vector<Vector2d> corners;
  for (std::size_t i = 0; i < x_m.size(); ++i) corners.push_back(to_picture(Vector2d(x_m[i], y_m[i])));
  return corners;
}

// " 43 %"; "" where it is not stated.
std::string PercentOf(float probability) { return std::isfinite(probability) ? fmt::format(" {:.0f} %", 100.0 * double{probability}) : ""; }

// The outline of a segment or an obstacle. Land is drawn as its waterline: the hull of a shore covers the water before it, and the boat.
template <typename Thing>
Outline OutlineOf(const Thing& thing, double distance_m, const std::string& place, std::vector<Vector2d> hull, std::vector<Vector2d> waterline) {
  const bool is_tentative = thing.confidence == segment_t::CONFIDENCE_TENTATIVE;
  const bool is_land = thing.kind == segment_t::KIND_LAND;
  // The size of a tentative obstacle, or of land, says little.
  const auto what = is_tentative ? std::string(words::WordOf(words::kConfidence, thing.confidence)) + PercentOf(thing.thing_probability)
                    : is_land    ? std::string(words::WordOf(words::kKind, thing.kind))
                                 : fmt::format("{:.1f} x {:.1f} m", thing.length_m, thing.width_m);
  const bool is_line = is_land && !waterline.empty();
  return {thing.id, is_tentative, is_line, distance_m, fmt::format("{:.1f} m{}, {}", distance_m, place, what), std::move(is_line ? waterline : hull),
          ""};
}

// Heading by POSE at the time of the scan.
struct SeenHeading {
  double heading_rad = 0.0;
  bool is_course = false;  // course over ground: there is no compass
};

std::string NorthText(const SeenHeading& heading) {
  return fmt::format("north up, {} {:.1f} deg", heading.is_course ? "no compass: course" : "heading", RadToDeg(heading.heading_rad));
}

Picture PictureOfReturns(const ScanMessages& scan, const MergeReasons& reasons, const std::optional<config::BoatFacts>& boat,
                         const std::optional<SeenHeading>& heading) {
  const bool is_north_up = boat && heading;
  const double up_rad = is_north_up ? heading->heading_rad : 0.0;
  const Eigen::Isometry3d T_vessel_lidar = boat ? boat->T_vessel_lidar : Eigen::Isometry3d::Identity();
  const auto to_picture = [&](const Vector3d& p_lidar_m) { return SeenFromAbove((T_vessel_lidar * p_lidar_m).head<2>(), up_rad); };

  Picture picture;
  picture.up = is_north_up ? "N" : (boat ? "bow" : "lidar x");
  if (boat) {
    picture.bow_rad = up_rad;
    picture.own_vessel_box_m = boat->own_vessel_box_m;
  }
  std::map<std::pair<int, std::string_view>, Dots> dots;  // by label, then reason: returns in no segment lie below
  int num_returns = 0;
  bool has_labels = false;
  for (const auto& [part_index, part] : scan.scans) {
    const auto* labels = LabelsOf(scan, part);
    has_labels = has_labels || labels != nullptr;
    messages::ForEachReturn(part, labels, [&](const messages::Return& one) {
      ++num_returns;
      dots[{one.label, one.reason}].points.push_back(to_picture(one.p_lidar_m));
    });
  }
  for (auto& [key, of_colour] : dots) {
    const auto& [label, reason] = key;
    of_colour.colour = label > 0 ? ColourOfSegment(label) : ColourOfReason(reason);
    if (label == 0) {
      const auto name = !reason.empty() ? reason : has_labels ? "without label" : "not labelled: no SEGMENTS in the log";
      of_colour.legend = fmt::format("{} ({} returns)", name, of_colour.points.size());
    }
    picture.dots.push_back(std::move(of_colour));
  }
  for (const auto& link : reasons.links) {
    picture.links.push_back({{to_picture(link.ends_m[0]), to_picture(link.ends_m[1])}, link.is_merged, double{link.log_odds}, link.why});
  }

  for (const auto& [part_index, part] : scan.segments) {
    for (const auto& segment : part.segments) {
      const auto to_corner = [&](const Vector2d& p_m) { return to_picture({p_m.x(), p_m.y(), segment.centroid_m[2]}); };
      auto& outline = picture.outlines.emplace_back(OutlineOf(segment, std::hypot(double{segment.nearest_m[0]}, double{segment.nearest_m[1]}), "",
                                                              Corners(segment.hull_x_m, segment.hull_y_m, to_corner),
                                                              Corners(segment.waterline_x_m, segment.waterline_y_m, to_corner)));
      outline.facts += fmt::format(", {} returns", segment.num_points);
      if (const auto why = reasons.why_of_segment.find(segment.id); why != reasons.why_of_segment.end()) outline.why = why->second;
    }
  }
  picture.title = fmt::format("Scan {}: {} returns, {}", scan.seq, num_returns, picture.Rank("segments"));
  picture.subtitles = {UtcText(scan.utime_us), is_north_up ? NorthText(*heading)
                                               : boat      ? "bow up: no heading in the log"
                                                           : "lidar frame: no config of the boat in the log"};
  picture.outlines_title = "segments, nearest first, tentative last";
  return picture;
}

Picture PictureOfObstacles(const ScanMessages& scan, const std::optional<config::BoatFacts>& boat, const std::optional<SeenHeading>& heading) {
  Picture picture;
  picture.up = heading ? "N" : "bow";
  picture.bow_rad = heading ? heading->heading_rad : 0.0;
  if (boat) picture.own_vessel_box_m = boat->own_vessel_box_m;
  const auto to_corner = [&picture](const Vector2d& p_m) { return SeenFromAbove(p_m, *picture.bow_rad); };
  std::map<int, int> num_by_status;
  for (const auto& [part_index, part] : scan.obstacles) {
    for (const auto& obstacle : part.obstacles) {
      ++num_by_status[obstacle.status];
      picture.outlines.push_back(OutlineOf(obstacle, obstacle.range_m, fmt::format(" at {:.0f} deg", RadToDeg(obstacle.bearing_rad)),
                                           Corners(obstacle.footprint_vessel_x_m, obstacle.footprint_vessel_y_m, to_corner),
                                           Corners(obstacle.waterline_vessel_x_m, obstacle.waterline_vessel_y_m, to_corner)));
    }
  }
  std::string statuses;
  for (const auto& [status, count] : num_by_status) {
    statuses += fmt::format("{}{} {}", statuses.empty() ? ", status: " : ", ", count, words::WordOf(words::kObstacleStatus, status));
  }
  picture.title = fmt::format("Scan {}: {}", scan.seq, picture.Rank("obstacles"));
  picture.subtitles = {UtcText(scan.utime_us) + statuses, heading ? NorthText(*heading) : "bow up: no heading in the log"};
  picture.outlines_title = "nearest first, tentative last; bearing from the bow";
  return picture;
}

class ScanSvgSink final : public Sink {
 public:
  ScanSvgSink(ChosenScan::Of what, std::optional<std::int64_t> seq) : what_(what), scan_(what, seq) {}
  // Draws the returns, segmented again.
  ScanSvgSink(const segmenter::Params& params, const config::BoatFacts& boat, std::optional<std::int64_t> seq)
      : what_(ChosenScan::Of::kReturns), scan_(what_, seq), boat_(boat), recorder_(params) {}

  std::vector<bus::Channel> Channels() const override {
    if (what_ == ChosenScan::Of::kObstacles) return {bus::kObstacles, bus::kPose, bus::kRunInfo};
    if (recorder_) return {bus::kLidarScan, bus::kPose};
    return {bus::kLidarScan, bus::kSegments, bus::kPose, bus::kRunInfo};
  }

  Taken Take(std::string_view channel, Bytes bytes, std::string&) override {
    if (channel == bus::kRunInfo.name) return TakeRunInfo(bytes, boat_);
    if (channel == bus::kPose.name) return TakePose(bytes);
    return scan_.Take(channel, bytes);
  }

  void Finish(std::string& text) override {
    scan_.Finish();
    if (!scan_.chosen()) return;
    auto scan = *scan_.chosen();
    std::optional<SeenHeading> heading;
    if (const auto heading_rad = headings_.At(scan.utime_us)) heading = {*heading_rad, is_course_};
    MergeReasons reasons;
    if (recorder_) {
      auto merged = recorder_->MergeChosen(scan);
      reasons = ReasonsOf(merged, *recorder_);
      scan.segments = std::move(merged.segments);
    }
    auto picture = what_ == ChosenScan::Of::kReturns ? PictureOfReturns(scan, reasons, boat_, heading) : PictureOfObstacles(scan, boat_, heading);
    if (recorder_) picture.subtitles[0] += ", pairs of the last round: green one, red two (rest the pointer on a line or an outline)";
    text += picture.Draw();
  }

 private:
  Taken TakePose(Bytes bytes) {
    const auto pose = bus::Decode<pose_t>(bytes);
    if (!pose) return Taken::kUndecodable;
    if (!UtimeFromWire(pose->utime_us)) return Taken::kInconsistent;
    // Poses that come long after the scan must not replace poses of the scan's time.
    constexpr std::int64_t kSpanUs = 10'000'000;
    const auto scan_utime_us = scan_.utime_us();
    if (scan_utime_us == 0 || std::abs(pose->utime_us - scan_utime_us) <= kSpanUs) {
      headings_.Add(pose->utime_us, pose->heading_rad);
      if (pose->heading_source != pose_t::HEADING_NONE) is_course_ = pose->heading_source == pose_t::HEADING_COURSE;
    }
    return Taken::kOk;
  }

  ChosenScan::Of what_;
  ChosenScan scan_;
  messages::HeadingHistory headings_;
  bool is_course_ = false;
  std::optional<config::BoatFacts> boat_;
  std::optional<MergeRecorder> recorder_;
};

}  // namespace

std::unique_ptr<Sink> MakeScanSvgSink(ChosenScan::Of what, std::optional<std::int64_t> seq) { return std::make_unique<ScanSvgSink>(what, seq); }

std::unique_ptr<Sink> MakeMergesSvgSink(const segmenter::Params& params, const config::BoatFacts& boat, std::optional<std::int64_t> seq) {
  return std::make_unique<ScanSvgSink>(params, boat, seq);
}

}  // namespace lookout::exporter
