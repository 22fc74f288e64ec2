#include "tests/unit/wire/counting_new.hpp"

#include <cstdlib>
#include <new>

// Memory still comes from malloc, which the sanitizers watch too. In a file of its own, since compilers warn of free() where they inline it.
namespace lookout {

std::size_t num_allocated_bytes = 0;

}  // namespace lookout

void* operator new(std::size_t size) {
  lookout::num_allocated_bytes += size;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
