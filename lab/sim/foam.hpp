// How much light foam and drops give back, and how long foam lasts: shared by wakes, crests, breakers and clouds.
#pragma once

namespace lookout::sim {

// Koepke, "Effective reflectance of oceanic whitecaps", Applied Optics 23, 1984: 0.22, foam of all ages.
inline constexpr double kFoamReflectance = 0.22;
inline constexpr double kDropReflectance = 0.04;

// Foam of breaking waves fades with a time constant of 2.5 s in fresh and 3.9 s in salt water (Monahan and Zietlow, "Laboratory comparisons of
// fresh-water and salt-water whitecaps", Journal of Geophysical Research 74, 1969).
inline constexpr double kFoamFadesS = 3.0;
inline constexpr double kFoamEndsS = 3.0 * kFoamFadesS;

}  // namespace lookout::sim
