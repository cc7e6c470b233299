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
    for (size_t i = BoxUnit::latency - 1; i > 0; --i) unit.stage[i] = unit.stage[i - 1];
    unit.stage[0] = in;
}

} // namespace hwsim
