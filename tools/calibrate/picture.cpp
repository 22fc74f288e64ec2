#include "tools/calibrate/picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "services/odometer/core/local_map.hpp"

namespace lookout::calibrate {

namespace {

constexpr std::size_t kEveryDrawnScan = 5;
constexpr double kCellM = 0.25;
constexpr double kHighestM = 6.0;
constexpr double kPanelPx = 640.0;
constexpr double kHeadPx = 30.0;

// Filled squares of the map, each once, from the first pose.
std::vector<Eigen::Vector2d> CellsOf(const Recording& recording, const Assumed& assumed, const Eigen::Vector3d& origin_m) {
  odometer::CubeIndex index;
  std::vector<Eigen::Vector2d> cells;
  for (std::size_t i = 0; i < recording.scans.size(); i += kEveryDrawnScan) {
    const auto pose = recording.track.At(recording.scans[i].end_time, assumed.latency);
    if (!pose) continue;
    for (const auto& point : StandingIn(recording.scans[i], recording.track, assumed)) {
      // The height of a pose on the earth may be far off, that above the water is not.
      const Eigen::Vector3d from_boat_m = pose->T_map_vessel.linear() * point.p_m;
      if (from_boat_m.z() + assumed.reference_point_above_water_m + pose->heave_m > kHighestM) continue;
      auto cube = odometer::CubeOf(from_boat_m + pose->T_map_vessel.translation() - origin_m, kCellM);
      cube.z() = 0;
      if (index.Insert(cube).second) cells.emplace_back(kCellM * cube.head<2>().cast<double>());
    }
  }
  return cells;
}

struct MapView {
  Eigen::AlignedBox2d box_m;
  double px_per_m = 1.0;

  Eigen::Vector2d ToPx(const Eigen::Vector2d& p_m) const {
    return {(p_m.x() - box_m.min().x()) * px_per_m, kHeadPx + (box_m.max().y() - p_m.y()) * px_per_m};
  }
};

std::string PanelOf(const std::string& title, double left_px, const MapView& view, const std::vector<Eigen::Vector2d>& cells,
                    const std::vector<Eigen::Vector2d>& way_m) {
  std::string text = fmt::format(
      "<g transform=\"translate({:.0f},0)\">\n<text x=\"8\" y=\"20\" font-family=\"sans-serif\" font-size=\"15\">{}</text>\n", left_px, title);
  text += "<path fill=\"#1b4f72\" d=\"";
  const double side_px = std::max(1.0, kCellM * view.px_per_m);
  for (const auto& cell : cells) {
    const auto at = view.ToPx(cell + Eigen::Vector2d(0.0, kCellM));
    text += fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", at.x(), at.y(), side_px, side_px, side_px);
  }
  text += "\"/>\n<polyline fill=\"none\" stroke=\"#c0392b\" stroke-width=\"1.5\" points=\"";
  for (const auto& p_m : way_m) text += fmt::format("{:.1f},{:.1f} ", view.ToPx(p_m).x(), view.ToPx(p_m).y());
  return text + "\"/>\n</g>\n";
}

}  // namespace

std::string PictureOf(const Recording& recording, const Calibration& calibration, const CalibrationParams& params) {
  const Eigen::Vector3d origin_m = recording.track.poses().front().T_map_vessel.translation();
  Assumed before = calibration.found;
  before.T_vessel_lidar = params.boat.T_vessel_lidar;
  before.latency = {};
  const auto cells_before = CellsOf(recording, before, origin_m);
  const auto cells_after = CellsOf(recording, calibration.found, origin_m);
  std::vector<Eigen::Vector2d> way_m;
  for (std::size_t i = 0; i < recording.track.poses().size(); i += 25) {
    way_m.emplace_back((recording.track.poses()[i].T_map_vessel.translation() - origin_m).head<2>());
  }
  MapView view;
  for (const auto& p_m : way_m) view.box_m.extend(p_m);
  for (const auto& cell : cells_after) view.box_m.extend(cell);
  view.box_m.extend(Eigen::Vector2d(view.box_m.max() + Eigen::Vector2d(1.0, 1.0)));
  view.px_per_m = kPanelPx / view.box_m.sizes().maxCoeff();
  const double height_px = kHeadPx + view.box_m.sizes().y() * view.px_per_m;
  const double width_px = view.box_m.sizes().x() * view.px_per_m;
  constexpr double kGapPx = 20.0;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      2.0 * width_px + kGapPx, height_px);
  text += fmt::format("<clipPath id=\"map\"><rect width=\"{:.0f}\" height=\"{:.0f}\"/></clipPath>\n", width_px, height_px);
  text += "<g clip-path=\"url(#map)\">\n" + PanelOf("before: boat.txtpb", 0.0, view, cells_before, way_m) + "</g>\n";
  text += PanelOf("after: the mounting that was found", width_px + kGapPx, view, cells_after, way_m);
  return text + "</svg>\n";
}

}  // namespace lookout::calibrate
