#include "hwsim/permit_unit.h"

#include <algorithm>

namespace hwsim {
namespace {

void note_time(PermitUnit& unit, const Dispatched& entry, uint64_t cycle) {
    const uint64_t taken = cycle - entry.pushed;
    unit.longest = std::max(unit.longest, taken);
    if (entry.segment.budget == 0) return;
    const int64_t slack = int64_t{entry.segment.budget} - static_cast<int64_t>(taken);
    unit.least_slack = std::min(unit.least_slack, slack);
    if (slack < 0) ++unit.missed;
}

} // namespace

void stop(PermitUnit& unit, Stop reason, uint32_t sequence, uint32_t line) {
    if (unit.stopped != Stop::none) return;
    unit.stopped = reason;
    unit.stop_sequence = sequence;
    unit.stop_line = line;
    unit.in_order.clear();
}

Retirement retire(PermitUnit& unit, const Answer& answer, uint64_t cycle) {
    const Dispatched entry = unit.in_order.front();
    unit.in_order.pop();
    const uint32_t sequence = entry.segment.sequence;
    if (answer.stop != Stop::none) return {.stopped = answer.stop};
    ++unit.retired;
    if (entry.segment.kind == SegmentKind::model) return {};
    const bool is_measured = entry.segment.kind == SegmentKind::measure;
    if (is_measured || answer.found) {
        unit.found = answer;
        unit.found_sequence = sequence;
    }
    if (is_measured) return {.measured = true};
    if (answer.found) return {.stopped = Stop::violation};
    if (!entry.segment.last) return {};
    note_time(unit, entry, cycle);
    unit.permit_sequence = sequence;
    return {.permitted = true};
}

} // namespace hwsim
