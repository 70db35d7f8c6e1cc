#pragma once

#include <cstddef>

namespace luminav::testing {

/// Size [bytes] of the largest piece of memory that `new` was asked for since the last call. A test that links this
/// file replaces the global operators.
std::size_t take_largest_allocation();

}  // namespace luminav::testing
