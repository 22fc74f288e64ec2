#include "lab/sim/truth.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lookout/sim_truth_t.hpp"

namespace lookout::sim {
namespace {

using std::chrono::microseconds;
using namespace std::chrono_literals;

constexpr microseconds kPosePeriod = 20ms;  // the grid of POSE: whole multiples
constexpr microseconds kObjectPeriod = 100ms;
constexpr std::size_t kSlotsPerPacket = std::size_t{vlp16::format::kNumBlocks} * vlp16::format::kSequencesPerBlock * vlp16::format::kNumLasers;

static_assert(static_cast<int>(ReturnReason::kFog) == sim_truth_t::REASON_FOG);
static_assert(kReasonNames.size() == static_cast<std::size_t>(ReturnReason::kFog) + 1);

template <typename... Values>
void Print(io::OutputFile& out, const char* form, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), form, values...);
  out.Write(std::string_view(text.data()));
}

// ",-12.3456". Much quicker than printf: a scan has 15 000 of them.
void AppendMetres(double value_m, std::string& text) {
  constexpr long long kUnitsPerMetre = 10'000;
  const long long units = std::llround(value_m * static_cast<double>(kUnitsPerMetre));
  text += units < 0 ? ",-" : ",";
  const std::string digits = std::to_string(kUnitsPerMetre + std::abs(units) % kUnitsPerMetre);
  text += std::to_string(std::abs(units) / kUnitsPerMetre) + "." + digits.substr(1);
}

// @param T_map_object  no bow straight up or down; angles as in POSE: heading clockwise, pitch positive bow up, roll positive starboard down
sim_object_t ToMessage(const SceneObject& scene_object, bool is_moving, const Eigen::Isometry3d& T_map_object) {
  const Eigen::Matrix3d R_map_object = T_map_object.linear();
  sim_object_t object{};
  object.id = scene_object.id;
  object.name = scene_object.name;
  object.kind = scene_object.kind;
  object.is_in_water = scene_object.is_in_water;
  object.is_moving = is_moving;
  object.east_m = T_map_object.translation().x();
  object.north_m = T_map_object.translation().y();
  object.up_m = T_map_object.translation().z();
  object.heading_rad = WrapTo2Pi(std::atan2(R_map_object(0, 0), R_map_object(1, 0)));
  object.pitch_rad = std::asin(std::clamp(R_map_object(2, 0), -1.0, 1.0));
  object.roll_rad = std::atan2(R_map_object(2, 1), R_map_object(2, 2));  // the y axis points to port: it rises as starboard goes down
  for (const auto& p_m : scene_object.outline_m) {
    const Eigen::Vector3d p_map_m = T_map_object * Eigen::Vector3d(p_m.x(), p_m.y(), 0.0);
    object.outline_east_m.push_back(p_map_m.x());
    object.outline_north_m.push_back(p_map_m.y());
  }
  object.num_outline = static_cast<std::int32_t>(object.outline_east_m.size());
  return object;
}

}  // namespace

TruthWriter::Folder::Folder(const std::filesystem::path& path) {
  if (std::filesystem::create_directories(path)) made = path;
}

TruthWriter::Folder::~Folder() {
  std::error_code ignored;
  if (!made.empty()) std::filesystem::remove(made, ignored);  // a folder that holds files stays
}

TruthWriter::TruthWriter(const std::filesystem::path& folder, const Scene& scene, const config::BoatFacts& boat, Utime start,
                         const io::OutputOptions& options)
    : folder_(folder),
      scene_(scene),
      reference_point_above_water_m_(boat.reference_point_above_water_m),
      own_vessel_{kOwnVessel,
                  "own_vessel",
                  "own_vessel",
                  Track{},
                  {},
                  Rectangle(boat.own_vessel_box_m.min().x(), boat.own_vessel_box_m.max().x(), boat.own_vessel_box_m.min().y(),
                            boat.own_vessel_box_m.max().y()),
                  true},
      datum_(boat.datum.value_or(kLakeDatum)),
      map_(MapFrame(boat)),
      start_(start),
      next_pose_(std::chrono::ceil<std::chrono::milliseconds>(start)),
      next_objects_(start),
      log_file_(folder / "truth.lcmlog", options),
      log_([this](Bytes bytes) { log_file_.Write(bytes); }),
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
  objects_.stream() << kOwnVessel << ",own_vessel,own_vessel,1,1\n" << kNoObject << ",none,none,0,0\n";
  for (const auto& object : scene_.objects) {
    objects_.stream() << object.id << ',' << object.name << ',' << object.kind << ',' << (object.track.is_moving() ? 1 : 0) << ','
                      << (object.is_in_water ? 1 : 0) << '\n';
    if (!object.track.is_moving()) WriteOutline(object.id, object.track.At(0.0), object.outline_m, start_);
  }
}

TruthWriter::LatitudeLongitude TruthWriter::OnEarth(const Eigen::Vector3d& p_map_m) const {
  LatitudeLongitude place;
  double height_m = 0.0;
  map_.Reverse(p_map_m.x(), p_map_m.y(), p_map_m.z(), place.latitude_deg, place.longitude_deg, height_m);
  return place;
}

void TruthWriter::WriteOutline(int object_id, const Placement& placement, const std::vector<Eigen::Vector2d>& outline_m, Utime time) {
  int vertex_index = 0;
  for (const auto& p_object_m : outline_m) {
    const Eigen::Vector2d p_map_m = placement.ToMap(p_object_m);
    const auto place = OnEarth({p_map_m.x(), p_map_m.y(), 0.0});
    Print(outlines_, "%d,%lld,%d,%.9f,%.9f,%.4f,%.4f\n", object_id, static_cast<long long>(ToUtimeUs(time)), vertex_index++, place.latitude_deg,
          place.longitude_deg, p_map_m.x(), p_map_m.y());
  }
}

void TruthWriter::WriteObjects(Utime time) {
  const double time_s = ToSeconds(time - start_);
  sim_truth_t message{};
  message.utime_us = ToUtimeUs(time);
  const OwnState own_state = StateAt(scene_.own_motion, reference_point_above_water_m_, time_s);
  WriteOutline(kOwnVessel, {own_state.position_map_m.head<2>(), own_state.heading_rad}, own_vessel_.outline_m, time);
  message.objects.push_back(ToMessage(own_vessel_, true, own_state.T_map_vessel()));
  for (const auto& object : scene_.objects) {
    if (object.track.is_moving()) WriteOutline(object.id, object.track.At(time_s), object.outline_m, time);
    message.objects.push_back(ToMessage(object, object.track.is_moving(), PoseAt(object, scene_.sea, time_s)));
  }
  for (const auto& object : message.objects) {
    const auto place = OnEarth({object.east_m, object.north_m, object.up_m});
    Print(object_poses_, "%d,%lld,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", static_cast<int>(object.id), static_cast<long long>(message.utime_us),
          place.latitude_deg, place.longitude_deg, object.east_m, object.north_m, object.up_m, RadToDeg(object.heading_rad),
          RadToDeg(object.roll_rad), RadToDeg(object.pitch_rad));
  }
  message.num_objects = static_cast<std::int32_t>(message.objects.size());
  WriteMessage(message);
}

void TruthWriter::WritePose(Utime time) {
  const auto state = StateAt(scene_.own_motion, reference_point_above_water_m_, ToSeconds(time - start_));
  const auto place = OnEarth(state.position_map_m);
  Print(pose_, "%lld,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", static_cast<long long>(ToUtimeUs(time)), place.latitude_deg, place.longitude_deg,
        RadToDeg(state.heading_rad), RadToDeg(state.roll_rad), RadToDeg(state.pitch_rad), state.velocity_map_mps.norm(),
        RadToDeg(WrapTo2Pi(std::atan2(state.velocity_map_mps.x(), state.velocity_map_mps.y()))), state.heave_m);
}

void TruthWriter::AddPacket(const LidarPacket& packet) {
  AddReturns(packet.returns);
  packets_.push_back(packet);
  if (packets_.size() == kPacketsPerMessage) WritePackets();
}

void TruthWriter::AddReturns(std::span<const TrueReturn> returns) {
  constexpr std::size_t kCharactersPerRow = 70;
  std::string text;
  text.reserve(returns.size() * kCharactersPerRow);
  std::array<char, 24> digits{};
  const auto append = [&](std::int64_t value) {
    const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text.append(digits.data(), result.ptr);
    text.push_back(',');
  };
  for (const auto& made : returns) {
    append(ToUtimeUs(made.time));
    append(made.ring);
    append(made.return_index);
    append(made.object_id);
    text.append(NameOf(made.reason));
    for (const double coordinate_m : made.p_lidar_m) AppendMetres(coordinate_m, text);
    text.push_back('\n');
  }
  returns_.Write(text);
}

void TruthWriter::WritePackets() {
  if (packets_.empty()) return;
  sim_truth_t message{};
  message.utime_us = ToUtimeUs(packets_.front().stamp);
  message.first_packet = num_packets_;
  message.object_id.assign(packets_.size() * kSlotsPerPacket, kNoObject);
  message.reason.assign(packets_.size() * kSlotsPerPacket, sim_truth_t::REASON_NONE);
  for (std::size_t i = 0; i < packets_.size(); ++i) {
    message.packet_utime_us.push_back(ToUtimeUs(packets_[i].stamp));
    for (const auto& made : packets_[i].returns) {
      const std::size_t slot = i * kSlotsPerPacket + static_cast<std::size_t>(made.slot);
      message.object_id[slot] = static_cast<std::int16_t>(made.object_id);
      message.reason[slot] = static_cast<std::uint8_t>(made.reason);
    }
  }
  message.num_packets = static_cast<std::int32_t>(message.packet_utime_us.size());
  message.num_slots = static_cast<std::int32_t>(message.object_id.size());
  WriteMessage(message);
  num_packets_ += message.num_packets;
  packets_.clear();
}

void TruthWriter::WriteMessage(sim_truth_t& message) {
  message.seq = seq_++;
  message.datum_latitude_deg = datum_.latitude_deg;
  message.datum_longitude_deg = datum_.longitude_deg;
  message.datum_ellipsoid_height_m = datum_.ellipsoid_height_m;
  log_.Write(Utime(microseconds(message.utime_us)), bus::kSimTruth.name, bus::Encode(message));
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
  for (; next_pose_ <= time; next_pose_ += kPosePeriod) WritePose(next_pose_);
  // One beyond the end, so that each return lies between two.
  for (; next_objects_ < time + kObjectPeriod; next_objects_ += kObjectPeriod) WriteObjects(next_objects_);
}

std::vector<io::OutputFile*> TruthWriter::Finish() {
  WritePackets();
  log_.Flush();
  return {&log_file_, &objects_, &object_poses_, &outlines_, &returns_, &pose_, &faults_};
}

}  // namespace lookout::sim
