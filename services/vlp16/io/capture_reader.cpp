#include "services/vlp16/io/capture_reader.hpp"

#include <array>
#include <pcap/pcap.h>
#include <stdexcept>

namespace lookout::vlp16 {

namespace {

std::string LinkTypeText(int link_type) {
  const char* name = pcap_datalink_val_to_name(link_type);
  return std::to_string(link_type) + (name != nullptr ? std::string(" (") + name + ")" : "");
}

}  // namespace

CaptureReader::CaptureReader(const std::filesystem::path& file) : capture_(nullptr, &pcap_close) {
  std::array<char, PCAP_ERRBUF_SIZE> fault{};
  // libpcap takes "-" for standard input.
  const std::string name = file == "-" ? "./-" : file.string();
  if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file)) {
    throw std::runtime_error(name + ": is a folder or a pipe, not the file of a capture");
  }
  capture_.reset(pcap_open_offline_with_tstamp_precision(name.c_str(), PCAP_TSTAMP_PRECISION_NANO, fault.data()));
  if (!capture_) throw std::runtime_error(name + ": cannot be read as a capture: " + fault.data());
  link_type_ = pcap_datalink(capture_.get());
  if (!IsLinkTypeUnderstood(link_type_)) {
    throw std::runtime_error(name + ": link type " + LinkTypeText(link_type_) +
                             " is not understood; Ethernet, Linux cooked, raw IP and BSD loopback are");
  }
}

std::optional<Datagram> CaptureReader::Next(std::int64_t max_frames) {
  for (std::int64_t i = 0; i < max_frames && !is_at_end_; ++i) {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int outcome = pcap_next_ex(capture_.get(), &header, &data);
    is_at_end_ = outcome != 1;
    if (outcome == PCAP_ERROR_BREAK) return std::nullopt;  // the end
    if (outcome != 1) {
      damage_ = std::string(pcap_geterr(capture_.get())) + ", after " + std::to_string(num_frames()) + " frames";
      return std::nullopt;
    }
    const auto frame = ParseFrame(link_type_, Bytes(data, header->caplen), header->caplen < header->len);
    // Nanoseconds were asked for: libpcap then leaves them in tv_usec.
    const auto host_time = UtimeOfStamp(header->ts.tv_sec, header->ts.tv_usec);
    if (!frames_.Add(frame, host_time)) continue;
    return Datagram{*host_time, frame.source_address, frame.source_port, frame.destination_port, {frame.payload.begin(), frame.payload.end()}};
  }
  return std::nullopt;
}

std::vector<Counter> CaptureReader::counters() const {
  std::vector<Counter> counters;
  frames_.AppendTo(counters);
  counters.push_back({"capture_damaged", num_damaged()});
  return counters;
}

}  // namespace lookout::vlp16
