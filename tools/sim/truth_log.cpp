#include "tools/sim/truth_log.hpp"

#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/sim_truth_t.hpp"
#include "tools/sim/map_frame.hpp"

namespace lookout::sim {
namespace {

constexpr std::size_t kSlotsPerPacket = std::size_t{vlp16::format::kNumBlocks} * vlp16::format::kSequencesPerBlock * vlp16::format::kNumLasers;

static_assert(static_cast<int>(ReturnReason::kMirror) == sim_truth_t::REASON_MIRROR);
static_assert(kReasonNames.size() == static_cast<std::size_t>(ReturnReason::kMirror) + 1);

void SetPose(const Eigen::Isometry3d& T_map_object, sim_object_t& object) {
  const Attitude attitude = AttitudeOf(T_map_object.linear());
  object.east_m = T_map_object.translation().x();
  object.north_m = T_map_object.translation().y();
  object.up_m = T_map_object.translation().z();
  object.heading_rad = attitude.heading_rad;
  object.pitch_rad = attitude.pitch_rad;
  object.roll_rad = attitude.roll_rad;
}

void SetOutline(const Eigen::Isometry3d& T_map_object, const std::vector<Eigen::Vector2d>& outline_m, sim_object_t& object) {
  for (const auto& p_m : outline_m) {
    const Eigen::Vector3d p_map_m = T_map_object * Eigen::Vector3d(p_m.x(), p_m.y(), 0.0);
    object.outline_east_m.push_back(p_map_m.x());
    object.outline_north_m.push_back(p_map_m.y());
  }
  object.num_outline = static_cast<std::int32_t>(outline_m.size());
}

}  // namespace

TruthLog::TruthLog(const std::filesystem::path& file, const Scene& scene, const config::BoatFacts& boat, Utime start, io::OutputOptions options)
    : scene_(scene), boat_(boat), start_(start), next_objects_(start), file_(file, std::move(options)), log_([this](Bytes bytes) {
        file_.Write(bytes);
      }) {}

void TruthLog::Write(sim_truth_t& message) {
  const auto datum = boat_.datum.value_or(kLakeDatum);
  message.seq = seq_++;
  message.datum_latitude_deg = datum.latitude_deg;
  message.datum_longitude_deg = datum.longitude_deg;
  message.datum_ellipsoid_height_m = datum.ellipsoid_height_m;
  log_.Write(Utime(std::chrono::microseconds(message.utime_us)), bus::kSimTruth.name, bus::Encode(message));
}

void TruthLog::AddPacket(const LidarPacket& packet) {
  packets_.push_back({packet.stamp, packet.returns});
  if (packets_.size() == kPacketsPerMessage) WritePackets();
}

void TruthLog::WritePackets() {
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
  Write(message);
  num_packets_ += message.num_packets;
  packets_.clear();
}

void TruthLog::WriteObjects(Utime time) {
  const double time_s = ToSeconds(time - start_);
  sim_truth_t message{};
  message.utime_us = ToUtimeUs(time);
  sim_object_t own{};
  own.id = kOwnVessel;
  own.name = own.kind = "own_vessel";
  own.is_in_water = own.is_moving = true;
  const Eigen::Isometry3d T_map_vessel = StateAt(scene_.own_motion, boat_.reference_point_above_water_m, time_s).T_map_vessel();
  SetPose(T_map_vessel, own);
  const auto& box_m = boat_.own_vessel_box_m;
  SetOutline(T_map_vessel, Rectangle(box_m.min().x(), box_m.max().x(), box_m.min().y(), box_m.max().y()), own);
  message.objects.push_back(own);
  for (const auto& object : scene_.objects) {
    sim_object_t told{};
    told.id = object.id;
    told.name = object.name;
    told.kind = object.kind;
    told.is_in_water = object.is_in_water;
    told.is_moving = object.track.is_moving();
    const Eigen::Isometry3d T_map_object = PoseAt(object, scene_.sea, time_s);
    SetPose(T_map_object, told);
    SetOutline(T_map_object, object.outline_m, told);
    message.objects.push_back(told);
  }
  message.num_objects = static_cast<std::int32_t>(message.objects.size());
  Write(message);
}

void TruthLog::AdvanceTo(Utime time) {
  // One beyond the end, so that each return lies between two.
  for (; next_objects_ < time + kObjectPeriod; next_objects_ += kObjectPeriod) WriteObjects(next_objects_);
}

io::OutputFile& TruthLog::Finish() {
  WritePackets();
  log_.Flush();
  return file_;
}

}  // namespace lookout::sim
