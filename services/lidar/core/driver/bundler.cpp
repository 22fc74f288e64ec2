#include "services/lidar/core/driver/bundler.hpp"

#include <utility>

#include "services/lidar/core/vlp16/foreign_sensor.hpp"

namespace lookout::lidar {

Bundler::Bundler(int data_port, int position_port, Form form) : data_port_(data_port), position_port_(position_port), form_(std::move(form)) {}

std::optional<PacketBundle> Bundler::Add(Utime host_time, int udp_port, Bytes payload) {
  const auto refuse = [](std::int64_t& count) {
    ++count;
    return std::nullopt;
  };
  const bool is_data = udp_port == data_port_;
  if (!is_data && udp_port != position_port_) return refuse(num_other_port_);
  if (is_data && !form_.is_data_size(payload.size())) {
    foreign_sensor_ = vlp16::NameOfForeignPayload(payload);
    return refuse(num_data_wrong_size_);
  }
  if (!is_data && !form_.is_position_size(payload.size())) return refuse(num_position_wrong_size_);
  if (!UtimeFromWire(ToUtimeUs(host_time))) return refuse(num_bad_host_time_);
  if (!bundle_.items.empty() && bundle_.payload.size() + payload.size() > kMaxPayloadBytes) {
    auto full = Close();
    Append(host_time, udp_port, payload);
    return full;
  }
  Append(host_time, udp_port, payload);
  const bool ends_scan = is_data && form_.ends_scan && form_.ends_scan(payload);
  if (!ends_scan && bundle_.items.size() < kMaxItems) return std::nullopt;
  return Close();
}

void Bundler::Append(Utime host_time, int udp_port, Bytes payload) {
  if (bundle_.items.empty()) bundle_.time = host_time;
  bundle_.items.push_back({host_time, udp_port, bundle_.payload.size(), payload.size()});
  bundle_.payload.insert(bundle_.payload.end(), payload.begin(), payload.end());
}

std::optional<PacketBundle> Bundler::AdvanceTo(Utime host_time) {
  if (bundle_.items.empty() || host_time - bundle_.time < form_.max_wait) return std::nullopt;
  return Close();
}

std::optional<PacketBundle> Bundler::Finish(Utime host_time) {
  if (bundle_.items.empty() && next_seq_ == 0) return std::nullopt;
  if (bundle_.items.empty()) bundle_.time = host_time;
  bundle_.is_end = true;
  PacketBundle bundle = Close();
  next_seq_ = 0;
  return bundle;
}

PacketBundle Bundler::Close() {
  bundle_.seq = next_seq_++;
  bundle_.is_start = bundle_.seq == 0;
  return std::exchange(bundle_, PacketBundle{});
}

std::vector<Counter> Bundler::counters() const {
  return {{"datagrams_other_port", num_other_port_},
          {"data_wrong_size", num_data_wrong_size_},
          {"position_wrong_size", num_position_wrong_size_},
          {"datagrams_bad_host_time", num_bad_host_time_}};
}

}  // namespace lookout::lidar
