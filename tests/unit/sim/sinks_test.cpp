#include "lab/sim/sinks.hpp"

#include <unistd.h>

#include <array>
#include <filesystem>
#include <gtest/gtest.h>
#include <pcap/pcap.h>
#include <stdexcept>
#include <vector>

#include "tests/support/files.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

unsigned U16(const std::uint8_t* bytes) { return static_cast<unsigned>(bytes[0]) << 8 | bytes[1]; }

// Ones' complement sum with its checksum in place: 0xFFFF when right.
unsigned Folded(const std::uint8_t* bytes, std::size_t size, unsigned sum) {
  for (std::size_t i = 0; i + 1 < size; i += 2) sum += U16(bytes + i);
  if (size % 2 != 0) sum += static_cast<unsigned>(bytes[size - 1]) << 8;
  while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
  return sum;
}

TEST(PcapSink, IsReadBackByLibpcapWithRightHeaders) {
  const support::TempDir folder;
  const auto file = folder / "file.pcap";
  const Utime time = Utime(1'781'532'600s) + 123'456us;
  {
    PcapSink sink(file, {2368, 8308});
    sink.Send({time, 2368, std::vector<std::uint8_t>(1206, 0xAB)});
    sink.Send({time + 1s, 10110, {'$', 'G', 'P'}});  // an odd number of bytes
    sink.Finish().Commit();
  }
  std::array<char, PCAP_ERRBUF_SIZE> fault{};
  pcap_t* capture = pcap_open_offline(file.c_str(), fault.data());
  ASSERT_NE(capture, nullptr) << fault.data();
  EXPECT_EQ(pcap_datalink(capture), DLT_EN10MB);
  int num_frames = 0;
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  while (pcap_next_ex(capture, &header, &bytes) == 1) {
    const bool is_lidar = num_frames == 0;
    const std::size_t payload_size = is_lidar ? 1206 : 3;
    ASSERT_EQ(header->caplen, 42 + payload_size);
    EXPECT_EQ(header->len, header->caplen);
    EXPECT_EQ(header->ts.tv_sec, 1'781'532'600 + num_frames);
    EXPECT_EQ(header->ts.tv_usec, 123'456);
    EXPECT_EQ(U16(bytes + 12), 0x0800U);
    EXPECT_EQ(U16(bytes + 16), 28 + payload_size);
    EXPECT_EQ(Folded(bytes + 14, 20, 0), 0xFFFFU);
    EXPECT_EQ(bytes[26], 192);
    EXPECT_EQ(bytes[29], is_lidar ? 201 : 10);
    EXPECT_EQ(U16(bytes + 36), is_lidar ? 2368U : 10110U);
    EXPECT_EQ(U16(bytes + 38), 8 + payload_size);
    const unsigned pseudo = Folded(bytes + 26, 8, 17 + static_cast<unsigned>(8 + payload_size));
    EXPECT_EQ(Folded(bytes + 34, 8 + payload_size, pseudo), 0xFFFFU);
    EXPECT_EQ(bytes[42], is_lidar ? 0xAB : '$');
    ++num_frames;
  }
  EXPECT_EQ(num_frames, 2);
  pcap_close(capture);
  std::filesystem::remove(file);
}

TEST(PcapSink, SaysThatAFolderIsMissing) { EXPECT_THROW(PcapSink("/nowhere/at/all.pcap", {2368}), std::runtime_error); }

constexpr Utime kSimulated{1'000'000s};
const Schedule::Clock::time_point kDue{100h};

TEST(Schedule, HasADeadlineForEachDatagram) {
  EXPECT_EQ(Schedule(kSimulated, kDue, 1.0).DueAt(kSimulated + 10s), kDue + 10s);
  EXPECT_EQ(Schedule(kSimulated, kDue, 4.0).DueAt(kSimulated + 10s), kDue + 2500ms);
  EXPECT_EQ(Schedule(kSimulated, kDue, 0.0).DueAt(kSimulated + 10s), kDue);
}

// It went on without a word: what heard it saw a late lidar.
TEST(Schedule, SaysOnceASecondByHowMuchItIsBehind) {
  Schedule schedule(kSimulated, kDue, 1.0);
  std::vector<std::string> told;
  auto now = kDue;
  for (int i = 0; i < 500; ++i) {
    const auto time = kSimulated + i * 10ms;
    now = std::max(now, schedule.DueAt(time));
    now += 15ms;  // to make one takes longer than there is time
    if (const auto line = schedule.Report(time, now)) told.push_back(*line);
  }
  ASSERT_EQ(told.size(), 8U) << "7.5 s of the clock, from 0.12 s on";
  EXPECT_EQ(told[0].substr(0, 6), "0.06 s");
  EXPECT_EQ(told[7].substr(0, 6), "2.40 s");
  EXPECT_EQ(schedule.Summary(), "492 of 500 datagrams were sent more than 0.05 s late, the latest 2.51 s");
}

TEST(Schedule, SaysNothingOfOneThatIsKeptOrThatThereIsNone) {
  Schedule kept(kSimulated, kDue, 1.0);
  Schedule none(kSimulated, kDue, 0.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(kept.Report(kSimulated + i * 10ms, kDue + i * 10ms + 49ms));
    EXPECT_FALSE(none.Report(kSimulated + i * 10ms, kDue + 1h));
  }
  EXPECT_EQ(kept.Summary() + none.Summary(), "");
}

TEST(Schedule, TellsOfEachStretchThatIsLate) {
  Schedule schedule(kSimulated, kDue, 2.0);
  EXPECT_TRUE(schedule.Report(kSimulated + 2s, kDue + 1s + 60ms));
  EXPECT_FALSE(schedule.Report(kSimulated + 4s, kDue + 2s));
  EXPECT_TRUE(schedule.Report(kSimulated + 6s, kDue + 3s + 60ms));
}

}  // namespace
}  // namespace lookout::sim
