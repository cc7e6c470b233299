#include "app/session/breakpoint.h"

#include <fmt/format.h>

namespace app {

std::string text_of(const Breakpoint& breakpoint) {
    std::string text;
    const auto add = [&](std::string part) { text += (text.empty() ? "" : ", ") + part; };
    if (breakpoint.line)
        add(breakpoint.file.empty()
                ? fmt::format("line {}", *breakpoint.line)
                : fmt::format("line {} of {}", *breakpoint.line, breakpoint.file));
    if (breakpoint.tool) add(fmt::format("change to T{}", core::value_of(*breakpoint.tool)));
    if (breakpoint.rule == "finding")
        add("any finding");
    else if (!breakpoint.rule.empty())
        add(fmt::format("finding {}", breakpoint.rule));
    if (breakpoint.condition)
        text += (text.empty() ? "if " : " if ") + breakpoint.condition->text();
    return text.empty() ? "every block" : text;
}

} // namespace app
