// Writes seeds for the fuzz targets, a folder for each: what real inputs look like, so that no time goes into guessing that.
#include <chrono>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/schema.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "tests/fuzz/corpus.hpp"
#include "tests/fuzz/packet_script.hpp"
#include "tests/unit/data/cloud_text.hpp"
#include "tests/unit/lidar/packet_maker.hpp"
#include "tests/unit/navigator/nmea_text.hpp"
#include "tests/unit/segmenter/message_maker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"
#include "tests/unit/wire/filled_messages.hpp"

namespace {

using namespace lookout;
using namespace lookout::fuzz;

// --- Packets of the sensor ---

namespace format = vlp16::format;
namespace script = vlp16::script;
using vlp16::test::Azimuths;
using vlp16::test::MakeDataPacket;
using vlp16::test::MakePositionPacket;
using vlp16::test::SpinningSensor;

constexpr std::uint32_t kLastMicroseconds = 3'599'995'000;  // of an hour; the script begins 5 ms before one

std::string Rmc(std::string_view time_of_day, char status) {
  return navigator::Line("GPRMC," + std::string(time_of_day) + "," + status + ",3649.7478,N,00224.4542,W,0.034,212.5,010626,0.0,E,A");
}

struct Run {
  std::string name;
  std::uint8_t mode = format::kModeStrongest;
  std::uint8_t product = format::kProductVlp16;
  double azimuth_deg = 0.0;
  double rpm = 600.0;
  std::int64_t time_ns = 60'000'000'000;
  int model = 0;
  int time = 0;
  int cut = 0;
};

// A dozen packets as they come, with a position packet in between.
Payload Script(const Run& run, int num_packets = 12) {
  SpinningSensor sensor;
  sensor.mode = run.mode;
  sensor.product = run.product;
  sensor.azimuth_deg = run.azimuth_deg;
  sensor.rpm = run.rpm;
  sensor.time_ns = run.time_ns;
  sensor.scene = [](double azimuth_deg, int laser, int return_index) -> vlp16::test::ReturnValue {
    if (laser % 3 == 0) return {};
    return {static_cast<std::uint16_t>(1000 + static_cast<int>(azimuth_deg) + 100 * return_index), static_cast<std::uint8_t>(10 * laser)};
  };
  const std::size_t host_step = sensor.is_dual() ? 1 : 0;
  script::Writer writer(run.model, run.time, run.cut);
  writer.Add(script::Kind::kPosition, 0, MakePositionPacket(sensor.stamp_us(), format::kPpsLocked, Rmc("115959.00", 'A')));
  for (int i = 0; i < num_packets; ++i) {
    if (i == num_packets / 2)
      writer.Add(script::Kind::kPosition, 2, MakePositionPacket(sensor.stamp_us(), format::kPpsLocked, Rmc("120000.00", 'A')));
    writer.Add(script::Kind::kData, host_step, sensor.Next());
  }
  return writer.bytes();
}

void WriteDataPackets(const Folder& folder) {
  const std::vector<Run> runs{{.name = "strongest"},
                              {.name = "last", .mode = format::kModeLast},
                              {.name = "dual", .mode = format::kModeDual},
                              {.name = "hi_res", .product = format::kProductPuckHiRes},
                              {.name = "shared_product_byte", .product = format::kProductHdl32e},
                              {.name = "hdl32e_by_choice", .product = format::kProductHdl32e, .model = 1},
                              {.name = "across_zero", .azimuth_deg = 358.5},
                              {.name = "dual_across_cut", .mode = format::kModeDual, .azimuth_deg = 35.5, .cut = 1},
                              {.name = "slow", .azimuth_deg = 359.5, .rpm = 300.0},
                              {.name = "fast", .azimuth_deg = 355.0, .rpm = 1200.0},
                              {.name = "standing", .rpm = 0.0},
                              {.name = "over_the_hour", .time_ns = std::int64_t{kLastMicroseconds} * 1000},
                              {.name = "over_the_hour_by_sensor", .time_ns = std::int64_t{kLastMicroseconds} * 1000, .time = 1},
                              {.name = "by_host", .time_ns = std::int64_t{kLastMicroseconds} * 1000, .time = 2}};
  for (const auto& run : runs) folder.Write(run.name, Script(run));

  using script::Kind;
  const auto one = [](const Payload& packet) { return script::Writer(0, 0, 0).Add(Kind::kData, 0, packet).bytes(); };
  folder.Write("one_packet", one(MakeDataPacket(Azimuths(1000, 20), 5'000'000)));
  folder.Write("azimuth_36000", one(MakeDataPacket({35960, 35980, 36000, 20, 40, 60, 80, 100, 120, 140, 160, 180}, 5'000'000)));
  folder.Write("limited_view", one(MakeDataPacket({8980, 9000, 27000, 27020, 27040, 27060, 27080, 27100, 27120, 27140, 27160, 27180}, 5'000'000)));
  folder.Write("trembling", one(MakeDataPacket({10, 35990, 15, 35995, 20, 0, 25, 5, 30, 10, 35, 15}, 5'000'000)));
  folder.Write("leap_second_stamp", one(MakeDataPacket(Azimuths(0, 20), 3'600'500'000)));
  folder.Write("beyond_the_hour", one(MakeDataPacket(Azimuths(0, 20), 3'700'000'000)));
  folder.Write("dual_of_unequal_pairs", one(MakeDataPacket(Azimuths(0, 20), 5'000'000, format::kModeDual)));
  folder.Write("wrong_mode", one(MakeDataPacket(Azimuths(0, 20), 5'000'000, 0x3A)));
  folder.Write("wrong_product", one(MakeDataPacket(Azimuths(0, 20), 5'000'000, format::kModeStrongest, 0x28)));

  // Lost, twice, late, a step of the sensor's clock, a change of mode, a pause, a flush and a start.
  SpinningSensor sensor;
  std::vector<Payload> packets;
  for (int i = 0; i < 12; ++i) packets.push_back(sensor.Next());
  script::Writer order(0, 0, 3);
  for (const std::size_t i : {0U, 1U, 4U, 4U, 3U, 2U, 6U, 5U, 7U}) order.Add(Kind::kData, 0, packets[i]);
  folder.Write("lost_twice_late", order.bytes());
  script::Writer jumps(0, 0, 0);
  jumps.Add(Kind::kData, 0, packets[0]).Add(Kind::kData, 0, packets[1]);
  sensor.time_ns = 2'000'000'000'000;
  jumps.Add(Kind::kData, 0, sensor.Next());
  sensor.mode = format::kModeDual;
  jumps.Add(Kind::kData, 5, sensor.Next())
      .Add(Kind::kFlush, 0)
      .Add(Kind::kData, 7, sensor.Next())
      .Add(Kind::kReset, 4)
      .Add(Kind::kData, 1, sensor.Next());
  folder.Write("jumps", jumps.bytes());
}

std::vector<std::pair<std::string, Payload>> PositionPackets() {
  std::vector<std::pair<std::string, Payload>> packets;
  for (const int pps : {0, 1, 2, 3, 4}) {
    packets.emplace_back("pps_" + std::to_string(pps), MakePositionPacket(1'000'000, static_cast<std::uint8_t>(pps), Rmc("120000.00", 'A')));
  }
  const std::string gga = navigator::GgaLine(navigator::NoonPlus(0.0), 44.3, -72.1, 4, 0.8, 30.0, -28.0);
  packets.emplace_back("void_rmc", MakePositionPacket(1'000'000, format::kPpsLocked, Rmc("120000.00", 'V')));
  packets.emplace_back("leap_second", MakePositionPacket(3'600'000'000, format::kPpsLocked, Rmc("235960.00", 'A')));
  packets.emplace_back("gga", MakePositionPacket(1'000'000, format::kPpsLocked, gga));
  packets.emplace_back("gnrmc", MakePositionPacket(1'000'000, format::kPpsLocked, navigator::Line("GNRMC,120000,A,4418.0,N,07206.0,W,0,0,010626,,")));
  packets.emplace_back("no_sentence", MakePositionPacket(1'000'000, format::kPpsAbsent, "", ""));
  packets.emplace_back("no_end", MakePositionPacket(1'000'000, format::kPpsLocked, Rmc("120000.00", 'A'), ""));
  packets.emplace_back("wrong_checksum", MakePositionPacket(1'000'000, format::kPpsLocked, "$GPRMC,120000,A,4418.0,N,07206.0,W,0,0,010626,,*00"));
  auto warm = MakePositionPacket(3'599'999'999, format::kPpsLocked, Rmc("115959.99", 'A'));
  warm[187] = 58;  // top and bottom board, degrees Celsius
  warm[188] = 61;
  warm[203] = 1;   // off for its temperature
  warm[204] = 90;  // at the last shutdown, and at power up
  warm[205] = 24;
  packets.emplace_back("telemetry", warm);
  return packets;
}

void WritePositionPackets(const Folder& folder, const Folder& scripts) {
  for (const auto& [name, packet] : PositionPackets()) {
    folder.Write(name, packet);
    script::Writer writer(0, 0, 0);
    writer.Add(script::Kind::kPosition, 0, packet).Add(script::Kind::kData, 0, MakeDataPacket(Azimuths(0, 20), 1'000'500));
    scripts.Write("position_" + name, writer.bytes());
  }
}

// --- NMEA 0183 ---

void WriteMotions(const Folder& folder) {
  using navigator::Line;
  const std::string covariance = "0.000010000000,0.000000000000,0.000000000000,0.000010000000,0.000000001000,0.000000100000";
  const std::string known = Line("PLKODO,1780315200000000,1780315200100000,K,0.200000,-0.010000,0.001000000," + covariance);
  const std::string unknown = Line("PLKODO,1780315200100000,1780315200200000,U");
  const std::string next = Line("PLKODO,1780315200200000,1780315200300000,K,0.210000,0.000000,-0.002000000," + covariance);
  folder.Write("known", known + "\r\n");
  folder.Write("unknown", unknown + "\r\n");
  std::string many;
  for (int i = 0; i < 20; ++i) many += known + "\r\n" + unknown + "\r\n" + next + "\r\n";
  folder.Write("many", many);
}

void WriteSentences(const Folder& folder) {
  using namespace navigator;
  const auto noon = NoonPlus(0.0);
  const std::string rmc = RmcLine(noon, 44.123456, -72.5, 1.5, 271.25);
  const std::string gga = GgaLine(noon, 44.123456, -72.5, 4, 0.8, 30.25, -28.5);
  const std::string vtg = Line("GPVTG,271.3,T,286.1,M,2.9,N,5.4,K,A");
  const std::string hdt = HdtLine(359.99);
  const std::string pashr = PashrLine(noon, 90.0, -1.5, 2.25, 0.1);
  const std::vector<std::pair<std::string, std::string>> lines{{"rmc", rmc},
                                                               {"gga", gga},
                                                               {"vtg", vtg},
                                                               {"hdt", hdt},
                                                               {"pashr", pashr},
                                                               {"rmc_void", Line("GPRMC,120000,V,,,,,,,010626,,,N")},
                                                               {"rmc_south_west", RmcLine(noon, -33.9, -18.4, 0.0, 0.0)},
                                                               {"rmc_pole", RmcLine(noon, 90.0, 180.0, 20.0, 360.0)},
                                                               {"rmc_old", Line("GPRMC,235959.999,A,4418.0,N,07206.0,W,0,0,311299,,")},
                                                               {"gga_no_fix", Line("GPGGA,120000,,,,,0,00,99.9,,M,,M,,")},
                                                               {"gns", Line("GNGNS,120000,4418.0,N,07206.0,W,RR,12,0.8,30.0,-28.0,,")},
                                                               {"hdg", Line("HCHDG,101.1,1.0,E,7.1,W")},
                                                               {"zda", Line("GPZDA,120000.00,01,06,2026,00,00")},
                                                               {"ais", "!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C"},
                                                               {"no_checksum", "$GPHDT,12.5,T"},
                                                               {"not_padded", Line("BMGLL,5430.0000,N,1012.0000,E,,A,D")},
                                                               {"spaces", Line("IIXDR,A, 2.5,D,PTCH ,A,-1.0 ,D,ROLL") + " \t"},
                                                               {"glued", gga + hdt + rmc + vtg},
                                                               {"csv", "timestamp,type,id,message\n2026-08-29T10:00:00.5Z,NMEA0183,,\"" + hdt + "\""},
                                                               {"csv_without_quotes", "2026-08-29T10:00:00+02:00,AIS," + hdt + ",x"},
                                                               {"empty_fields", Line("GPRMC,,,,,,,,,,,,")}};
  std::string all;
  for (const auto& [name, line] : lines) {
    folder.Write(name, line + "\r\n");
    all += line + "\r\n";
  }
  folder.Write("all", all);
  folder.Write("ubx_between", rmc + "\r\n\xB5\x62\x01\x07\x5C!#$%&[" + gga + "\r\n");
  folder.Write("tsip_between", "\x10\x8F\x20" + std::string(40, '\x11') + "\x10\x03" + rmc + "\r\n" + gga + "\r");
  folder.Write("byte_order_mark", "\xEF\xBB\xBF" + rmc + "\r\n");
  folder.Write("broken_off", "$GPGGA,12" + rmc + "\r\n");
  folder.Write("second_of_receiver", rmc + "\r\n" + gga + "\r\n" + vtg + "\r\n" + hdt + "\r\n");
  folder.Write("without_carriage_returns", rmc + "\n" + gga + "\n");
  folder.Write("without_end", rmc);
}

// --- Captures ---

Payload Udp(int port, const Payload& payload) {
  return BigEndian(2368, 2) + BigEndian(static_cast<std::uint64_t>(port), 2) + BigEndian(payload.size() + 8, 2) + BigEndian(0, 2) + payload;
}

Payload Ipv4(const Payload& udp) {
  return Payload{0x45, 0} + BigEndian(udp.size() + 20, 2) + Payload{0, 1, 0, 0, 64, 17, 0, 0, 192, 168, 1, 201, 255, 255, 255, 255} + udp;
}

Payload Ipv6(const Payload& udp) { return Payload{0x60, 0, 0, 0} + BigEndian(udp.size(), 2) + Payload{17, 64} + Payload(32) + udp; }

const Payload kMacs(12, 0xFF);

// Classic pcap; its times are in microseconds unless the magic number says nanoseconds.
Payload Pcap(std::uint32_t link_type, const std::vector<Payload>& frames, std::uint32_t magic = 0xA1B2C3D4) {
  Payload file =
      LittleEndian(magic, 4) + LittleEndian(2, 2) + LittleEndian(4, 2) + LittleEndian(0, 8) + LittleEndian(65535, 4) + LittleEndian(link_type, 4);
  std::uint64_t fraction = 0;
  for (const auto& frame : frames) {
    file = file + LittleEndian(1'780'000'000, 4) + LittleEndian(fraction, 4) + LittleEndian(frame.size(), 4) + LittleEndian(frame.size(), 4) + frame;
    fraction += 1327;
  }
  return file;
}

Payload PcapngBlock(std::uint32_t type, Payload body) {
  body.resize((body.size() + 3) / 4 * 4);
  const Payload size = LittleEndian(body.size() + 12, 4);
  return LittleEndian(type, 4) + size + body + size;
}

Payload Pcapng(std::uint16_t link_type, const std::vector<Payload>& frames) {
  Payload file = PcapngBlock(0x0A0D0D0A, LittleEndian(0x1A2B3C4D, 4) + LittleEndian(1, 2) + LittleEndian(0, 2) + Payload(8, 0xFF)) +
                 PcapngBlock(1, LittleEndian(link_type, 2) + LittleEndian(0, 2) + LittleEndian(65535, 4));
  for (const auto& frame : frames) {
    file = file + PcapngBlock(6, LittleEndian(0, 4) + LittleEndian(0x65315, 4) + LittleEndian(1327, 4) + LittleEndian(frame.size(), 4) +
                                     LittleEndian(frame.size(), 4) + frame);
  }
  return file;
}

void WriteCaptures(const Folder& folder) {
  const Payload data = Udp(format::kDataPort, MakeDataPacket(Azimuths(0, 20), 1'000'000));
  const Payload position = Udp(format::kPositionPort, MakePositionPacket(1'000'000, format::kPpsLocked, Rmc("120000.00", 'A')));
  const Payload small = Udp(10110, {'$', 'G', 'P', 'H', 'D', 'T'});
  const Payload ethernet = kMacs + BigEndian(0x0800, 2) + Ipv4(small);
  const std::vector<std::pair<std::string, Payload>> frames{
      {"ethernet", ethernet},
      {"ethernet_ipv6", kMacs + BigEndian(0x86DD, 2) + Ipv6(small)},
      {"vlan", kMacs + BigEndian(0x8100, 2) + BigEndian(5, 2) + BigEndian(0x0800, 2) + Ipv4(small)},
      {"vlan_in_vlan", kMacs + BigEndian(0x88A8, 2) + BigEndian(5, 2) + BigEndian(0x8100, 2) + BigEndian(6, 2) + BigEndian(0x0800, 2) + Ipv4(small)},
      {"cooked", Payload(14) + BigEndian(0x0800, 2) + Ipv4(small)},
      {"cooked_2", BigEndian(0x0800, 2) + Payload(18) + Ipv4(small)},
      {"null", LittleEndian(2, 4) + Ipv4(small)},
      {"raw", Ipv4(small)},
      {"raw_ipv6", Ipv6(small)}};
  for (const auto& [name, frame] : frames) folder.Write("frame_" + name, frame);

  const auto in_ethernet = [](const Payload& udp) { return kMacs + BigEndian(0x0800, 2) + Ipv4(udp); };
  constexpr std::uint32_t kNanoseconds = 0xA1B23C4D;
  folder.Write("microseconds.pcap", Pcap(1, {in_ethernet(data), in_ethernet(position), ethernet}));
  folder.Write("nanoseconds.pcap", Pcap(1, {in_ethernet(data), ethernet}, kNanoseconds));
  folder.Write("empty.pcap", Pcap(1, {}));
  folder.Write("vlan.pcap", Pcap(1, {frames[2].second, frames[3].second}));
  folder.Write("cooked.pcap", Pcap(113, {frames[4].second}));
  folder.Write("cooked_2.pcap", Pcap(276, {frames[5].second}));
  folder.Write("null.pcap", Pcap(0, {frames[6].second}));
  folder.Write("raw.pcap", Pcap(101, {frames[7].second, frames[8].second}));
  folder.Write("ethernet.pcapng", Pcapng(1, {in_ethernet(data), in_ethernet(position), ethernet}));
  folder.Write("raw.pcapng", Pcapng(101, {Ipv4(small), Ipv6(small)}));
  // Another interface, with nanoseconds and an offset, and a packet of it.
  const Payload options =
      LittleEndian(9, 2) + LittleEndian(1, 2) + LittleEndian(9, 4) + LittleEndian(14, 2) + LittleEndian(8, 2) + LittleEndian(60, 8);
  const Payload& of_null = frames[6].second;
  folder.Write("two_link_types.pcapng", Pcapng(1, {ethernet}) + PcapngBlock(1, LittleEndian(0, 4) + LittleEndian(2000, 4) + options) +
                                            PcapngBlock(6, LittleEndian(1, 4) + LittleEndian(0x65315, 4) + LittleEndian(1327, 4) +
                                                               LittleEndian(of_null.size(), 4) + LittleEndian(of_null.size(), 4) + of_null));
}

// --- Logs ---

// Every message that has a channel of its own, one after the other, and the log once more, with numbers that begin anew.
void WriteLogs(const Folder& folder) {
  Payload log;
  std::int64_t number = 0;
  ForEachFilledMessage([&](const auto& message) {
    const std::string_view type = message.getTypeName();
    for (const auto& channel : bus::kChannels) {
      if (channel.type == type) bus::AppendLogEvent(log, number++, Utime(std::chrono::seconds(1'780'000'000)), channel.name, bus::Encode(message));
    }
  });
  folder.Write("log", log);
  folder.Write("begins_anew", log + log);
  Payload small;
  for (int i = 0; i < 5; ++i) bus::AppendLogEvent(small, 0, Utime(std::chrono::seconds(i)), "CHANNEL", Payload(10));
  folder.Write("small", small);
}

// --- Messages ---

constexpr std::ptrdiff_t kFingerprintBytes = 8;

void WriteMessages(const Folder& folder) {
  // As the target takes them: the number of the type, then the message without its fingerprint.
  std::uint8_t type = 0;
  ForEachFilledMessage([&](const auto& message) {
    const auto encoded = bus::Encode(message);
    folder.Write("message_" + std::to_string(type), Payload{type} + Payload(encoded.begin() + kFingerprintBytes, encoded.end()));
    ++type;
  });
}

// The number of a type, then two of its messages without their fingerprint: the second has another last byte.
void WritePairsOfMessages(const Folder& folder) {
  ForEachFilledMessage([&](const auto& message) {
    const auto encoded = bus::Encode(message);
    const auto fingerprint = static_cast<std::uint64_t>(std::decay_t<decltype(message)>::getHash());
    const auto& types = bus::TypeFingerprints();
    for (std::size_t type = 0; type < types.size(); ++type) {
      if (types[type].fingerprint != fingerprint) continue;
      const Payload one(encoded.begin() + kFingerprintBytes, encoded.end());
      Payload other = one;
      other.back() ^= 1;
      folder.Write("pair_" + std::to_string(type), Payload{static_cast<std::uint8_t>(type)} + one + other);
    }
  });
}

void WriteScans(const Folder& folder) {
  using namespace segmenter::test;
  for (const int num_returns : {1, 2}) {
    auto scan = EmptyScan({.num_columns = 90, .num_returns = num_returns});
    const std::vector<Wall> walls{{10.0, -8.0, 10.0, 8.0, -1.0, 1.5}, {-5.0, -1.0, -5.0, 1.0, -1.0, 0.5}};
    Look(scan, walls, 0.05);
    const std::string name = num_returns == 1 ? "single" : "dual";
    for (const int num_parts : {1, 2}) {
      const auto messages = ScanMessages(scan, 3, num_parts);
      for (const std::uint8_t image : {0, 1}) {
        const auto encoded = bus::Encode(messages.front());
        folder.Write(name + "_of_" + std::to_string(num_parts) + "_image_" + std::to_string(image),
                     Payload{image} + Payload(encoded.begin(), encoded.end()));
      }
    }
  }
}

// Places, values and messages that are changed: one byte each of SEGMENTS and of the poses.
void WritePatches(const Folder& folder) {
  folder.Write("none", Payload{});
  for (const std::uint8_t message : {0, 1, 3, 5}) {
    Payload patches;
    for (std::uint16_t place = 0; place < 64; place = static_cast<std::uint16_t>(place + 8)) {
      const std::uint8_t value = place % 16 == 0 ? 0x7F : 0xFF;
      patches = patches + LittleEndian(place, 2) + Payload{value, message};
    }
    folder.Write("message_" + std::to_string(message), patches);
  }
}

// NAME.json in the first line, then NAME.f16: two floats, which are no network.
void WriteLearnedWeights(const Folder& folder) {
  const std::string payload("\x00\x3c\x00\xc0", 4);
  bus::Sha256 sha256;
  sha256.Add(payload.data(), payload.size());
  folder.Write("two", R"({"mean": [20, 0, 1, 0.1, 25], "deviation": [16, 13, 3, 0.1, 18], "trained_on": ["beach"], "weights_sha256": ")" +
                          sha256.Finish() + "\"}\n" + payload);
}

// One input is a PCD file, or points and then their labels.
void WritePointFiles(const Folder& folder) {
  using namespace data::test;
  const std::string text = "1 2 3 7\n-4.5 nan 6 0\n1e1 2 3 7\n";
  folder.Write("text.pcd", PcdHeaderText(3, "x y z label", "4 4 4 4", "F F F U", "ascii") + text);
  folder.Write("order.pcd", PcdHeaderText(3, "label z intensity x y", "2 8 4 4 4", "I F F F F", "ascii") + "1 2 3 4 5\n2 3 4 5 6\n3 4 5 6 7\n");
  std::string binary = PcdHeaderText(40, "x y z _ label", "4 4 8 1 4", "F F F U U", "binary");
  std::string points;
  std::string labels;
  for (int i = 0; i < 40; ++i) {
    const auto value = static_cast<float>(i);
    Append(binary, value);
    Append(binary, 10.0F);
    Append(binary, 0.25 * i);
    Append<std::uint8_t>(binary, 0);
    Append(binary, i % 3);
    points += KittiPoint(10.0F, 0.1F * value, static_cast<float>(i % 4));
    labels += KittiLabel(10, static_cast<std::uint16_t>(i % 3));
  }
  folder.Write("binary.pcd", binary);
  folder.Write("kitti", points + labels);
}

void WriteConfigs(const Folder& folder, const std::filesystem::path& boats) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(boats)) {
    if (entry.path().extension() != ".txtpb") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    folder.Write(entry.path().parent_path().filename().string() + "_" + entry.path().filename().string(), text);
  }
}

// What comes back to the plotter.
void WriteAnswers(const Folder& folder) {
  folder.Write("ack", std::string("$IIACK,003*55"));
  folder.Write("acn", std::string("IIACN,102031.00,LKO,10002,3,A,C"));
  folder.Write("requests", std::string("17:33:21.107 R 18EAFF01 00 EE 00\n17:33:21.107 R 18EA2301 14 F0 01\n17:33:21.107 R 18EA2301 00 EE 01\n"
                                       "17:33:21.107 R 18EA2301 00 F1 01\n"));
  folder.Write("contention", std::string("17:33:21.107 R 18EEFF23 01 00 00 00 00 00 00 C0\n17:33:21.107 T 18EEFF24 FF FF FF FF FF FF FF FF\n"
                                         "17:33:21.107 R 18EEFFFE 01 00 00 00 00 00 00 C0\n"));
  folder.Write("command", std::string("17:33:21.107 R 18ECFF01 20 09 00 02 FF D8 FE 00\n17:33:21.107 R 18EBFF01 01 45 23 C1 FF 00 BE 78\n"
                                      "17:33:21.107 R 18EBFF01 02 C0 50 FF FF FF FF FF\n"));
  folder.Write("hello", std::string(R"({"name":"signalk-server","version":"2.23.0","self":"vessels.urn:1"})"));
  folder.Write("delta", std::string(R"({"context":"vessels.self","updates":[{"values":[{"path":"notifications.lookout.x","value":)"
                                    R"({"state":"alarm","method":[],"status":{"silenced":true,"acknowledged":true}}}]}]})"));
}

// Typed answers of lookout-setup; the first letter says what it has heard.
void WriteTypedAnswers(const Folder& folder) {
  folder.Write("usual", std::string("1Ida\n5.2 x 2.1\n1.2 0 1.5\n\n\n\n\n\n"));
  folder.Write("all", std::string("1\n6m, 2m\n-0.5 0.1 1.25\nstarboard\n1 -2\n5.75 -0.4 2\n30\neverybody\n"));
  folder.Write("none", std::string("0boat\n5.2 2.1\nXT32\n1.2 0 1.5\n90\nupside down\nnone\n0\n\n"));
  folder.Write("two", std::string("2boat\n5.2;2.1\n2\n1.2 0 1.5\nahead\nlevel\nnone\nas usual\nthis computer\n"));
  folder.Write("heading", std::string("\x82\nhull\n5,2\n5.2 2.1\n1\n1.2 0 1.5\n\n\n\n-90\n\n\n"));
}

// What a browser asks the page's server for, and headers of its requests.
void WritePageRequests(const Folder& folder) {
  folder.Write("watch", std::string(R"({"op":"watch","channels":["LIDAR_SCAN","TRACKS"]})"));
  folder.Write("got", std::string(R"({"op":"got","frames":12})"));
  folder.Write("at", std::string(R"({"op":"at","id":7,"source":1,"utime_us":1781618400000000,"channels":["TRACKS"]})"));
  folder.Write("scan", std::string(R"({"op":"at","id":7,"source":1,"scan_utime_us":1781618400000000,"channels":[]})"));
  folder.Write("step", std::string(R"({"op":"step","id":8,"source":0,"utime_us":1781618400000000,"scans":-1,"channels":["POSE"]})"));
  folder.Write("range", std::string(R"({"op":"range","id":9,"source":0,"channel":"POSE","from_utime_us":1,"to_utime_us":2,"max_messages":500})"));
  folder.Write("strip", std::string(R"({"op":"strip","id":9,"source":0,"from_utime_us":1,"to_utime_us":2,"buckets":800})"));
  folder.Write("acknowledgement", std::string(R"({"alert_id":7,"raised_utime_us":1781618400000000})"));
  folder.Write("order", std::string(R"({"kind":"settings","mode":"harbour","guard_zone_range_m":7.5,"cpa_limit_m":3})"));
  folder.Write("host", std::string("[::1]:8080"));
  folder.Write("origin", std::string("http://localhost:8080"));
  folder.Write("token", std::string("Bearer token"));
  folder.Write("tile", std::string("/tiles/12/2200/1500"));
  folder.Write("encoding", std::string("gzip;q=0.5, deflate, br;q=0"));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "make_corpus FOLDER CONFIG: seeds for each fuzz target into FOLDER/<target>; CONFIG holds the boats' files\n";
    return 2;
  }
  const std::filesystem::path root(argv[1]);
  const Folder data_packets(root / "fuzz_data_packet");
  WriteDataPackets(data_packets);
  WritePositionPackets(Folder(root / "fuzz_position_packet"), data_packets);
  WriteHesaiPackets(Folder(root / "fuzz_hesai"));
  WriteVelodynePackets(Folder(root / "fuzz_velodyne"));
  WriteOuster(Folder(root / "fuzz_ouster"));
  WriteAis(Folder(root / "fuzz_ais"));
  WriteSentences(Folder(root / "fuzz_nmea_sentence"));
  WriteMotions(Folder(root / "fuzz_odometry_line"));
  WriteAutopilot(Folder(root / "fuzz_mavlink"));
  WriteAnswers(Folder(root / "fuzz_plotter"));
  WriteTypedAnswers(Folder(root / "fuzz_setup"));
  WriteCaptures(Folder(root / "fuzz_capture"));
  WriteLogs(Folder(root / "fuzz_log"));
  WriteMessages(Folder(root / "fuzz_message"));
  WritePairsOfMessages(Folder(root / "fuzz_message_diff"));
  WriteScans(Folder(root / "fuzz_segmenter"));
  WritePatches(Folder(root / "fuzz_georeferencer"));
  WritePatches(Folder(root / "fuzz_tracker"));
  WriteLearnedWeights(Folder(root / "fuzz_learned_weights"));
  WritePointFiles(Folder(root / "fuzz_point_file"));
  WritePageRequests(Folder(root / "fuzz_page_request"));
  WriteArchiveTexts(Folder(root / "fuzz_archive"));
  WriteRecordings(root);
  WriteConfigs(Folder(root / "fuzz_config"), argv[2]);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "make_corpus: " << error.what() << '\n';
  return 1;
}
