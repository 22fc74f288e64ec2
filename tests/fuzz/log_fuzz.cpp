// Any bytes as an lcm-log: read whole, by its heads, and as one that grows; what is found is whole, and comes the same each time.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "tools/log/payloads.hpp"

namespace {

using lookout::bus::LogReader;

void Require(bool holds) {
  if (!holds) std::abort();
}

void Read(const std::string& name, std::size_t size) {
  std::vector<std::int64_t> places;
  LogReader reader(name);
  std::int64_t end = 0;
  while (const auto event = reader.Next()) {
    Require(event->position_bytes >= end);
    end = reader.position_bytes();
    Require(end <= static_cast<std::int64_t>(size) && event->bytes.size() == event->num_data_bytes);
    lookout::log::PayloadFault(event->channel, event->bytes);
    places.push_back(event->position_bytes);
  }
  LogReader heads(name);
  for (const auto place : places) {
    const auto event = heads.NextHead([](std::string_view) { return std::size_t{8}; });
    Require(event && event->position_bytes == place);
  }
  LogReader growing(name);
  std::size_t num_found = 0;
  while (growing.NextHeadSoFar([](std::string_view) { return std::size_t{0}; })) ++num_found;
  Require(num_found <= places.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("log", MFD_CLOEXEC);
  if (file < 0) std::abort();
  if (write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  try {
    Read("/proc/self/fd/" + std::to_string(file), size);
  } catch (const std::runtime_error&) {
    // Another kind of file: said, not a fault.
  }
  close(file);
  return 0;
}
