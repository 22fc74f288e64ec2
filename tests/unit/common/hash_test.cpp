#include "common/core/hash.hpp"

#include <gtest/gtest.h>

namespace lookout {
namespace {

// Values of the authors' own test vectors.
TEST(Hash, IsFnv1a) {
  EXPECT_EQ(Fnv1a(""), 0xcbf29ce484222325U);
  EXPECT_EQ(Fnv1a("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(Fnv1a("foobar"), 0x85944171f73967e8U);
}

}  // namespace
}  // namespace lookout
