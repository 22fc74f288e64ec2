#include "services/lidar/io/capture_reader.hpp"

#include <stdio.h>

#include <algorithm>
#include <array>
#include <pcap/pcap.h>
#include <stdexcept>
#include <utility>

#include "common/io/file_kind.hpp"

namespace lookout::lidar {

namespace {

std::string LinkTypeText(int link_type) {
  const char* name = pcap_datalink_val_to_name(link_type);
  return std::to_string(link_type) + (name != nullptr ? std::string(" (") + name + ")" : "");
}

std::string NotUnderstood(const std::vector<int>& link_types) {
  std::string text;
  for (const int link_type : link_types) text += (text.empty() ? "link type " : ", ") + LinkTypeText(link_type);
  return text + " is not understood; Ethernet, Linux cooked, raw IP and BSD loopback are";
}

// For libpcap, which reads a file of stdio.
ssize_t ReadUnpacked(void* cookie, char* out, std::size_t size) {
  return static_cast<ssize_t>(static_cast<io::UnpackedFile*>(cookie)->Read({reinterpret_cast<std::uint8_t*>(out), size}));
}

// pcap has 32 bits of seconds, without a sign. libpcap takes them for signed: from January 2038 on they would come as years before 1902.
std::int64_t SecondsOfPcap(std::int64_t seconds) {
  constexpr std::int64_t kAllOf32Bits = 0xFFFF'FFFF;
  return seconds & kAllOf32Bits;
}

}  // namespace

CaptureReader::CaptureReader(const std::filesystem::path& file) : capture_(nullptr, &pcap_close) {
  if (const auto reason = io::WhyNot(file, io::Wanted::kCapture); !reason.empty()) throw std::runtime_error(reason);
  auto kind = io::FileKindOf(file);
  const bool is_packed = kind == io::FileKind::kGzip;
  if (is_packed) kind = io::PackedKindOf(file);
  if (kind == io::FileKind::kPcapng) {
    OpenPcapng(file);
  } else {
    OpenPcap(file, is_packed);
  }
}

void CaptureReader::OpenPcap(const std::filesystem::path& file, bool is_packed) {
  std::array<char, PCAP_ERRBUF_SIZE> fault{};
  // libpcap takes "-" for standard input.
  const std::string name = file == "-" ? "./-" : file.string();
  if (is_packed) {
    packed_ = std::make_unique<io::UnpackedFile>(file);
    FILE* const stream = fopencookie(packed_.get(), "r", {.read = &ReadUnpacked, .write = nullptr, .seek = nullptr, .close = nullptr});
    if (stream == nullptr) throw std::runtime_error(name + ": no memory to read it");
    capture_.reset(pcap_fopen_offline_with_tstamp_precision(stream, PCAP_TSTAMP_PRECISION_NANO, fault.data()));
    if (!capture_) fclose(stream);
  } else {
    capture_.reset(pcap_open_offline_with_tstamp_precision(name.c_str(), PCAP_TSTAMP_PRECISION_NANO, fault.data()));
  }
  if (!capture_) throw std::runtime_error(name + ": cannot be read as a capture: " + fault.data());
  link_type_ = pcap_datalink(capture_.get());
  if (!IsLinkTypeUnderstood(link_type_)) throw std::runtime_error(name + ": " + NotUnderstood({link_type_}));
}

void CaptureReader::OpenPcapng(const std::filesystem::path& file) {
  // Looked at as far as an interface that is understood. Others may stand beside it.
  PcapngReader first(file);
  const auto is_found = [&first] { return std::ranges::any_of(first.link_types(), &IsLinkTypeUnderstood); };
  bool goes_on = true;
  while (goes_on && !is_found()) goes_on = first.Next().has_value();
  if (first.link_types().empty()) {
    throw std::runtime_error(file.string() +
                             ": cannot be read as a capture: " + (first.damage().empty() ? "it describes no interface" : first.damage()));
  }
  if (!is_found()) throw std::runtime_error(file.string() + ": " + NotUnderstood(first.link_types()));
  pcapng_ = std::make_unique<PcapngReader>(file);
}

std::optional<CapturedFrame> CaptureReader::NextFrame() {
  if (pcapng_) {
    auto frame = pcapng_->Next();
    if (!frame) damage_ = pcapng_->damage();
    return frame;
  }
  pcap_pkthdr* header = nullptr;
  const u_char* data = nullptr;
  const int outcome = pcap_next_ex(capture_.get(), &header, &data);
  if (outcome == 1) {
    // Nanoseconds were asked for: libpcap then leaves them in tv_usec.
    return CapturedFrame{link_type_, Bytes(data, header->caplen), header->caplen < header->len,
                         UtimeOfStamp(SecondsOfPcap(header->ts.tv_sec), header->ts.tv_usec)};
  }
  if (outcome != PCAP_ERROR_BREAK) damage_ = pcap_geterr(capture_.get());
  if (packed_ && !packed_->fault().empty()) damage_ = packed_->fault();
  return std::nullopt;
}

std::optional<Datagram> CaptureReader::Next(std::int64_t max_frames) {
  for (std::int64_t i = 0; i < max_frames && !is_at_end_; ++i) {
    const auto captured = NextFrame();
    is_at_end_ = !captured;
    if (!captured) {
      if (!damage_.empty()) damage_ += ", after " + std::to_string(num_frames()) + " frames";
      return std::nullopt;
    }
    auto frame = ParseFrame(captured->link_type, captured->bytes, captured->is_cut);
    std::optional<std::vector<std::uint8_t>> joined;
    if (frame.fragment && captured->time) {
      joined = fragments_.Add(*captured->time, *frame.fragment);
      if (joined) frame = ParseDatagram(*joined, frame.fragment->source_address, frame.fragment->destination_address);
    }
    if (!frames_.Add(frame, captured->time)) continue;
    return Datagram{.host_time = *captured->time,
                    .source_address = std::move(frame.source_address),
                    .source_port = frame.source_port,
                    .destination_address = std::move(frame.destination_address),
                    .destination_port = frame.destination_port,
                    .payload = {frame.payload.begin(), frame.payload.end()}};
  }
  return std::nullopt;
}

std::int64_t CaptureReader::position_bytes() const {
  if (pcapng_) return pcapng_->position_bytes();
  return packed_ ? packed_->position_bytes() : ftello(pcap_file(capture_.get()));
}

std::vector<Counter> CaptureReader::counters() const {
  std::vector<Counter> counters;
  frames_.AppendTo(counters);
  counters.push_back({"datagrams_given_up", fragments_.num_given_up()});
  counters.push_back({"capture_damaged", num_damaged()});
  return counters;
}

}  // namespace lookout::lidar
