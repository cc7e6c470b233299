#include <fmt/format.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/json/json_report.h"

namespace app {
namespace {

constexpr const char* block_column_names =
    "block,file,line,calls,text,motion,tool,time,duration,removed,lower,upper,allowance,part,body,"
    "at,part_x,part_y,part_z,body_x,body_y,body_z,verdict,rules\r\n";

std::string joined(const std::vector<uint32_t>& lines) {
    std::string text;
    for (const uint32_t line : lines) text += fmt::format("{}{}", text.empty() ? "" : " ", line);
    return text;
}

/// The rules of a block, in one cell.
std::string cell_of(const std::vector<std::string>& rules) {
    std::string text;
    for (const std::string& rule : rules) text += (text.empty() ? "" : " ") + rule;
    return text;
}

/// The cells from `lower` to `body_z`; all empty for a block without motion.
std::string clearance_cells(const CheckRun& run, const core::BlockResult& result) {
    constexpr const char* nothing = ",,,,,,,,,,,";
    if (result.motion == core::BlockMotion::none) return nothing;
    if (!result.deciding) return fmt::format("{}", least_clearance(run.setup, result)) + nothing;
    const core::PairClearance& pair = result.pairs[*result.deciding];
    std::string cells = fmt::format("{},", pair.lower);
    if (pair.found()) cells += fmt::format("{}", pair.upper);
    cells += fmt::format(",{},{},{}", pair.allowance.distance,
                         csv_cell(core::part_name(run.setup, pair.pair)),
                         csv_cell(core::body_name(run.setup, pair.pair)));
    if (!pair.found()) return cells + ",,,,,,,";
    cells += fmt::format(",{:.6f}", result.duration > 0.0 ? pair.time / result.duration : 0.0);
    for (const core::Vec3& point : {pair.on_tool, pair.on_body})
        cells += fmt::format(",{:.6f},{:.6f},{:.6f}", point.x, point.y, point.z);
    return cells;
}

} // namespace

void csv_report(const CheckRun& run, const TextSink& out) {
    const RulesByBlock rules = rules_of_blocks(run);
    out(block_column_names);
    for (const CheckedBlock& block : run.blocks) {
        const core::BlockResult& result = block.result;
        const std::string tool =
            result.tool ? fmt::format("{}", core::value_of(*result.tool)) : std::string();
        out(fmt::format("{},{},{},{},{},{},{},{:.6f},{:.6f},{:.6f},{},{},{}\r\n",
                        core::value_of(block.block), csv_cell(block.file), block.line,
                        joined(block.calls), csv_cell(block.text), core::name_of(result.motion),
                        tool, result.time, result.duration, result.removed,
                        clearance_cells(run, result), core::name_of(result.verdict),
                        cell_of(rules_of(block.block, rules))));
    }
}

std::string csv_report(const CheckRun& run) {
    return text_of([&](const TextSink& out) { csv_report(run, out); });
}

} // namespace app
