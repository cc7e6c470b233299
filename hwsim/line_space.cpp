#include "hwsim/line_space.h"

#include <cassert>

namespace hwsim {

std::optional<LineRun> take(LineSpace& space, uint32_t count) {
    assert(count >= 1 && count <= LineSpace::most);
    if (space.returned[count].empty() && space.end - space.next >= count) {
        space.next += count;
        return LineRun{space.next - count, count};
    }
    for (uint32_t length = count; length <= LineSpace::most; ++length) {
        std::vector<uint32_t>& runs = space.returned[length];
        if (runs.empty()) continue;
        const LineRun run{runs.back(), count};
        runs.pop_back();
        if (length > count) give_back(space, {run.first + count, length - count});
        return run;
    }
    return {};
}

void give_back(LineSpace& space, const LineRun& run) {
    assert(run.count >= 1 && run.count <= LineSpace::most);
    space.returned[run.count].push_back(run.first);
}

} // namespace hwsim
