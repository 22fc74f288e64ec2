// pcapng: interfaces of several link types, snap lengths and resolutions of stamps, either byte order, and what libpcap reads read alike.
#include "services/lidar/io/pcapng.hpp"

#include <array>
#include <filesystem>
#include <gtest/gtest.h>
#include <pcap/pcap.h>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/lidar/io/capture_reader.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kEthernetLink = 1;
constexpr std::uint32_t kNullLink = 0;
constexpr std::uint32_t kWlanLink = 105;

// Writes blocks in one of the two byte orders.
class Blocks {
 public:
  explicit Blocks(bool is_big_endian = false) : is_big_endian_(is_big_endian) {}

  std::string U16(std::uint32_t value) const { return Number(value, 2); }
  std::string U32(std::uint32_t value) const { return Number(value, 4); }
  std::string U64(std::uint64_t value) const {
    const auto high = U32(static_cast<std::uint32_t>(value >> 32));
    const auto low = U32(static_cast<std::uint32_t>(value));
    return is_big_endian_ ? high + low : low + high;
  }
  std::string Block(std::uint32_t type, std::string body) const {
    body.resize((body.size() + 3) / 4 * 4);
    const auto length = U32(static_cast<std::uint32_t>(body.size()) + 12);
    return U32(type) + length + body + length;
  }
  std::string Section() const { return Block(0x0A0D0D0A, U32(0x1A2B3C4D) + U16(1) + U16(0) + U64(~std::uint64_t{0})); }
  std::string Option(std::uint32_t code, std::string value) const {
    const auto size = static_cast<std::uint32_t>(value.size());
    value.resize((value.size() + 3) / 4 * 4);
    return U16(code) + U16(size) + value;
  }
  std::string Interface(std::uint32_t link_type, std::uint32_t snap_length = 0, const std::string& options = "") const {
    return Block(1, U16(link_type) + U16(0) + U32(snap_length) + options + (options.empty() ? "" : Option(0, "")));
  }
  std::string Packet(std::uint32_t interface, std::uint64_t stamp, const std::string& frame, std::uint32_t num_more = 0) const {
    const auto size = static_cast<std::uint32_t>(frame.size());
    return Block(6, U32(interface) + U32(static_cast<std::uint32_t>(stamp >> 32)) + U32(static_cast<std::uint32_t>(stamp)) + U32(size) +
                        U32(size + num_more) + frame);
  }

 private:
  std::string Number(std::uint32_t value, int size) const {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * (is_big_endian_ ? size - 1 - i : i)));
    return bytes;
  }

  bool is_big_endian_;
};

// A datagram of one byte to port 2368.
std::string Ip(char content) {
  std::string ip{0x45, 0, 0, 29, 0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2};
  return ip + std::string{1, 2, 0x09, 0x40, 0, 9, 0, 0, content};
}
std::string OfEthernet(char content) { return std::string(12, '\x01') + std::string{0x08, 0x00} + Ip(content); }
std::string OfNull(char content) { return std::string{2, 0, 0, 0} + Ip(content); }

class Pcapng : public ::testing::Test {
 protected:
  // "a@5123456": content and time of each datagram.
  std::vector<std::string> Read(const std::string& bytes) {
    support::WriteFile(file_, bytes);
    CaptureReader reader(file_);
    std::vector<std::string> lines;
    while (const auto datagram = reader.Next()) {
      lines.push_back(std::string(1, static_cast<char>(datagram->payload.at(0))) + "@" + std::to_string(ToUtimeUs(datagram->host_time)));
    }
    damage_ = reader.damage();
    counters_ = reader.counters();
    return lines;
  }
  std::int64_t Counted(std::string_view name) const { return support::CountOf(counters_, name); }
  std::string FaultOf(const std::string& bytes) {
    try {
      Read(bytes);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  support::TempDir folder_;
  const fs::path file_ = folder_ / "capture.pcapng";
  std::string damage_;
  std::vector<Counter> counters_;
};

using Lines = std::vector<std::string>;

// libpcap ends at a second interface whose link type or snap length is another.
TEST_F(Pcapng, ReadsEachPacketAsItsInterfaceSays) {
  for (const bool is_big_endian : {false, true}) {
    SCOPED_TRACE(is_big_endian);
    const Blocks blocks(is_big_endian);
    const auto resolution = [&blocks](char value) { return blocks.Option(9, std::string(1, value)); };
    const auto bytes = blocks.Section() + blocks.Interface(kEthernetLink, 262'144) + blocks.Interface(kNullLink, 2000, resolution(9)) +
                       blocks.Packet(0, 5'123'456, OfEthernet('a')) + blocks.Packet(1, 5'123'457'999, OfNull('b')) +
                       blocks.Interface(kEthernetLink, 100, resolution(3) + blocks.Option(14, blocks.U64(1000))) +
                       blocks.Packet(2, 7'001, OfEthernet('c')) + blocks.Packet(0, 5'123'459, OfEthernet('d')) +
                       blocks.Interface(kEthernetLink, 0, resolution(static_cast<char>(0x80 | 10))) +
                       blocks.Packet(3, (5U << 10U) + 512, OfEthernet('e'));
    EXPECT_EQ(Read(bytes), (Lines{"a@5123456", "b@5123457", "c@1007001000", "d@5123459", "e@5500000"}));
    EXPECT_EQ(damage_, "");
  }
}

TEST_F(Pcapng, BehindAnotherSectionBeginsAnew) {
  const Blocks little(false);
  const Blocks big(true);
  const auto one = little.Section() + little.Interface(kNullLink) + little.Packet(0, 1, OfNull('a'));
  const auto other = big.Section() + big.Interface(kEthernetLink) + big.Packet(0, 2, OfEthernet('b'));
  EXPECT_EQ(Read(one + other + one), (Lines{"a@1", "b@2", "a@1"}));
  EXPECT_EQ(Read(one + other + little.Packet(0, 3, OfNull('c'))), (Lines{"a@1", "b@2"})) << "a block in the wrong order is damage";
  EXPECT_NE(damage_, "");
}

TEST_F(Pcapng, PassesOverBlocksThatHoldNoPacket) {
  const Blocks blocks;
  const auto bytes = blocks.Section() + blocks.Block(4, "names of hosts") + blocks.Interface(kEthernetLink) +
                     blocks.Block(0x0BAD, std::string(5000, 'x')) + blocks.Packet(0, 1, OfEthernet('a')) + blocks.Block(5, std::string(12, 's'));
  EXPECT_EQ(Read(bytes), Lines{"a@1"});
}

// Simple packet blocks have no stamp; old packet blocks have 16 bits of interface.
TEST_F(Pcapng, ReadsTheOtherBlocksOfPackets) {
  const Blocks blocks;
  const auto frame = OfEthernet('a');
  const auto size = static_cast<std::uint32_t>(frame.size());
  const auto bytes = blocks.Section() + blocks.Interface(kEthernetLink) + blocks.Block(3, blocks.U32(size) + frame) +
                     blocks.Block(2, blocks.U16(0) + blocks.U16(7) + blocks.U32(0) + blocks.U32(9) + blocks.U32(size) + blocks.U32(size) + frame);
  EXPECT_EQ(Read(bytes), (Lines{"a@0", "a@9"}));
}

TEST_F(Pcapng, CountsFramesOfAnInterfaceThatIsNotUnderstood) {
  const Blocks blocks;
  const auto wlan = blocks.Section() + blocks.Interface(kWlanLink) + blocks.Packet(0, 1, OfEthernet('x'));
  EXPECT_EQ(Read(wlan + blocks.Interface(kEthernetLink) + blocks.Packet(1, 2, OfEthernet('a'))), Lines{"a@2"});
  EXPECT_EQ(Counted("frames_link_type"), 1);
  EXPECT_EQ(Counted("frames_read"), 2);
  const auto fault = FaultOf(wlan);
  EXPECT_NE(fault.find("105 (IEEE802_11)"), std::string::npos) << fault;
}

TEST_F(Pcapng, KeepsWhatStandsBeforeDamage) {
  const Blocks blocks;
  const auto head = blocks.Section() + blocks.Interface(kEthernetLink) + blocks.Packet(0, 1, OfEthernet('a'));
  const auto last = blocks.Packet(0, 2, OfEthernet('b'));
  for (std::size_t size = 1; size < last.size(); ++size) {
    EXPECT_EQ(Read(head + last.substr(0, size)), Lines{"a@1"}) << size;
    EXPECT_EQ(damage_, "the last block is cut short, after 1 frames") << size;
  }
  for (const auto& bad :
       {blocks.U32(6) + blocks.U32(13) + std::string(100, 'x'), blocks.Packet(7, 2, OfEthernet('b')), blocks.U32(6) + blocks.U32(0xFFFF'FFF0),
        blocks.Block(6, "short"), blocks.Block(6, blocks.U32(0) + blocks.U32(0) + blocks.U32(0) + blocks.U32(5000) + blocks.U32(5000) + "x")}) {
    EXPECT_EQ(Read(head + bad + last), Lines{"a@1"});
    EXPECT_NE(damage_.find(", after 1 frames"), std::string::npos) << damage_;
  }
  EXPECT_NE(FaultOf(blocks.Section()).find("it describes no interface"), std::string::npos);
  EXPECT_NE(FaultOf(blocks.Section().substr(0, 20)).find("cut short"), std::string::npos);
}

TEST_F(Pcapng, StampsThatCannotBeAreCounted) {
  const Blocks blocks;
  const auto bytes = blocks.Section() + blocks.Interface(kEthernetLink, 0, blocks.Option(9, std::string(1, '\0'))) +
                     blocks.Interface(kEthernetLink, 0, blocks.Option(14, blocks.U64(std::uint64_t{1} << 63U))) +
                     blocks.Packet(0, ~std::uint64_t{0}, OfEthernet('x')) + blocks.Packet(1, 5, OfEthernet('x')) +
                     blocks.Packet(0, 4'000'000'000, OfEthernet('a'));  // the year 2096
  EXPECT_EQ(Read(bytes), Lines{"a@4000000000000000"});
  EXPECT_EQ(Counted("frames_bad_time"), 2);
}

// Frames as libpcap reads them, and whether it came to the end.
std::pair<std::vector<std::string>, bool> ByLibpcap(const fs::path& file) {
  std::array<char, PCAP_ERRBUF_SIZE> fault{};
  const CaptureHandle capture(pcap_open_offline_with_tstamp_precision(file.c_str(), PCAP_TSTAMP_PRECISION_NANO, fault.data()), &pcap_close);
  std::pair<std::vector<std::string>, bool> read{{}, false};
  if (!capture) return read;
  pcap_pkthdr* header = nullptr;
  const u_char* data = nullptr;
  int outcome = 0;
  while ((outcome = pcap_next_ex(capture.get(), &header, &data)) == 1) {
    read.first.push_back(std::to_string(header->ts.tv_sec * 1'000'000 + header->ts.tv_usec / 1000) + " " +
                         (header->caplen < header->len ? "cut" : std::to_string(header->len)) + " " +
                         std::string(reinterpret_cast<const char*>(data), header->caplen));
  }
  read.second = outcome == PCAP_ERROR_BREAK;
  return read;
}

std::vector<std::string> ByOurs(const fs::path& file, std::string& damage) {
  std::vector<std::string> frames;
  PcapngReader reader(file);
  while (const auto frame = reader.Next()) {
    const auto size = frame->bytes.size();
    frames.push_back((frame->time ? std::to_string(ToUtimeUs(*frame->time)) : "none") + " " + (frame->is_cut ? "cut" : std::to_string(size)) + " " +
                     std::string(frame->bytes.begin(), frame->bytes.end()));
  }
  damage = reader.damage();
  return frames;
}

// Whatever libpcap reads to its end comes the same, and no frame that it reads is lost.
TEST_F(Pcapng, OfOneInterfaceIsReadAsLibpcapReadsIt) {
  std::vector<std::string> files;
  for (const bool is_big_endian : {false, true}) {
    const Blocks blocks(is_big_endian);
    for (const int resolution : {0, 3, 6, 9, 12, 0x80, 0x8A, 0x9F, 0xA0, 0xB0}) {
      auto bytes = blocks.Section() + blocks.Interface(kEthernetLink, 0, blocks.Option(9, std::string(1, static_cast<char>(resolution))));
      for (std::uint64_t i = 0; i < 6; ++i) bytes += blocks.Packet(0, i * 1'234'567'891, OfEthernet('a'));
      files.push_back(bytes + blocks.Block(5, std::string(12, 's')));
    }
  }
  const auto recording = support::kRecordings / "bad_pcap/tcpdump_msnlb2.pcapng";
  if (fs::exists(recording)) files.push_back(support::ReadFile(recording));
  std::minstd_rand random(7);
  int num_whole = 0;
  for (const auto& bytes : files) {
    for (int round = 0; round < 60; ++round) {
      auto changed = bytes;
      if (round > 0) changed[random() % changed.size()] ^= static_cast<char>(1U << random() % 8);
      if (round % 5 == 4) changed.resize(random() % changed.size());
      support::WriteFile(file_, changed);
      const auto [expected, is_end] = ByLibpcap(file_);
      std::string damage;
      const auto frames = ByOurs(file_, damage);
      EXPECT_GE(frames.size(), expected.size()) << "round " << round << ": " << damage;
      num_whole += is_end ? 1 : 0;
      EXPECT_TRUE(!is_end || damage.empty()) << "round " << round << ": " << damage;
      for (std::size_t i = 0; is_end && round == 0 && i < expected.size(); ++i) EXPECT_EQ(frames.at(i), expected[i]) << i;
    }
  }
  EXPECT_GT(num_whole, 20);
}

}  // namespace
}  // namespace lookout::vlp16
