#include "app/guard/live_setup.h"

#include "app/setup/setup_file.h"

namespace app {

std::string why_incomplete(const SetupFile& setup, std::string_view who) {
    const auto lacks = [&](const std::string& what) {
        return std::string(who) + " needs a set-up that states " + what;
    };
    if (setup.infers_frame || setup.offsets_set.empty())
        return lacks("the work offsets in machine coordinates");
    if (setup.needs_stock) return lacks("the stock");
    if (setup.is_partial) return lacks("a job: work offsets, tools and the stock");
    if (setup.setup.tools.empty()) return lacks("the tools with their sizes, under [[tool]]");
    if (!setup.partial_tools.empty()) return lacks("all sizes of its tools");
    if (!setup.assumed.empty()) return lacks("what it calls assumed");
    if (!setup.setup.fixture_moves.empty())
        return std::string(who) + " does not follow fixtures that are moved ([[fixture.move]])";
    if (!setup.offsets_of_bodies.empty())
        return lacks("the place of its bodies: they stand in a work offset that it does not state");
    return {};
}

} // namespace app
