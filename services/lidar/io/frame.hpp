// Finds the UDP datagram in a captured link-layer frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/io/fragments.hpp"

struct pcap;  // libpcap's pcap_t

namespace lookout::lidar {

enum class FrameFault {
  kNone,
  kTruncated,  // the capture kept fewer bytes than were on the wire, and the datagram needs them
  kNotIp,
  kNotUdp,
  kFragment,       // one part of an IP datagram: the other parts are needed
  kIpv6Extension,  // IPv6 with extension headers
  kBadIpHeader,    // version or header length that cannot be
  kBadLength,      // a length that goes beyond the bytes that hold it
  kLinkType,       // of an interface whose link type is not understood, beside others that are
};
inline constexpr std::array<std::string_view, 9> kFrameFaultNames{"frames_datagram",      "frames_truncated",  "frames_not_ip",
                                                                  "frames_not_udp",       "frames_fragment",   "frames_ipv6_extension",
                                                                  "frames_bad_ip_header", "frames_bad_length", "frames_link_type"};

struct Frame {
  FrameFault fault = FrameFault::kNone;  // the other members are set when the fault is kNone
  std::string source_address = {};       // numeric
  int source_port = 0;
  int destination_port = 0;
  Bytes payload = {};                     // within the bytes of the frame
  std::optional<Fragment> fragment = {};  // with kFragment alone, where all bytes of the part were captured
  std::string destination_address = {};   // numeric
};

/// Handle of libpcap, for capturing or reading; closes itself.
using CaptureHandle = std::unique_ptr<pcap, void (*)(pcap*)>;

/// Link types that are understood, by libpcap's DLT numbers: Ethernet (also VLAN-tagged, stacked), Linux cooked v1, v2, raw IP, BSD loopback.
bool IsLinkTypeUnderstood(int link_type);

/// @param link_type  DLT number; where not IsLinkTypeUnderstood the fault is kLinkType
/// @param bytes      as captured
/// @param is_cut     the frame was longer on the wire than in the capture
///
/// The length in the UDP header counts, where the captured bytes hold it: position packets of a real VLP-16 carry the IP length of a data packet.
/// Checksums are not looked at: with checksum offload a capture holds wrong ones for good datagrams.
/// A fragment is handed on: FragmentJoiner puts it together with the others, and ParseDatagram reads the datagram.
Frame ParseFrame(int link_type, Bytes bytes, bool is_cut);

/// Parses a UDP datagram with its header, as FragmentJoiner gives it. The payload of the result refers to `bytes`.
Frame ParseDatagram(Bytes bytes, std::string source_address, std::string destination_address);

/// Time of a frame, as libpcap reports it when nanoseconds were asked for.
///
/// @return nullopt when it cannot be: nanoseconds outside of a second, or a year outside of 1900 to 2200
std::optional<Utime> UtimeOfStamp(std::int64_t seconds, std::int64_t nanoseconds);

/// The frames of one capture, live or from a file, one after the other: datagrams, and skipped frames with the reason.
class FrameCounts {
 public:
  /// Counts a frame.
  ///
  /// @param time  nullopt: its stamp cannot be
  /// @return whether it holds a datagram with a time
  bool Add(const Frame& frame, const std::optional<Utime>& time);

  std::int64_t num_frames() const { return num_frames_; }
  std::int64_t num_datagrams() const { return num_by_fault_[static_cast<std::size_t>(FrameFault::kNone)]; }

  /// Appends frames_read, frames_datagram, then skipped frames by reason.
  void AppendTo(std::vector<Counter>& counters) const;

 private:
  std::int64_t num_frames_ = 0;
  std::int64_t num_bad_times_ = 0;
  std::array<std::int64_t, kFrameFaultNames.size()> num_by_fault_{};
};

}  // namespace lookout::lidar
