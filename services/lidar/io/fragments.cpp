#include "services/lidar/io/fragments.hpp"

#include <algorithm>

namespace lookout::lidar {

namespace {

constexpr std::size_t kMaxIpBytes = 65'535;

}  // namespace

std::optional<std::vector<std::uint8_t>> FragmentJoiner::Add(Utime time, const Fragment& fragment) {
  num_given_up_ += static_cast<std::int64_t>(
      std::erase_if(datagrams_, [&](const Datagram& datagram) { return time < datagram.first || time - datagram.first > kMaxAge; }));
  auto found = std::ranges::find_if(datagrams_, [&](const Datagram& datagram) {
    return datagram.identification == fragment.identification && datagram.source_address == fragment.source_address &&
           datagram.destination_address == fragment.destination_address;
  });
  if (found == datagrams_.end()) {
    if (datagrams_.size() == kMaxDatagrams) {
      datagrams_.erase(datagrams_.begin());
      ++num_given_up_;
    }
    found =
        datagrams_.insert(datagrams_.end(), Datagram{time, fragment.source_address, fragment.destination_address, fragment.identification, {}, {}});
  }
  auto& datagram = *found;
  const std::size_t end = fragment.offset_bytes + fragment.bytes.size();
  const auto next = std::ranges::upper_bound(datagram.parts, fragment.offset_bytes, {}, &Part::offset);
  const bool is_behind = next == datagram.parts.begin() || std::prev(next)->offset + std::prev(next)->bytes.size() <= fragment.offset_bytes;
  const bool is_before = next == datagram.parts.end() || end <= next->offset;
  // All but the last hold whole units of 8 bytes.
  const bool is_whole = !fragment.bytes.empty() && (fragment.is_last || fragment.bytes.size() % 8 == 0);
  const bool is_end_beyond = !fragment.is_last || datagram.parts.empty() || end > datagram.parts.back().offset;
  const bool fits =
      is_whole && is_end_beyond && end <= kMaxIpBytes && (!datagram.size || end <= *datagram.size) && !(fragment.is_last && datagram.size);
  if (!is_behind || !is_before || !fits) {
    ++num_given_up_;
    datagrams_.erase(found);
    return std::nullopt;
  }
  if (fragment.is_last) datagram.size = end;
  datagram.parts.insert(next, Part{fragment.offset_bytes, {fragment.bytes.begin(), fragment.bytes.end()}});
  if (!datagram.size) return std::nullopt;
  std::size_t num_bytes = 0;
  for (const auto& part : datagram.parts) num_bytes += part.bytes.size();
  if (num_bytes < *datagram.size) return std::nullopt;
  std::vector<std::uint8_t> whole;
  whole.reserve(num_bytes);
  for (const auto& part : datagram.parts) whole.insert(whole.end(), part.bytes.begin(), part.bytes.end());
  datagrams_.erase(found);
  return whole;
}

}  // namespace lookout::lidar
