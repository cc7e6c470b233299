#include "app/session/timing_notes.h"

#include <fmt/format.h>

#include "core/sim/timing.h"

namespace app {

std::vector<std::string> timing_notes(const core::Machine& machine) {
    std::string known, unknown;
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!machine.axes[i].present) continue;
        std::string& names = machine.axes[i].acceleration ? known : unknown;
        names += (names.empty() ? "" : ", ") + std::string(1, core::axis_letters[i]);
    }
    if (known.empty()) return {"feeds and rapids run at full speed: accelerations are not counted"};
    std::vector<std::string> notes;
    if (!unknown.empty())
        notes.push_back(fmt::format(
            "axes whose acceleration is not stated are at full speed at once: {}", unknown));
    notes.push_back(fmt::format("corners are passed within {} mm, unless the program says how "
                                "(G61, G61.1, G64 P); clearances are those of sharp corners",
                                core::default_blend_tolerance));
    notes.push_back("changes of tool and spindle take no time beyond coming to rest");
    return notes;
}

} // namespace app
