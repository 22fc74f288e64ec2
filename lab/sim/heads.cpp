#include "lab/sim/heads.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lookout::sim {
namespace {

std::vector<HeadBeam> LowestFirst(std::vector<HeadBeam> beams) {
  std::ranges::sort(beams, {}, &HeadBeam::elevation_deg);
  return beams;
}

// Velodyne VLP-32C User Manual 63-9325, table 9-1: by laser; a pair fires each 2.304 us.
std::vector<HeadBeam> BeamsOfVlp32c() {
  constexpr std::array<double, 32> kElevationDeg{-25.0,  -1.0,   -1.667, -15.639, -11.31, 0.0,    -0.667, -8.843, -7.254, 0.333,  -0.333,
                                                 -6.148, -5.333, 1.333,  0.667,   -4.0,   -4.667, 1.667,  1.0,    -3.667, -3.333, 3.333,
                                                 2.333,  -2.667, -3.0,   7.0,     4.667,  -2.333, -2.0,   15.0,   10.333, -1.333};
  constexpr std::array<double, 32> kOffsetDeg{1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
                                              1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4};
  std::vector<HeadBeam> beams;
  beams.reserve(kElevationDeg.size());
  for (std::size_t laser = 0; laser < kElevationDeg.size(); ++laser) {
    beams.push_back({kElevationDeg[laser], kOffsetDeg[laser], 2.304 * std::floor(static_cast<double>(laser) / 2.0)});
  }
  return LowestFirst(std::move(beams));
}

// Velodyne HDL-32E User Manual 63-9113: even lasers from -30.67 deg, odd ones from -9.33 deg, one each 1.152 us.
std::vector<HeadBeam> BeamsOfHdl32e() {
  std::vector<HeadBeam> beams;
  beams.reserve(32);
  for (int laser = 0; laser < 32; ++laser) {
    const double first_deg = laser % 2 == 0 ? -92.0 / 3.0 : -28.0 / 3.0;
    beams.push_back({first_deg + 4.0 / 3.0 * std::floor(laser / 2.0), 0.0, 1.152 * laser});
  }
  return LowestFirst(std::move(beams));
}

// Ouster, gen 1 and 2: equal steps, four lines of beams side by side.
std::vector<HeadBeam> BeamsOfOs1(int num_beams, double highest_deg, const std::array<double, 4>& offset_deg) {
  std::vector<HeadBeam> beams;
  beams.reserve(static_cast<std::size_t>(num_beams));
  for (int beam = 0; beam < num_beams; ++beam) {
    beams.push_back({highest_deg - 2.0 * highest_deg * beam / (num_beams - 1), offset_deg[static_cast<std::size_t>(beam) % offset_deg.size()], 0.0});
  }
  return LowestFirst(std::move(beams));
}

// Hesai PandarXT-32 User Manual: 15 to -16 deg by 1 deg, a channel each 1.512 us.
std::vector<HeadBeam> BeamsOfXt32() {
  std::vector<HeadBeam> beams;
  beams.reserve(32);
  for (int channel = 0; channel < 32; ++channel) beams.push_back({15.0 - channel, 0.0, 0.368 + 1.512 * channel});
  return LowestFirst(std::move(beams));
}

// Hesai PandarQT User Manual, appendix: steps from 1.45 deg in the middle to 2.3 deg at the ends, two lines of beams. Firing times stand for its
// table.
std::vector<HeadBeam> BeamsOfQt64() {
  constexpr std::array<double, 32> kElevationDeg{0.725,  2.175,  3.626,  5.079,  6.535,  7.994,  9.457,  10.925, 12.399, 13.88, 15.368,
                                                 16.865, 18.372, 19.889, 21.42,  22.964, 24.517, 26.094, 27.69,  29.308, 30.95, 32.619,
                                                 34.32,  36.055, 37.831, 39.653, 41.528, 43.465, 45.477, 47.577, 49.785, 52.121};
  std::vector<HeadBeam> beams;
  for (int channel = 0; channel < 64; ++channel) {
    const auto from_middle = static_cast<std::size_t>(channel < 32 ? 31 - channel : channel - 32);
    // Farther out the lines are farther apart: the optics stretch azimuths by the secant of the elevation.
    const double elevation_deg = channel < 32 ? -kElevationDeg[from_middle] : kElevationDeg[from_middle];
    const bool is_left = channel / 16 % 2 == 1;
    const double stretch = 1.0 / std::cos(DegToRad(elevation_deg));
    beams.push_back({elevation_deg, (is_left ? -4.9 : 5.4) * std::sqrt(stretch), 2.4 * channel});
  }
  return LowestFirst(std::move(beams));
}

// Range noise and reach as multiples of a VLP-16's (sd 2.5 cm; 100 m): data sheets. Range units: as the drivers write them into LIDAR_SCAN.
std::vector<Head> MakeHeads() {
  std::vector<Head> heads;
  heads.push_back(
      {"vlp-32c", "VLP-32C", BeamsOfVlp32c(), 55.296, 0, 0.0, {.unit_m = 0.004, .min_m = 0.5, .max_m = 200.0, .noise = 1.0, .reach = 1.6}});
  heads.push_back(
      {"hdl-32e", "HDL-32E", BeamsOfHdl32e(), 46.08, 0, 0.0, {.unit_m = 0.002, .min_m = 0.9, .max_m = 110.0, .noise = 0.8, .reach = 1.0}});
  heads.push_back({"os1-64",
                   "OS1-64",
                   BeamsOfOs1(64, 16.6, {3.07, 0.92, -1.23, -3.37}),
                   0.0,
                   1024,
                   0.012163,
                   {.unit_m = 0.002, .min_m = 0.5, .max_m = 130.0, .noise = 0.6, .reach = 0.9}});
  heads.push_back({"os1-128",
                   "OS1-128",
                   BeamsOfOs1(128, 21.15, {4.23, 1.41, -1.41, -4.23}),
                   0.0,
                   2048,
                   0.015806,
                   {.unit_m = 0.004, .min_m = 0.5, .max_m = 200.0, .noise = 0.6, .reach = 1.1}});
  heads.push_back({"xt32", "PandarXT-32", BeamsOfXt32(), 50.0, 0, 0.0, {.unit_m = 0.004, .min_m = 0.1, .max_m = 120.0, .noise = 0.3, .reach = 1.2}});
  heads.push_back(
      {"qt64", "PandarQT", BeamsOfQt64(), 500.0 / 3.0, 0, 0.0, {.unit_m = 0.004, .min_m = 0.1, .max_m = 60.0, .noise = 0.8, .reach = 0.4}});
  return heads;
}

}  // namespace

std::span<const Head> Heads() {
  static const std::vector<Head> heads = MakeHeads();
  return heads;
}

const Head* FindHead(std::string_view name) {
  const auto found = std::ranges::find(Heads(), name, &Head::name);
  return found == Heads().end() ? nullptr : &*found;
}

std::vector<std::string> HeadNames() {
  std::vector<std::string> names{std::string(kVlp16Name), std::string(kHiResName)};
  names.reserve(names.size() + Heads().size());
  for (const Head& head : Heads()) names.emplace_back(head.name);
  return names;
}

}  // namespace lookout::sim
