#include "hwsim/box_unit.h"

namespace hwsim {

BoxUnit::Output box_question(uint8_t thread, const Halves& halves, const Segment& segment) {
    BoxUnit::Output in{.valid = true, .thread = thread, .in_range = {true, true}};
    for (size_t i = 0; i < 2; ++i) {
        if (!halves.there[i]) continue;
        const auto gap = squared_gap(halves.pair[i], segment);
        in.in_range[i] = gap.has_value();
        in.squared[i] = gap.value_or(0);
    }
    return in;
}

void tick(BoxUnit& unit, const BoxUnit::Output& in) {
    // An empty stage keeps its old contents but for `valid`.
    if (in.valid)
        unit.stage[unit.next] = in;
    else
        unit.stage[unit.next].valid = false;
    unit.next = unit.next + 1 == BoxUnit::latency ? 0 : unit.next + 1;
}

} // namespace hwsim
