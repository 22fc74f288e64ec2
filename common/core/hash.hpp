// A hash of a text that is the same on each computer and at each start, unlike that of the standard library.
#pragma once

#include <cstdint>
#include <string_view>

namespace lookout {

/// Source: G. Fowler, L. Noll, K.-P. Vo: FNV-1a, 64 bits. No protection against who makes texts of one hash.
constexpr std::uint64_t Fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3;
  return hash;
}

}  // namespace lookout
