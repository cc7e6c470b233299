#pragma once

/// The integer specification of the coprocessor. The functional model, the cycle-exact emulator and
/// the driver share it, and nothing else, with a circuit:
///
///   fixed_point.h    lengths, their rounding, the comparison that refuses
///   memory_line.h    lines of memory: nodes, leaves of records, check words
///   segment.h        an entry of the segment FIFO, reasons to stop, the answer to a query
///   registers.h      the register map, words of a segment, counters
///   interpolation.h  where the tool stands at a sample
///   pair_distance.h  the distance of two records
///   traversal.h      what a search divides, and the box test

#include "hwsim/fixed_point.h"
#include "hwsim/memory_line.h"
#include "hwsim/pair_distance.h"
#include "hwsim/registers.h"
#include "hwsim/search.h"
#include "hwsim/segment.h"
