#pragma once

#include <cstddef>

namespace luminav::test {

/// How often this program has asked for memory with `new` so far; linking it replaces the global operators.
std::size_t allocation_count();

}  // namespace luminav::test
