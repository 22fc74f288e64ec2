#include "services/lidar/io/live_capture.hpp"

#include <net/if.h>

#include <algorithm>
#include <filesystem>
#include <pcap/pcap.h>
#include <stdexcept>
#include <utility>

namespace lookout::lidar {

namespace {

// A data packet of most lidars takes up to 1300 bytes with its headers, 8 more with two VLAN tags, and larger ones come in fragments of 1514. On the
// loopback interface and on those for jumbo frames a datagram of an Ouster, of up to 25 kB, is one frame. Frames that are longer take more of the
// ring.
constexpr int kSnapLengthBytes = 2048;
constexpr int kJumboSnapLengthBytes = 65'535;

// Compiles and, with a live handle, installs it.
std::string ApplyFilter(pcap_t* capture, const std::string& filter, bool is_installed) {
  constexpr int kOptimise = 1;
  bpf_program program{};
  if (pcap_compile(capture, &program, filter.c_str(), kOptimise, PCAP_NETMASK_UNKNOWN) != 0) return pcap_geterr(capture);
  const bool is_fine = !is_installed || pcap_setfilter(capture, &program) == 0;
  pcap_freecode(&program);
  return is_fine ? "" : pcap_geterr(capture);
}

std::string ProgramFile() {
  std::error_code error;
  const auto file = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? "this program" : file.string();
}

std::string ReasonOf(pcap_t* capture, int status) {
  if (status == PCAP_ERROR_PERM_DENIED || status == PCAP_ERROR_PROMISC_PERM_DENIED) {
    return "capturing needs CAP_NET_RAW, which is missing. Give it once: sudo setcap cap_net_raw=ep " + ProgramFile();
  }
  const std::string detail = pcap_geterr(capture);
  return std::string(pcap_statustostr(status)) + (detail.empty() ? "" : ": " + detail);
}

}  // namespace

std::string FilterOfPorts(int data_port, int position_port, bool has_vlan) {
  // Parts of a datagram behind the first have no ports.
  const std::string ports = "((udp and (dst port " + std::to_string(data_port) + " or dst port " + std::to_string(position_port) +
                            ")) or (ip proto 17 and ip[6:2] & 0x1fff != 0) or (ip6[6] == 44 and ip6[40] == 17))";
  // "vlan" shifts the offsets of everything to its right, so untagged frames stand first and the tags nest.
  return has_vlan ? ports + " or (vlan and (" + ports + " or (vlan and " + ports + ")))" : ports;
}

std::string FilterFault(const std::string& filter) {
  const CaptureHandle dead(pcap_open_dead(DLT_EN10MB, kSnapLengthBytes), &pcap_close);
  return dead ? ApplyFilter(dead.get(), filter, false) : "libpcap does not start";
}

LiveCapture::LiveCapture(LiveOptions options) : options_(std::move(options)), capture_(nullptr, &pcap_close) {
  const auto& interface = options_.interface;
  if (if_nametoindex(interface.c_str()) == 0) throw std::runtime_error("cannot capture: " + io::NoInterfaceText(interface));
  if (!io::IsInterfaceUp(interface)) {
    fault_ = CheckInterface();
    return;
  }
  const auto fault = Open();
  if (!fault.empty()) throw std::runtime_error(fault);
}

std::string LiveCapture::Open() {
  const std::string where = "cannot capture on interface '" + options_.interface + "': ";
  std::array<char, PCAP_ERRBUF_SIZE> fault{};
  CaptureHandle opened(pcap_create(options_.interface.c_str(), fault.data()), &pcap_close);
  if (!opened) return where + fault.data();
  pcap_t* capture = opened.get();
  pcap_set_snaplen(capture, options_.has_large_packets ? kJumboSnapLengthBytes : kSnapLengthBytes);
  pcap_set_promisc(capture, 0);
  pcap_set_immediate_mode(capture, 1);  // a frame can be read as soon as it comes, not only when a block of the ring is full
  pcap_set_buffer_size(capture, options_.receive_buffer_bytes);
  // A kernel that cannot is no fault: the stamps are microseconds then.
  pcap_set_tstamp_precision(capture, PCAP_TSTAMP_PRECISION_NANO);
  const unsigned int index = if_nametoindex(options_.interface.c_str());
  const int status = pcap_activate(capture);
  if (status < 0) return where + ReasonOf(capture, status);
  if (pcap_setnonblock(capture, 1, fault.data()) != 0) return where + fault.data();
  const int link_type = pcap_datalink(capture);
  if (!IsLinkTypeUnderstood(link_type)) return where + "link type " + std::to_string(link_type) + " is not understood";
  const auto filter = options_.filter.empty() ? FilterOfPorts(options_.data_port, options_.position_port, link_type == DLT_EN10MB) : options_.filter;
  const auto filter_fault = ApplyFilter(capture, filter, true);
  if (!filter_fault.empty()) return where + "filter '" + filter + "': " + filter_fault;
  constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;
  nanoseconds_per_fraction_ = pcap_get_tstamp_precision(capture) == PCAP_TSTAMP_PRECISION_NANO ? 1 : kNanosecondsPerMicrosecond;
  link_type_ = link_type;
  interface_index_ = index;
  filter_ = filter;
  capture_ = std::move(opened);
  ++num_opened_;
  return "";
}

void LiveCapture::Close() {
  if (!capture_) return;
  past_drops_ = CurrentDrops();
  capture_.reset();
  filter_.clear();
}

LiveCapture::Drops LiveCapture::CurrentDrops() const {
  Drops drops = past_drops_;
  pcap_stat statistics{};
  if (capture_ && pcap_stats(capture_.get(), &statistics) == 0) {
    drops.num_kernel += statistics.ps_drop;
    drops.num_interface += statistics.ps_ifdrop;
  }
  return drops;
}

std::string LiveCapture::CheckInterface() {
  const auto& interface = options_.interface;
  const unsigned int index = if_nametoindex(interface.c_str());
  const bool is_up = index != 0 && io::IsInterfaceUp(interface);
  if (index != interface_index_ || !is_up) Close();
  if (index == 0) return "interface '" + interface + "' is not there";
  if (!is_up) return "interface '" + interface + "' is down";
  return capture_ ? "" : Open();
}

std::string LiveCapture::Poll(Utime now) {
  if (!timer_.IsDue(now)) return "";
  const auto num_opened_before = num_opened_;
  const auto fault = CheckInterface();
  const bool is_reopened = num_opened_ != num_opened_before;
  if (fault == fault_ && !is_reopened) return "";
  num_outages_ += fault_.empty() ? 1 : 0;
  fault_ = fault;
  const auto read_fault = std::exchange(read_fault_, "");
  return (fault.empty() ? "captures again on interface '" + options_.interface + "'" : fault) +
         (read_fault.empty() ? "" : "; reading had ended: " + read_fault);
}

std::optional<io::Source::Piece> LiveCapture::Check(Bytes bytes, bool is_cut, std::int64_t seconds, std::int64_t fraction) {
  auto frame = ParseFrame(link_type_, bytes, is_cut);
  const auto host_time = UtimeOfStamp(seconds, fraction * nanoseconds_per_fraction_);
  if (frame.fragment && host_time) {
    if (auto joined = fragments_.Add(*host_time, *frame.fragment)) {
      joined_ = std::move(*joined);
      frame = ParseDatagram(joined_, frame.fragment->source_address, frame.fragment->destination_address);
    }
  }
  if (host_time) last_time_ = *host_time;
  if (!frames_.Add(frame, host_time)) return std::nullopt;
  const auto& allowed = options_.allowed_source_addresses;
  if (!allowed.empty() && std::ranges::find(allowed, frame.source_address) == allowed.end()) {
    ++num_source_refused_;
    return std::nullopt;
  }
  return Piece{.host_time = *host_time,
               .bytes = frame.payload,
               .port = frame.destination_port,
               .source_address = std::move(frame.source_address),
               .source_port = frame.source_port,
               .destination_address = std::move(frame.destination_address)};
}

std::optional<io::Source::Piece> LiveCapture::Receive(Utime) {
  is_empty_ = false;
  for (int i = 0; i < kMaxSkippedPerCall && !is_empty_; ++i) {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int outcome = capture_ ? pcap_next_ex(capture_.get(), &header, &data) : 0;
    if (outcome == 1) {
      auto datagram = Check(Bytes(data, header->caplen), header->caplen < header->len, header->ts.tv_sec, header->ts.tv_usec);
      if (datagram) return datagram;
      continue;
    }
    is_empty_ = true;
    if (outcome == 0) continue;
    // Poll opens it again.
    ++num_read_errors_;
    read_fault_ = pcap_geterr(capture_.get());
    Close();
  }
  return std::nullopt;
}

std::vector<Counter> LiveCapture::counters() {
  const auto drops = CurrentDrops();
  std::vector<Counter> counters{{"capture_kernel_drops", drops.num_kernel},
                                {"capture_interface_drops", drops.num_interface},
                                {"capture_source_refused", num_source_refused_},
                                {"capture_outages", num_outages_},
                                {"capture_read_errors", num_read_errors_}};
  frames_.AppendTo(counters);
  counters.push_back({"datagrams_given_up", fragments_.num_given_up()});
  return counters;
}

}  // namespace lookout::lidar
