#include "hwsim/pair_unit.h"

namespace hwsim {

void tick(PairUnit& unit, const PairUnit::Output& in) {
    // An empty stage keeps its old contents but for `valid`.
    if (in.valid)
        unit.stage[unit.next] = in;
    else
        unit.stage[unit.next].valid = false;
    unit.next = unit.next + 1 == PairUnit::latency ? 0 : unit.next + 1;
}

} // namespace hwsim
