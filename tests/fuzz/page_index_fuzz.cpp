// The index of a log, behind a right head and with a right digest: whatever stands in it, it is read whole and as it was written, or refused.
#include <cstdlib>

#include "common/bus/schema.hpp"
#include "services/page/film/index_file.hpp"

using namespace lookout;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kDigestBytes = 64;
  constexpr std::size_t kCountsBytes = 4 * sizeof(std::uint64_t);
  static const page::LogIdentity kIdentity{.size_bytes = 1'000'000, .modified_ns = 1, .digest = std::string(kDigestBytes, '0')};
  auto bytes = page::ToIndexBytes(kIdentity, {});
  bytes.resize(bytes.size() - kDigestBytes - kCountsBytes);
  bytes.insert(bytes.end(), data, data + size);
  bus::Sha256 digest;
  digest.Add(bytes.data(), bytes.size());
  const auto text = digest.Finish();
  bytes.insert(bytes.end(), text.begin(), text.end());
  if (const auto part = page::FromIndexBytes(bytes, kIdentity)) {
    if (page::ToIndexBytes(kIdentity, *part) != bytes) std::abort();
  }
  return 0;
}
