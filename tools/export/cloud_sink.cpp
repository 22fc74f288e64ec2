#include <deque>
#include <stdexcept>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/messages/pose_message.hpp"
#include "common/messages/returns.hpp"
#include "tools/export/boat_of_log.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

class CloudSink final : public Sink {
 public:
  CloudSink(std::unique_ptr<CloudWriter> writer, CloudFrame frame, std::optional<std::int64_t> seq, bool is_of_one_scan)
      : writer_(std::move(writer)),
        frame_(frame),
        is_of_one_scan_(is_of_one_scan),
        chosen_(ChosenScan::Of::kReturns, seq),
        collector_(MakeCollector(IsLabelled, [this](const ScanMessages& scan) {
          if (!scan.scans.empty()) waiting_.push_back(scan);
        })) {}

  std::vector<bus::Channel> Channels() const override {
    std::vector<bus::Channel> channels{bus::kLidarScan, bus::kSegments};
    if (frame_ != CloudFrame::kLidar) channels.push_back(bus::kRunInfo);
    if (frame_ == CloudFrame::kEarth) channels.push_back(bus::kPose);
    return channels;
  }
  // A scan at the edge of the part is placed by poses beside it.
  bool IsWantedAtAnyTime(std::string_view channel) const override { return channel == bus::kRunInfo.name || channel == bus::kPose.name; }

  Taken Take(std::string_view channel, Bytes bytes, std::string& text) override {
    if (channel == bus::kRunInfo.name) return TakeRunInfo(bytes, boat_);
    auto taken = Taken::kOk;
    if (channel == bus::kPose.name) {
      taken = TakePose(bytes);
    } else {
      taken = is_of_one_scan_ ? chosen_.Take(channel, bytes) : AddTo(collector_, channel, bytes);
    }
    while (!waiting_.empty() && (IsPlaceable(waiting_.front()) || waiting_.size() > kMostWaiting)) WriteFirst(text);
    return taken;
  }

  bool IsDone() const override { return is_of_one_scan_ && chosen_.IsDone() && IsPlaceable(*chosen_.chosen()); }

  void Finish(std::string& text) override {
    if (is_of_one_scan_) {
      chosen_.Finish();
      if (!chosen_.chosen()) return;
      std::string points;
      Write(*chosen_.chosen(), points);
      text += writer_->Head() + points;
    } else {
      collector_.Finish();
      while (!waiting_.empty()) WriteFirst(text);
    }
    if (frame_ == CloudFrame::kEarth && writer_->num_points() == 0)
      throw std::runtime_error("no return has a place on the earth: the log holds no POSE that knows it at the time of the scan");
  }

  std::string Head() const override { return is_of_one_scan_ ? std::string() : writer_->Head(); }

  std::vector<std::string> Remarks() const override {
    std::vector<std::string> remarks;
    if (num_unplaced_ > 0) remarks.push_back(std::to_string(num_unplaced_) + " returns have no place on the earth, and are left out");
    if (num_too_far_ > 0)
      remarks.push_back(std::to_string(num_too_far_) + " returns are farther from the first one than the file can tell, and are left out");
    return remarks;
  }

 private:
  static constexpr std::size_t kMostWaiting = 32;

  Taken TakePose(Bytes bytes) {
    const auto message = bus::Decode<pose_t>(bytes);
    if (!message) return Taken::kUndecodable;
    const auto checked = messages::ToPose(*message);
    const auto* const pose = std::get_if<Pose>(&checked);
    if (pose == nullptr) return Taken::kInconsistent;
    if (poses_.newest() != nullptr && pose->time <= poses_.newest()->time) poses_.Clear();
    poses_.Add(*pose);
    return Taken::kOk;
  }

  // Whether no later pose places it better.
  bool IsPlaceable(const ScanMessages& scan) const {
    if (frame_ != CloudFrame::kEarth) return true;
    constexpr std::chrono::milliseconds kLongestScan{300};
    return poses_.newest() != nullptr && poses_.newest()->time > Utime(std::chrono::microseconds(scan.utime_us)) + kLongestScan;
  }

  void WriteFirst(std::string& text) {
    if (!has_begun_) {
      has_begun_ = true;
      text += writer_->Head();  // the final Head() replaces it at the end
    }
    Write(waiting_.front(), text);
    waiting_.pop_front();
  }

  void Write(const ScanMessages& scan, std::string& text) {
    if (frame_ != CloudFrame::kLidar && !boat_)
      throw std::runtime_error("the log says nothing of the mounting of the lidar: RUN_INFO with boat.txtpb does not stand before its scans");
    if (frame_ == CloudFrame::kEarth) {
      const auto datum = poses_.DatumAt(Utime(std::chrono::microseconds(scan.utime_us)));
      // A map frame has one datum; degrees need none.
      const bool is_other = !datum_.IsSameAs(datum) && (writer_->is_geodetic() || !map_);
      if (is_other) {
        datum_ = datum;
        map_.reset();
        if (datum.IsSameAs(datum) && !datum.IsRelative()) map_.emplace(datum.Map());
      }
    }
    writer_->BeginScan(scan.seq, scan.utime_us, datum_);
    for (const auto& indexed : scan.scans) {
      const auto& part = indexed.second;
      messages::ForEachReturn(part, LabelsOf(scan, part), [&](const messages::Return& one) {
        const auto p = PlaceOf(one);
        if (!p) {
          ++num_unplaced_;
          return;
        }
        CloudPoint point{.p = *p, .reflectivity = one.reflectivity, .ring = one.ring, .return_number = one.return_index + 1};
        if (one.has_label) point.label = one.label;
        point.num_returns = part.num_returns;
        point.utime_us = one.utime_us;
        if (!writer_->Add(point, text)) ++num_too_far_;
      });
    }
  }

  std::optional<Eigen::Vector3d> PlaceOf(const messages::Return& one) {
    if (frame_ == CloudFrame::kLidar) return one.p_lidar_m;
    const Eigen::Vector3d p_vessel_m = boat_->T_vessel_lidar * one.p_lidar_m;
    if (frame_ == CloudFrame::kVessel) return p_vessel_m;
    if (!map_) return std::nullopt;
    // Some returns are of one time.
    if (one.utime_us != placed_utime_us_) {
      place_ = poses_.PlaceAt(Utime(std::chrono::microseconds(one.utime_us)), datum_);
      placed_utime_us_ = one.utime_us;
    }
    if (!place_ || !place_->is_placed) return std::nullopt;
    const Eigen::Vector3d p_map_m =
        place_->position_map_m + place_->R_map_here * (RotationMapVessel(place_->heading_rad, place_->pitch_rad, place_->roll_rad) * p_vessel_m);
    if (!writer_->is_geodetic()) return p_map_m;
    const auto place = map_->Reverse(p_map_m);
    return Eigen::Vector3d(place.longitude_deg, place.latitude_deg, place.ellipsoid_height_m);
  }

  std::unique_ptr<CloudWriter> writer_;
  CloudFrame frame_;
  bool is_of_one_scan_;
  ChosenScan chosen_;
  std::deque<ScanMessages> waiting_;
  messages::ScanCollector collector_;
  std::optional<config::BoatFacts> boat_;
  PoseHistory poses_;
  Datum datum_;
  std::optional<LocalFrame> map_;
  std::optional<std::int64_t> placed_utime_us_;
  std::optional<Place> place_;
  bool has_begun_ = false;
  std::int64_t num_unplaced_ = 0;
  std::int64_t num_too_far_ = 0;
};

}  // namespace

std::unique_ptr<Sink> MakeCloudSink(std::unique_ptr<CloudWriter> writer, CloudFrame frame, std::optional<std::int64_t> seq, bool is_of_one_scan) {
  return std::make_unique<CloudSink>(std::move(writer), frame, seq, is_of_one_scan);
}

}  // namespace lookout::exporter
