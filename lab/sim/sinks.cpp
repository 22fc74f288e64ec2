#include "lab/sim/sinks.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <pcap/pcap.h>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/io/stop_signal.hpp"

namespace lookout::sim {
namespace {

constexpr std::size_t kEthernetBytes = 14;
constexpr std::size_t kIpBytes = 20;
constexpr std::size_t kUdpBytes = 8;
constexpr std::size_t kHeaderBytes = kEthernetBytes + kIpBytes + kUdpBytes;
constexpr std::uint8_t kUdpProtocol = 17;
constexpr std::uint8_t kTimeToLive = 64;
constexpr int kSnapshotBytes = 65535;

using Address = std::array<std::uint8_t, 4>;
using Mac = std::array<std::uint8_t, 6>;
// As delivered: VLP-16 User Manual 63-9243 Rev E, chapter 5. Its makers' prefix is 60-76-88.
constexpr Address kLidarAddress{192, 168, 1, 201};
constexpr Mac kLidarMac{0x60, 0x76, 0x88, 0x00, 0x00, 0x01};
constexpr Address kNavigationAddress{192, 168, 1, 10};
constexpr Mac kNavigationMac{0x02, 0x00, 0x00, 0x00, 0x00, 0x0A};  // locally administered
constexpr Address kBroadcastAddress{255, 255, 255, 255};

void WriteU16BigEndian(std::span<std::uint8_t> bytes, std::size_t offset, std::size_t value) {
  bytes[offset] = static_cast<std::uint8_t>(value >> 8 & 0xFF);
  bytes[offset + 1] = static_cast<std::uint8_t>(value & 0xFF);
}

// Ones' complement sum of RFC 1071, not yet complemented.
std::uint32_t Sum(Bytes bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i < bytes.size(); ++i) sum += i % 2 == 0 ? static_cast<std::uint32_t>(bytes[i]) << 8 : bytes[i];
  while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
  return sum;
}

std::vector<std::uint8_t> Frame(const Datagram& datagram, bool is_lidar, std::uint16_t identification) {
  std::vector<std::uint8_t> frame(kHeaderBytes + datagram.payload.size());
  const std::span<std::uint8_t> bytes(frame);
  const auto& mac = is_lidar ? kLidarMac : kNavigationMac;
  const auto& address = is_lidar ? kLidarAddress : kNavigationAddress;
  std::ranges::fill(bytes.first(6), std::uint8_t{0xFF});
  std::ranges::copy(mac, bytes.begin() + 6);
  WriteU16BigEndian(bytes, 12, 0x0800);  // IPv4

  const auto ip = bytes.subspan(kEthernetBytes, kIpBytes);
  ip[0] = 0x45;  // version 4, five words of header
  WriteU16BigEndian(ip, 2, frame.size() - kEthernetBytes);
  WriteU16BigEndian(ip, 4, identification);
  WriteU16BigEndian(ip, 6, 0x4000);  // not to be fragmented
  ip[8] = kTimeToLive;
  ip[9] = kUdpProtocol;
  std::ranges::copy(address, ip.begin() + 12);
  std::ranges::copy(kBroadcastAddress, ip.begin() + 16);
  WriteU16BigEndian(ip, 10, ~Sum(ip, 0) & 0xFFFF);

  const auto udp = bytes.subspan(kEthernetBytes + kIpBytes);
  const auto port = static_cast<std::size_t>(datagram.port);
  WriteU16BigEndian(udp, 0, port);  // source port: the sensor sends from the same port
  WriteU16BigEndian(udp, 2, port);
  WriteU16BigEndian(udp, 4, udp.size());
  std::ranges::copy(datagram.payload, udp.begin() + kUdpBytes);
  // RFC 768: over a pseudo header of addresses, protocol and length too; 0 means "none", so 0 is sent as 0xFFFF.
  const std::uint32_t pseudo = Sum(ip.subspan(12, 8), 0) + kUdpProtocol + static_cast<std::uint32_t>(udp.size());
  const std::uint32_t checksum = ~Sum(udp, pseudo) & 0xFFFF;
  WriteU16BigEndian(udp, 6, checksum == 0 ? 0xFFFF : checksum);
  return frame;
}

}  // namespace

PcapSink::PcapSink(const std::filesystem::path& file, std::vector<int> lidar_ports, io::OutputOptions options)
    : file_(file, std::move(options)),
      lidar_ports_(std::move(lidar_ports)),
      capture_(pcap_open_dead(DLT_EN10MB, kSnapshotBytes), pcap_close),
      dumper_(nullptr, pcap_dump_close) {
  if (!capture_) throw std::runtime_error(file.string() + ": libpcap cannot open a capture");
  // libpcap closes what it writes to; the file keeps a descriptor of its own.
  const int descriptor = fcntl(file_.descriptor(), F_DUPFD_CLOEXEC, 0);
  std::FILE* out = descriptor < 0 ? nullptr : fdopen(descriptor, "wb");
  if (out == nullptr) Fail();
  dumper_.reset(pcap_dump_fopen(capture_.get(), out));
  if (!dumper_) throw std::runtime_error(file.string() + ": " + pcap_geterr(capture_.get()));
}

void PcapSink::Fail() const {
  const auto reason = std::system_category().message(errno);
  io::ThrowIfStopAsked();
  throw std::runtime_error(file_.file().string() + ": write failed: " + reason);
}

void PcapSink::Send(const Datagram& datagram) {
  const auto frame = Frame(datagram, std::ranges::find(lidar_ports_, datagram.port) != lidar_ports_.end(), num_sent_++);
  const auto second = std::chrono::floor<std::chrono::seconds>(datagram.time);
  pcap_pkthdr header{};
  header.ts.tv_sec = second.time_since_epoch().count();
  header.ts.tv_usec = (datagram.time - second).count();
  header.caplen = header.len = static_cast<bpf_u_int32>(frame.size());
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): libpcap takes the dumper as the user pointer of a callback.
  pcap_dump(reinterpret_cast<u_char*>(dumper_.get()), &header, frame.data());
  if (std::ferror(pcap_dump_file(dumper_.get())) != 0) Fail();
}

io::OutputFile& PcapSink::Finish() {
  if (pcap_dump_flush(dumper_.get()) != 0) Fail();
  return file_;
}

UdpSink::UdpSink(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (code != 0) throw std::runtime_error(host + ": " + gai_strerror(code));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof(address));
  address_ = address.sin_addr.s_addr;
  freeaddrinfo(found);

  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) throw std::runtime_error(std::string("socket: ") + std::strerror(errno));
  const int allowed = 1;
  setsockopt(socket_, SOL_SOCKET, SO_BROADCAST, &allowed, sizeof(allowed));
}

UdpSink::~UdpSink() {
  if (socket_ >= 0) close(socket_);
}

void UdpSink::Send(const Datagram& datagram) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(datagram.port));
  address.sin_addr.s_addr = address_;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket interface asks for it.
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (sendto(socket_, datagram.payload.data(), datagram.payload.size(), 0, generic, sizeof(address)) < 0) ++num_refused_;
}

Schedule::Clock::time_point Schedule::DueAt(Utime time) const {
  const std::chrono::duration<double, std::micro> wait(speed_ > 0.0 ? static_cast<double>((time - start_).count()) / speed_ : 0.0);
  return base_ + std::chrono::duration_cast<Clock::duration>(wait);
}

std::optional<std::string> Schedule::Report(Utime time, Clock::time_point now) {
  ++num_sent_;
  if (speed_ <= 0.0) return std::nullopt;
  const auto late = now - DueAt(time);
  if (late <= kLate) return std::nullopt;
  ++num_late_;
  greatest_ = std::max(greatest_, late);
  if (last_report_ && now - *last_report_ < kReportEvery) return std::nullopt;
  last_report_ = now;
  return fmt::format("{:.2f} s behind its schedule: this computer is too slow for the scene, or too busy; data arrive late", ToSeconds(late));
}

std::string Schedule::Summary() const {
  if (num_late_ == 0) return {};
  return fmt::format("{} of {} datagrams were sent more than {:.2f} s late, the latest {:.2f} s", num_late_, num_sent_, ToSeconds(kLate),
                     ToSeconds(greatest_));
}

}  // namespace lookout::sim
