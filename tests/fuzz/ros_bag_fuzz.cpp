// Any bytes as a ROS bag.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/fuzz/recording_fuzz.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/ros_bag.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout::importer;
  const std::vector<std::uint8_t> bytes(data, data + size);
  RosBag whole(std::make_unique<MemorySource>(bytes));
  auto topics = whole.IndexedTopics();
  if (topics.empty()) {
    while (whole.Next()) {
    }
    topics = whole.topics();
  }
  RosBag bag(std::make_unique<MemorySource>(bytes));
  ImportAll(bag, topics);
  return 0;
}
