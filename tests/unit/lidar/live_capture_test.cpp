// What of a live capture needs no right: the filter, and what is said when it cannot start. The rest is in tests/system/sources_test.cpp.
#include "services/lidar/io/live_capture.hpp"

#include <gtest/gtest.h>
#include <pcap/pcap.h>
#include <stdexcept>
#include <vector>

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using Frame = std::vector<std::uint8_t>;

// An Ethernet frame of UDP over IPv4 behind some VLAN tags.
Frame Tagged(int num_tags, int port) {
  Frame frame(12, 1);
  for (int i = 0; i < num_tags; ++i)
    frame.insert(frame.end(), {static_cast<std::uint8_t>(i + 1 == num_tags ? 0x81 : 0x88), static_cast<std::uint8_t>(i + 1 == num_tags ? 0x00 : 0xA8),
                               0x00, 0x05});
  frame.insert(frame.end(), {0x08,
                             0x00,
                             0x45,
                             0,
                             0,
                             29,
                             0,
                             0,
                             0,
                             0,
                             64,
                             17,
                             0,
                             0,
                             192,
                             168,
                             1,
                             201,
                             192,
                             168,
                             1,
                             77,
                             0x09,
                             0x40,
                             static_cast<std::uint8_t>(port >> 8),
                             static_cast<std::uint8_t>(port & 0xFF),
                             0,
                             9,
                             0,
                             0,
                             7});
  return frame;
}

bool Passes(const std::string& filter, const Frame& frame) {
  pcap_t* dead = pcap_open_dead(DLT_EN10MB, 2048);
  bpf_program program{};
  EXPECT_EQ(pcap_compile(dead, &program, filter.c_str(), 1, PCAP_NETMASK_UNKNOWN), 0) << pcap_geterr(dead);
  pcap_pkthdr header{};
  header.caplen = static_cast<bpf_u_int32>(frame.size());
  header.len = header.caplen;
  const bool passes = pcap_offline_filter(&program, &header, frame.data()) != 0;
  pcap_freecode(&program);
  pcap_close(dead);
  return passes;
}

TEST(FilterOfPorts, TakesBothPortsAlsoInVlanTags) {
  const auto filter = FilterOfPorts(2368, 8308, true);
  for (int num_tags = 0; num_tags <= 2; ++num_tags) {
    EXPECT_TRUE(Passes(filter, Tagged(num_tags, 2368))) << num_tags;
    EXPECT_TRUE(Passes(filter, Tagged(num_tags, 8308))) << num_tags;
    EXPECT_FALSE(Passes(filter, Tagged(num_tags, 2369))) << num_tags;
  }
  auto tcp = Tagged(0, 2368);
  tcp[23] = 6;
  EXPECT_FALSE(Passes(filter, tcp));
}

TEST(FilterFault, TellsWhatIsWrongWithAFilter) {
  EXPECT_EQ(FilterFault("udp and src host 192.168.1.201"), "");
  EXPECT_EQ(FilterFault(FilterOfPorts(2368, 8308, true)), "");
  EXPECT_NE(FilterFault("udp and port"), "");
  EXPECT_NE(FilterFault("no such word"), "");
}

TEST(LiveCapture, SaysThatItsInterfaceIsNotThere) {
  LiveOptions options;
  options.interface = "nosuch0";
  try {
    const LiveCapture capture(options);
    FAIL() << "captures on nothing";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no interface 'nosuch0'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lookout::vlp16
