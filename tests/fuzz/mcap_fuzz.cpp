// Any bytes as an MCAP file.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/fuzz/recording_fuzz.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/mcap_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout::importer;
  const std::vector<std::uint8_t> bytes(data, data + size);
  McapFile whole(std::make_unique<MemorySource>(bytes));
  auto topics = whole.IndexedTopics();
  if (topics.empty()) {
    while (whole.Next()) {
    }
    topics = whole.topics();
  }
  McapFile file(std::make_unique<MemorySource>(bytes));
  ImportAll(file, topics);
  return 0;
}
