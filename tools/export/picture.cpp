#include "tools/export/picture.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::exporter {

namespace {

// The page, in pixels: a round view at the left, the legend at the right.
constexpr double kWidth = 1320.0;
constexpr double kHeight = 1000.0;
constexpr double kMiddleX = 500.0;
constexpr double kMiddleY = 535.0;
constexpr double kRadius = 430.0;
constexpr double kLegendX = 985.0;
constexpr double kLegendTop = 96.0;
constexpr double kLegendLine = 22.0;
constexpr double kLegendBottom = 960.0;

struct Pixel {
  double x;
  double y;
};

// One decimal of a pixel is finer than any screen.
std::string Number(double value, int decimals = 1) {
  std::array<char, 32> digits{};
  const double bounded = std::clamp(value, -1e6, 1e6);
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), bounded, std::chars_format::fixed, decimals).ptr;
  std::string text(digits.data(), end);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string Css(const Rgb& colour) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const auto value : {colour.red, colour.green, colour.blue}) {
    text += kDigits[value >> 4];
    text += kDigits[value & 0xF];
  }
  return text;
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else {
      escaped += c >= ' ' && c <= '~' ? c : '?';  // names come from outside
    }
  }
  return escaped;
}

bool IsFinite(const Spot& spot) { return std::isfinite(spot.right_m) && std::isfinite(spot.up_m); }

double Distance(const Spot& spot) { return std::hypot(spot.right_m, spot.up_m); }

// Distance between range rings and their number, so that what is worth seeing fills the view.
struct Rings {
  double step_m;
  int count;
};

Rings RingsFor(const Picture& picture) {
  double far_m = 0.0;
  for (const auto& outline : picture.outlines) {
    for (const auto& corner : outline.corners) {
      if (IsFinite(corner)) far_m = std::max(far_m, Distance(corner));
    }
  }
  if (far_m == 0.0) {
    for (const auto& dots : picture.dots) {
      for (const auto& spot : dots.spots) {
        if (IsFinite(spot)) far_m = std::max(far_m, Distance(spot));
      }
    }
  }
  constexpr std::array kSteps{0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0, 200.0, 500.0, 1000.0};
  constexpr int kMaxCount = 5;
  double step_m = kSteps.back();
  for (const double candidate_m : kSteps) {
    if (far_m <= candidate_m * kMaxCount) {
      step_m = candidate_m;
      break;
    }
  }
  return {step_m, std::clamp(static_cast<int>(std::ceil(std::min(far_m, 1e6) / step_m)), 2, kMaxCount)};
}

class Drawing {
 public:
  explicit Drawing(const Picture& picture) : picture_(picture), rings_(RingsFor(picture)), pixels_per_m_(kRadius / (rings_.step_m * rings_.count)) {}

  std::string Draw() {
    svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + Number(kWidth) + "\" height=\"" + Number(kHeight) + "\" viewBox=\"0 0 " +
           Number(kWidth) + " " + Number(kHeight) +
           "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n"
           "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
           "<clipPath id=\"view\"><circle cx=\"" +
           Number(kMiddleX) + "\" cy=\"" + Number(kMiddleY) + "\" r=\"" + Number(kRadius) + "\"/></clipPath>\n";
    DrawTitle();
    DrawWater();
    svg_ += "<g clip-path=\"url(#view)\">\n";
    DrawBoat();
    for (const auto& dots : picture_.dots) DrawDots(dots);
    for (const auto& outline : picture_.outlines) DrawOutline(outline);
    svg_ += "</g>\n";
    DrawRingNames();
    DrawUpward();
    DrawNames();
    DrawLegend();
    svg_ += "</svg>\n";
    return std::move(svg_);
  }

 private:
  Pixel ToPixel(const Spot& spot) const { return {kMiddleX + spot.right_m * pixels_per_m_, kMiddleY - spot.up_m * pixels_per_m_}; }

  void Line(Pixel from, Pixel to, const std::string& style) {
    svg_ +=
        "<line x1=\"" + Number(from.x) + "\" y1=\"" + Number(from.y) + "\" x2=\"" + Number(to.x) + "\" y2=\"" + Number(to.y) + "\" " + style + "/>\n";
  }

  void Text(Pixel at, const std::string& text, const std::string& style) {
    svg_ += "<text x=\"" + Number(at.x) + "\" y=\"" + Number(at.y) + "\" " + style + ">" + Escaped(text) + "</text>\n";
  }

  void DrawTitle() {
    Text({40, 44}, picture_.title, "font-size=\"24\" font-weight=\"bold\" fill=\"#1c2b3a\"");
    double y = 68.0;
    for (const auto& line : picture_.subtitles) {
      Text({40, y}, line, "font-size=\"14\" fill=\"#5b6b7b\"");
      y += 20.0;
    }
  }

  void DrawWater() {
    for (int ring = rings_.count; ring >= 1; --ring) {
      svg_ += "<circle cx=\"" + Number(kMiddleX) + "\" cy=\"" + Number(kMiddleY) + "\" r=\"" + Number(kRadius * ring / rings_.count) + "\" fill=\"" +
              (ring == rings_.count ? "#f1f6fa" : "none") + "\" stroke=\"#bccbd8\" stroke-width=\"" + (ring == rings_.count ? "1.5" : "1") + "\"/>\n";
    }
    // A spoke every 30 degrees.
    for (int spoke = 0; spoke < 12; ++spoke) {
      const double angle_rad = spoke * kPi / 6.0;
      const double inner = kRadius / rings_.count;
      Line({kMiddleX + inner * std::sin(angle_rad), kMiddleY - inner * std::cos(angle_rad)},
           {kMiddleX + kRadius * std::sin(angle_rad), kMiddleY - kRadius * std::cos(angle_rad)}, "stroke=\"#dbe5ed\" stroke-width=\"1\"");
    }
  }

  void DrawBoat() {
    if (!picture_.boat) {
      svg_ += "<circle cx=\"" + Number(kMiddleX) + "\" cy=\"" + Number(kMiddleY) + "\" r=\"6\" fill=\"#31465a\"/>\n";
      return;
    }
    const auto& boat = *picture_.boat;
    // A hull seen from above in its box; a mark of 10 x 26 pixels where the box is not known or too small to be seen.
    double left = boat.min_right_m * pixels_per_m_, right = boat.max_right_m * pixels_per_m_;
    double stern = boat.min_up_m * pixels_per_m_, bow = boat.max_up_m * pixels_per_m_;
    if (!boat.has_size || bow - stern < 26.0) {
      left = -5.0, right = 5.0;
      stern = -13.0, bow = 13.0;
    }
    const double middle = (left + right) / 2.0;
    const double shoulder = bow - 0.35 * (bow - stern);
    svg_ += "<path transform=\"translate(" + Number(kMiddleX) + " " + Number(kMiddleY) + ") rotate(" + Number(RadToDeg(boat.bow_rad), 2) +
            ")\" d=\"M" + Number(middle) + " " + Number(-bow) + "Q" + Number(right) + " " + Number(-(bow + shoulder) / 2.0) + " " + Number(right) +
            " " + Number(-shoulder) + "L" + Number(right * 0.8 + middle * 0.2) + " " + Number(-stern) + "L" + Number(left * 0.8 + middle * 0.2) +
            " " + Number(-stern) + "L" + Number(left) + " " + Number(-shoulder) + "Q" + Number(left) + " " + Number(-(bow + shoulder) / 2.0) + " " +
            Number(middle) + " " + Number(-bow) + "Z\" fill=\"#31465a\" fill-opacity=\"0.85\" stroke=\"#1c2b3a\" stroke-width=\"1\"/>\n";
    const double course = boat.bow_rad;
    Line({kMiddleX + (bow + 4.0) * std::sin(course), kMiddleY - (bow + 4.0) * std::cos(course)},
         {kMiddleX + kRadius * std::sin(course), kMiddleY - kRadius * std::cos(course)},
         "stroke=\"#31465a\" stroke-width=\"1.2\" stroke-dasharray=\"7 6\" stroke-opacity=\"0.6\"");
  }

  void DrawDots(const Dots& dots) {
    std::string path;
    for (const auto& spot : dots.spots) {
      if (!IsFinite(spot) || Distance(spot) > rings_.step_m * rings_.count) continue;
      const auto pixel = ToPixel(spot);
      path += "M" + Number(pixel.x) + " " + Number(pixel.y) + "h0";
    }
    if (path.empty()) return;
    svg_ += "<path d=\"" + path + "\" stroke=\"" + Css(dots.colour) + "\" stroke-width=\"3.2\" stroke-linecap=\"round\" fill=\"none\"/>\n";
  }

  void DrawOutline(const Outline& outline) {
    if (outline.corners.empty() || !std::ranges::all_of(outline.corners, IsFinite)) return;
    std::string path;
    for (const auto& corner : outline.corners) {
      const auto pixel = ToPixel(corner);
      path += (path.empty() ? "M" : "L") + Number(pixel.x) + " " + Number(pixel.y);
    }
    if (outline.corners.size() == 1) {
      path += "h0";
    } else if (!outline.is_line) {
      path += "Z";
    }
    const std::string colour = Css(outline.colour);
    const std::string round = "\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
    const std::string fill = outline.is_line ? "none" : colour + "\" fill-opacity=\"" + (outline.is_tentative ? "0.05" : "0.14");
    // A wide stroke around the returns themselves, so that the line does not cover them.
    svg_ += "<path d=\"" + path + "\" fill=\"" + fill + "\" stroke=\"" + colour + "\" stroke-width=\"9\" stroke-opacity=\"" +
            (outline.is_tentative ? "0.08" : "0.18") + round;
    const std::string line = outline.is_tentative ? "0.8\" stroke-dasharray=\"2 3\" stroke-opacity=\"0.6" : outline.is_line ? "2.4" : "1.2";
    svg_ += "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"" + line + round;
  }

  void DrawRingNames() {
    // Along 120 degrees, where neither the bow nor the arrow of the upward direction stand.
    const double angle_rad = DegToRad(120.0);
    for (int ring = 1; ring <= rings_.count; ++ring) {
      const double radius = kRadius * ring / rings_.count;
      Text({kMiddleX + radius * std::sin(angle_rad), kMiddleY - radius * std::cos(angle_rad) + 4.0}, Number(rings_.step_m * ring) + " m",
           "font-size=\"12\" fill=\"#5b6b7b\" text-anchor=\"middle\" stroke=\"#ffffff\" stroke-width=\"4\" paint-order=\"stroke\"");
    }
  }

  void DrawUpward() {
    const Pixel tip{kMiddleX, kMiddleY - kRadius - 24.0};
    svg_ += "<path d=\"M" + Number(tip.x) + " " + Number(tip.y) + "l9 22l-9 -6l-9 6Z\" fill=\"#b3261e\"/>\n";
    Text({tip.x + 16.0, tip.y + 16.0}, picture_.up, "font-size=\"18\" font-weight=\"bold\" fill=\"#b3261e\"");
  }

  // Names beside their outlines, by rank; a name that would cover another is left to the legend.
  void DrawNames() {
    struct Box {
      double left, top, right, bottom;
    };
    std::vector<Box> taken;
    for (const auto index : ByRank()) {
      const auto& outline = picture_.outlines[index];
      if (outline.corners.empty() || !std::ranges::all_of(outline.corners, IsFinite)) continue;
      // Beside the corner that lies farthest to the right, left, top or bottom.
      std::vector<Pixel> corners;
      for (const auto& corner : outline.corners) corners.push_back(ToPixel(corner));
      const auto [left, right] = std::ranges::minmax(corners, {}, &Pixel::x);
      const auto [top, bottom] = std::ranges::minmax(corners, {}, &Pixel::y);
      const double width = 9.0 * static_cast<double>(outline.name.size());
      constexpr double kTextHeight = 13.0, kGap = 8.0;
      const std::array<Pixel, 4> places{Pixel{right.x + kGap, right.y + 5.0}, Pixel{left.x - kGap - width, left.y + 5.0},
                                        Pixel{top.x - width / 2.0, top.y - kGap}, Pixel{bottom.x - width / 2.0, bottom.y + kGap + kTextHeight}};
      for (const auto& place : places) {
        const Box box{place.x - 2.0, place.y - kTextHeight, place.x + width + 2.0, place.y + 3.0};
        const bool is_in_view = std::hypot(place.x + width / 2.0 - kMiddleX, place.y - kMiddleY) < kRadius - 14.0;
        const bool is_free = std::ranges::none_of(taken, [&box](const Box& other) {
          return box.left < other.right && other.left < box.right && box.top < other.bottom && other.top < box.bottom;
        });
        if (!is_in_view || !is_free) continue;
        taken.push_back(box);
        Text(place, outline.name,
             std::string("font-size=\"13\" ") + (outline.is_tentative ? "fill-opacity=\"0.7\"" : "font-weight=\"bold\"") + " fill=\"" +
                 Css(outline.colour) + "\" stroke=\"#ffffff\" stroke-width=\"3.5\" paint-order=\"stroke\"");
        break;
      }
    }
  }

  void DrawLegend() {
    double y = kLegendTop;
    const auto mark = [&](const Rgb& colour, bool is_light = false) {
      svg_ += "<circle cx=\"" + Number(kLegendX + 6.0) + "\" cy=\"" + Number(y - 5.0) + "\" r=\"6\" fill=\"" + Css(colour) +
              (is_light ? "\" fill-opacity=\"0.4" : "") + "\"/>\n";
    };
    const std::string dark = "font-size=\"14\" fill=\"#1c2b3a\"";
    const std::string pale = "font-size=\"13\" fill=\"#5b6b7b\"";
    for (const auto& entry : picture_.legend) {
      mark(entry.colour);
      Text({kLegendX + 22.0, y}, entry.text, dark);
      y += kLegendLine;
    }
    if (picture_.outlines.empty()) return;
    if (!picture_.legend.empty()) y += 12.0;
    Text({kLegendX, y}, picture_.outlines_title, pale);
    y += kLegendLine + 2.0;
    const auto order = ByRank();
    std::size_t num_drawn = 0;
    for (const auto index : order) {
      if (y + kLegendLine > kLegendBottom && num_drawn + 1 < order.size()) break;
      const auto& outline = picture_.outlines[index];
      mark(outline.colour, outline.is_tentative);
      Text({kLegendX + 22.0, y}, outline.name, dark + " font-weight=\"bold\"");
      Text({kLegendX + 60.0, y}, outline.facts, dark);
      y += kLegendLine;
      ++num_drawn;
    }
    if (num_drawn < order.size()) Text({kLegendX + 22.0, y}, "and " + std::to_string(order.size() - num_drawn) + " more", pale);
  }

  // Nearest first, what is tentative behind all that is sure: in rain it would else fill the legend.
  std::vector<std::size_t> ByRank() const {
    std::vector<std::size_t> order(picture_.outlines.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // What is not finite counts as farthest, so that the order stays one.
    const auto rank = [this](std::size_t index) {
      const auto& outline = picture_.outlines[index];
      return std::pair(outline.is_tentative, std::isfinite(outline.distance_m) ? outline.distance_m : 1e9);
    };
    std::ranges::stable_sort(order, {}, rank);
    return order;
  }

  const Picture& picture_;
  Rings rings_;
  double pixels_per_m_;
  std::string svg_;
};

}  // namespace

std::string DrawSvg(const Picture& picture) { return Drawing(picture).Draw(); }

}  // namespace lookout::exporter
