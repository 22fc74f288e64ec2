// Folders of scans made file by file.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lookout::importer::test {

template <typename T>
void AppendRaw(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), sizeof(T));
}

struct MadePoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  float intensity = 0.0F;
  std::uint16_t ring = 0;
  double time_s = 0.0;
  std::uint32_t label = 0;
};

/// A turn of 16 rings, 2 degrees apart, on a wall around at 20 m; what stands nearer from `first_deg` to `last_deg` has the label.
inline std::vector<MadePoint> MadeTurn(double first_deg = 0.0, double last_deg = 0.0, std::uint32_t label = 0) {
  constexpr int kNumColumns = 360;
  constexpr double kRadPerDeg = 0.017453292519943295;
  std::vector<MadePoint> points;
  for (int column = 0; column < kNumColumns; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth_deg = 360.0 * (column + 0.5) / kNumColumns;
      const bool is_thing = azimuth_deg >= first_deg && azimuth_deg < last_deg;
      const double level_m = is_thing ? 8.0 : 20.0;
      const double elevation_rad = kRadPerDeg * (2.0 * ring - 15.0);
      points.push_back({static_cast<float>(level_m * std::cos(kRadPerDeg * azimuth_deg)),
                        static_cast<float>(-level_m * std::sin(kRadPerDeg * azimuth_deg)), static_cast<float>(level_m * std::tan(elevation_rad)),
                        is_thing ? 0.8F : 0.25F, static_cast<std::uint16_t>(ring), 0.1 * column / kNumColumns, is_thing ? label : 0});
    }
  }
  return points;
}

inline std::string KittiBytes(const std::vector<MadePoint>& points) {
  std::string bytes;
  for (const auto& point : points) {
    for (const float value : {point.x_m, point.y_m, point.z_m, point.intensity}) AppendRaw(bytes, value);
  }
  return bytes;
}

inline std::string LabelBytes(const std::vector<MadePoint>& points) {
  std::string bytes;
  for (const auto& point : points) AppendRaw(bytes, point.label);
  return bytes;
}

/// LZF: bytes as they are, and a byte that is repeated as a match.
inline std::string PackLzf(const std::string& bytes) {
  std::string packed;
  std::size_t at = 0;
  while (at < bytes.size()) {
    std::size_t run = 1;
    while (at + run < bytes.size() && bytes[at + run] == bytes[at] && run < 265) ++run;
    const auto is_run = run >= 12;
    packed += '\0';
    packed += bytes[at];
    ++at;
    if (!is_run) continue;
    const auto length = run - 1 - 2;  // of the match, less two
    packed += '\xE0';
    packed += static_cast<char>(length - 7);
    packed += '\0';
    at += run - 1;
  }
  return packed;
}

enum class PcdKind { kText, kBinary, kCompressed };

/// x y z intensity, ring (16 bits), time (64-bit float).
inline std::string PcdBytes(const std::vector<MadePoint>& points, PcdKind kind, int height = 1) {
  const auto num = std::to_string(points.size());
  const std::string word = kind == PcdKind::kText ? "ascii" : kind == PcdKind::kBinary ? "binary" : "binary_compressed";
  std::string bytes = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 8\nTYPE F F F F U F\nCOUNT 1 1 1 1 1 1\nWIDTH " +
                      std::to_string(points.size() / static_cast<std::size_t>(height)) + "\nHEIGHT " + std::to_string(height) +
                      "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + num + "\nDATA " + word + "\n";
  if (kind == PcdKind::kText) {
    for (const auto& point : points) {
      for (const float value : {point.x_m, point.y_m, point.z_m, 100.0F * point.intensity}) bytes += std::to_string(value) + " ";
      bytes += std::to_string(point.ring) + " " + std::to_string(point.time_s) + "\n";
    }
    return bytes;
  }
  if (kind == PcdKind::kBinary) {
    for (const auto& point : points) {
      for (const float value : {point.x_m, point.y_m, point.z_m, 100.0F * point.intensity}) AppendRaw(bytes, value);
      AppendRaw(bytes, point.ring);
      AppendRaw(bytes, point.time_s);
    }
    return bytes;
  }
  std::string plain;
  for (const auto& point : points) AppendRaw(plain, point.x_m);
  for (const auto& point : points) AppendRaw(plain, point.y_m);
  for (const auto& point : points) AppendRaw(plain, point.z_m);
  for (const auto& point : points) AppendRaw(plain, 100.0F * point.intensity);
  for (const auto& point : points) AppendRaw(plain, point.ring);
  for (const auto& point : points) AppendRaw(plain, point.time_s);
  const auto packed = PackLzf(plain);
  AppendRaw(bytes, static_cast<std::uint32_t>(packed.size()));
  AppendRaw(bytes, static_cast<std::uint32_t>(plain.size()));
  return bytes + packed;
}

/// Of a boat that goes east at 2 m/s.
inline std::string OxtsText() {
  return "45.5 9.25 210.125 0.05 -0.02 0.0 0.0 2.0 2.0 0.0 0.0 0.1 0.2 9.8 0.1 0.2 9.8 0.01 0.02 0.03 0.01 0.02 0.03 0.3 0.01 4 11 6 6 6\n";
}

inline void WriteIn(const std::filesystem::path& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

}  // namespace lookout::importer::test
