#include "tools/export/map_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "tools/export/csv.hpp"

namespace lookout::exporter {

namespace {

constexpr std::int64_t kNanodegPerDeg = 1'000'000'000;
constexpr std::int64_t kHalfCircle = 180 * kNanodegPerDeg;
constexpr std::int64_t kQuarterCircle = 90 * kNanodegPerDeg;

using Places = std::vector<MapPlace>;

double ToDeg(std::int64_t angle_ndeg) { return static_cast<double>(angle_ndeg) / static_cast<double>(kNanodegPerDeg); }

// Steps in longitude the shorter way, in (-180, 180].
std::int64_t Step(std::int64_t from_ndeg, std::int64_t to_ndeg) {
  const auto step = to_ndeg - from_ndeg;
  return step > kHalfCircle ? step - 2 * kHalfCircle : step <= -kHalfCircle ? step + 2 * kHalfCircle : step;
}

// Crossings and corners along a line, in order.
struct Walked {
  // A stretch between two crossings of the 180th meridian; all on one side of it.
  struct Stretch {
    Places places;
    std::vector<double> at;  // position of each place along the line: an index, with a fraction between two places
  };
  struct Crossing {
    std::int64_t side = 0;  // longitude at which the stretch before ends; the next stretch begins at minus this longitude
    std::int64_t latitude = 0;
  };
  std::vector<Stretch> stretches;  // one stretch more than crossings
  std::vector<Crossing> crossings;
};

Walked Walk(std::span<const MapPlace> places) {
  Walked walked;
  walked.stretches.push_back({{places.front()}, {0.0}});
  auto longitude = places.front().longitude_ndeg;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const auto step = Step(longitude, places[i].longitude_ndeg);
    auto next = longitude + step;
    if (next > kHalfCircle || next < -kHalfCircle) {
      const auto side = next > 0 ? kHalfCircle : -kHalfCircle;
      const double share = static_cast<double>(side - longitude) / static_cast<double>(step);
      const auto climb = static_cast<double>(places[i].latitude_ndeg - places[i - 1].latitude_ndeg);
      const auto latitude = places[i - 1].latitude_ndeg + std::llround(share * climb);
      const double at = static_cast<double>(i - 1) + share;
      walked.crossings.push_back({side, latitude});
      walked.stretches.back().places.push_back({side, latitude});
      walked.stretches.back().at.push_back(at);
      walked.stretches.push_back({{{-side, latitude}}, {at}});
      next -= 2 * side;
    }
    walked.stretches.back().places.push_back({next, places[i].latitude_ndeg});
    walked.stretches.back().at.push_back(static_cast<double>(i));
    longitude = next;
  }
  return walked;
}

bool AreOne(const Places& places) {
  return std::ranges::all_of(places, [&](const MapPlace& place) { return place == places.front(); });
}

// Twice the area, in square 1e-9 deg; positive where the ring is counter-clockwise.
double SignedArea(const Places& ring) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const auto x = [&](std::size_t k) { return static_cast<double>(ring[k].longitude_ndeg - ring.front().longitude_ndeg); };
    const auto y = [&](std::size_t k) { return static_cast<double>(ring[k].latitude_ndeg - ring.front().latitude_ndeg); };
    sum += x(i) * y(i + 1) - x(i + 1) * y(i);
  }
  return sum;
}

void AddRing(Places ring, std::vector<Places>& rings) {
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  if (ring.size() > 1 && ring.front() != ring.back()) ring.push_back(ring.front());
  const double area = SignedArea(ring);
  if (ring.size() < 4 || area == 0.0) return;
  if (area < 0.0) std::ranges::reverse(ring);
  rings.push_back(std::move(ring));
}

// Each crossing's partner: along the 180th meridian the area lies between the two. Its own number: between it and the pole.
std::vector<std::size_t> Partners(const std::vector<Walked::Crossing>& crossings) {
  std::vector<std::size_t> order(crossings.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return crossings[i].latitude; });
  std::vector<std::size_t> partners(crossings.size());
  const bool holds_pole = order.size() % 2 == 1;
  const bool is_south = holds_pole && crossings[order.front()].latitude < 0;
  std::size_t first = 0;
  if (is_south) {
    partners[order.front()] = order.front();
    first = 1;
  }
  for (; first + 1 < order.size(); first += 2) {
    partners[order[first]] = order[first + 1];
    partners[order[first + 1]] = order[first];
  }
  if (holds_pole && !is_south) partners[order.back()] = order.back();
  return partners;
}

// Rings of the area inside of a closed line that crosses the 180th meridian: its stretches, joined along the meridian.
void AddCutRings(Walked walked, std::vector<Places>& rings) {
  // The first stretch goes on where the last one ends.
  const auto num_crossings = walked.crossings.size();
  auto& last = walked.stretches.back().places;
  const auto& first = walked.stretches.front().places;
  last.insert(last.end(), first.begin(), first.end());
  const auto stretch_after = [&](std::size_t crossing) -> const Places& { return walked.stretches[crossing + 1].places; };
  const auto partners = Partners(walked.crossings);
  std::vector<bool> is_used(num_crossings, false);
  for (std::size_t begin = 0; begin < num_crossings; ++begin) {
    Places ring;
    for (auto crossing = begin; !is_used[crossing];) {
      is_used[crossing] = true;
      const auto& stretch = stretch_after(crossing);
      ring.insert(ring.end(), stretch.begin(), stretch.end());
      const auto end = (crossing + 1) % num_crossings;
      crossing = partners[end];
      if (crossing == end) {
        const auto pole = walked.crossings[end].latitude < 0 ? -kQuarterCircle : kQuarterCircle;
        ring.push_back({walked.crossings[end].side, pole});
        ring.push_back({-walked.crossings[end].side, pole});
      }
    }
    AddRing(std::move(ring), rings);
  }
}

double DistanceFromOrigin(const Eigen::Vector3d& begin_m, const Eigen::Vector3d& end_m) {
  const Eigen::Vector3d side_m = end_m - begin_m;
  const double squared_m2 = side_m.squaredNorm();
  const double share = squared_m2 > 0.0 ? std::clamp(-begin_m.dot(side_m) / squared_m2, 0.0, 1.0) : 0.0;
  return (begin_m + share * side_m).norm();
}

GeodeticPlace OnTheEllipsoid(const MapPlace& place) { return {ToDeg(place.latitude_ndeg), ToDeg(place.longitude_ndeg), 0.0}; }

void AppendPlaces(const Places& places, std::string& text) {
  text += '(';
  for (const auto& place : places) {
    if (text.back() != '(') text += ',';
    AppendPlace(place, ' ', text);
  }
  text += ')';
}

}  // namespace

MapPlace ToMapPlace(const GeodeticPlace& place) {
  // Exact: a remainder.
  const double longitude_deg = std::remainder(place.longitude_deg, 360.0);
  return {std::llround(longitude_deg * static_cast<double>(kNanodegPerDeg)), std::llround(place.latitude_deg * static_cast<double>(kNanodegPerDeg))};
}

void AppendPlace(const MapPlace& place, char separator, std::string& text) {
  AppendCell(Fixed{ToDeg(place.longitude_ndeg), 9}, text);
  text += separator;
  AppendCell(Fixed{ToDeg(place.latitude_ndeg), 9}, text);
}

Geometry PointAt(const MapPlace& place) { return {Geometry::Kind::kPoint, {{place}}, {}}; }

Geometry PointsAt(std::span<const MapPlace> places) { return {Geometry::Kind::kPoints, {{places.begin(), places.end()}}, {}}; }

Geometry LineAlong(std::span<const MapPlace> places, std::span<const std::int64_t> utimes_us) {
  const bool has_times = !utimes_us.empty();
  if (places.size() == 1 || (!has_times && AreOne({places.begin(), places.end()}))) {
    auto point = PointAt(places.front());
    if (has_times) point.utimes_us = {{utimes_us.front()}};
    return point;
  }
  Geometry line{Geometry::Kind::kLine, {}, {}};
  auto walked = Walk(places);
  for (auto& stretch : walked.stretches) {
    // The line only touched the meridian there.
    if (walked.stretches.size() > 1 && AreOne(stretch.places)) continue;
    if (has_times) {
      auto& times = line.utimes_us.emplace_back();
      for (const double at : stretch.at) {
        const auto before = static_cast<std::size_t>(at);
        const auto after = std::min(before + 1, utimes_us.size() - 1);
        const double share = at - static_cast<double>(before);
        times.push_back(utimes_us[before] + std::llround(share * static_cast<double>(utimes_us[after] - utimes_us[before])));
      }
    }
    line.parts.push_back(std::move(stretch.places));
  }
  return line;
}

Geometry LinesAlong(std::span<const std::vector<MapPlace>> lines) {
  Geometry all{Geometry::Kind::kLine, {}, {}};
  for (const auto& places : lines) {
    if (places.empty()) continue;
    auto line = LineAlong(places);
    if (line.kind == Geometry::Kind::kLine) std::ranges::move(line.parts, std::back_inserter(all.parts));
  }
  return all;
}

Geometry PolygonAround(std::span<const MapPlace> corners) {
  Places closed(corners.begin(), corners.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  if (closed.size() > 1 && closed.front() == closed.back()) closed.pop_back();
  if (closed.size() > 2) {
    // A walk that begins on the meridian would cross it once only.
    const auto begin = std::ranges::find_if(closed, [](const MapPlace& place) { return std::abs(place.longitude_ndeg) != kHalfCircle; });
    if (begin != closed.end()) std::rotate(closed.begin(), begin, closed.end());
    closed.push_back(closed.front());
    Geometry polygon{Geometry::Kind::kPolygon, {}, {}};
    auto walked = Walk(closed);
    if (walked.crossings.empty()) {
      AddRing(std::move(walked.stretches.front().places), polygon.parts);
    } else {
      AddCutRings(std::move(walked), polygon.parts);
    }
    if (!polygon.parts.empty()) return polygon;
  }
  return LineAlong(closed);
}

std::string Wkt(const Geometry& geometry) {
  std::string text;
  const bool is_one = geometry.parts.size() == 1;
  switch (geometry.kind) {
    case Geometry::Kind::kPoint:
      text = "POINT";
      break;
    case Geometry::Kind::kPoints:
      text = "MULTIPOINT";
      break;
    case Geometry::Kind::kLine:
      text = is_one ? "LINESTRING" : "MULTILINESTRING";
      break;
    case Geometry::Kind::kPolygon:
      text = is_one ? "POLYGON" : "MULTIPOLYGON";
      break;
  }
  const bool is_polygon = geometry.kind == Geometry::Kind::kPolygon;
  if (!is_one) text += '(';
  for (std::size_t i = 0; i < geometry.parts.size(); ++i) {
    if (i > 0) text += ',';
    if (is_polygon) text += '(';
    AppendPlaces(geometry.parts[i], text);
    if (is_polygon) text += ')';
  }
  if (!is_one) text += ')';
  return text;
}

bool MapOfDatum::IsOf(const GeodeticPlace& datum) const {
  return datum.latitude_deg == datum_.latitude_deg && datum.longitude_deg == datum_.longitude_deg &&
         datum.ellipsoid_height_m == datum_.ellipsoid_height_m;
}

MapPlace MapOfDatum::PlaceAt(const Eigen::Vector2d& p_map_m) const {
  // The plane of the map touches the earth at its datum: 8 cm above it at 1 km, 785 m at 100 km. The sphere (mean radius, IUGG) is the first guess of
  // how far, the second is right to a millimetre.
  constexpr double kEarthRadiusM = 6'371'008.8;
  double up_m = -p_map_m.squaredNorm() / (2.0 * kEarthRadiusM);
  auto place = frame_.Reverse({p_map_m.x(), p_map_m.y(), up_m});
  const double excess_m = place.ellipsoid_height_m - datum_.ellipsoid_height_m;
  if (std::abs(excess_m) > 1e-3) {
    up_m -= excess_m;
    place = frame_.Reverse({p_map_m.x(), p_map_m.y(), up_m});
  }
  return ToMapPlace(place);
}

void MapOfDatum::AddSide(const Eigen::Vector2d& begin_m, const Eigen::Vector2d& end_m, const MapPlace& end, int depth, Places& places) const {
  constexpr std::int64_t kLongestStep = 5 * kNanodegPerDeg;
  if (depth > 0 && std::abs(Step(places.back().longitude_ndeg, end.longitude_ndeg)) > kLongestStep) {
    const Eigen::Vector2d middle_m = 0.5 * (begin_m + end_m);
    AddSide(begin_m, middle_m, PlaceAt(middle_m), depth - 1, places);
    AddSide(middle_m, end_m, end, depth - 1, places);
    return;
  }
  places.push_back(end);
}

std::vector<MapPlace> MapOfDatum::Line(std::span<const Eigen::Vector2d> corners_map_m) const {
  constexpr int kMostHalvings = 12;
  Places places;
  for (std::size_t i = 0; i < corners_map_m.size(); ++i) {
    const auto place = PlaceAt(corners_map_m[i]);
    if (i == 0) {
      places.push_back(place);
    } else {
      AddSide(corners_map_m[i - 1], corners_map_m[i], place, kMostHalvings, places);
    }
  }
  return places;
}

std::vector<MapPlace> MapOfDatum::Outline(std::span<const Eigen::Vector2d> corners_map_m) const {
  std::vector<Eigen::Vector2d> closed_m(corners_map_m.begin(), corners_map_m.end());
  if (closed_m.size() > 2) closed_m.push_back(closed_m.front());
  return Line(closed_m);
}

std::vector<MapPlace> MapOfDatum::Ellipse(const Eigen::Vector2d& center_map_m, const Eigen::Vector3d& covariance_m2) const {
  // Chi-square of two degrees of freedom that chance exceeds in one of 20 cases: -2 ln 0.05.
  constexpr double kChiSquare95 = 5.991464547107979;
  constexpr double kLongestM = 1e5;
  constexpr int kNumCorners = 36;
  // Square root of the covariance, a triangle (Cholesky): it takes a circle to the ellipse.
  const double ee = std::sqrt(covariance_m2[0]);
  const double ne = covariance_m2[1] / ee;
  const double nn = std::sqrt(covariance_m2[2] - ne * ne);
  const double scale = std::sqrt(kChiSquare95);
  if (!(ee > 0.0) || !(nn > 0.0) || !(scale * std::sqrt(covariance_m2[0] + covariance_m2[2]) < kLongestM)) return {};
  std::vector<Eigen::Vector2d> corners_m;
  for (int i = 0; i < kNumCorners; ++i) {
    const double angle_rad = kTwoPi * i / kNumCorners;
    const double x = scale * Cos(angle_rad);
    const double y = scale * Sin(angle_rad);
    corners_m.push_back(center_map_m + Eigen::Vector2d(ee * x, ne * x + nn * y));
  }
  return Outline(corners_m);
}

Near::Near(const GeodeticPlace& place, double radius_m) : frame_(OnEllipsoid(place)), radius_m_(radius_m) {}

Eigen::Vector3d Near::From(const MapPlace& place) const { return frame_.Forward(OnTheEllipsoid(place)); }

bool Near::Holds(const MapPlace& place) const { return From(place).norm() <= radius_m_; }

bool Near::Holds(const Geometry& geometry) const {
  for (const auto& part : geometry.parts) {
    std::vector<Eigen::Vector3d> places_m;
    places_m.reserve(part.size());
    for (const auto& place : part) places_m.push_back(From(place));
    if (geometry.kind == Geometry::Kind::kPoint || geometry.kind == Geometry::Kind::kPoints) {
      if (std::ranges::any_of(places_m, [&](const auto& place_m) { return place_m.norm() <= radius_m_; })) return true;
      continue;
    }
    bool is_inside = false;
    for (std::size_t i = 1; i < places_m.size(); ++i) {
      const auto& [a, b] = std::pair(places_m[i - 1], places_m[i]);
      if (DistanceFromOrigin(a, b) <= radius_m_) return true;
      // A ray to the east crosses the side; what is beyond the horizon of a quarter of the earth is not around the place.
      if ((a.y() > 0.0) != (b.y() > 0.0) && a.z() > -3e6 && a.x() - a.y() * (b.x() - a.x()) / (b.y() - a.y()) > 0.0) is_inside = !is_inside;
    }
    if (is_inside && geometry.kind == Geometry::Kind::kPolygon) return true;
  }
  return false;
}

}  // namespace lookout::exporter
