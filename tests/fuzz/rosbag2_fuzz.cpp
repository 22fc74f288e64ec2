// Any bytes as a database of rosbag2.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "tests/fuzz/recording_fuzz.hpp"
#include "tools/import/rosbag2_database.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout::importer;
  try {
    Rosbag2Database database(std::vector<std::uint8_t>(data, data + size));
    ImportAll(database, database.topics());
  } catch (const std::runtime_error&) {
    return 0;  // no recording: said, not a fault
  }
  return 0;
}
