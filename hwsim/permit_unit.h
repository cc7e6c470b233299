#pragma once

#include "hwsim/ring.h"
#include "hwsim/segment.h"

namespace hwsim {

/// Where the answer to an entry of the FIFO comes from.
struct Dispatched {
    Segment segment;
    uint64_t pushed = 0;   // cycle
    bool searched = false; // by a thread; else `fault` is all there is to say
    uint8_t element = 0, thread = 0;
    Stop fault = Stop::none;

    bool operator==(const Dispatched&) const = default;
};

/// Decides what is permitted: takes answers in the order of the FIFO, and stops at the first that
/// is no yes.
struct PermitUnit {
    Ring<Dispatched> in_order;
    uint32_t permit_sequence = 0; // everything up to this may be entered
    uint32_t retired = 0;         // entries

    Stop stopped = Stop::none; // nothing is permitted while it is not none
    uint32_t stop_sequence = 0, stop_line = 0;

    Answer found; // of the violation or the last measurement
    uint32_t found_sequence = 0;

    uint64_t missed = 0, longest = 0;
    int64_t least_slack = INT64_MAX;

    bool operator==(const PermitUnit&) const = default;
};

/// What an answer made of the permits.
struct Retirement {
    bool permitted = false, measured = false;
    Stop stopped = Stop::none; // why the device has to stop
};

/// Takes the answer to the first entry: one that permits advances the permit if it is the last of
/// its segment; any other is a reason to stop.
Retirement retire(PermitUnit& unit, const Answer& answer, uint64_t cycle);

/// Stops for a reason, unless stopped already. Entries that wait are dropped.
void stop(PermitUnit& unit, Stop reason, uint32_t sequence, uint32_t line = 0);

} // namespace hwsim
