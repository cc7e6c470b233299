#include "core/sim/tool_description.h"

#include <utility>

#include <fmt/format.h>

namespace core {
namespace {

constexpr std::pair<const char*, ToolShape> shapes[] = {
    {"flat", ToolShape::flat},         {"ball", ToolShape::ball},
    {"bull", ToolShape::bull},         {"drill", ToolShape::drill},
    {"taper", ToolShape::taper},       {"chamfer", ToolShape::chamfer},
    {"tslot", ToolShape::tslot},       {"dovetail", ToolShape::dovetail},
    {"lollipop", ToolShape::lollipop}, {"threadmill", ToolShape::threadmill},
    {"profile", ToolShape::profile}};

} // namespace

const char* name_of(ToolShape shape) {
    for (const auto& [name, known] : shapes)
        if (known == shape) return name;
    return "";
}

std::optional<ToolShape> tool_shape_named(const std::string& name) {
    for (const auto& [known, shape] : shapes)
        if (name == known) return shape;
    return std::nullopt;
}

tl::unexpected<Error> tool_error(const ToolDescription& tool, const std::string& why) {
    return fail(ErrorCode::invalid_value, fmt::format("tool {}: {}", value_of(tool.number), why));
}

} // namespace core
