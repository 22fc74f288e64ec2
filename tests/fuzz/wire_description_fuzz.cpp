// Any text as a description of wire types, and any two messages of one of them compared field by field: also of Lookout's own types.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tools/diff/compare.hpp"
#include "tools/log/recorded_run.hpp"

namespace {

using namespace lookout;

void CompareHalves(const bus::WireTypes& types, std::size_t which, Bytes bytes) {
  if (types.types().empty()) return;
  const auto fingerprint = types.types()[which % types.types().size()].fingerprint;
  std::vector<std::uint8_t> a;
  for (int shift = 56; shift >= 0; shift -= 8) a.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  auto b = a;
  const auto half = bytes.size() / 2;
  a.insert(a.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(half));
  b.insert(b.end(), bytes.begin() + static_cast<std::ptrdiff_t>(half), bytes.end());
  diff::Tolerances tolerances;
  // Without tolerances equal is equal bytes.
  if (diff::CompareMessages({&types}, tolerances, a, b).has_value() == (a == b)) std::abort();
  tolerances.Set("x", 1.0);
  diff::CompareMessages({&types}, tolerances, a, b);
  if (diff::CompareMessages({&types}, tolerances, a, a)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bus::WireTypes kOwnTypes = log::OwnTypes();
  if (size < 2) return 0;
  const Bytes bytes(data, size);
  if (bytes[0] == 0) {
    CompareHalves(kOwnTypes, bytes[1], bytes.subspan(2));
    return 0;
  }
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  const bus::WireTypes types({std::string(bytes.begin(), end)});
  CompareHalves(types, 0, bytes.subspan(static_cast<std::size_t>(end - bytes.begin())));
  return 0;
}
