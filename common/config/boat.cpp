#include "common/config/boat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/boat.pb.h"

namespace lookout::config {

namespace {

constexpr double kBoxMarginM = 1.0;    // of fenders, an outboard engine, a bowsprit
constexpr double kOutsideHullM = 2.0;  // of a stern arch or a boom

std::string Metres(double length_m, int num_decimals = 1) {
  return fmt::format("{:.{}f} m", length_m == 0.0 ? 0.0 : length_m, num_decimals);  // no "-0.0"
}

// "1.4 m ahead", "0.5 m astern": of a place along x.
std::string Along(double x_m, int num_decimals) { return Metres(std::abs(x_m), num_decimals) + (x_m < 0.0 ? " astern" : " ahead"); }
std::string Across(double y_m, int num_decimals) { return Metres(std::abs(y_m), num_decimals) + (y_m < 0.0 ? " to starboard" : " to port"); }
std::string AboveWater(double z_m, int num_decimals = 1) {
  return Metres(std::abs(z_m), num_decimals) + (z_m < 0.0 ? " below" : " above") + " the water";
}

BoatRemark OwnBox(const BoatFacts& boat) {
  const auto& box = boat.own_vessel_box_m;
  const double water_m = boat.reference_point_above_water_m;
  // A box that does not hold the reference point begins on the same side.
  const auto side = [](double near_m, double far_m, auto in_words) {
    return near_m * far_m < 0.0 || near_m == 0.0 || far_m == 0.0 ? "up to " + in_words(far_m, 1) + " and " + in_words(near_m, 1)
                                                                 : "from " + in_words(near_m, 1) + " to " + in_words(far_m, 1);
  };
  BoatRemark remark;
  remark.words = "returns " + side(box.min().x(), box.max().x(), Along) + ", " + side(box.min().y(), box.max().y(), Across) +
                 " of the reference point, from " + AboveWater(box.min().z() + water_m) + " to " + AboveWater(box.max().z() + water_m) +
                 ", are own boat";
  if (!boat.hull_m) return remark;
  const double length_m = boat.hull_m->length_m;
  const double beam_m = boat.hull_m->beam_m;
  // The reference point lies on the hull, so no part of the hull is farther from it than the hull is long.
  const bool is_too_long = box.sizes().x() > length_m + kBoxMarginM || std::max(-box.min().x(), box.max().x()) > length_m + kBoxMarginM;
  const bool is_too_wide = box.sizes().y() > beam_m + kBoxMarginM || std::max(-box.min().y(), box.max().y()) > beam_m + kBoxMarginM;
  if (is_too_long || is_too_wide) {
    remark.words += "; that box is " + Metres(box.sizes().x()) + " x " + Metres(box.sizes().y()) + ", the hull " + Metres(length_m) + " x " +
                    Metres(beam_m) + ": obstacles beside the hull would count as own boat";
    remark.cure = "own_vessel in boat.txtpb should hold hull, mast and gear and no more; or hull_length_m and hull_beam_m are wrong";
  }
  return remark;
}

// How far a place lies outside of the known hull, seen from above.
double OutsideHullM(const BoatFacts& boat, const Eigen::Vector3d& p_vessel_m) {
  if (boat.hull_m) return std::max(std::abs(p_vessel_m.x()) - boat.hull_m->length_m, std::abs(p_vessel_m.y()) - boat.hull_m->beam_m);
  Eigen::Vector3d beside_m = p_vessel_m;
  beside_m.z() = boat.own_vessel_box_m.center().z();
  return boat.own_vessel_box_m.exteriorDistance(beside_m);
}

BoatRemark Place(const BoatFacts& boat, const std::string& what, const std::string& field, const Eigen::Vector3d& p_vessel_m) {
  const double above_water_m = p_vessel_m.z() + boat.reference_point_above_water_m;
  BoatRemark remark;
  remark.words = fmt::format("the {} is {} and {} of the reference point, {}", what, Along(p_vessel_m.x(), 2), Across(p_vessel_m.y(), 2),
                             AboveWater(above_water_m, 2));
  remark.is_under_water = above_water_m <= 0.0;
  if (remark.is_under_water) {
    remark.cure = "the sign of " + field + ".z_m (up is positive) and reference_point_above_water_m in boat.txtpb";
  } else if (OutsideHullM(boat, p_vessel_m) > kOutsideHullM) {
    remark.words += "; that is more than " + Metres(kOutsideHullM) + " outside of " +
                    (boat.hull_m ? "a hull of " + Metres(boat.hull_m->length_m) + " x " + Metres(boat.hull_m->beam_m) : "own_vessel");
    remark.cure = "the place of the " + what + ": " + field + " in boat.txtpb, in metres from the reference point, x forward and y to port";
  }
  return remark;
}

}  // namespace

namespace {

lookout::Mounting ToMounting(const Mounting& message) {
  lookout::Mounting mounting;
  mounting.p_vessel_m = {message.x_m(), message.y_m(), message.z_m()};
  mounting.roll_rad = DegToRad(message.roll_deg());
  mounting.pitch_rad = DegToRad(message.pitch_deg());
  mounting.yaw_rad = DegToRad(message.yaw_deg());
  return mounting;
}

}  // namespace

BoatFacts LoadBoat(const std::filesystem::path& folder) { return ToFacts(Load<Boat>(folder, "boat.txtpb"), folder / "boat.txtpb"); }

BoatFacts ToFacts(const Boat& boat, const std::filesystem::path& file) {
  const auto& box = boat.own_vessel();
  FaultList faults;
  if (box.min_x_m() >= box.max_x_m()) faults.Add(FaultLine(file, "own_vessel.min_x_m", "must be less than max_x_m"));
  if (box.min_y_m() >= box.max_y_m()) faults.Add(FaultLine(file, "own_vessel.min_y_m", "must be less than max_y_m"));
  if (box.min_z_m() >= box.max_z_m()) faults.Add(FaultLine(file, "own_vessel.min_z_m", "must be less than max_z_m"));
  if (boat.has_hull_length_m() != boat.has_hull_beam_m()) {
    faults.Add(FaultLine(file, boat.has_hull_length_m() ? "hull_beam_m" : "hull_length_m", "must be set where the other of the two is"));
  }
  faults.ThrowIfAny();

  BoatFacts facts;
  facts.name = boat.name();
  facts.lidar = ToMounting(boat.lidar());
  if (boat.has_lidar_2()) facts.lidar_2 = ToMounting(boat.lidar_2());
  facts.T_vessel_lidar = TransformVesselSensor(facts.lidar);
  facts.p_vessel_antenna_m = {boat.gnss_antenna().x_m(), boat.gnss_antenna().y_m(), boat.gnss_antenna().z_m()};
  if (boat.has_imu()) facts.p_vessel_imu_m = {boat.imu().x_m(), boat.imu().y_m(), boat.imu().z_m()};
  facts.reference_point_above_water_m = boat.reference_point_above_water_m();
  facts.own_vessel_box_m = {Eigen::Vector3d(box.min_x_m(), box.min_y_m(), box.min_z_m()),
                            Eigen::Vector3d(box.max_x_m(), box.max_y_m(), box.max_z_m())};
  if (boat.has_hull_length_m()) facts.hull_m = HullSize{boat.hull_length_m(), boat.hull_beam_m()};
  if (boat.has_datum()) {
    facts.datum = GeodeticPlace{boat.datum().latitude_deg(), boat.datum().longitude_deg(), boat.datum().ellipsoid_height_m()};
  }
  return facts;
}

std::vector<BoatRemark> RemarksOnBoat(const BoatFacts& boat) {
  std::vector<BoatRemark> remarks{OwnBox(boat), Place(boat, "lidar", "lidar", boat.T_vessel_lidar.translation()),
                                  Place(boat, "GNSS antenna", "gnss_antenna", boat.p_vessel_antenna_m)};
  if (!boat.hull_m) {
    remarks.push_back({"the size of the hull is not set: whether own_vessel is too large cannot be checked",
                       "hull_length_m and hull_beam_m in boat.txtpb (metres over all)"});
  }
  return remarks;
}

std::string RemarksAsComments(const BoatFacts& boat) {
  std::string text;
  for (const auto& remark : RemarksOnBoat(boat)) {
    text += "# boat.txtpb: " + std::string(remark.cure.empty() ? "" : "warning: ") + remark.words +
            (remark.cure.empty() ? "" : "; look at " + remark.cure) + "\n";
  }
  return text;
}

}  // namespace lookout::config
