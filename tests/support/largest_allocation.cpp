#include "tests/support/largest_allocation.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> g_largest{0};

}  // namespace

void* operator new(std::size_t size) {
  g_largest = std::max(g_largest.load(), size);
  void* memory = std::malloc(size);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace luminav::testing {

std::size_t take_largest_allocation() {
  return g_largest.exchange(0);
}

}  // namespace luminav::testing
