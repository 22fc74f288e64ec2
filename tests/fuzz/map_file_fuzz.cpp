// Any text as the file of the own map: a map that is written and read again as the same, or a refusal.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "services/tracker/map_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace tracker = lookout::tracker;
  try {
    const auto text = tracker::MapText(tracker::ParseMap({reinterpret_cast<const char*>(data), size}));
    if (tracker::MapText(tracker::ParseMap(text)) != text) std::abort();
  } catch (const tracker::MapFileError&) {
    // A refusal: said, not a fault.
  }
  return 0;
}
