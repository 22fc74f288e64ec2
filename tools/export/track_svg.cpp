#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/export/colour.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

constexpr double kWidth = 1320.0;
constexpr double kHeight = 1000.0;
constexpr double kMargin = 60.0;
constexpr double kLeastStepM = 0.2;
// Least extent that fills the page, so that noise of a standing track does not.
constexpr double kLeastSpanM = 20.0;
constexpr double kLandCellM = 0.5;
constexpr const char* kLandColour = "#b8a07a";
constexpr const char* kWarningColour = "#c00000";
constexpr const char* kCautionColour = "#c86e00";
constexpr std::size_t kMostAlertLines = 12;
// Room of a number of a track.
constexpr double kNumberWidth = 34.0;
constexpr double kNumberHeight = 11.0;
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

// Text in a picture.
std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<') {
      escaped += "&lt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else {
      escaped += c >= ' ' && c <= '~' ? c : '?';
    }
  }
  return escaped;
}

// "1 track", "3 tracks"
std::string Number(std::size_t number, std::string_view noun) { return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s"); }

// One track of the tracker, as long as it was confirmed.
struct Followed {
  std::vector<Eigen::Vector2d> places_m;   // places of the centre
  std::vector<Eigen::Vector2d> outline_m;  // outline when the track was seen last
  bool has_moved = false;
};

// Where the boat was when an alert came up.
struct Warned {
  Eigen::Vector2d place_m;
  bool is_warning = false;
  double time_s = 0.0;  // since the first place
  std::string text;
};

class TrackSvgSink : public Sink {
 public:
  /// @param has_tracks  of the tracker, with its land and alerts
  explicit TrackSvgSink(bool has_tracks) : has_tracks_(has_tracks) {}

  std::vector<bus::Channel> Channels() const override {
    return has_tracks_ ? std::vector<bus::Channel>{bus::kTracks, bus::kPose, bus::kAlerts} : std::vector<bus::Channel>{bus::kPose};
  }

  Taken Take(std::string_view channel, Bytes bytes, std::string&) override {
    if (channel == bus::kTracks.name) return TakeTracks(bytes);
    if (channel == bus::kAlerts.name) return TakeAlerts(bytes);
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
    if (!first_utime_us_) first_utime_us_ = pose->utime_us;
    Add(*style, pose->latitude_deg, pose->longitude_deg);
    return Taken::kOk;
  }

  void Finish(std::string& text) override {
    if (!stretches_.empty()) Draw(text);
  }

 private:
  // East and north of the first place of the boat.
  Eigen::Vector2d PlaceOf(double latitude_deg, double longitude_deg) const {
    return {kEarthRadiusM * std::cos(DegToRad(latitude_deg_)) * WrapToPi(DegToRad(longitude_deg - longitude_deg_)),
            kEarthRadiusM * DegToRad(latitude_deg - latitude_deg_)};
  }

  // Tracks before the first place of the boat are left out.
  Taken TakeTracks(Bytes bytes) {
    const auto tracks = bus::Decode<tracks_t>(bytes);
    if (!tracks) return Taken::kUndecodable;
    if (!UtimeFromWire(tracks->end_utime_us) || std::abs(tracks->datum_latitude_deg) > 90.0 || std::abs(tracks->datum_longitude_deg) > 180.0) {
      return Taken::kInconsistent;
    }
    if (stretches_.empty() || !std::isfinite(tracks->datum_latitude_deg + tracks->datum_longitude_deg + tracks->datum_ellipsoid_height_m)) {
      return Taken::kOk;
    }
    const LocalFrame map({tracks->datum_latitude_deg, tracks->datum_longitude_deg, tracks->datum_ellipsoid_height_m});
    const auto place_of = [&](double east_m, double north_m) {
      const auto place = map.Reverse({east_m, north_m, 0.0});
      return PlaceOf(place.latitude_deg, place.longitude_deg);
    };
    for (const auto& track : tracks->tracks) {
      if (track.status != track_t::STATUS_CONFIRMED && track.status != track_t::STATUS_COASTING) continue;
      const Eigen::Vector2d place_m = place_of(track.position_map_m[0], track.position_map_m[1]);
      if (!place_m.allFinite()) return Taken::kInconsistent;
      auto& followed = followed_[track.id];
      followed.has_moved |= track.speed_mps > 0.0F;
      auto& places_m = followed.places_m;
      if (places_m.empty() || (place_m - places_m.back()).norm() >= kLeastStepM) places_m.push_back(place_m);
      followed.outline_m.clear();
      for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) {
        followed.outline_m.push_back(place_of(track.outline_east_m[i], track.outline_north_m[i]));
        if (!followed.outline_m.back().allFinite()) return Taken::kInconsistent;
      }
    }
    for (std::size_t i = 0; i < tracks->waterline_east_m.size(); ++i) {
      const Eigen::Vector2d place_m = place_of(tracks->waterline_east_m[i], tracks->waterline_north_m[i]) / kLandCellM;
      if (!(place_m.cwiseAbs().maxCoeff() < 1e9)) return Taken::kInconsistent;
      land_.emplace(std::llround(place_m.x()), std::llround(place_m.y()));
    }
    return Taken::kOk;
  }

  Taken TakeAlerts(Bytes bytes) {
    const auto alerts = bus::Decode<alerts_t>(bytes);
    if (!alerts) return Taken::kUndecodable;
    if (!UtimeFromWire(alerts->end_utime_us)) return Taken::kInconsistent;
    if (stretches_.empty()) return Taken::kOk;
    for (const auto& alert : alerts->alerts) {
      if (alert.state != alert_t::STATE_ACTIVE || !told_.emplace(alert.id, alert.raised_utime_us).second) continue;
      warned_.push_back({stretches_.back().places_m.back(), alert.level == alert_t::LEVEL_WARNING,
                         1e-6 * static_cast<double>(alerts->end_utime_us - *first_utime_us_), alert.text});
    }
    return Taken::kOk;
  }

  void Add(const Style& style, double latitude_deg, double longitude_deg) {
    if (stretches_.empty()) {
      latitude_deg_ = latitude_deg;
      longitude_deg_ = longitude_deg;
    }
    const Eigen::Vector2d place_m = PlaceOf(latitude_deg, longitude_deg);
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
    for (const auto& [id, followed] : followed_) {
      for (const auto& place_m : followed.places_m) box_m.extend(place_m);
    }
    const double pixels_per_m = std::min((kWidth - 2.0 * kMargin) / std::max(box_m.sizes().x(), kLeastSpanM),
                                         (kHeight - 2.0 * kMargin) / std::max(box_m.sizes().y(), kLeastSpanM));
    const auto x = [&](const Eigen::Vector2d& place_m) { return kWidth / 2.0 + pixels_per_m * (place_m - box_m.center()).x(); };
    const auto y = [&](const Eigen::Vector2d& place_m) { return kHeight / 2.0 - pixels_per_m * (place_m - box_m.center()).y(); };
    text +=
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1320\" height=\"1000\" font-family=\"sans-serif\" font-size=\"14\">\n"
        "<title>Track of the boat</title>\n<rect width=\"1320\" height=\"1000\" fill=\"#ffffff\"/>\n";
    const auto points_of = [&](const std::vector<Eigen::Vector2d>& places_m) {
      std::string points;
      for (const auto& place_m : places_m) points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", x(place_m), y(place_m));
      return points;
    };
    if (has_tracks_) {
      text += "<style>text{paint-order:stroke;stroke:#ffffff;stroke-width:3px}</style>\n";
      DrawTracks(x, y, points_of, text);
    }
    for (const auto& stretch : stretches_) {
      std::string points = points_of(stretch.places_m);
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
    if (has_tracks_) DrawAlerts(x, y, line_y, text);
    const double bar_m = RoundLength(kWidth / 4.0 / pixels_per_m);
    text += fmt::format(
        "<line x1=\"20\" x2=\"{:.1f}\" y1=\"970\" y2=\"970\" stroke=\"#000000\" stroke-width=\"3\"/>\n<text x=\"20\" y=\"962\">{:.{}f} "
        "m</text>\n</svg>\n",
        20.0 + bar_m * pixels_per_m, bar_m, bar_m < 1.0 ? 1 : 0);
  }

  // Land below, then tracks: the way of moving ones, the last outline of all, a number where none lies on another.
  void DrawTracks(const auto& x, const auto& y, const auto& points_of, std::string& text) const {
    std::string land;
    for (const auto& [east, north] : land_) {
      const Eigen::Vector2d place_m = kLandCellM * Eigen::Vector2d(static_cast<double>(east), static_cast<double>(north));
      if (x(place_m) > 0.0 && x(place_m) < kWidth && y(place_m) > 0.0 && y(place_m) < kHeight) {
        land += fmt::format("M{:.1f} {:.1f}h2v2h-2z", x(place_m) - 1.0, y(place_m) - 1.0);
      }
    }
    if (!land.empty()) text += fmt::format("<path fill=\"{}\" d=\"{}\"/>\n", kLandColour, land);
    std::vector<Eigen::Vector2d> numbers;
    for (const auto& [id, followed] : followed_) {
      const auto [red, green, blue] = ColourOfSegment(static_cast<int>(id % 1'000'000) + 1);
      const auto colour = fmt::format("#{:02x}{:02x}{:02x}", red, green, blue);
      text += fmt::format("<g stroke=\"{}\" fill=\"none\"><title>track {}</title>", colour, id);
      if (followed.outline_m.size() > 1) text += fmt::format("<polygon points=\"{}\"/>", points_of(followed.outline_m));
      if (followed.has_moved) text += fmt::format("<polyline stroke-width=\"1.5\" points=\"{}\"/>", points_of(followed.places_m));
      text += "</g>\n";
      const auto& end_m = followed.places_m.back();
      const Eigen::Vector2d number(x(end_m), y(end_m));
      const bool is_free = std::ranges::none_of(numbers, [&](const Eigen::Vector2d& other) {
        return std::abs(number.x() - other.x()) < kNumberWidth && std::abs(number.y() - other.y()) < kNumberHeight;
      });
      if (!is_free) continue;
      numbers.push_back(number);
      text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" dx=\"4\" dy=\"-4\" font-size=\"11\" fill=\"{}\">{}</text>\n", number.x(), number.y(),
                          colour, id);
    }
  }

  // A ring where the boat was when each came up, and the first of them in words.
  void DrawAlerts(const auto& x, const auto& y, int line_y, std::string& text) const {
    const auto num_moved = std::ranges::count_if(followed_, [](const auto& item) { return item.second.has_moved; });
    text += fmt::format("<text x=\"20\" y=\"{}\">{} of the tracker, {} moved; {}{}</text>\n", line_y, Number(followed_.size(), "track"), num_moved,
                        Number(warned_.size(), "alert"), warned_.empty() ? "" : ", each where the boat was when it came up:");
    for (std::size_t i = 0; i < warned_.size(); ++i) {
      const auto& [place_m, is_warning, time_s, words] = warned_[i];
      const auto line = fmt::format("{:.1f} s, {}: {}", time_s, is_warning ? "warning" : "caution", Escaped(words));
      const auto* colour = is_warning ? kWarningColour : kCautionColour;
      text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"7\" fill=\"none\" stroke-width=\"2.5\" stroke=\"{}\"><title>{}</title></circle>\n",
                          x(place_m), y(place_m), colour, line);
      line_y += 18;
      if (i < kMostAlertLines) text += fmt::format("<text x=\"20\" y=\"{}\" font-size=\"12\" fill=\"{}\">{}</text>\n", line_y, colour, line);
    }
    if (warned_.size() > kMostAlertLines) {
      text += fmt::format("<text x=\"20\" y=\"{}\" font-size=\"12\">and {} more</text>\n",
                          line_y - 18 * static_cast<int>(warned_.size() - kMostAlertLines - 1), warned_.size() - kMostAlertLines);
    }
  }

  bool has_tracks_;
  std::map<std::int64_t, Followed> followed_;             // by id
  std::set<std::pair<std::int64_t, std::int64_t>> land_;  // cells of kLandCellM
  std::set<std::pair<std::int64_t, std::int64_t>> told_;  // id of an alert, and when it was raised
  std::vector<Warned> warned_;
  std::optional<std::int64_t> first_utime_us_;
  double latitude_deg_ = 0.0;  // of the first place
  double longitude_deg_ = 0.0;
  bool is_broken_ = false;
  std::vector<Stretch> stretches_;
};

}  // namespace

std::unique_ptr<Sink> MakeTrackSvgSink(bool has_tracks) { return std::make_unique<TrackSvgSink>(has_tracks); }

}  // namespace lookout::exporter
