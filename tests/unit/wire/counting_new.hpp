// Counts what operator new is asked for, in the test program that counting_new.cpp is linked to.
#pragma once

#include <cstddef>

namespace lookout {

extern std::size_t num_allocated_bytes;

}  // namespace lookout
