#include "app/viewer/setup_summary.h"

#include <fmt/format.h>

#include "app/session/setup_sheet.h"

namespace app::viewer {
namespace {

constexpr size_t most_tools = 3;

std::string stock_line(const ViewModel& model, const SetupSheet& sheet) {
    const core::Vec3 size = core::bounds(sheet.stock).size();
    return fmt::format("Stock {} x {} x {} {}", length_text(model, size.x),
                       length_text(model, size.y), length_text(model, size.z), length_unit(model));
}

std::string tool_line(const ViewModel& model, const SheetTool& tool) {
    return fmt::format("T{} {}, D{} {}", core::value_of(tool.tool.number),
                       core::name_of(tool.tool.shape), length_text(model, tool.tool.diameter),
                       length_unit(model));
}

} // namespace

std::vector<std::string> inferred_summary(const ViewModel& model) {
    if (!model.program || !model.program->is_inferred || !model.program->sheet) return {};
    const SetupSheet& sheet = *model.program->sheet;
    std::vector<std::string> lines = {"Inferred set-up: E edits it", stock_line(model, sheet)};
    for (size_t i = 0; i < std::min(sheet.tools.size(), most_tools); ++i)
        lines.push_back(tool_line(model, sheet.tools[i]));
    if (sheet.tools.size() > most_tools)
        lines.push_back(fmt::format("and {} more tools", sheet.tools.size() - most_tools));
    lines.push_back("No fixtures are known");
    return lines;
}

} // namespace app::viewer
