// Whose packets are taken, through the service: with packets of others beside the lidar everything that it publishes is as without them.
#include "services/lidar/core/driver/sender_lock.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/lidar/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::Payload;
using test::SpinningSensor;

const Utime kLockStart = Utime(hours(24 * 20000));
const Sender kLidar{"192.168.1.201", 2368};
const Sender kLidarPosition{"192.168.1.201", 8308};
const Sender kOther{"192.168.1.202", 2368};
const Sender kOtherPosition{"192.168.1.202", 8308};

struct Arrival {
  Utime time;
  int udp_port = 0;
  Payload payload;
  Sender sender;
};
using Arrivals = std::vector<Arrival>;

// A lidar that sends from `begin` to `end` after the start, position packets included.
Arrivals OfLidar(microseconds begin, microseconds end, const std::string& address = kLidar.address, int port = 2368,
                 std::uint8_t mode = format::kModeStrongest, std::uint8_t product = format::kProductVlp16) {
  SpinningSensor sensor;
  sensor.mode = mode;
  sensor.product = product;
  sensor.time_ns = (begin + seconds(100)).count() * 1000;
  const int range = static_cast<int>(std::hash<std::string>{}(address) % 1000);
  sensor.scene = [range](double azimuth_deg, int laser, int) {
    return test::ReturnValue{static_cast<std::uint16_t>(1000 + range + 10 * static_cast<int>(azimuth_deg) + laser), 7};
  };
  Arrivals arrivals;
  for (int i = 0;; ++i) {
    const Utime time = kLockStart + begin + std::chrono::duration_cast<microseconds>(i * sensor.period());
    if (time >= kLockStart + end) return arrivals;
    if (i % 10 == 0) arrivals.push_back({time, 8308, test::MakePositionPacket(sensor.stamp_us(), 2, test::kValidRmc), {address, port + 5940}});
    arrivals.push_back({time, 2368, sensor.Next(), {address, port}});
  }
}

// Others' packets, so many a second.
Arrivals Foreign(microseconds begin, microseconds end, double per_s, const std::function<Payload(SpinningSensor&)>& make,
                 const Sender& sender = kOther) {
  SpinningSensor sensor;
  sensor.azimuth_deg = 123.0;
  sensor.time_ns = 55'000'000'000;
  Arrivals arrivals;
  for (int i = 0;; ++i) {
    const Utime time = kLockStart + begin + microseconds(311 + static_cast<std::int64_t>(i * 1e6 / per_s));
    if (time >= kLockStart + end) return arrivals;
    arrivals.push_back({time, 2368, make(sensor), sender});
    if (i % 3 == 0) arrivals.push_back({time, 8308, test::MakePositionPacket(sensor.stamp_us(), 0, ""), {sender.address, sender.port + 5940}});
  }
}

Payload ValidOnes(SpinningSensor& sensor) { return sensor.Next(); }
Payload NoLidar(SpinningSensor&) { return Payload(format::kDataPacketSizeBytes, 7); }

Arrivals MergedArrivals(const std::vector<Arrivals>& parts) {
  Arrivals all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::ranges::stable_sort(all, {}, &Arrival::time);
  return all;
}

struct Published {
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> messages;
  std::vector<std::string> notices;
  HealthReport report;

  std::int64_t CountOf(std::string_view name) const {
    const auto found = std::ranges::find(report.counters, name, &Counter::name);
    return found != report.counters.end() ? found->count : -1;
  }
  std::vector<std::vector<std::uint8_t>> Of(std::string_view channel) const {
    std::vector<std::vector<std::uint8_t>> bytes;
    for (const auto& message : messages) {
      if (message.first == channel) bytes.push_back(message.second);
    }
    return bytes;
  }
  // What the scans hold, but not which bundle of raw packets ended them.
  std::vector<std::vector<std::uint8_t>> ScansWithoutRawSeq() const {
    std::vector<std::vector<std::uint8_t>> scans;
    for (const auto& bytes : Of("LIDAR_SCAN")) {
      auto scan = bus::Decode<lidar_scan_t>(bytes).value();
      scan.raw_seq = 0;
      std::vector<std::uint8_t> encoded(static_cast<std::size_t>(scan.getEncodedSize()));
      scan.encode(encoded.data(), 0, static_cast<int>(encoded.size()));
      scans.push_back(std::move(encoded));
    }
    return scans;
  }
  // Packets in LIDAR_PACKETS.
  std::int64_t NumData() const { return NumRaw(2368); }
  std::int64_t NumRaw(int udp_port) const {
    std::int64_t count = 0;
    for (const auto& bytes : Of("LIDAR_PACKETS")) {
      const auto message = bus::Decode<lidar_packets_t>(bytes).value();
      count += std::ranges::count(message.udp_port, udp_port);
    }
    return count;
  }
};

class LockRun {
 public:
  explicit LockRun(const Params& params = {}) : service_(bus_, params) {
    bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) {
      published_.messages.emplace_back(channel, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    });
    service_.OnNotice([this](const std::string& line) { published_.notices.push_back(line); });
  }

  LockRun& Feed(const Arrivals& arrivals) {
    for (const auto& arrival : arrivals) {
      service_.AdvanceTo(arrival.time);
      service_.OnDatagram(arrival.time, arrival.udp_port, arrival.payload, arrival.sender);
      support::HandleAll(bus_);
    }
    published_.report = service_.Report();
    return *this;
  }
  const Published& Finish(Utime time) {
    service_.Finish(time);
    support::HandleAll(bus_);
    return published_;
  }
  const Published& published() const { return published_; }

 private:
  bus::MemoryBus bus_;
  Service service_;
  Published published_;
};

Published Of(const Arrivals& arrivals, const Params& params = {}) { return LockRun(params).Feed(arrivals).Finish(kLockStart + hours(3)); }

TEST(SenderLock, MakesWhatIsPublishedTheSameWithForeignPacketsBesideTheLidar) {
  for (const std::uint8_t mode : {format::kModeStrongest, format::kModeDual}) {
    const auto lidar = OfLidar(seconds(0), seconds(3), kLidar.address, 2368, mode);
    const auto alone = Of(lidar);
    ASSERT_GE(alone.Of("LIDAR_SCAN").size(), 29U);
    for (const auto& make : {ValidOnes, NoLidar}) {
      for (const double per_s : {4.0, 60.0, 754.0}) {
        const auto beside = Of(MergedArrivals({lidar, Foreign(milliseconds(10), seconds(3), per_s, make)}));
        EXPECT_TRUE(beside.Of("LIDAR_SCAN") == alone.Of("LIDAR_SCAN")) << per_s;
        EXPECT_TRUE(beside.messages == alone.messages) << per_s;
        EXPECT_NEAR(static_cast<double>(beside.CountOf("data_sender_refused")), 3.0 * per_s, 0.01 * per_s + 1.0);
        EXPECT_EQ(beside.CountOf("position_sender_refused"), (beside.CountOf("data_sender_refused") + 2) / 3);
        EXPECT_EQ(beside.report.state, HealthState::kDegraded);
        EXPECT_NE(beside.report.reason.find("192.168.1.202:"), std::string::npos) << beside.report.reason;
        EXPECT_NE(beside.report.reason.find("192.168.1.201:2368"), std::string::npos) << beside.report.reason;
      }
    }
  }
}

TEST(SenderLock, IsNeverHeldByAForeignSenderOfWhatIsNoPacket) {
  const auto lidar = OfLidar(seconds(2), seconds(5));
  const auto alone = Of(lidar);
  for (const double per_s : {4.0, 60.0, 754.0}) {
    const auto beside = Of(MergedArrivals({Foreign(seconds(0), seconds(5), per_s, NoLidar), lidar}));
    // What came before the lidar stands in LIDAR_PACKETS, so bundles are numbered otherwise.
    EXPECT_TRUE(beside.ScansWithoutRawSeq() == alone.ScansWithoutRawSeq()) << per_s;
    EXPECT_GT(beside.CountOf("data_sender_refused"), 0);
  }
}

TEST(SenderLock, IsNotHeldByAnotherModel) {
  const auto lidar = OfLidar(seconds(2), seconds(5));
  const auto alone = Of(lidar);
  // A VLP-32C, by its product byte; an HDL-32E, by its interval, for its product byte is that of some early VLP-16.
  const auto vlp32c = OfLidar(seconds(0), seconds(5), kOther.address, 2368, format::kModeStrongest, 0x28);
  EXPECT_TRUE(Of(MergedArrivals({vlp32c, lidar})).ScansWithoutRawSeq() == alone.ScansWithoutRawSeq());
  const auto hdl32e = Foreign(seconds(0), seconds(5), 1808.0, [](SpinningSensor& sensor) {
    sensor.product = format::kProductHdl32e;
    sensor.time_ns -= sensor.period().count() - 553'000;
    return sensor.Next();
  });
  EXPECT_TRUE(Of(MergedArrivals({hdl32e, lidar})).ScansWithoutRawSeq() == alone.ScansWithoutRawSeq());
}

// Early ones, which only the interval between their packets tells from an HDL-32E: alternating, neither showed one, and both were taken for ever.
TEST(SenderLock, IsHeldByOneOfTwoLidarsThatAreToldByTheirIntervals) {
  const auto early = [](microseconds begin, const std::string& address) {
    return OfLidar(begin, seconds(3), address, 2368, format::kModeStrongest, format::kProductHdl32e);
  };
  const auto first = early(seconds(0), kLidar.address);
  const auto second = early(microseconds(600), kOther.address);
  const auto both = Of(MergedArrivals({first, second}));
  EXPECT_NEAR(static_cast<double>(both.NumData()), static_cast<double>(std::ranges::count(first, 2368, &Arrival::udp_port)), 8.0);
  EXPECT_EQ(both.report.reason.rfind("packets that are not the lidar's: 192.168.1.202:2368 sends to port 2368 besides the lidar", 0), 0U)
      << both.report.reason;
  EXPECT_GE(both.Of("LIDAR_SCAN").size(), 29U);
  // Beside an HDL-32E that was first.
  const auto hdl32e = Foreign(seconds(0), seconds(3), 1808.0, [](SpinningSensor& sensor) {
    sensor.product = format::kProductHdl32e;
    sensor.time_ns -= sensor.period().count() - 553'000;
    return sensor.Next();
  });
  const auto beside = Of(MergedArrivals({hdl32e, early(milliseconds(500), kLidar.address)}));
  EXPECT_EQ(std::ranges::count(beside.notices, "uses the lidar at 192.168.1.201:2368"), 1);
}

// What cannot be the lidar took the place on trial for a second at a time.
TEST(SenderLock, PassesToAnotherLidarInAFloodOfWhatIsNoPacket) {
  const auto before = OfLidar(seconds(0), milliseconds(200));
  const auto after = OfLidar(milliseconds(10'500), seconds(12), kOther.address);
  const auto flood = Foreign(seconds(10), seconds(12), 8000.0, NoLidar, {"192.168.1.203", 4000});
  const auto both = Of(MergedArrivals({before, after, flood}));
  EXPECT_EQ(both.CountOf("lidar_changes"), 1);
  const auto num_before = std::ranges::count(before, 2368, &Arrival::udp_port);
  EXPECT_NEAR(static_cast<double>(both.NumData() - num_before), (1.5 - 0.25) * 753.5, 8.0);
}

TEST(SenderLock, IsHeldByTheFirstOfTwoLidarsAndTheSecondIsNamed) {
  const auto first = OfLidar(seconds(0), seconds(5), kOther.address);
  const auto both = Of(MergedArrivals({first, OfLidar(milliseconds(500), seconds(5))}));
  EXPECT_TRUE(both.messages == Of(first).messages);
  EXPECT_EQ(both.report.state, HealthState::kDegraded);
  EXPECT_EQ(both.report.reason.rfind("two lidars on one port: 192.168.1.201:", 0), 0U) << both.report.reason;
  EXPECT_NE(both.report.reason.find("besides the lidar at 192.168.1.202:2368"), std::string::npos) << both.report.reason;
}

TEST(SenderLock, NamesTheSecondLidarWithItsFirstPacketAndForgetsItThreeSecondsAfterTheLast) {
  LockRun run;
  run.Feed(OfLidar(seconds(0), seconds(1)));
  EXPECT_EQ(run.published().report.reason, "");
  run.Feed({{kLockStart + seconds(1), 2368, SpinningSensor().Next(), kOther}});
  EXPECT_NE(run.published().report.reason.find("two lidars on one port: 192.168.1.202:2368"), std::string::npos);
  run.Feed(OfLidar(seconds(1), milliseconds(3900)));
  EXPECT_EQ(run.published().report.state, HealthState::kDegraded);
  run.Feed(OfLidar(milliseconds(3900), milliseconds(4100)));
  EXPECT_EQ(run.published().report.reason, "");
}

TEST(SenderLock, PassesToAnotherAddressAfterTenSecondsOfSilence) {
  // Ends at 2 s; the other one begins at once, and is refused until 12 s.
  const auto before = OfLidar(seconds(0), seconds(2));
  const auto after = OfLidar(seconds(2), seconds(20), kOther.address);
  const auto both = Of(MergedArrivals({before, after}));
  EXPECT_EQ(both.CountOf("lidar_changes"), 1);
  EXPECT_EQ(both.report.reason, "");
  const auto num_before = std::ranges::count(before, 2368, &Arrival::udp_port);
  EXPECT_NEAR(static_cast<double>(both.NumData() - num_before), 8.0 * 753.5, 8.0);
  EXPECT_EQ(both.NumData() + both.CountOf("data_sender_refused"), num_before + std::ranges::count(after, 2368, &Arrival::udp_port));
  const auto tells_the_change = [](const std::string& line) {
    return line == "uses the lidar at 192.168.1.202:2368; the one at 192.168.1.201:2368 is silent";
  };
  EXPECT_EQ(std::ranges::count_if(both.notices, tells_the_change), 1);
  // After a pause nothing but the trial is lost.
  const auto late = Of(MergedArrivals({before, OfLidar(seconds(14), seconds(20), kOther.address)}));
  EXPECT_NEAR(static_cast<double>(late.NumData() - num_before), (6.0 - 0.25) * 753.5, 8.0);
  EXPECT_NEAR(static_cast<double>(late.CountOf("position_sender_refused")), 0.25 * 75.35, 3.0);
  const auto early = Of(MergedArrivals({before, OfLidar(seconds(3), seconds(11), kOther.address)}));
  EXPECT_EQ(early.NumData(), num_before);
  EXPECT_NE(early.report.reason.find("no lidar packets for 8 s; two lidars on one port: 192.168.1.202:"), std::string::npos) << early.report.reason;
}

TEST(SenderLock, PassesToAnotherPortOfTheSameAddressAfterOneSecond) {
  const auto before = OfLidar(seconds(0), seconds(2), kLidar.address, 40'000);
  const auto both = Of(MergedArrivals({before, OfLidar(milliseconds(2100), seconds(6), kLidar.address, 40'001)}));
  const auto num_before = std::ranges::count(before, 2368, &Arrival::udp_port);
  EXPECT_NEAR(static_cast<double>(both.NumData() - num_before), 3.0 * 753.5, 8.0);
  EXPECT_EQ(both.CountOf("position_sender_refused"), 68);
  EXPECT_EQ(both.report.reason, "");
}

// It was told as "two lidars on one port", the lidar beside itself.
TEST(SenderLock, TellsOfALidarThatStartsAgainAsOfOne) {
  LockRun run;
  run.Feed(OfLidar(seconds(0), seconds(2), kLidar.address, 40'000));
  run.Feed(OfLidar(milliseconds(2100), milliseconds(2500), kLidar.address, 40'001));
  const auto restarted = run.published();
  EXPECT_TRUE(restarted.report.reason.starts_with("the lidar at 192.168.1.201 has started again: it sends to port ")) << restarted.report.reason;
  EXPECT_NE(restarted.report.reason.find(", before from 4"), std::string::npos) << restarted.report.reason;
  run.Feed(OfLidar(milliseconds(2500), seconds(6), kLidar.address, 40'001));
  const auto after = run.published();
  EXPECT_EQ(after.report.reason, "");
  EXPECT_EQ(std::ranges::count(after.notices, "uses the lidar at 192.168.1.201:40001; it started again, before it sent from port 40000"), 1);
  EXPECT_TRUE(std::ranges::none_of(after.notices, [](const std::string& line) { return line.find("two lidars") != std::string::npos; }));
}

// A forwarder that runs twice, say.
TEST(SenderLock, TellsOfTwoThatSendFromOneAddress) {
  const auto both =
      Of(MergedArrivals({OfLidar(seconds(0), seconds(3), kLidar.address, 40'000), OfLidar(milliseconds(1003), seconds(3), kLidar.address, 40'001)}));
  EXPECT_TRUE(both.report.reason.starts_with("two programs at 192.168.1.201 send packets of a lidar to port ")) << both.report.reason;
}

TEST(SenderLock, IsKeptWhileTwoLidarsAlternate) {
  Arrivals first;
  Arrivals second;
  for (int i = 0; i < 20; ++i) {
    auto& scan = i % 2 == 0 ? first : second;
    const auto part = OfLidar(seconds(i), seconds(i + 1), i % 2 == 0 ? kLidar.address : kOther.address);
    scan.insert(scan.end(), part.begin(), part.end());
  }
  EXPECT_TRUE(Of(MergedArrivals({first, second})).Of("LIDAR_SCAN") == Of(first).Of("LIDAR_SCAN"));
}

TEST(SenderLock, IsKeptWhenTheHostsClockIsSetOrTheHostStoodStill) {
  // With a foreign packet between any two of the lidar's, one is the first after the step, whenever that is.
  for (const microseconds step : {microseconds(hours(1)), microseconds(-hours(1)), microseconds(seconds(12)), microseconds(-milliseconds(500))}) {
    for (int place = 0; place < 6; ++place) {
      auto arrivals = MergedArrivals({OfLidar(seconds(0), seconds(4)), Foreign(seconds(1), seconds(4), 1000.0, ValidOnes)});
      std::int64_t num_of_lidar = 0;
      for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (i > 2500 + static_cast<std::size_t>(place)) arrivals[i].time += step;
        num_of_lidar += arrivals[i].sender == kLidar ? 1 : 0;
      }
      const auto both = Of(arrivals);
      EXPECT_EQ(both.NumData(), num_of_lidar) << step.count() << " us, place " << place;
      EXPECT_EQ(both.CountOf("lidar_changes"), 0);
    }
  }
}

TEST(SenderLock, IsOpenAgainAfterAHoldersStampsOfTheFuture) {
  auto arrivals = OfLidar(seconds(0), seconds(1));
  arrivals.back().time += hours(1);
  const auto after = OfLidar(seconds(2), seconds(20), kOther.address);
  arrivals.insert(arrivals.end(), after.begin(), after.end());
  EXPECT_EQ(Of(arrivals).CountOf("lidar_changes"), 1);
}

TEST(SenderLock, IsHeldByAnAllowedAddressAlone) {
  Params params;
  params.sources.allowed_source_addresses = {kLidar.address, "192.168.1.203"};
  const auto lidar = OfLidar(milliseconds(500), seconds(3));
  const auto foreign = OfLidar(seconds(0), seconds(3), kOther.address);
  const auto both = Of(MergedArrivals({foreign, lidar}), params);
  EXPECT_TRUE(both.messages == Of(lidar).messages);
  EXPECT_NE(both.report.reason.find("allowed_source_address does not name it"), std::string::npos) << both.report.reason;
  // Of several that are allowed the first holds it.
  EXPECT_TRUE(Of(MergedArrivals({OfLidar(milliseconds(600), seconds(3), "192.168.1.203"), lidar}), params).messages == Of(lidar).messages);
}

TEST(SenderLock, TakesPositionPacketsFromTheAddressOfTheData) {
  // Before any data the first of them is heard; with the data the address is known.
  const auto positions = [](const Sender& sender, int begin_s, int end_s) {
    Arrivals arrivals;
    for (int i = 10 * begin_s; i < 10 * end_s; ++i) {
      arrivals.push_back({kLockStart + milliseconds(100 * i), 8308, test::MakePositionPacket(static_cast<std::uint32_t>(i), 0, ""), sender});
    }
    return arrivals;
  };
  const auto alone = Of(MergedArrivals({positions(kOtherPosition, 0, 3), positions(kLidarPosition, 1, 3)}));
  EXPECT_EQ(alone.NumRaw(8308), 30);
  EXPECT_EQ(alone.CountOf("position_sender_refused"), 20);
  auto data = OfLidar(seconds(2), seconds(3));
  std::erase_if(data, [](const Arrival& arrival) { return arrival.udp_port != 2368; });
  const auto with_data = Of(MergedArrivals({data, positions(kOtherPosition, 0, 3), positions(kLidarPosition, 1, 3)}));
  EXPECT_EQ(with_data.NumRaw(8308), 20 + 10);
}

TEST(SenderLock, TellsTheJournalAtMostALineASecond) {
  std::vector<Arrivals> parts{OfLidar(seconds(0), seconds(6))};
  for (int i = 0; i < 50; ++i) {
    parts.push_back(Foreign(milliseconds(100 + i), seconds(6), 20.0, ValidOnes, {"10.0.0." + std::to_string(i), 1000 + i}));
  }
  const auto many = Of(MergedArrivals(parts));
  const auto num_lines = std::ranges::count_if(many.notices, [](const std::string& line) { return line.rfind("sensor clock", 0) != 0; });
  EXPECT_LE(num_lines, 7);
  EXPECT_GE(num_lines, 5);
  const auto one = Of(MergedArrivals({OfLidar(seconds(0), seconds(6)), Foreign(seconds(1), seconds(6), 60.0, ValidOnes)}));
  EXPECT_EQ(std::ranges::count_if(one.notices, [](const std::string& line) { return line.rfind("two lidars", 0) == 0; }), 1);
}

TEST(SenderLock, WritesAddressAndPort) {
  EXPECT_EQ(ToText(kLidar), "192.168.1.201:2368");
  EXPECT_EQ(ToText(Sender{"fe80::1", 40'000}), "[fe80::1]:40000");
}

// Ethernet frames, those of the lidar plain, in a VLAN or as IPv6; those of the others as IPv4.
class CaptureMaker {
 public:
  enum class Form { kPlain, kInVlan, kInIpv6 };

  void Add(const Arrival& arrival, Form form) {
    std::string udp = Big(arrival.sender.port) + Big(arrival.udp_port) + Big(static_cast<int>(arrival.payload.size()) + 8) + std::string(2, '\0');
    udp.append(arrival.payload.begin(), arrival.payload.end());
    const char last = static_cast<char>(std::stoi(arrival.sender.address.substr(arrival.sender.address.find_last_of(".:") + 1)));
    std::string frame(12, '\x11');
    if (form == Form::kInVlan) frame += Big(0x8100) + Big(5);
    if (form == Form::kInIpv6) {
      frame += Big(0x86DD) + std::string("\x60\0\0\0", 4) + Big(static_cast<int>(udp.size())) + std::string("\x11\x40", 2);
      frame += std::string("\xFE\x80\0\0\0\0\0\0\0\0\0\0\0\0\0", 15) + last + std::string(16, '\xFF');
    } else {
      frame += Big(0x0800) + std::string("\x45\0", 2) + Big(static_cast<int>(udp.size()) + 20) + std::string("\0\0\0\0\x40\x11\0\0\xC0\xA8\x01", 11) +
               last;
      frame += std::string(4, '\xFF');
    }
    frame += udp;
    const auto time_us = ToUtimeUs(arrival.time);
    bytes_ += Little(static_cast<std::uint32_t>(time_us / 1'000'000)) + Little(static_cast<std::uint32_t>(time_us % 1'000'000));
    bytes_ += Little(static_cast<std::uint32_t>(frame.size())) + Little(static_cast<std::uint32_t>(frame.size())) + frame;
  }
  void Write(const std::filesystem::path& file) const { std::ofstream(file, std::ios::binary) << bytes_; }

 private:
  static std::string Big(int number) { return {static_cast<char>(number >> 8), static_cast<char>(number & 0xFF)}; }
  static std::string Little(std::uint32_t number) {
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(number >> shift & 0xFF);
    return text;
  }

  std::string bytes_ = Little(0xA1B2C3D4) + Little(0x00040002) + Little(0) + Little(0) + Little(65535) + Little(1);
};

TEST(SenderLock, GoesByTheAddressesInACapture) {
  const support::TempDir folder;
  const auto file = folder / "file.pcap";
  const auto lidar = OfLidar(seconds(0), seconds(2));
  const auto expected = Of(lidar).messages;
  for (const auto form : {CaptureMaker::Form::kPlain, CaptureMaker::Form::kInVlan, CaptureMaker::Form::kInIpv6}) {
    CaptureMaker maker;
    for (const auto& arrival : MergedArrivals({lidar, Foreign(milliseconds(1), seconds(2), 60.0, ValidOnes)})) {
      maker.Add(arrival, arrival.sender.address == kLidar.address ? form : CaptureMaker::Form::kPlain);
    }
    maker.Write(file);
    Arrivals read;
    CaptureReader reader(file);
    while (const auto datagram = reader.Next()) {
      read.push_back({datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port}});
    }
    EXPECT_EQ(read.front().sender.port, 8308);
    const auto published = Of(read);
    EXPECT_TRUE(published.messages == expected) << static_cast<int>(form);
    EXPECT_EQ(published.CountOf("data_sender_refused"), 120);
  }
  std::filesystem::remove(file);
}

// Any senders, stamps and payloads: what is refused and what is taken make up what came, and the same comes out twice.
TEST(SenderLock, CountsEveryPacketOnceWhateverComes) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&random](std::uint32_t limit) { return static_cast<int>(random() % limit); };
    Arrivals arrivals;
    SpinningSensor sensor;
    Utime time = kLockStart;
    for (int i = 0; i < 3000; ++i) {
      time += below(50) == 0 ? microseconds(below(15'000'000)) - microseconds(2'000'000) : microseconds(below(3000));
      const bool is_data = below(4) != 0;
      Payload payload = is_data ? sensor.Next() : test::MakePositionPacket(sensor.stamp_us(), static_cast<std::uint8_t>(below(5)), "");
      if (below(10) == 0) payload[static_cast<std::size_t>(below(static_cast<std::uint32_t>(payload.size())))] ^= 0xFF;
      arrivals.push_back({time, is_data ? 2368 : 8308, std::move(payload), {"10.0.0." + std::to_string(below(3)), 2000 + below(2)}});
    }
    const auto published = Of(arrivals);
    EXPECT_TRUE(published.messages == Of(arrivals).messages) << "seed " << seed;
    EXPECT_EQ(published.NumData() + published.CountOf("data_sender_refused"), std::ranges::count(arrivals, 2368, &Arrival::udp_port))
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace lookout::vlp16
