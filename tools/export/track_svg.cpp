#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "lookout/pose_t.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

constexpr double kWidth = 1320.0;
constexpr double kHeight = 1000.0;
constexpr double kMargin = 60.0;
constexpr double kLeastStepM = 0.2;
// Of a track that does not move, so that noise does not fill the page.
constexpr double kLeastSpanM = 20.0;
// Mean radius of the earth (IUGG); a picture needs no ellipsoid.
constexpr double kEarthRadiusM = 6'371'008.8;

// Okabe and Ito: for readers who confuse red and green.
struct Style {
  int status;
  std::string_view name;
  std::string_view colour;
};
constexpr std::array kStyles{Style{pose_t::STATUS_OK, "ok", "#0072B2"}, Style{pose_t::STATUS_COASTING, "coasting", "#D55E00"},
                             Style{pose_t::STATUS_NO_HEADING, "no heading", "#56B4E9"}};

struct Stretch {
  const Style* style;
  std::vector<Eigen::Vector2d> places_m;  // east and north of the first of all
};

// 1, 2 or 5 times a power of ten, at most `length_m`.
double RoundLength(double length_m) {
  const double power = std::pow(10.0, std::floor(std::log10(length_m)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= length_m) return factor * power;
  }
  return power;
}

class TrackSvgSink : public Sink {
 public:
  std::vector<bus::Channel> Channels() const override { return {bus::kPose}; }

  Taken Take(std::string_view, Bytes bytes, std::string&) override {
    const auto pose = bus::Decode<pose_t>(bytes);
    if (!pose) return Taken::kUndecodable;
    const auto* style = std::ranges::find(kStyles, pose->status, &Style::status);
    if (style == kStyles.end()) {
      is_broken_ = true;
      return UtimeFromWire(pose->utime_us) ? Taken::kOk : Taken::kInconsistent;
    }
    if (!UtimeFromWire(pose->utime_us) || !(std::abs(pose->latitude_deg) <= 90.0) || !(std::abs(pose->longitude_deg) <= 180.0)) {
      return Taken::kInconsistent;
    }
    Add(*style, pose->latitude_deg, pose->longitude_deg);
    return Taken::kOk;
  }

  void Finish(std::string& text) override {
    if (!stretches_.empty()) Draw(text);
  }

 private:
  void Add(const Style& style, double latitude_deg, double longitude_deg) {
    if (stretches_.empty()) {
      latitude_deg_ = latitude_deg;
      longitude_deg_ = longitude_deg;
    }
    const Eigen::Vector2d place_m(kEarthRadiusM * std::cos(DegToRad(latitude_deg_)) * WrapToPi(DegToRad(longitude_deg - longitude_deg_)),
                                  kEarthRadiusM * DegToRad(latitude_deg - latitude_deg_));
    if (is_broken_ || stretches_.empty()) {
      stretches_.push_back({&style, {place_m}});
    } else if (stretches_.back().style != &style) {
      // The new stretch begins where the old one ends.
      stretches_.push_back({&style, {Eigen::Vector2d(stretches_.back().places_m.back()), place_m}});
    } else if ((place_m - stretches_.back().places_m.back()).norm() >= kLeastStepM) {
      stretches_.back().places_m.push_back(place_m);
    }
    is_broken_ = false;
  }

  void Draw(std::string& text) const {
    Eigen::AlignedBox2d box_m;
    double length_m = 0.0;
    for (const auto& stretch : stretches_) {
      for (std::size_t i = 0; i < stretch.places_m.size(); ++i) {
        box_m.extend(stretch.places_m[i]);
        if (i > 0) length_m += (stretch.places_m[i] - stretch.places_m[i - 1]).norm();
      }
    }
    const double pixels_per_m = std::min((kWidth - 2.0 * kMargin) / std::max(box_m.sizes().x(), kLeastSpanM),
                                         (kHeight - 2.0 * kMargin) / std::max(box_m.sizes().y(), kLeastSpanM));
    const auto x = [&](const Eigen::Vector2d& place_m) { return kWidth / 2.0 + pixels_per_m * (place_m - box_m.center()).x(); };
    const auto y = [&](const Eigen::Vector2d& place_m) { return kHeight / 2.0 - pixels_per_m * (place_m - box_m.center()).y(); };
    text +=
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1320\" height=\"1000\" font-family=\"sans-serif\" font-size=\"14\">\n"
        "<title>Track of the boat</title>\n<rect width=\"1320\" height=\"1000\" fill=\"#ffffff\"/>\n";
    for (const auto& stretch : stretches_) {
      std::string points;
      for (const auto& place_m : stretch.places_m) points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", x(place_m), y(place_m));
      // A stretch of one place is seen as a dot.
      if (stretch.places_m.size() == 1) points += " " + points;
      text += fmt::format("<polyline fill=\"none\" stroke-width=\"2\" stroke-linecap=\"round\" stroke=\"{}\" points=\"{}\"/>\n",
                          stretch.style->colour, points);
    }
    for (const auto& [place_m, word] : {std::pair(stretches_.front().places_m.front(), "begin"), {stretches_.back().places_m.back(), "end"}}) {
      text += fmt::format("<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"4\"/>\n<text x=\"{0:.1f}\" y=\"{1:.1f}\" dx=\"7\" dy=\"-7\">{2}</text>\n",
                          x(place_m), y(place_m), word);
    }
    text += fmt::format(
        "<text x=\"20\" y=\"28\" font-size=\"18\">Track of the boat, north up</text>\n"
        "<text x=\"20\" y=\"50\">{:.0f} m; begins at {:.6f}, {:.6f}</text>\n",
        length_m, latitude_deg_, longitude_deg_);
    int line_y = 72;
    for (const auto& style : kStyles) {
      if (std::ranges::none_of(stretches_, [&style](const Stretch& stretch) { return stretch.style == &style; })) continue;
      text +=
          fmt::format("<line x1=\"20\" x2=\"50\" y1=\"{0}\" y2=\"{0}\" stroke-width=\"3\" stroke=\"{1}\"/>\n<text x=\"58\" y=\"{2}\">{3}</text>\n",
                      line_y - 5, style.colour, line_y, style.name);
      line_y += 20;
    }
    const double bar_m = RoundLength(kWidth / 4.0 / pixels_per_m);
    text += fmt::format(
        "<line x1=\"20\" x2=\"{:.1f}\" y1=\"970\" y2=\"970\" stroke=\"#000000\" stroke-width=\"3\"/>\n<text x=\"20\" y=\"962\">{:.{}f} "
        "m</text>\n</svg>\n",
        20.0 + bar_m * pixels_per_m, bar_m, bar_m < 1.0 ? 1 : 0);
  }

  double latitude_deg_ = 0.0;  // of the first place
  double longitude_deg_ = 0.0;
  bool is_broken_ = false;
  std::vector<Stretch> stretches_;
};

}  // namespace

std::unique_ptr<Sink> MakeTrackSvgSink() { return std::make_unique<TrackSvgSink>(); }

}  // namespace lookout::exporter
