// Captures: frames of every link type, files that are whole, empty, damaged or no captures, and the recordings at hand.
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/lidar/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using Text = std::vector<std::uint8_t>;

// Link types as files number them; those used here are also libpcap's numbers.
constexpr int kEthernet = 1;
constexpr int kNull = 0;
constexpr int kRaw = 12;
constexpr int kCooked = 113;
constexpr int kCooked2 = 276;
constexpr int kLoop = 108;
constexpr int kIpv6 = 229;

Text operator+(const Text& a, const Text& b) {
  Text sum = a;
  sum.insert(sum.end(), b.begin(), b.end());
  return sum;
}

Text Udp(int port, const Text& payload) {
  const auto size = static_cast<int>(payload.size()) + 8;
  return Text{0x01,
              0x02,
              static_cast<std::uint8_t>(port >> 8),
              static_cast<std::uint8_t>(port),
              static_cast<std::uint8_t>(size >> 8),
              static_cast<std::uint8_t>(size),
              0,
              0} +
         payload;
}

Text Ipv4(const Text& udp, int num_option_words = 0, int fragment = 0, int protocol = 17) {
  const auto size = static_cast<int>(udp.size()) + 20 + 4 * num_option_words;
  return Text{static_cast<std::uint8_t>(0x45 + num_option_words),
              0,
              static_cast<std::uint8_t>(size >> 8),
              static_cast<std::uint8_t>(size),
              0,
              0,
              static_cast<std::uint8_t>(fragment >> 8),
              static_cast<std::uint8_t>(fragment),
              64,
              static_cast<std::uint8_t>(protocol),
              0,
              0,
              192,
              168,
              1,
              201,
              255,
              255,
              255,
              255} +
         Text(static_cast<std::size_t>(4 * num_option_words), 1) + udp;
}

Text Ipv6(const Text& udp, int next_header = 17) {
  const auto size = static_cast<int>(udp.size());
  Text header{0x60, 0, 0, 0, static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size), static_cast<std::uint8_t>(next_header), 64};
  header.resize(40);
  header[8] = 0xFE;
  header[9] = 0x80;
  header[23] = 1;
  return header + udp;
}

const Text kPayload{1, 2, 3};
const Text kMacs(12, 0xAB);

void ExpectDatagram(int link_type, const Text& frame, const std::string& source = "192.168.1.201") {
  const auto found = ParseFrame(link_type, frame, false);
  EXPECT_EQ(found.fault, FrameFault::kNone) << kFrameFaultNames[static_cast<std::size_t>(found.fault)];
  EXPECT_EQ(Text(found.payload.begin(), found.payload.end()), kPayload);
  EXPECT_EQ(found.destination_port, 2368);
  EXPECT_EQ(found.source_address, source);
}

TEST(Frame, OfEveryLinkTypeGivesItsDatagram) {
  const Text ip = Ipv4(Udp(2368, kPayload));
  ExpectDatagram(kEthernet, kMacs + Text{0x08, 0x00} + ip);
  ExpectDatagram(kEthernet, kMacs + Text{0x08, 0x00} + ip + Text(15, 0));  // padded to the least size of a frame
  ExpectDatagram(kEthernet, kMacs + Text{0x81, 0x00, 0, 5, 0x08, 0x00} + ip);
  ExpectDatagram(kEthernet, kMacs + Text{0x88, 0xA8, 0, 5, 0x81, 0x00, 0, 6, 0x08, 0x00} + ip);
  ExpectDatagram(kCooked, Text(14, 0) + Text{0x08, 0x00} + ip);
  ExpectDatagram(kCooked, Text(14, 0) + Text{0x81, 0x00, 0, 5, 0x08, 0x00} + ip);
  ExpectDatagram(kCooked2, Text{0x08, 0x00} + Text(18, 0) + ip);
  ExpectDatagram(kRaw, ip);
  ExpectDatagram(kNull, Text{2, 0, 0, 0} + ip);
  ExpectDatagram(kNull, Text{0, 0, 0, 2} + ip);  // captured on a big-endian computer
  ExpectDatagram(kLoop, Text{0, 0, 0, 2} + ip);
  ExpectDatagram(kRaw, Ipv4(Udp(2368, kPayload), 3));
}

TEST(Frame, OfIpv6GivesItsDatagram) {
  const Text ip = Ipv6(Udp(2368, kPayload));
  ExpectDatagram(kEthernet, kMacs + Text{0x86, 0xDD} + ip, "fe80::1");
  ExpectDatagram(kRaw, ip, "fe80::1");
  ExpectDatagram(kIpv6, ip, "fe80::1");
  ExpectDatagram(kNull, Text{30, 0, 0, 0} + ip, "fe80::1");
}

TEST(Frame, WithoutADatagramIsRefusedByReason) {
  const Text udp = Udp(2368, kPayload);
  const auto fault = [](int link_type, const Text& frame, bool is_cut = false) { return ParseFrame(link_type, frame, is_cut).fault; };
  EXPECT_EQ(fault(kEthernet, kMacs + Text{0x08, 0x06} + Text(28, 0)), FrameFault::kNotIp);
  EXPECT_EQ(fault(kRaw, Ipv4(udp, 0, 0, 6)), FrameFault::kNotUdp);
  EXPECT_EQ(fault(kRaw, Ipv4(udp, 0, 0x2000)), FrameFault::kFragment);  // more follow
  EXPECT_EQ(fault(kRaw, Ipv4(udp, 0, 0x00B9)), FrameFault::kFragment);  // not the first
  EXPECT_EQ(fault(kRaw, Ipv4(udp, 0, 0x4000)), FrameFault::kNone);      // "do not fragment"
  EXPECT_EQ(fault(kRaw, Ipv6(udp, 44)), FrameFault::kFragment);
  EXPECT_EQ(fault(kRaw, Ipv6(udp, 0)), FrameFault::kIpv6Extension);
  EXPECT_EQ(fault(kRaw, Text{0x42} + Text(30, 0)), FrameFault::kBadIpHeader);
  EXPECT_EQ(fault(kRaw, Text{0x75} + Text(30, 0)), FrameFault::kBadIpHeader);
  EXPECT_EQ(fault(kNull, Text{77, 0, 0, 0} + Ipv4(udp)), FrameFault::kNotIp);

  Text ip = Ipv4(udp);
  ip[25] = 200;  // UDP longer than IP
  EXPECT_EQ(fault(kRaw, ip), FrameFault::kBadLength);
  ip[25] = 7;  // shorter than its own header
  EXPECT_EQ(fault(kRaw, ip), FrameFault::kBadLength);
}

// Position packets of a real VLP-16 carry the IP length of a data packet, 1234 bytes, in a frame of 554: they were refused.
TEST(Frame, WithAWrongIpLengthIsReadByTheLengthThatUdpSays) {
  for (const int ip_length : {0, 19, 29, 32, 1234, 65535}) {
    Text ip = Ipv4(Udp(2368, kPayload));
    ip[2] = static_cast<std::uint8_t>(ip_length >> 8);
    ip[3] = static_cast<std::uint8_t>(ip_length);
    ExpectDatagram(kRaw, ip);
    ExpectDatagram(kEthernet, kMacs + Text{0x08, 0x00} + ip + Text(15, 0));
    // What was captured does not hold it: as refused as ever.
    const auto cut = Bytes(ip).first(ip.size() - 1);
    if (ip_length > 32) {
      EXPECT_EQ(ParseFrame(kRaw, cut, true).fault, FrameFault::kTruncated);
    }
    EXPECT_EQ(ParseFrame(kRaw, cut, false).fault, FrameFault::kBadLength);
  }
  Text ip = Ipv6(Udp(2368, kPayload));
  ip[4] = 4;
  ExpectDatagram(kRaw, ip, "fe80::1");
}

TEST(FrameCounts, HaveADatagramWithoutATimeByItself) {
  FrameCounts frames;
  EXPECT_TRUE(frames.Add({}, Utime()));
  EXPECT_FALSE(frames.Add({}, std::nullopt));
  EXPECT_FALSE(frames.Add({.fault = FrameFault::kNotIp}, std::nullopt));
  std::vector<Counter> counters;
  frames.AppendTo(counters);
  std::map<std::string_view, std::int64_t> by_name;
  for (const auto& [name, count] : counters) by_name[name] = count;
  EXPECT_EQ(by_name["frames_read"], 3);
  EXPECT_EQ(by_name["frames_datagram"], 1);
  EXPECT_EQ(by_name["frames_bad_time"], 1);
  EXPECT_EQ(by_name["frames_not_ip"], 1);
}

TEST(Frame, IsCutAnywhereWithoutHarm) {
  for (const auto& [link_type, whole] : std::map<int, Text>{{kEthernet, kMacs + Text{0x81, 0x00, 0, 5, 0x08, 0x00} + Ipv4(Udp(2368, kPayload))},
                                                            {kCooked2, Text{0x86, 0xDD} + Text(18, 0) + Ipv6(Udp(2368, kPayload))},
                                                            {kLoop, Text{0, 0, 0, 2} + Ipv4(Udp(2368, kPayload), 2)}}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_EQ(ParseFrame(link_type, Bytes(whole).first(size), true).fault, FrameFault::kTruncated) << size;
      EXPECT_EQ(ParseFrame(link_type, Bytes(whole).first(size), false).fault, FrameFault::kBadLength) << size;
    }
  }
}

// A classic capture in a file of its own.
class CaptureFile {
 public:
  explicit CaptureFile(const Text& bytes) {
    std::ofstream(path_, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  support::TempDir folder_;
  std::filesystem::path path_ = folder_ / "capture.pcap";
};

Text U32(std::uint32_t value) {
  Text bytes(4);
  WriteU32LittleEndian(bytes, 0, value);
  return bytes;
}

Text Header(std::uint32_t link_type, std::uint32_t magic = 0xA1B2C3D4) {
  return U32(magic) + Text{2, 0, 4, 0} + U32(0) + U32(0) + U32(65535) + U32(link_type);
}

Text Record(const Text& frame, std::uint32_t second, std::uint32_t fraction) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  return U32(second) + U32(fraction) + U32(size) + U32(size) + frame;
}

const Text kFrame = kMacs + Text{0x08, 0x00} + Ipv4(Udp(2368, kPayload));

TEST(CaptureReader, GivesDatagramsWithTheirTimes) {
  const CaptureFile file(Header(1) + Record(kFrame, 0, 0) + Record(kMacs + Text{0x08, 0x06}, 1, 0) + Record(kFrame, 1'600'000'000, 999'999));
  CaptureReader reader(file.path());
  const auto first = reader.Next();
  ASSERT_TRUE(first);
  EXPECT_EQ(ToUtimeUs(first->host_time), 0);
  EXPECT_EQ(first->payload, kPayload);
  EXPECT_EQ(ToUtimeUs(reader.Next()->host_time), 1'600'000'000'999'999);
  EXPECT_FALSE(reader.Next());
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_frames(), 3);
  EXPECT_EQ(reader.num_datagrams(), 2);
  EXPECT_EQ(reader.num_damaged(), 0);
}

TEST(CaptureReader, ReadsNanosecondCaptures) {
  const CaptureFile file(Header(1, 0xA1B23C4D) + Record(kFrame, 5, 123'456'789));
  EXPECT_EQ(ToUtimeUs(CaptureReader(file.path()).Next()->host_time), 5'123'456);
}

// The seconds have no sign: from January 2038 on they came as years before 1902, and up to 2106 they are right.
TEST(CaptureReader, ReadsSecondsBeyond2038) {
  for (const std::uint32_t second : {0x7FFF'FFFFU, 0x8000'0000U, 2'177'488'800U, 0xFFFF'FFFFU}) {
    for (const std::uint32_t magic : {0xA1B2C3D4U, 0xA1B23C4DU}) {
      const CaptureFile file(Header(1, magic) + Record(kFrame, second, 7000));
      const auto datagram = CaptureReader(file.path()).Next();
      ASSERT_TRUE(datagram) << second;
      EXPECT_EQ(ToUtimeUs(datagram->host_time), std::int64_t{second} * 1'000'000 + (magic == 0xA1B2C3D4U ? 7000 : 7));
    }
  }
}

TEST(CaptureReader, ReadsWhatGzipPacked) {
  const Text whole = Header(1) + Record(kFrame, 1, 0) + Record(kFrame, 2, 0);
  const CaptureFile file(whole);
  const auto pack = [&file](const Text& bytes) {
    const gzFile out = gzopen(file.path().c_str(), "wb");
    gzwrite(out, bytes.data(), static_cast<unsigned int>(bytes.size()));
    gzclose(out);
  };
  pack(whole);
  {
    CaptureReader reader(file.path());
    EXPECT_EQ(ToUtimeUs(reader.Next()->host_time), 1'000'000);
    EXPECT_EQ(ToUtimeUs(reader.Next()->host_time), 2'000'000);
    EXPECT_FALSE(reader.Next());
    EXPECT_EQ(reader.damage(), "");
    EXPECT_EQ(reader.position_bytes(), static_cast<std::int64_t>(std::filesystem::file_size(file.path())));
  }
  pack(Text(whole.begin(), whole.end() - 5));  // the capture is cut
  CaptureReader torn(file.path());
  EXPECT_TRUE(torn.Next());
  EXPECT_FALSE(torn.Next());
  EXPECT_EQ(torn.num_damaged(), 1);
  pack(whole);
  std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) - 6);  // what is packed is cut
  CaptureReader cut(file.path());
  while (cut.Next()) continue;
  EXPECT_EQ(cut.damage(), "what gzip packed is cut short, after 2 frames");
  pack({'h', 'e', 'l', 'l', 'o'});
  EXPECT_THROW(CaptureReader{file.path()}, std::runtime_error);
}

TEST(CaptureReader, ReadsEveryNumberOfRawIp) {
  for (const std::uint32_t link_type : {101U, 228U, 12U, 14U}) {
    const CaptureFile file(Header(link_type) + Record(Ipv4(Udp(2368, kPayload)), 5, 0));
    EXPECT_TRUE(CaptureReader(file.path()).Next()) << link_type;
  }
}

TEST(CaptureReader, AcceptsACaptureWithoutPackets) {
  const CaptureFile file(Header(1));
  CaptureReader reader(file.path());
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_damaged(), 0);
}

TEST(CaptureReader, KeepsWhatStandsBeforeATruncatedTail) {
  const Text whole = Header(1) + Record(kFrame, 1, 0) + Record(kFrame, 2, 0);
  for (std::size_t num_missing = 1; num_missing < kFrame.size() + 16; ++num_missing) {
    const CaptureFile file(Text(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(num_missing)));
    CaptureReader reader(file.path());
    EXPECT_TRUE(reader.Next());
    EXPECT_FALSE(reader.Next());
    EXPECT_EQ(reader.num_damaged(), 1) << num_missing;
    EXPECT_NE(reader.damage().find("after 1 frames"), std::string::npos) << reader.damage();
    EXPECT_FALSE(reader.Next());
  }
}

TEST(CaptureReader, TellsACaptureWhoseEveryFrameWasRefused) {
  const CaptureFile file(Header(1) + Record(kMacs + Text{0x08, 0x06}, 1, 0));
  CaptureReader reader(file.path());
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.num_frames(), 1);
  EXPECT_EQ(reader.num_datagrams(), 0);
}

std::string FaultOf(const std::filesystem::path& file) {
  try {
    const CaptureReader reader(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(CaptureReader, NamesFileAndReasonWhenItCannotRead) {
  const CaptureFile text({'h', 'e', 'l', 'l', 'o'});
  EXPECT_NE(FaultOf(text.path()).find(text.path().string()), std::string::npos);
  EXPECT_NE(FaultOf("/nowhere.pcap").find("/nowhere.pcap"), std::string::npos);
  EXPECT_NE(FaultOf(std::filesystem::temp_directory_path()).find("folder"), std::string::npos);
  const CaptureFile wlan(Header(105));
  EXPECT_NE(FaultOf(wlan.path()).find("105 (IEEE802_11)"), std::string::npos) << FaultOf(wlan.path());
}

using support::kRecordings;

TEST(CaptureReader, SurvivesEveryRecordingThatIsBroken) {
  if (!std::filesystem::exists(kRecordings / "bad_pcap")) GTEST_SKIP() << "no recordings at " << kRecordings;
  for (const char* folder : {"bad_pcap", "other_lidar"}) {
    for (const auto& entry : std::filesystem::directory_iterator(kRecordings / folder)) {
      try {
        CaptureReader reader(entry.path());
        std::int64_t num_datagrams = 0;
        while (reader.Next()) ++num_datagrams;
        std::int64_t num_counted = 0;
        for (const auto& counter : reader.counters()) num_counted += counter.count;
        EXPECT_EQ(num_counted, 2 * reader.num_frames() + reader.num_damaged()) << entry.path();  // each frame once, and all of them
        EXPECT_EQ(num_datagrams, reader.num_datagrams());
      } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find(entry.path().string()), std::string::npos);
      }
    }
  }
}

struct ScanCount {
  int num_full = 0;
  int num_partial = 0;
  std::int64_t num_nonzero = 0;
};

ScanCount CountScans(const std::filesystem::path& file) {
  bus::MemoryBus bus;
  Service service(bus, Params{});
  ScanCount count;
  bus::Subscribe<lidar_scan_t>(bus, bus::kLidarScan, [&count](const lidar_scan_t& scan) {
    ((scan.flags & ~std::int32_t{lidar_scan_t::FLAG_HOLE}) == 0 ? count.num_full : count.num_partial) += 1;
    for (const auto range : scan.range) count.num_nonzero += range != 0 ? 1 : 0;
  });
  CaptureReader reader(file);
  Utime last;
  while (const auto datagram = reader.Next()) {
    last = datagram->host_time;
    service.OnDatagram(datagram->host_time, datagram->destination_port, datagram->payload);
  }
  service.Finish(last);
  support::HandleAll(bus);
  return count;
}

std::int64_t CountNonzero(const std::filesystem::path& file) {
  CaptureReader reader(file);
  std::int64_t num_nonzero = 0;
  while (const auto datagram = reader.Next()) {
    if (datagram->payload.size() != format::kDataPacketSizeBytes) continue;
    for (std::size_t block = 0; block < 12; ++block) {
      for (std::size_t i = 0; i < 32; ++i) num_nonzero += ReadU16LittleEndian(datagram->payload, block * 100 + 4 + 3 * i) != 0 ? 1 : 0;
    }
  }
  return num_nonzero;
}

TEST(Recordings, GiveTheirScansAndEveryReturn) {
  struct Expected {
    const char* file;
    int num_full;
    int num_partial;
  };
  for (const auto& expected : {Expected{"mrpt_sample_velodyne_vlp16_gps.pcap", 3, 2}, Expected{"einride_vlp16_1000pkt.pcap", 12, 2},
                               Expected{"rlu_vlp16_example.pcap", 0, 2}}) {
    const auto file = kRecordings / "vlp16" / expected.file;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
    const auto count = CountScans(file);
    EXPECT_EQ(count.num_full, expected.num_full) << file;
    EXPECT_EQ(count.num_partial, expected.num_partial) << file;
    EXPECT_EQ(count.num_nonzero, CountNonzero(file)) << file;
  }
}

TEST(Recordings, OfAnHdl32eGiveNoScan) {
  const auto file = kRecordings / "other_lidar/vv_hdl32_monterey.pcap";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const auto count = CountScans(file);
  EXPECT_EQ(count.num_full + count.num_partial, 0);
}

}  // namespace
}  // namespace lookout::vlp16
