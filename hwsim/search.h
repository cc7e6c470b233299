#pragma once

#include <span>

#include "hwsim/traversal.h"

namespace hwsim {

/// The functional model: what the device answers to a query, without its time.
///
/// A pair of parts whose bound is not below the best distance so far is left out. Of two halves the
/// one with the lesser bound is looked at first, the first one where they are equal; the other
/// waits on a stack. A pair of records becomes the nearest only if it is nearer than all before it,
/// so of equally near ones the first in this order is named.
///
/// Result: `squared` is the least squared distance of two records at any sample, or the query's
///         limit if none is below. Beyond `stack_depth` waiting pairs, or where the memory is at
///         fault, `stop` says why there is no answer.
Answer search(std::span<const Line> memory, const Query& query, uint32_t stack_depth = 64);

/// What is wrong with a line that a query wants to read, or none. `epoch` is that of its model:
/// a line that was written later belongs to another one.
Stop fault_of(const Line& line, uint32_t address, uint32_t epoch);

} // namespace hwsim
