// Which seeds of the simulator may choose values, and which may make tables. A figure on seeds that chose the method flatters it.
#pragma once

#include <cstdint>

namespace lookout::eval {

/// Seeds of sweeps, and of every choice of a default: ours (1 to 4) and the peers' (1 to 4) were chosen on these. The guards of the tests, too.
inline constexpr std::uint64_t kFirstTuningSeed = 1;
inline constexpr std::uint64_t kLastTuningSeed = 100;

/// Seeds of tables and figures: these and above. Nothing was ever chosen on them.
inline constexpr std::uint64_t kFirstTableSeed = 101;

enum class SeedUse { kTuning, kTables };

/// @return the first seed where the user names none
constexpr std::uint64_t DefaultFirstSeed(SeedUse use) { return use == SeedUse::kTuning ? kFirstTuningSeed : kFirstTableSeed; }

/// @throws std::invalid_argument when one of the seeds is of the other range; says both ranges
void CheckSeeds(SeedUse use, std::uint64_t first_seed, int num_seeds);

}  // namespace lookout::eval
