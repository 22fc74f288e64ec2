// Captures of spinning lidars at hand, whole and as truth by others tells them. Each datagram of these captures is one frame.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "services/lidar/core/models/packet_reader.hpp"
#include "tests/support/files.hpp"

namespace lookout::lidar {

using namespace std::chrono_literals;
using Payload = std::vector<std::uint8_t>;

inline std::string Unpacked(const std::filesystem::path& file) {
  if (file.extension() != ".xz") return support::ReadFile(file);
  FILE* pipe = popen(("xz -dc '" + file.string() + "'").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error(file.string() + " cannot be unpacked");
  std::string bytes;
  std::array<char, 65'536> buffer{};
  while (const std::size_t num_read = fread(buffer.data(), 1, buffer.size(), pipe)) bytes.append(buffer.data(), num_read);
  if (pclose(pipe) != 0) throw std::runtime_error(file.string() + " cannot be unpacked");
  return bytes;
}

/// Payloads to the port in a capture of libpcap (little-endian, Ethernet, IPv4 without options).
inline std::vector<Payload> PayloadsTo(int port, const std::string& capture) {
  constexpr std::size_t kFileHead = 24;
  constexpr std::size_t kRecordHead = 16;
  constexpr std::size_t kFrameHead = 14 + 20 + 8;
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(capture.data()), capture.size());
  std::vector<Payload> payloads;
  for (std::size_t at = kFileHead; at + kRecordHead <= bytes.size();) {
    const std::size_t num_bytes = ReadU32LittleEndian(bytes, at + 8);
    const Bytes frame = bytes.subspan(at + kRecordHead, num_bytes);
    at += kRecordHead + num_bytes;
    if (frame.size() < kFrameHead || (frame[36] << 8 | frame[37]) != port) continue;
    const auto num_payload_bytes = static_cast<std::size_t>(frame[38] << 8 | frame[39]) - 8;
    payloads.emplace_back(frame.begin() + kFrameHead, frame.begin() + static_cast<std::ptrdiff_t>(kFrameHead + num_payload_bytes));
  }
  return payloads;
}

struct TrueReturn {
  int packet = 0;
  int block = 0;
  int channel = 0;
  int range_mm = 0;
  int reflectivity = 0;
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double time_us = 0.0;
  std::array<double, 3> p_maker_m{};  // +y at azimuth 0, +x right
};

inline std::vector<TrueReturn> ReadTruth(const std::filesystem::path& file) {
  const std::string text = Unpacked(file);
  std::vector<TrueReturn> truth;
  for (std::size_t at = text.find('\n') + 1; at < text.size(); at = text.find('\n', at) + 1) {
    std::array<double, 12> fields{};
    const char* place = text.data() + at;
    for (auto& field : fields) place = std::from_chars(place, text.data() + text.size(), field).ptr + 1;
    truth.push_back({static_cast<int>(fields[0]),
                     static_cast<int>(fields[1]),
                     static_cast<int>(fields[2]),
                     static_cast<int>(std::lround(1000.0 * fields[6])),
                     static_cast<int>(fields[7]),
                     fields[4],
                     fields[5],
                     fields[8],
                     {fields[9], fields[10], fields[11]}});
  }
  return truth;
}

/// Sums of a whole capture.
struct Totals {
  std::int64_t num_packets = 0;
  std::int64_t num_returns = 0;
  std::int64_t sum_range_mm = 0;
  std::int64_t sum_reflectivity = 0;

  bool operator==(const Totals&) const = default;
};

inline void PrintTo(const Totals& totals, std::ostream* out) {
  *out << totals.num_packets << " packets, " << totals.num_returns << " returns, " << totals.sum_range_mm << " mm, " << totals.sum_reflectivity;
}

inline void Add(const Packet& packet, const Head& head, Totals& totals) {
  const auto unit_mm = std::llround(1000.0 * head.range_unit_m);
  ++totals.num_packets;
  for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
    totals.num_returns += packet.range[cell] != 0 ? 1 : 0;
    totals.sum_range_mm += unit_mm * packet.range[cell];
    totals.sum_reflectivity += packet.reflectivity[cell];
  }
}

/// Of the column in its packet, radians per second: to the next column, for the last from the one before.
inline double RateRadps(const Packet& packet, std::size_t column) {
  if (packet.columns.size() < 2) return 0.0;
  const std::size_t from = std::min(column, packet.columns.size() - 2);
  const double turn_rad = std::remainder(packet.columns[from + 1].azimuth_rad - packet.columns[from].azimuth_rad, 2.0 * std::numbers::pi);
  return turn_rad / std::chrono::duration<double>(packet.columns[from + 1].time - packet.columns[from].time).count();
}

/// Expects that the packet holds each of these returns and no other, and that pairs are in the order of their ranges where `is_nearest_first`.
/// Azimuth within 0.01 deg, position within 2 mm, time within 1 us. Truth gives a jump within a packet no time: such packets are compared without
/// times.
inline void ExpectReturns(std::span<const TrueReturn> truth, const Packet& packet, const Head& head, bool is_nearest_first) {
  // [column, channel, range_mm, reflectivity]: returns of one shot may come in another order.
  using Key = std::tuple<int, int, int, int>;
  const std::size_t num_returns = head.returns.size();
  std::multimap<Key, std::size_t> cells;
  const auto unit_mm = std::llround(1000.0 * head.range_unit_m);
  for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
    if (packet.range[cell] == 0) continue;
    const auto& beam = head.beams[cell / num_returns % head.beams.size()];
    const std::size_t column = cell / head.num_cells_of_column();
    cells.emplace(Key(static_cast<int>(column), beam.channel, static_cast<int>(unit_mm * packet.range[cell]), packet.reflectivity[cell]), cell);
    if (is_nearest_first && cell % 2 == 1) {
      EXPECT_LE(packet.range[cell - 1], packet.range[cell]);
      EXPECT_NE(packet.range[cell - 1], 0U);
    }
  }
  const double degree = std::numbers::pi / 180.0;
  const bool has_jump = packet.duration > 5ms;
  for (const auto& one : truth) {
    const int column = one.block / static_cast<int>(num_returns);
    const auto found = cells.find(Key(column, one.channel, one.range_mm, one.reflectivity));
    ASSERT_NE(found, cells.end()) << "packet " << one.packet << " block " << one.block << " channel " << one.channel << " " << one.range_mm << " mm";
    const auto& beam = head.beams[found->second / num_returns % head.beams.size()];
    cells.erase(found);
    const auto& fired = packet.columns[static_cast<std::size_t>(column)];
    const double turned_rad = RateRadps(packet, static_cast<std::size_t>(column)) * std::chrono::duration<double>(beam.turning_time).count();
    const double azimuth_rad = fired.azimuth_rad + beam.azimuth_offset_rad + turned_rad;
    EXPECT_LT(std::abs(std::remainder(azimuth_rad / degree - one.azimuth_deg, 360.0)), 0.01);
    EXPECT_NEAR(beam.elevation_rad / degree, one.elevation_deg, 0.001);
    if (!has_jump) {
      EXPECT_NEAR(std::chrono::duration<double>(fired.time + beam.time_offset).count() * 1e6, one.time_us, 1.0);
    }
    const double range_m = one.range_mm / 1000.0;
    const double level_m = range_m * std::cos(beam.elevation_rad);
    EXPECT_NEAR(level_m * std::sin(azimuth_rad), one.p_maker_m[0], 0.002);
    EXPECT_NEAR(level_m * std::cos(azimuth_rad), one.p_maker_m[1], 0.002);
    EXPECT_NEAR(range_m * std::sin(beam.elevation_rad) + beam.origin_height_m, one.p_maker_m[2], 0.002);
  }
  EXPECT_TRUE(cells.empty()) << cells.size() << " returns that truth does not know";
}

/// Reads a capture as a whole.
///
/// @return its totals; the number of returns that were compared with truth as `num_compared`
inline Totals CheckCapture(const std::filesystem::path& capture, const std::filesystem::path& truth_file, PacketReader& reader, bool is_nearest_first,
                           std::size_t& num_compared) {
  const auto truth = ReadTruth(truth_file);
  num_compared = truth.size();
  Packet packet;
  Totals totals;
  auto next = truth.begin();
  int number = 0;
  for (const auto& payload : PayloadsTo(2368, Unpacked(capture))) {
    const auto fault = reader.Read(payload, packet);
    EXPECT_EQ(fault, PacketFault::kNone) << "packet " << number << ": " << reader.reason();
    if (fault != PacketFault::kNone) return totals;
    Add(packet, reader.head(), totals);
    const auto end = std::find_if(next, truth.end(), [&](const TrueReturn& one) { return one.packet != number; });
    if (next != end) ExpectReturns({next, end}, packet, reader.head(), is_nearest_first);
    if (::testing::Test::HasFailure()) return totals;
    next = end;
    ++number;
  }
  EXPECT_EQ(next, truth.end());
  return totals;
}

}  // namespace lookout::lidar
