#include "services/vlp16/core/bundler.hpp"

#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "services/vlp16/core/data_packet.hpp"
#include "services/vlp16/core/foreign_sensor.hpp"

namespace lookout::vlp16 {

Bundler::Bundler(int data_port, int position_port, double cut_azimuth_rad)
    : data_port_(data_port),
      position_port_(position_port),
      cut_cdeg_(static_cast<int>(std::llround(RadToDeg(WrapTo2Pi(cut_azimuth_rad)) * 100.0) % format::kAzimuthsPerRevolution)) {}

std::optional<PacketBundle> Bundler::Add(Utime host_time, int udp_port, Bytes payload) {
  const auto refuse = [](std::int64_t& count) {
    ++count;
    return std::nullopt;
  };
  const bool is_data = udp_port == data_port_;
  if (!is_data && udp_port != position_port_) return refuse(num_other_port_);
  if (is_data && payload.size() != format::kDataPacketSizeBytes) {
    foreign_sensor_ = NameOfForeignPayload(payload);
    return refuse(num_data_wrong_size_);
  }
  if (!is_data && payload.size() != format::kPositionPacketSizeBytes) return refuse(num_position_wrong_size_);
  if (!UtimeFromWire(ToUtimeUs(host_time))) return refuse(num_bad_host_time_);
  if (bundle_.items.empty()) bundle_.time = host_time;
  bundle_.items.push_back({host_time, udp_port, bundle_.payload.size(), payload.size()});
  bundle_.payload.insert(bundle_.payload.end(), payload.begin(), payload.end());
  const bool ends_scan = is_data && EndsScan(payload);
  if (!ends_scan && bundle_.items.size() < kMaxItems) return std::nullopt;
  return Close();
}

std::optional<PacketBundle> Bundler::AdvanceTo(Utime host_time) {
  if (bundle_.items.empty() || host_time - bundle_.time < kMaxWait) return std::nullopt;
  return Close();
}

std::optional<PacketBundle> Bundler::Finish(Utime host_time) {
  if (bundle_.items.empty() && next_seq_ == 0) return std::nullopt;
  if (bundle_.items.empty()) bundle_.time = host_time;
  bundle_.is_end = true;
  PacketBundle bundle = Close();
  next_seq_ = 0;
  last_azimuth_cdeg_.reset();
  return bundle;
}

PacketBundle Bundler::Close() {
  bundle_.seq = next_seq_++;
  bundle_.is_start = bundle_.seq == 0;
  return std::exchange(bundle_, PacketBundle{});
}

// Only when to send depends on this, not what: azimuths are taken as they stand.
bool Bundler::EndsScan(Bytes payload) {
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

std::vector<Counter> Bundler::counters() const {
  return {{"datagrams_other_port", num_other_port_},
          {"data_wrong_size", num_data_wrong_size_},
          {"position_wrong_size", num_position_wrong_size_},
          {"datagrams_bad_host_time", num_bad_host_time_}};
}

}  // namespace lookout::vlp16
