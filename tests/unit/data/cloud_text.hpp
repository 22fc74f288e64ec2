// Recordings of others, small enough to be written by hand.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace lookout::data::test {

template <typename T>
void Append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

inline std::string KittiPoint(float x_m, float y_m, float z_m, float intensity = 0.5F) {
  std::string bytes;
  for (const float value : {x_m, y_m, z_m, intensity}) Append(bytes, value);
  return bytes;
}

inline std::string KittiLabel(std::uint16_t kind, std::uint16_t instance) {
  std::string bytes;
  Append(bytes, static_cast<std::uint32_t>(instance) << 16 | kind);
  return bytes;
}

/// Header of `num_points` in one row.
inline std::string PcdHeaderText(int num_points, std::string_view fields, std::string_view sizes, std::string_view types, std::string_view data) {
  const auto num = std::to_string(num_points);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + std::string(fields) + "\nSIZE " + std::string(sizes) + "\nTYPE " + std::string(types) + "\nWIDTH " +
         num + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + num + "\nDATA " + std::string(data) + "\n";
}

}  // namespace lookout::data::test
