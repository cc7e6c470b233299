#include "app/report/text/text_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/finding_group.h"
#include "app/base/finding_text.h"
#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/check/conclusion.h"
#include "app/check/stock_file.h"
#include "core/sim/part_comparison.h"
#include "core/sim/verdict.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

/// The lines of the blocks that have the findings of a group.
std::vector<uint32_t> lines_of(const CheckRun& run, const GroupOf<core::Finding>& group) {
    std::vector<uint32_t> lines;
    for (const core::Finding* finding : group.findings)
        if (finding->block) lines.push_back(run.blocks[core::value_of(*finding->block)].line);
    return lines;
}

std::string finding_groups_text(const CheckRun& run) {
    std::string text;
    for (const GroupOf<core::Finding>& group : grouped_by(run.findings, subject_of)) {
        const core::Finding& worst = *group.worst;
        text += finding_title(worst, 8);
        if (worst.block) {
            const CheckedBlock& block = run.blocks[core::value_of(*worst.block)];
            text += finding_location(block.line, block.file, block.text);
        }
        text += "\n" + wrapped(worst.message, 9);
        if (!worst.cure.empty()) text += wrapped(cure_text(worst), 9);
        const std::vector<uint32_t> lines = lines_of(run, group);
        if (lines.size() > 1)
            text += wrapped(
                fmt::format("The worst of {} blocks, lines {}.", lines.size(), line_ranges(lines)),
                9);
        text += "\n";
    }
    return text;
}

std::string block_clearance(const CheckRun& run, const core::BlockResult& result) {
    return clearance_text(shown_clearance(run.setup, result), ClearanceStyle::column);
}

std::string blocks_text(const CheckRun& run) {
    std::string text = " line move  tool   clearance mm bodies            verdict   block\n";
    for (const CheckedBlock& block : run.blocks) {
        const core::BlockResult& result = block.result;
        if (result.motion == core::BlockMotion::none) continue;
        std::string pair;
        if (result.deciding) {
            const core::PairClearance& near = result.pairs[*result.deciding];
            pair = fmt::format("{} / {}", core::part_name(run.setup, near.pair),
                               core::body_name(run.setup, near.pair));
        }
        text += fmt::format("{:>5} {:<5} {:>4} {:>15} {:<17} {:<9} {}\n", block.line,
                            core::name_of(result.motion),
                            result.tool ? std::to_string(core::value_of(*result.tool)) : "-",
                            block_clearance(run, result), clipped(trimmed(pair), 17),
                            core::name_of(result.verdict), clipped(trimmed(block.text), 19));
    }
    return text + "\n";
}

std::string assumptions_text(const std::vector<std::string>& all,
                             const std::vector<std::string>& shown_assumptions) {
    const auto is_in = [](const std::vector<std::string>& list) {
        return [&list](const std::string& each) {
            return std::find(list.begin(), list.end(), each) != list.end();
        };
    };
    const bool is_more =
        !shown_assumptions.empty()
        && std::all_of(shown_assumptions.begin(), shown_assumptions.end(), is_in(all));
    std::string text = is_more ? "  assuming   the same as before\n" : "  assuming\n";
    for (const std::string& assumption : all)
        if (!is_more || !is_in(shown_assumptions)(assumption))
            text += wrapped("- " + assumption, 4, 2);
    return text;
}

std::string summary_text(const CheckRun& run, const std::vector<std::string>& shown_assumptions) {
    size_t moving = 0;
    for (const CheckedBlock& block : run.blocks)
        moving += block.result.motion != core::BlockMotion::none;
    std::string text = fmt::format("{}: {}\n", trimmed(run.program_file), outcome_text(run));
    text += fmt::format("  findings   {}\n", counts_text(run));
    text += fmt::format("  blocks     {}, {} with motion; dialect {}\n", run.blocks.size(), moving,
                        gcode::dialect(run.dialect).name);
    if (const CheckedBlock* block = nearest_block(run)) {
        const core::PairClearance& pair = block->result.pairs[*block->result.deciding];
        const std::string heading = "  tightest   ";
        const std::string tightest = fmt::format(
            "line {}: {} / {}, {} mm (minimum {} mm)", block->line,
            core::part_name(run.setup, pair.pair), core::body_name(run.setup, pair.pair),
            block_clearance(run, block->result), core::at_most(pair.allowance.distance));
        text += heading + wrapped(tightest, heading.size()).substr(heading.size());
    }
    text += fmt::format("  cycle time {}\n", duration_text(run.cycle_time));
    text += fmt::format("  removed    {:.1f} mm3\n", run.removed);
    text +=
        fmt::format("  model      mesh size {} mm, {} scan lines, {} points, {:.0f} MB; {:.2f} s\n",
                    run.setup.mesh_size, run.lines, run.points, std::ceil(1e-6 * run.memory),
                    run.times.read + run.times.model + run.times.check);
    if (run.comparison)
        text +=
            fmt::format("  part       {}\n", facts_of(*run.comparison, run.setup.part->tolerance));
    if (run.saved_stock) text += fmt::format("  saved      {}\n", facts_of(*run.saved_stock));
    return text + assumptions_text(run.all_assumptions(), shown_assumptions);
}

/// Whether a text contains the name as a whole word.
bool has_word(const std::string& text, const std::string& name) {
    const auto ends_word = [&](size_t at) {
        return at >= text.size()
               || std::string_view(" :'\",;()").find(text[at]) != std::string::npos;
    };
    if (name.empty()) return true;
    for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
        if ((at == 0 || ends_word(at - 1)) && ends_word(at + name.size())) return true;
    return false;
}

} // namespace

std::string counts_text(const CheckRun& run) { return counts_text(run.findings); }

std::string outcome_text(const CheckRun& run) {
    if (run.stopped) return "STOPPED, not checked to its end";
    if (run.verdict == core::Verdict::clear && run.has_errors())
        return "ERRORS in the program; clearances are sufficient";
    return verdict_text(run.verdict);
}

std::string text_report(const CheckRun& run, const TextOptions& options) {
    std::string text = finding_groups_text(run);
    if (options.blocks) text += blocks_text(run);
    return printable(text + summary_text(run, options.shown_assumptions));
}

std::string error_text(const core::Error& error) {
    // Messages about a file as a whole contain its name.
    const bool is_named = error.where.line == 0 && has_word(error.message, error.file);
    std::string text = is_named ? std::string() : error.file;
    if (error.where.line > 0) text += fmt::format(":{}", error.where.line);
    if (error.where.column > 0) text += fmt::format(":{}", error.where.column);
    return text.empty() ? error.message : text + ": " + error.message;
}

} // namespace app
