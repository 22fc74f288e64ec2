#include "tools/calibrate/report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/core/angles.hpp"
#include "tools/calibrate/boat_file.hpp"

namespace lookout::calibrate {

namespace {

std::string AngleRow(const char* name, const Found& found, double was_rad) {
  if (!found.is_found)
    return fmt::format("  {:<6} not found, deviation {:.2f} deg; boat.txtpb says {:.2f} deg\n", name, RadToDeg(found.sd), RadToDeg(was_rad));
  return fmt::format("  {:<6} {:8.2f} deg, deviation {:.2f}; boat.txtpb says {:.2f} deg\n", name, RadToDeg(found.value), RadToDeg(found.sd),
                     RadToDeg(was_rad));
}

// Advice about a latency; empty where the latency may be 0.
std::string LatencyAdvice(const char* what, const Found& found) {
  constexpr double kWorthMentioningS = 0.003;
  if (!found.is_found || std::abs(found.value) < std::max(kWorthMentioningS, 2.0 * found.sd)) return "";
  if (found.value > 0.0)
    return fmt::format("         {} comes too late against the lidar: latency_s of its input in navigator.txtpb is too small\n", what);
  return fmt::format(
      "         {} comes too early against the lidar: latency_s of its input in navigator.txtpb is too large, or the lidar's clock is ahead\n", what);
}

std::string LatencyRow(const char* name, const char* what, const Found& found) {
  if (!found.is_found) return fmt::format("  latency of {}: not found, deviation {:.0f} ms\n", name, 1e3 * found.sd);
  return fmt::format("  latency of {}: {:.1f} ms, deviation {:.1f}\n", name, 1e3 * found.value, 1e3 * found.sd) + LatencyAdvice(what, found);
}

std::string HeightRow(const Calibration& calibration, const config::BoatFacts& boat) {
  const double said_m = boat.T_vessel_lidar.translation().z() + boat.reference_point_above_water_m;
  if (!calibration.height) {
    return "  height  not found: too few upright faces whose feet are seen (quay, walls, hulls); boat.txtpb says " +
           fmt::format("{:.2f} m\n", said_m);
  }
  const auto& height = *calibration.height;
  std::string text = fmt::format(
      "  height  {:.2f} m of the lidar above the water, deviation {:.2f}; boat.txtpb says {:.2f} m (z_m + reference_point_above_water_m)\n",
      height.lidar_above_water_m, height.sd_m, said_m);
  return text;
}

std::string DoneText(const Manoeuvres& done) {
  return fmt::format("recorded: {:.0f} s, way {:.0f} m, turned by {:.0f} deg, what stands is in sight in {:.0f} % of the scans\n", done.seconds,
                     done.way_m, RadToDeg(done.turned_rad), 100.0 * done.share_in_sight);
}

}  // namespace

std::string ReportOf(const Calibration& calibration, const config::BoatFacts& boat) {
  std::string text;
  if (calibration.manoeuvres.seconds > 0.0) text += DoneText(calibration.manoeuvres);
  if (!calibration.turned_in_words.empty()) text += "the lidar is not mounted as boat.txtpb says: " + calibration.turned_in_words + "\n";
  if (calibration.has_fit) {
    text += fmt::format("mounting, by {} pairs of scans:\n", calibration.num_pairs);
    text += AngleRow("roll", calibration.roll, boat.lidar.roll_rad);
    text += AngleRow("pitch", calibration.pitch, boat.lidar.pitch_rad);
    text += AngleRow("yaw", calibration.yaw, boat.lidar.yaw_rad);
    text += LatencyRow("heading", "heading", calibration.latency);
    text += LatencyRow("roll and pitch", "attitude", calibration.tilt_latency);
    if (calibration.latency_by_turning_s)
      text += fmt::format("  by the rate of turn alone the latency of heading is {:.0f} ms\n", 1e3 * *calibration.latency_by_turning_s);
    text += HeightRow(calibration, boat);
    text += fmt::format("pairs of scans disagree by {:.2f} m and {:.2f} deg with boat.txtpb, by {:.2f} m and {:.2f} deg with the result\n",
                        calibration.before_m, RadToDeg(calibration.before_rad), calibration.after_m, RadToDeg(calibration.after_rad));
  }
  for (const auto& motion : calibration.missing) text += "missing: " + motion + "\n";
  if (calibration.IsRefused()) return text + "refused: " + calibration.refusal + "\n";
  const auto& place_m = calibration.boat_place_m;
  text += "for boat.txtpb:\n";
  text += fmt::format("lidar {{ x_m: {:g} y_m: {:g} z_m: {:g} {} }}\n", place_m.x(), place_m.y(), place_m.z(), AngleLines(calibration.angles));
  return text;
}

std::string FiguresOf(const Calibration& calibration) {
  if (!calibration.has_fit) return "";
  const auto angle = [](const char* name, const Found& found) {
    return fmt::format("{} {:.4f} {:.4f}\n", name, RadToDeg(found.value), RadToDeg(found.sd));
  };
  std::string text = angle("roll_deg", calibration.roll) + angle("pitch_deg", calibration.pitch) + angle("yaw_deg", calibration.yaw);
  text += fmt::format("latency_ms {:.3f} {:.3f}\n", 1e3 * calibration.latency.value, 1e3 * calibration.latency.sd);
  text += fmt::format("tilt_latency_ms {:.3f} {:.3f}\n", 1e3 * calibration.tilt_latency.value, 1e3 * calibration.tilt_latency.sd);
  if (calibration.height) text += fmt::format("height_m {:.4f} {:.4f}\n", calibration.height->lidar_above_water_m, calibration.height->sd_m);
  return text;
}

namespace {

void AppendTransform(const Eigen::Isometry3d& T, std::string& row) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 4; ++k) row += fmt::format(",{:.9g}", T.matrix()(i, k));
  }
}

}  // namespace

std::string PairsCsv(const Calibration& calibration, const PoseTrack& track) {
  const auto numbers = calibration.motions_correction.ToNumbers();
  std::string text = "# found";
  for (int i = 0; i < Correction::kNumNumbers; ++i) text += fmt::format(" {:.9g}", numbers[i]);
  const auto& place_m = calibration.boat_place_m;
  text += fmt::format("\n# lidar {:.9g} {:.9g} {:.9g}\nbegin_utime_us,end_utime_us", place_m.x(), place_m.y(), place_m.z());
  const auto add_names = [&text](const char* name, int rows, int columns) {
    for (int i = 0; i < rows; ++i) {
      for (int k = 0; k < columns; ++k) text += fmt::format(",{}_{}{}", name, i, k);
    }
  };
  constexpr int kLatencies = 3;
  add_names("lidar", 3, 4);
  add_names("weight", 6, 6);
  for (int i = 0; i < kLatencies; ++i) {
    add_names(fmt::format("begin{}", i).c_str(), 3, 4);
    add_names(fmt::format("end{}", i).c_str(), 3, 4);
  }
  text += "\n";
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  if (!track.empty()) origin.translation() = -track.poses().front().T_map_vessel.translation();
  for (std::size_t number = 0; number < calibration.weights.size(); ++number) {
    const auto& motion = calibration.motions[number];
    std::string row = fmt::format("{},{}", ToUtimeUs(motion.begin), ToUtimeUs(motion.end));
    AppendTransform(motion.T_begin_end, row);
    const auto& weight = calibration.weights[number];
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) row += fmt::format(",{:.9g}", weight(i, k));
    }
    bool is_whole = true;
    for (int i = 0; i < kLatencies; ++i) {
      Latency latency = calibration.motions_correction.latency;
      if (i == 1) latency.heading_s += kCsvLatencyStepS;
      if (i == 2) latency.tilt_s += kCsvLatencyStepS;
      const auto begin = track.At(motion.begin, latency);
      const auto end = track.At(motion.end, latency);
      is_whole = is_whole && begin && end;
      if (!is_whole) break;
      AppendTransform(origin * begin->T_map_vessel, row);
      AppendTransform(origin * end->T_map_vessel, row);
    }
    if (is_whole) text += row + "\n";
  }
  return text;
}

}  // namespace lookout::calibrate
