// Any text as an Ouster's metadata, and any bytes, whole packets and packets with a few bytes changed through its reader: what comes out is sound.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "common/core/angles.hpp"
#include "services/lidar/core/models/ouster.hpp"
#include "tests/unit/lidar_models/ouster_packet_maker.hpp"

namespace {

using namespace lookout;
using namespace lookout::lidar;

// The optimiser makes one abort() of all, so that a stack trace does not tell which.
void Expect(bool is_true, int line = __builtin_LINE()) {
  if (is_true) return;
  std::fprintf(stderr, "line %d does not hold\n", line);
  std::abort();
}

void CheckHead(const Head& head, const OusterMetadata& metadata) {
  Expect(head.beams.size() == static_cast<std::size_t>(metadata.pixels_per_column) && !head.beams.empty() && head.beams.size() <= 128);
  Expect(head.returns.size() == 1 || head.returns.size() == 2);
  Expect(std::ranges::is_sorted(head.beams, {}, &Beam::elevation_rad));
  Expect(std::ranges::all_of(head.beams, [](const Beam& beam) {
    return std::abs(beam.elevation_rad) <= kPi / 2 && std::abs(beam.azimuth_offset_rad) <= kPi && std::abs(beam.origin_height_m) < 1.0;
  }));
}

void CheckPacket(const Packet& packet, const Head& head) {
  Expect(packet.range.size() == packet.columns.size() * head.num_cells_of_column() && packet.reflectivity.size() == packet.range.size());
  Expect(packet.stamp.count() >= 0 && packet.duration.count() >= 0);
  Expect(!packet.number || packet.number->number < packet.number->modulus);
  Expect(std::ranges::is_sorted(packet.columns, {}, &Column::time));
  for (const auto& column : packet.columns) {
    Expect(column.azimuth_rad >= 0.0 && column.azimuth_rad < kTwoPi && column.time.count() >= 0 && column.time <= std::chrono::seconds(1));
  }
  for (std::size_t cell = 0; cell < packet.range.size(); ++cell) {
    Expect(packet.range[cell] < 1U << 20 && (packet.range[cell] != 0 || packet.reflectivity[cell] == 0));
  }
}

void Read(OusterReader& reader, Bytes payload, Packet& packet) {
  for (const auto& layout : OusterLayoutsOf(payload)) {
    Expect(layout.pixels_per_column >= 16 && layout.pixels_per_column <= 128 && OusterStampOf(payload, layout).count() >= 0);
  }
  const std::size_t num_before = packet.range.size();
  const auto number_before = packet.number;
  if (reader.Read(payload, packet) == PacketFault::kNone) {
    CheckPacket(packet, reader.head());
  } else {
    Expect(!reader.reason().empty() && packet.range.size() == num_before && packet.number.has_value() == number_before.has_value());
  }
}

void ReadMetadata(Bytes text) {
  try {
    const auto metadata = ParseOusterMetadata({reinterpret_cast<const char*>(text.data()), text.size()});
    OusterReader reader(metadata);
    CheckHead(reader.head(), metadata);
    Packet packet;
    Read(reader, ouster_maker::MakePacket(metadata, {}), packet);
  } catch (const std::runtime_error&) {
    return;  // refused: said, not a fault
  }
}

void ReadPackets(Bytes script) {
  constexpr std::size_t kHeadBytes = 8;
  constexpr std::size_t kStepBytes = 16;
  if (script.size() < kHeadBytes) return;
  const int columns_per_packet = 1 + script[1] % 16;
  const int num_columns = columns_per_packet + ReadU16LittleEndian(script, 2) % 2048;
  auto metadata = ouster_maker::MakeMetadata(static_cast<OusterProfile>(script[0] % 5), 1 + script[0] / 5 % 16, columns_per_packet, num_columns);
  metadata.first_column = ReadU16LittleEndian(script, 4) % num_columns;
  metadata.last_column = ReadU16LittleEndian(script, 6) % num_columns;
  OusterReader reader(metadata);
  CheckHead(reader.head(), metadata);
  Packet packet;
  ouster_maker::PacketText text;
  for (Bytes rest = script.subspan(kHeadBytes); rest.size() >= kStepBytes; rest = rest.subspan(kStepBytes)) {
    const std::uint8_t kind = rest[0];
    if ((kind & 3) == 3) return Read(reader, rest.subspan(1), packet);
    text.first_id = ReadU16LittleEndian(rest, 1);
    text.frame = ReadU16LittleEndian(rest, 3) * ((kind & 4) != 0 ? 65'537U : 1U);
    text.stamp_ns += ReadU32LittleEndian(rest, 5);
    text.column_ns = ReadU16LittleEndian(rest, 9);
    text.has_checksum = (kind & 8) != 0;
    const auto good = ReadU16LittleEndian(rest, 11);
    text.is_good = [good](int column) { return (good >> (column % 16) & 1) != 0; };
    auto bytes = ouster_maker::MakePacket(metadata, text);
    const std::size_t place = ReadU16LittleEndian(rest, 13) % bytes.size();
    if ((kind & 3) == 1) bytes[place] = rest[15];
    if ((kind & 3) == 2) bytes.resize(place);
    Read(reader, bytes, packet);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, size);
  if (const auto sample = ParseOusterImu(bytes)) {
    for (std::size_t axis = 0; axis < 3; ++axis) Expect(std::isfinite(sample->acceleration_g[axis]) && std::isfinite(sample->rate_degps[axis]));
  }
  if (!bytes.empty() && bytes[0] == '{') {
    ReadMetadata(bytes);
  } else {
    ReadPackets(bytes);
  }
  return 0;
}
