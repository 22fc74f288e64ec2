#include "common/config/boat.hpp"

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/boat.pb.h"

namespace lookout::config {

BoatFacts LoadBoat(const std::filesystem::path& folder) {
  const auto file = folder / "boat.txtpb";
  const auto boat = Load<Boat>(folder, "boat.txtpb");
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
  facts.lidar.p_vessel_m = {boat.lidar().x_m(), boat.lidar().y_m(), boat.lidar().z_m()};
  facts.lidar.roll_rad = DegToRad(boat.lidar().roll_deg());
  facts.lidar.pitch_rad = DegToRad(boat.lidar().pitch_deg());
  facts.lidar.yaw_rad = DegToRad(boat.lidar().yaw_deg());
  facts.T_vessel_lidar = TransformVesselSensor(facts.lidar);
  facts.p_vessel_antenna_m = {boat.gnss_antenna().x_m(), boat.gnss_antenna().y_m(), boat.gnss_antenna().z_m()};
  if (boat.has_imu()) facts.p_vessel_imu_m = {boat.imu().x_m(), boat.imu().y_m(), boat.imu().z_m()};
  facts.reference_point_above_water_m = boat.reference_point_above_water_m();
  facts.own_vessel_box_m = {Eigen::Vector3d(box.min_x_m(), box.min_y_m(), box.min_z_m()),
                            Eigen::Vector3d(box.max_x_m(), box.max_y_m(), box.max_z_m())};
  if (boat.has_hull_length_m()) facts.hull_m = HullSize{boat.hull_length_m(), boat.hull_beam_m()};
  if (boat.has_datum()) {
    facts.datum = BoatDatum{boat.datum().latitude_deg(), boat.datum().longitude_deg(), boat.datum().ellipsoid_height_m()};
  }
  return facts;
}

}  // namespace lookout::config
