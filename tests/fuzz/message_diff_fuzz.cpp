// Any two messages of one of Lookout's types compared field by field.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/bus/schema.hpp"
#include "tools/diff/compare.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout;
  if (size < 1) return 0;
  const auto fingerprint = bus::TypeFingerprints()[data[0] % bus::TypeFingerprints().size()].fingerprint;
  std::vector<std::uint8_t> a;
  for (int shift = 56; shift >= 0; shift -= 8) a.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  auto b = a;
  const auto* const half = data + 1 + (size - 1) / 2;
  a.insert(a.end(), data + 1, half);
  b.insert(b.end(), half, data + size);
  diff::Tolerances tolerances;
  // Without tolerances equal is equal bytes.
  if (diff::CompareMessages(tolerances, a, b).has_value() == (a == b)) std::abort();
  tolerances.Set("x", 1.0);
  diff::CompareMessages(tolerances, a, b);
  if (diff::CompareMessages(tolerances, a, a)) std::abort();
  return 0;
}
