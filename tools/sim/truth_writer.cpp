#include "tools/sim/truth_writer.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "common/core/angles.hpp"
#include "tools/sim/map_frame.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
using namespace std::chrono_literals;

constexpr microseconds kPosePeriod = 20ms;  // the grid of POSE: whole multiples
constexpr microseconds kOutlinePeriod = 100ms;

template <typename... Values>
void Print(io::OutputFile& out, const char* form, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), form, values...);
  out.Write(std::string_view(text.data()));
}

// ",-12.3456". Much quicker than printf, of which a turn of the lidar would need 15 000.
void AppendMetres(double value_m, std::string& text) {
  constexpr long long kUnitsPerMetre = 10'000;
  const long long units = std::llround(value_m * static_cast<double>(kUnitsPerMetre));
  text += units < 0 ? ",-" : ",";
  const std::string digits = std::to_string(kUnitsPerMetre + std::abs(units) % kUnitsPerMetre);
  text += std::to_string(std::abs(units) / kUnitsPerMetre) + "." + digits.substr(1);
}

}  // namespace

TruthWriter::Folder::Folder(const std::filesystem::path& path) {
  if (std::filesystem::create_directories(path)) made = path;
}

TruthWriter::Folder::~Folder() {
  std::error_code ignored;
  if (!made.empty()) std::filesystem::remove(made, ignored);  // a folder with files in it stays
}

TruthWriter::TruthWriter(const std::filesystem::path& folder, const Scene& scene, const config::BoatFacts& boat, Utime start,
                         const io::OutputOptions& options)
    : folder_(folder),
      scene_(scene),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      own_outline_m_(Rectangle(boat.own_vessel_box_m.min().x(), boat.own_vessel_box_m.max().x(), boat.own_vessel_box_m.min().y(),
                               boat.own_vessel_box_m.max().y())),
      map_(MapFrame(boat)),
      start_(start),
      next_pose_(std::chrono::ceil<std::chrono::milliseconds>(start)),
      next_outline_(start),
      log_(folder / "truth.lcmlog", scene, boat, start, options),
      objects_(folder / "objects.csv", options),
      object_poses_(folder / "object_poses.csv", options),
      outlines_(folder / "outlines.csv", options),
      returns_(folder / "returns.csv", options),
      pose_(folder / "pose.csv", options),
      faults_(folder / "faults.csv", options) {
  while (next_pose_.time_since_epoch() % kPosePeriod != 0us) next_pose_ += 1ms;
  objects_.Write("object_id,name,kind,is_moving,is_in_water\n");
  object_poses_.Write("object_id,utime_us,latitude_deg,longitude_deg,east_m,north_m,up_m,heading_deg,roll_deg,pitch_deg\n");
  outlines_.Write("object_id,utime_us,vertex_index,latitude_deg,longitude_deg,east_m,north_m\n");
  returns_.Write("utime_us,ring,return_index,object_id,reason,x_m,y_m,z_m\n");
  pose_.Write("utime_us,latitude_deg,longitude_deg,heading_deg,roll_deg,pitch_deg,speed_mps,course_deg,heave_m\n");
  faults_.Write("utime_us,kind,packet_index,end_utime_us,value\n");
  WriteObjects();
}

void TruthWriter::WriteObjects() {
  objects_.stream() << kOwnVessel << ",own_vessel,own_vessel,1,1\n" << kNoObject << ",none,none,0,0\n";
  for (const auto& object : scene_.objects) {
    objects_.stream() << object.id << ',' << object.name << ',' << object.kind << ',' << (object.track.is_moving() ? 1 : 0) << ','
                      << (object.is_in_water ? 1 : 0) << '\n';
    if (!object.track.is_moving()) WriteOutline(object, start_);
  }
}

void TruthWriter::WriteOutline(const SceneObject& object, Utime time) {
  WriteOutline(object.id, object.track.At(ToSeconds(time - start_)), object.outline_m, time);
}

void TruthWriter::WriteOutline(int object_id, const Placement& placement, const std::vector<Eigen::Vector2d>& outline_m, Utime time) {
  int vertex_index = 0;
  for (const auto& p_object_m : outline_m) {
    const Eigen::Vector2d p_map_m = placement.ToMap(p_object_m);
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    map_.Reverse(p_map_m.x(), p_map_m.y(), 0.0, latitude_deg, longitude_deg, height_m);
    Print(outlines_, "%d,%lld,%d,%.9f,%.9f,%.4f,%.4f\n", object_id, static_cast<long long>(ToUtimeUs(time)), vertex_index++, latitude_deg,
          longitude_deg, p_map_m.x(), p_map_m.y());
  }
}

void TruthWriter::WriteObjectPose(int object_id, const Eigen::Isometry3d& T_map_object, Utime time) {
  const Eigen::Vector3d p_map_m = T_map_object.translation();
  const Attitude attitude = AttitudeOf(T_map_object.linear());
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  map_.Reverse(p_map_m.x(), p_map_m.y(), p_map_m.z(), latitude_deg, longitude_deg, height_m);
  Print(object_poses_, "%d,%lld,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", object_id, static_cast<long long>(ToUtimeUs(time)), latitude_deg,
        longitude_deg, p_map_m.x(), p_map_m.y(), p_map_m.z(), RadToDeg(attitude.heading_rad), RadToDeg(attitude.roll_rad),
        RadToDeg(attitude.pitch_rad));
}

void TruthWriter::WriteObjectsAt(Utime time) {
  const double time_s = ToSeconds(time - start_);
  const OwnState own = StateAt(scene_.own_motion, reference_point_above_water_m_, time_s);
  WriteObjectPose(kOwnVessel, own.T_map_vessel(), time);
  WriteOutline(kOwnVessel, {own.position_map_m.head<2>(), own.heading_rad}, own_outline_m_, time);
  for (const auto& object : scene_.objects) {
    WriteObjectPose(object.id, PoseAt(object, scene_.sea, time_s), time);
    if (object.track.is_moving()) WriteOutline(object, time);
  }
}

void TruthWriter::WritePose(Utime time) {
  const auto state = StateAt(scene_.own_motion, reference_point_above_water_m_, ToSeconds(time - start_));
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  map_.Reverse(state.position_map_m.x(), state.position_map_m.y(), state.position_map_m.z(), latitude_deg, longitude_deg, height_m);
  Print(pose_, "%lld,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", static_cast<long long>(ToUtimeUs(time)), latitude_deg, longitude_deg,
        RadToDeg(state.heading_rad), RadToDeg(state.roll_rad), RadToDeg(state.pitch_rad), state.velocity_map_mps.norm(),
        RadToDeg(WrapTo2Pi(std::atan2(state.velocity_map_mps.x(), state.velocity_map_mps.y()))), state.heave_m);
}

void TruthWriter::AddPacket(const LidarPacket& packet) {
  constexpr std::size_t kCharactersPerRow = 70;
  std::string text;
  text.reserve(packet.returns.size() * kCharactersPerRow);
  std::array<char, 24> digits{};
  const auto append = [&](std::int64_t value) {
    const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text.append(digits.data(), result.ptr);
    text.push_back(',');
  };
  for (const auto& made : packet.returns) {
    append(ToUtimeUs(made.time));
    append(made.ring);
    append(made.return_index);
    append(made.object_id);
    text.append(NameOf(made.reason));
    for (const double coordinate_m : made.p_lidar_m) AppendMetres(coordinate_m, text);
    text.push_back('\n');
  }
  returns_.Write(text);
  log_.AddPacket(packet);
}

void TruthWriter::AddFault(const Fault& fault) {
  faults_.stream() << ToUtimeUs(fault.time) << ',' << kFaultNames[static_cast<std::size_t>(fault.kind)] << ',' << fault.packet_index << ",,\n";
}

void TruthWriter::AddFault(const TimedFault& fault) {
  faults_.stream() << ToUtimeUs(start_ + fault.begin) << ',' << FormOf(fault.kind).name << ",," << ToUtimeUs(start_ + fault.end) << ',';
  if (!FormOf(fault.kind).unit.empty()) faults_.stream() << fault.value;
  faults_.Write("\n");
}

void TruthWriter::AdvanceTo(Utime time) {
  log_.AdvanceTo(time);
  for (; next_pose_ <= time; next_pose_ += kPosePeriod) WritePose(next_pose_);
  // One outline beyond the end, so that each return lies between two.
  for (; next_outline_ < time + kOutlinePeriod; next_outline_ += kOutlinePeriod) WriteObjectsAt(next_outline_);
}

std::vector<io::OutputFile*> TruthWriter::Finish() { return {&log_.Finish(), &objects_, &object_poses_, &outlines_, &returns_, &pose_, &faults_}; }

}  // namespace lookout::sim
