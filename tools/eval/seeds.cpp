#include "tools/eval/seeds.hpp"

#include <stdexcept>
#include <string>

namespace lookout::eval {

void CheckSeeds(SeedUse use, std::uint64_t first_seed, int num_seeds) {
  const std::uint64_t last_seed = first_seed + static_cast<std::uint64_t>(num_seeds) - 1;
  const std::string seeds = "seeds " + std::to_string(first_seed) + " to " + std::to_string(last_seed);
  const std::string ranges = " (seeds of tuning are " + std::to_string(kFirstTuningSeed) + " to " + std::to_string(kLastTuningSeed) +
                             ", those of tables " + std::to_string(kFirstTableSeed) + " and above)";
  if (last_seed < first_seed) {
    throw std::invalid_argument(std::to_string(num_seeds) + " seeds from " + std::to_string(first_seed) + " on: there are not so many" + ranges);
  }
  if (use == SeedUse::kTables && first_seed < kFirstTableSeed) {
    throw std::invalid_argument(seeds + ": tables are not made on seeds of tuning" + ranges + "; --tuning shows them without making a table");
  }
  if (use == SeedUse::kTuning && (first_seed < kFirstTuningSeed || last_seed > kLastTuningSeed)) {
    throw std::invalid_argument(seeds + ": nothing is tuned on seeds of tables" + ranges);
  }
}

}  // namespace lookout::eval
