#include "services/lidar/io/pcapng.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <pcap/pcap.h>

#include "services/lidar/io/frame.hpp"

namespace lookout::lidar {

namespace {

// Types of blocks.
constexpr std::uint32_t kSectionHeader = 0x0A0D0D0A;  // the same in both byte orders
constexpr std::uint32_t kInterfaceDescription = 1;
constexpr std::uint32_t kOldPacket = 2;
constexpr std::uint32_t kSimplePacket = 3;
constexpr std::uint32_t kEnhancedPacket = 6;
constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;
constexpr std::uint32_t kSwappedByteOrderMagic = 0x4D3C2B1A;
// Options of an interface.
constexpr int kOptionEnd = 0;
constexpr int kOptionResolution = 9;  // if_tsresol
constexpr int kOptionOffset = 14;     // if_tsoffset
constexpr std::size_t kOptionHeadBytes = 4;
constexpr std::size_t kMostInterfaces = 65536;  // a packet of the older form numbers no more

constexpr std::size_t kBlockHeadBytes = 8;   // type, length
constexpr std::size_t kBlockEdgeBytes = 12;  // and the length once more at the block's end
constexpr std::size_t kMaxBlockBytes = 16UL * 1024 * 1024;
// Beyond, a second is no 64 bits of such stamps.
constexpr unsigned int kMaxDecimalExponent = 19;
constexpr unsigned int kMaxBinaryExponent = 63;
constexpr std::int64_t kMaxOffsetS = std::int64_t{1} << 40;

std::size_t Padded(std::size_t size) { return (size + 3) / 4 * 4; }

std::uint64_t PowerOfTen(unsigned int exponent) {
  std::uint64_t power = 1;
  for (unsigned int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

// Nanoseconds of a fraction of a second that is given in units of 10^-exponent s.
std::uint64_t NanosecondsOfDecimal(std::uint64_t fraction, unsigned int exponent) {
  constexpr unsigned int kNano = 9;
  return exponent <= kNano ? fraction * PowerOfTen(kNano - exponent) : fraction / PowerOfTen(exponent - kNano);
}

// Nanoseconds of a fraction in units of 2^-exponent s.
std::uint64_t NanosecondsOfBinary(std::uint64_t fraction, unsigned int exponent) {
  constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
  constexpr unsigned int kMostBits = 32;  // so that the product has 62
  if (exponent > kMostBits) {
    fraction >>= exponent - kMostBits;
    exponent = kMostBits;
  }
  return fraction * kNanosecondsPerSecond >> exponent;
}

// The DLT number of a link type on this computer. They differ for raw IP, about which systems disagree.
int DltOfLinkType(int link_type) {
  constexpr int kRawIpInFiles = 101;
  return link_type == kRawIpInFiles ? DLT_RAW : link_type;
}

}  // namespace

bool PcapngReader::Fail(const std::string& reason) {
  damage_ = reason;
  return false;
}

std::uint32_t PcapngReader::U32(std::size_t offset) const {
  const auto value = ReadU32LittleEndian(body_, offset);
  return is_big_endian_ ? __builtin_bswap32(value) : value;
}

std::uint16_t PcapngReader::U16(std::size_t offset) const {
  const auto value = ReadU16LittleEndian(body_, offset);
  return is_big_endian_ ? __builtin_bswap16(value) : value;
}

// Reads type and length of a block; of a section also its byte order, which tells how to read the length. @return false at the end, and where the
// file is damaged
bool PcapngReader::ReadHeader(std::vector<std::uint8_t>& header) {
  header.resize(kBlockHeadBytes);
  const auto size = file_.Read(header);
  if (size == 0 && file_.fault().empty()) return false;
  if (size < header.size()) return Fail(file_.fault().empty() ? "the last block is cut short" : file_.fault());
  if (ReadU32LittleEndian(header, 0) != kSectionHeader) return has_section_ || Fail("it begins with no section header");
  header.resize(kBlockHeadBytes + 4);
  if (file_.Read(std::span(header).subspan(kBlockHeadBytes)) < 4) return Fail("the last block is cut short");
  const auto magic = ReadU32LittleEndian(header, kBlockHeadBytes);
  if (magic != kByteOrderMagic && magic != kSwappedByteOrderMagic) return Fail("a section header without a byte order");
  is_big_endian_ = magic == kSwappedByteOrderMagic;
  return true;
}

// @return false at the end, and where the file is damaged
bool PcapngReader::ReadBlock() {
  std::vector<std::uint8_t> header;
  if (!ReadHeader(header)) return false;
  body_.assign(header.begin(), header.end());
  block_type_ = U32(0);
  const std::size_t length = U32(4);
  if (length < std::max(kBlockEdgeBytes, header.size() + 4) || length % 4 != 0 || length > kMaxBlockBytes) {
    return Fail("a block of " + std::to_string(length) + " bytes cannot be");
  }
  body_.resize(length);
  if (file_.Read(std::span(body_).subspan(header.size())) < length - header.size()) {
    return Fail(file_.fault().empty() ? "the last block is cut short" : file_.fault());
  }
  // libpcap does not check the second length of a section header either.
  if (block_type_ != kSectionHeader && U32(length - 4) != length)
    return Fail("the two lengths of a block differ: " + std::to_string(length) + ", " + std::to_string(U32(length - 4)));
  body_.resize(length - 4);
  body_.erase(body_.begin(), body_.begin() + kBlockHeadBytes);
  return true;
}

bool PcapngReader::BeginSection() {
  constexpr std::size_t kBytes = 16;
  if (body_.size() < kBytes) return Fail("a section header is too short");
  const int major = U16(4);
  const int minor = U16(6);
  // 1.2 is written by some, and reads as 1.0 does.
  if (major != 1 || (minor != 0 && minor != 2)) return Fail("version " + std::to_string(major) + "." + std::to_string(minor) + " is not known");
  has_section_ = true;
  interfaces_.clear();
  return true;
}

bool PcapngReader::AddInterface() {
  constexpr std::size_t kHeadBytes = 8;
  if (body_.size() < kHeadBytes) return Fail("the description of an interface is too short");
  Interface interface { .link_type = DltOfLinkType(U16(0)), .snap_length_bytes = U32(4) };
  for (std::size_t place = kHeadBytes; place + kOptionHeadBytes <= body_.size();) {
    const int code = U16(place);
    const std::size_t size = U16(place + 2);
    place += kOptionHeadBytes;
    if (code == kOptionEnd) break;
    if (size > body_.size() - place) return Fail("an option of an interface goes beyond its block");
    if (code == kOptionResolution && size == 1) {
      constexpr std::uint8_t kBinary = 0x80;
      interface.is_binary = (body_[place] & kBinary) != 0;
      interface.exponent = body_[place] & static_cast<std::uint8_t>(~kBinary);
      if (interface.exponent > (interface.is_binary ? kMaxBinaryExponent : kMaxDecimalExponent)) return Fail("stamps finer than 64 bits can hold");
    } else if (code == kOptionOffset && size == 8) {
      const std::uint64_t low = U32(is_big_endian_ ? place + 4 : place);
      const std::uint64_t high = U32(is_big_endian_ ? place : place + 4);
      interface.offset_s = static_cast<std::int64_t>(high << 32 | low);
    }
    place += Padded(size);
  }
  if (interfaces_.size() >= kMostInterfaces) return Fail("more than 65536 interfaces in a section");
  interfaces_.push_back(interface);
  if (std::ranges::find(link_types_, interface.link_type) == link_types_.end()) link_types_.push_back(interface.link_type);
  return true;
}

std::optional<CapturedFrame> PcapngReader::FrameOf(std::uint32_t interface, std::optional<std::uint64_t> stamp, std::size_t header_bytes,
                                                   std::uint32_t captured_bytes, std::uint32_t wire_bytes) {
  if (captured_bytes > body_.size() - header_bytes) {
    Fail("a packet of " + std::to_string(captured_bytes) + " bytes goes beyond its block");
    return std::nullopt;
  }
  const auto& facts = interfaces_[interface];
  CapturedFrame frame{.link_type = facts.link_type,
                      .bytes = Bytes(body_).subspan(header_bytes, captured_bytes),
                      .is_cut = captured_bytes < wire_bytes,
                      .time = UtimeOfStamp(0, 0)};
  if (!stamp) return frame;
  const std::uint64_t units_per_second = facts.is_binary ? std::uint64_t{1} << facts.exponent : PowerOfTen(facts.exponent);
  const std::uint64_t seconds = *stamp / units_per_second;
  const std::uint64_t fraction = *stamp % units_per_second;
  const auto nanoseconds = facts.is_binary ? NanosecondsOfBinary(fraction, facts.exponent) : NanosecondsOfDecimal(fraction, facts.exponent);
  const bool can_be = seconds <= static_cast<std::uint64_t>(kMaxOffsetS) && facts.offset_s >= -kMaxOffsetS && facts.offset_s <= kMaxOffsetS;
  frame.time = can_be ? UtimeOfStamp(static_cast<std::int64_t>(seconds) + facts.offset_s, static_cast<std::int64_t>(nanoseconds)) : std::nullopt;
  return frame;
}

// The frame of a block that holds a packet. @return nullopt where the block is damaged
std::optional<CapturedFrame> PcapngReader::PacketOfBlock() {
  constexpr std::size_t kHeadBytes = 20;       // of an enhanced and of an old packet block
  constexpr std::size_t kSimpleHeadBytes = 4;  // length on the wire
  const bool is_simple = block_type_ == kSimplePacket;
  if (body_.size() < (is_simple ? kSimpleHeadBytes : kHeadBytes)) {
    Fail("a packet's block is too short");
    return std::nullopt;
  }
  const std::uint32_t interface = is_simple ? 0 : block_type_ == kOldPacket ? U16(0) : U32(0);
  if (interface >= interfaces_.size()) {
    Fail("a packet of interface " + std::to_string(interface) + ", which is not described");
    return std::nullopt;
  }
  if (is_simple) {
    const std::uint32_t snap_bytes = interfaces_[0].snap_length_bytes;
    const std::uint32_t wire_bytes = U32(0);
    return FrameOf(0, std::nullopt, kSimpleHeadBytes, snap_bytes == 0 ? wire_bytes : std::min(wire_bytes, snap_bytes), wire_bytes);
  }
  return FrameOf(interface, std::uint64_t{U32(4)} << 32 | U32(8), kHeadBytes, U32(12), U32(16));
}

std::optional<CapturedFrame> PcapngReader::Next() {
  while (damage_.empty() && ReadBlock()) {
    if (block_type_ == kSectionHeader) {
      BeginSection();
    } else if (block_type_ == kInterfaceDescription) {
      AddInterface();
    } else if (block_type_ == kEnhancedPacket || block_type_ == kOldPacket || block_type_ == kSimplePacket) {
      return PacketOfBlock();
    }
  }
  return std::nullopt;
}

}  // namespace lookout::lidar
