#include "services/lidar/io/frame.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <pcap/pcap.h>
#include <utility>

namespace lookout::lidar {

namespace {

// IEEE 802 numbers ("ethertypes").
constexpr int kEthertypeIpv4 = 0x0800;
constexpr int kEthertypeIpv6 = 0x86DD;
constexpr std::array<int, 4> kEthertypesVlan{0x8100, 0x88A8, 0x9100, 0x9200};  // 802.1Q, 802.1ad, and two that older switches stack
constexpr std::size_t kVlanTagSizeBytes = 4;
constexpr std::size_t kUdpHeaderSizeBytes = 8;
constexpr std::size_t kIpv6HeaderSizeBytes = 40;
// IANA protocol numbers.
constexpr int kProtocolUdp = 17;
constexpr int kProtocolIpv6Fragment = 44;
constexpr std::array<int, 6> kProtocolsIpv6Extension{0, 43, 51, 60, 135, 139};
// Raw IP as OpenBSD numbers it; libpcap hands the number on elsewhere.
constexpr int kRawIpOfOpenBsd = 14;
constexpr std::uint32_t kFamilyIpv4 = 2;
constexpr std::array<std::uint32_t, 4> kFamiliesIpv6{10, 24, 28, 30};  // Linux, NetBSD and OpenBSD, FreeBSD, Darwin

int ReadU16BigEndian(Bytes bytes, std::size_t offset) { return bytes[offset] << 8 | bytes[offset + 1]; }

Frame Refused(FrameFault fault) { return {.fault = fault}; }

std::string AddressText(int family, Bytes address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  return inet_ntop(family, address.data(), text.data(), text.size()) != nullptr ? text.data() : "";
}

// A short datagram is short because the capture cut it, or because a length lies.
FrameFault Short(bool is_cut) { return is_cut ? FrameFault::kTruncated : FrameFault::kBadLength; }

// `bytes`: captured behind the IP header, with padding of the frame. `ip_size`: of the datagram, by the IP header: it tells only what is wrong with a
// datagram that is not whole.
Frame ParseUdp(Bytes bytes, std::size_t ip_size, bool is_cut, std::string source_address, std::string destination_address) {
  const auto fault = ip_size > bytes.size() ? Short(is_cut) : FrameFault::kBadLength;
  if (bytes.size() < kUdpHeaderSizeBytes) return Refused(fault);
  const auto size = static_cast<std::size_t>(ReadU16BigEndian(bytes, 4));
  if (size < kUdpHeaderSizeBytes) return Refused(FrameFault::kBadLength);
  if (size > bytes.size()) return Refused(fault);
  return {.fault = FrameFault::kNone,
          .source_address = std::move(source_address),
          .source_port = ReadU16BigEndian(bytes, 0),
          .destination_port = ReadU16BigEndian(bytes, 2),
          .payload = bytes.subspan(kUdpHeaderSizeBytes, size - kUdpHeaderSizeBytes),
          .destination_address = std::move(destination_address)};
}

// `bytes`: captured behind the header of IP, or of the fragment; `size`: of the part, by that header.
Frame FragmentOf(Bytes bytes, std::size_t size, bool is_cut, Fragment fragment) {
  if (size > bytes.size()) return Refused(Short(is_cut));
  fragment.bytes = bytes.first(size);
  Frame frame = Refused(FrameFault::kFragment);
  frame.fragment = std::move(fragment);
  return frame;
}

constexpr std::size_t kFragmentUnitBytes = 8;

Frame ParseIpv4(Bytes bytes, bool is_cut) {
  constexpr std::size_t kMinHeaderSizeBytes = 20;
  if (bytes.size() < kMinHeaderSizeBytes) return Refused(Short(is_cut));
  const std::size_t header_size = 4U * (bytes[0] & 0x0FU);  // with options
  const auto total_size = static_cast<std::size_t>(ReadU16BigEndian(bytes, 2));
  if (bytes[0] >> 4 != 4 || header_size < kMinHeaderSizeBytes) return Refused(FrameFault::kBadIpHeader);
  constexpr int kMoreFragments = 0x2000;
  constexpr int kFragmentOffset = 0x1FFF;
  const int fragment = ReadU16BigEndian(bytes, 6) & (kMoreFragments | kFragmentOffset);
  if (fragment != 0) {
    if (bytes[9] != kProtocolUdp || header_size > bytes.size()) return Refused(FrameFault::kFragment);
    return FragmentOf(bytes.subspan(header_size), total_size - std::min(total_size, header_size), is_cut,
                      {.source_address = AddressText(AF_INET, bytes.subspan(12, 4)),
                       .destination_address = AddressText(AF_INET, bytes.subspan(16, 4)),
                       .identification = static_cast<std::uint32_t>(ReadU16BigEndian(bytes, 4)),
                       .offset_bytes = static_cast<std::size_t>(fragment & kFragmentOffset) * kFragmentUnitBytes,
                       .is_last = (fragment & kMoreFragments) == 0,
                       .bytes = {}});
  }
  if (bytes[9] != kProtocolUdp) return Refused(FrameFault::kNotUdp);
  if (header_size > bytes.size()) return Refused(Short(is_cut));
  return ParseUdp(bytes.subspan(header_size), total_size - std::min(total_size, header_size), is_cut, AddressText(AF_INET, bytes.subspan(12, 4)),
                  AddressText(AF_INET, bytes.subspan(16, 4)));
}

// Behind the header of IPv6: next header, a spare byte, offset and flag, identification.
Frame ParseIpv6Fragment(Bytes bytes, bool is_cut) {
  constexpr std::size_t kFragmentHeaderBytes = 8;
  constexpr int kMoreFragments = 1;
  const auto size = static_cast<std::size_t>(ReadU16BigEndian(bytes, 4));
  if (bytes.size() < kIpv6HeaderSizeBytes + kFragmentHeaderBytes) return Refused(Short(is_cut));
  const auto header = bytes.subspan(kIpv6HeaderSizeBytes, kFragmentHeaderBytes);
  if (header[0] != kProtocolUdp) return Refused(FrameFault::kFragment);
  const int place = ReadU16BigEndian(header, 2);
  return FragmentOf(
      bytes.subspan(kIpv6HeaderSizeBytes + kFragmentHeaderBytes), size - std::min(size, kFragmentHeaderBytes), is_cut,
      {.source_address = AddressText(AF_INET6, bytes.subspan(8, 16)),
       .destination_address = AddressText(AF_INET6, bytes.subspan(24, 16)),
       .identification = static_cast<std::uint32_t>(ReadU16BigEndian(header, 4)) << 16U | static_cast<std::uint32_t>(ReadU16BigEndian(header, 6)),
       .offset_bytes = static_cast<std::size_t>(place) / kFragmentUnitBytes * kFragmentUnitBytes,
       .is_last = (place & kMoreFragments) == 0,
       .bytes = {}});
}

Frame ParseIpv6(Bytes bytes, bool is_cut) {
  if (bytes.size() < kIpv6HeaderSizeBytes) return Refused(Short(is_cut));
  if (bytes[0] >> 4 != 6) return Refused(FrameFault::kBadIpHeader);
  const int protocol = bytes[6];
  if (protocol == kProtocolIpv6Fragment) return ParseIpv6Fragment(bytes, is_cut);
  if (std::ranges::find(kProtocolsIpv6Extension, protocol) != kProtocolsIpv6Extension.end()) return Refused(FrameFault::kIpv6Extension);
  if (protocol != kProtocolUdp) return Refused(FrameFault::kNotUdp);
  const auto payload_size = static_cast<std::size_t>(ReadU16BigEndian(bytes, 4));
  return ParseUdp(bytes.subspan(kIpv6HeaderSizeBytes), payload_size, is_cut, AddressText(AF_INET6, bytes.subspan(8, 16)),
                  AddressText(AF_INET6, bytes.subspan(24, 16)));
}

Frame ParseIp(Bytes bytes, bool is_cut) {
  if (bytes.empty()) return Refused(Short(is_cut));
  switch (bytes[0] >> 4) {
    case 4:
      return ParseIpv4(bytes, is_cut);
    case 6:
      return ParseIpv6(bytes, is_cut);
    default:
      return Refused(FrameFault::kBadIpHeader);
  }
}

// `offset`: of the ethertype. `header_size`: of the bytes before the network layer when there is no VLAN tag.
Frame ParseEthertype(Bytes bytes, std::size_t offset, std::size_t header_size, bool is_cut) {
  while (true) {
    if (bytes.size() < std::max(offset + 2, header_size)) return Refused(Short(is_cut));
    const int ethertype = ReadU16BigEndian(bytes, offset);
    if (ethertype == kEthertypeIpv4) return ParseIpv4(bytes.subspan(header_size), is_cut);
    if (ethertype == kEthertypeIpv6) return ParseIpv6(bytes.subspan(header_size), is_cut);
    if (std::ranges::find(kEthertypesVlan, ethertype) == kEthertypesVlan.end()) return Refused(FrameFault::kNotIp);
    offset = header_size + kVlanTagSizeBytes - 2;
    header_size += kVlanTagSizeBytes;
  }
}

Frame ParseLoopback(Bytes bytes, bool is_cut) {
  constexpr std::size_t kHeaderSizeBytes = 4;
  if (bytes.size() < kHeaderSizeBytes) return Refused(Short(is_cut));
  // In the byte order of the computer that captured (NULL) or big-endian (LOOP).
  const std::uint32_t little = ReadU32LittleEndian(bytes, 0);
  const std::uint32_t big = static_cast<std::uint32_t>(ReadU16BigEndian(bytes, 0)) << 16 | static_cast<std::uint32_t>(ReadU16BigEndian(bytes, 2));
  const std::uint32_t family = std::min(little, big);
  if (family == kFamilyIpv4) return ParseIpv4(bytes.subspan(kHeaderSizeBytes), is_cut);
  if (std::ranges::find(kFamiliesIpv6, family) != kFamiliesIpv6.end()) return ParseIpv6(bytes.subspan(kHeaderSizeBytes), is_cut);
  return Refused(FrameFault::kNotIp);
}

}  // namespace

bool IsLinkTypeUnderstood(int link_type) {
  constexpr std::array kUnderstood{DLT_EN10MB, DLT_LINUX_SLL, DLT_LINUX_SLL2, DLT_RAW, kRawIpOfOpenBsd, DLT_IPV4, DLT_IPV6, DLT_NULL, DLT_LOOP};
  return std::ranges::find(kUnderstood, link_type) != kUnderstood.end();
}

Frame ParseFrame(int link_type, Bytes bytes, bool is_cut) {
  if (!IsLinkTypeUnderstood(link_type)) return Refused(FrameFault::kLinkType);
  switch (link_type) {
    case DLT_EN10MB:
      return ParseEthertype(bytes, 12, 14, is_cut);
    case DLT_LINUX_SLL:
      return ParseEthertype(bytes, 14, 16, is_cut);
    case DLT_LINUX_SLL2:
      return ParseEthertype(bytes, 0, 20, is_cut);
    case DLT_NULL:
    case DLT_LOOP:
      return ParseLoopback(bytes, is_cut);
    default:
      return ParseIp(bytes, is_cut);
  }
}

Frame ParseDatagram(Bytes bytes, std::string source_address, std::string destination_address) {
  return ParseUdp(bytes, bytes.size(), false, std::move(source_address), std::move(destination_address));
}

std::optional<Utime> UtimeOfStamp(std::int64_t seconds, std::int64_t nanoseconds) {
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;
  if (nanoseconds < 0 || nanoseconds >= kNanosecondsPerSecond) return std::nullopt;
  if (seconds < kMinUtimeUs / kMicrosecondsPerSecond || seconds > kMaxUtimeUs / kMicrosecondsPerSecond) return std::nullopt;
  return UtimeFromWire(seconds * kMicrosecondsPerSecond + nanoseconds / 1000);
}

bool FrameCounts::Add(const Frame& frame, const std::optional<Utime>& time) {
  ++num_frames_;
  const bool is_datagram = frame.fault == FrameFault::kNone;
  ++(is_datagram && !time ? num_bad_times_ : num_by_fault_[static_cast<std::size_t>(frame.fault)]);
  return is_datagram && time;
}

void FrameCounts::AppendTo(std::vector<Counter>& counters) const {
  counters.push_back({"frames_read", num_frames_});
  for (std::size_t i = 0; i < kFrameFaultNames.size(); ++i) counters.push_back({kFrameFaultNames[i], num_by_fault_[i]});
  counters.push_back({"frames_bad_time", num_bad_times_});
}

}  // namespace lookout::lidar
