// Any bytes into the guarded decoder of every channel's type: no crash, no hang, no great allocation.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/bus/decode.hpp"
#include "tests/support/wire_types.hpp"

namespace {

// The first byte chooses the type; its fingerprint is put in front, since no fuzzer guesses one.
template <typename T>
void DecodeAs(lookout::Bytes body) {
  std::vector<std::uint8_t> bytes;
  const auto fingerprint = static_cast<std::uint64_t>(T::getHash());
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  bytes.insert(bytes.end(), body.begin(), body.end());
  const auto message = lookout::bus::Decode<T>(bytes);
  // What decodes took exactly these bytes; encoded again it has the same length, unless a string holds a zero byte.
  if (message && message->getEncodedSize() != static_cast<int>(bytes.size())) std::abort();
}

int NumTypes() {
  int num_types = 0;
  lookout::ForEachChannelType([&num_types](const auto&) { ++num_types; });
  return num_types;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const lookout::Bytes body(data + 1, size - 1);
  static const int kNumTypes = NumTypes();
  const int chosen = data[0] % kNumTypes;
  int type = 0;
  lookout::ForEachChannelType([&]<typename T>(T) {
    if (type++ == chosen) DecodeAs<T>(body);
  });
  return 0;
}
