#include "tests/unit/detector/allocation_count.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

std::size_t allocations = 0;  // the tests have one thread

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
  if (void* memory = std::aligned_alloc(alignment, rounded)) {
    return memory;
  }
  throw std::bad_alloc();
}

}  // namespace

// Array and nothrow forms end in these.
void* operator new(std::size_t size) {
  return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace luminav::test {

std::size_t allocation_count() {
  return allocations;
}

}  // namespace luminav::test
