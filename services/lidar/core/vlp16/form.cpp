#include "services/lidar/core/vlp16/form.hpp"

#include <cmath>
#include <optional>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/data_packet.hpp"

namespace lookout::vlp16 {

namespace {

// Only when to send depends on this, not what: azimuths are taken as they stand, and what a run left behind only closes a bundle early.
class CutWatch {
 public:
  explicit CutWatch(int cut_cdeg) : cut_cdeg_(cut_cdeg) {}

  bool EndsScan(Bytes payload) {
    bool ends_scan = false;
    for (std::size_t block = 0; block < format::kNumBlocks; ++block) {
      const int azimuth_cdeg =
          ReadU16LittleEndian(payload, block * format::kBlockSizeBytes + format::kBlockAzimuthOffset) % format::kAzimuthsPerRevolution;
      if (last_azimuth_cdeg_) {
        const int to_cut_cdeg = ClockwiseCdeg(*last_azimuth_cdeg_, cut_cdeg_);
        const int sweep_cdeg = ClockwiseCdeg(*last_azimuth_cdeg_, azimuth_cdeg);
        if (sweep_cdeg > format::kAzimuthsPerRevolution - kMaxGapCdeg) continue;  // noise of the encoder goes back a little
        ends_scan = ends_scan || (to_cut_cdeg > 0 && to_cut_cdeg <= sweep_cdeg);
      }
      last_azimuth_cdeg_ = azimuth_cdeg;
    }
    return ends_scan;
  }

 private:
  int cut_cdeg_;
  std::optional<int> last_azimuth_cdeg_;
};

}  // namespace

lidar::Bundler::Form FormOf(double cut_azimuth_rad) {
  const auto cut_cdeg = static_cast<int>(std::llround(RadToDeg(WrapTo2Pi(cut_azimuth_rad)) * 100.0) % format::kAzimuthsPerRevolution);
  lidar::Bundler::Form form;
  form.is_data_size = [](std::size_t size_bytes) { return size_bytes == format::kDataPacketSizeBytes; };
  form.is_position_size = [](std::size_t size_bytes) { return size_bytes == format::kPositionPacketSizeBytes; };
  form.ends_scan = [watch = CutWatch(cut_cdeg)](Bytes payload) mutable { return watch.EndsScan(payload); };
  return form;
}

}  // namespace lookout::vlp16
