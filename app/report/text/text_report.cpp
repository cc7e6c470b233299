#include "app/report/text/text_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/check/conclusion.h"
#include "app/check/stock_file.h"
#include "app/setup/coverage.h"
#include "app/tolerance/tolerances.h"
#include "core/sim/part_comparison.h"
#include "core/sim/verdict.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

/// The lines of the blocks that have the findings of a group.
std::vector<uint32_t> lines_of(const CheckRun& run, const GroupOf<core::Finding>& group) {
    std::vector<uint32_t> lines;
    for (const core::Finding* finding : group.findings)
        if (finding->block) lines.push_back(run.blocks.line(core::value_of(*finding->block)));
    return lines;
}

constexpr int bad_colour = 31, good_colour = 32, doubt_colour = 33; // ANSI codes

std::string coloured(const std::string& text, int colour, const TextOptions& options) {
    return options.colour ? fmt::format("\033[{}m{}\033[0m", colour, text) : text;
}

/// "plate.nc:44:1", as editors and terminals open it: the first word of the block.
std::string location_of(const CheckRun& run, const CheckedBlock& block) {
    const size_t first = block.text.find_first_not_of(" \t");
    return fmt::format("{}:{}:{}", trimmed(block.file.empty() ? run.program_file : block.file),
                       block.line, first == std::string::npos ? 1 : first + 1);
}

/// The first line of a finding: severity, rule, location and text of the block.
std::string title_of(const CheckRun& run, const core::Finding& finding,
                     const TextOptions& options) {
    constexpr size_t least_text = 12, most_text = 40;
    std::string title = finding_title(finding, 8);
    if (finding.block) {
        const CheckedBlock block = run.blocks[core::value_of(*finding.block)];
        title += ", " + location_of(run, block) + ": ";
        const size_t room = options.width - std::min(options.width, title.size());
        const size_t most =
            std::max(most_text, options.width - std::min<size_t>(options.width, 60));
        title += clipped(trimmed(block.text), std::clamp(room, least_text, most));
    }
    title = printable(title);
    const size_t severity = std::string_view(core::name_of(finding.severity)).size();
    const bool is_error = finding.severity == core::Severity::error;
    if (finding.severity < core::Severity::warning) return title;
    return coloured(title.substr(0, severity), is_error ? bad_colour : doubt_colour, options)
           + title.substr(severity);
}

std::string finding_groups_text(const CheckRun& run, const TextOptions& options) {
    std::string text;
    for (const GroupOf<core::Finding>& group : grouped_by(run.findings, subject_of)) {
        const core::Finding& worst = *group.worst;
        std::string words = wrapped(worst.message, 9, 0, options.width);
        if (!worst.cure.empty()) words += wrapped(cure_text(worst), 9, 0, options.width);
        const std::vector<uint32_t> lines = lines_of(run, group);
        if (lines.size() > 1)
            words += wrapped(fmt::format("{} of {} blocks, lines {}.",
                                         worst.pair[0].empty() ? "The first" : "The worst",
                                         lines.size(), line_ranges(lines)),
                             9, 0, options.width);
        text += title_of(run, worst, options) + "\n" + printable(words) + "\n";
    }
    return text;
}

/// Whether the deciding pair of a block touches as intended.
bool is_contact(const core::BlockResult& result) {
    if (!result.deciding || result.verdict != core::Verdict::clear) return false;
    const core::PairClearance& pair = result.pairs[*result.deciding];
    return pair.found() && pair.upper <= 0.0 && pair.allowance.distance <= core::resolution;
}

std::string block_clearance(const CheckRun& run, const core::BlockResult& result) {
    return clearance_text(shown_clearance(run.setup, result), ClearanceStyle::column);
}

/// The deciding pair of a block; empty if no pair decides it.
std::string pair_text(const CheckRun& run, const core::BlockResult& result) {
    if (!result.deciding) return {};
    const core::PairClearance& near = result.pairs[*result.deciding];
    return trimmed(fmt::format("{} / {}", core::part_name(run.setup, near.pair),
                               core::body_name(run.setup, near.pair)));
}

std::string blocks_text(const CheckRun& run, const TextOptions& options) {
    constexpr size_t least_pair = 17, least_text = 19, least_width = 80;
    size_t longest = least_pair; // of the pairs
    for (const CheckedBlock& block : run.blocks)
        longest = std::max(longest, pair_text(run, block.result).size());
    size_t room = std::max(options.width, least_width) - least_width;
    const size_t pair_width = std::min(longest, least_pair + room);
    room -= pair_width - least_pair;
    std::string text = fmt::format(" line move  tool   clearance mm {:<{}} verdict   block\n",
                                   "bodies", pair_width);
    for (const CheckedBlock& block : run.blocks) {
        const core::BlockResult& result = block.result;
        if (result.motion == core::BlockMotion::none) continue;
        const std::string clearance = !is_contact(result)    ? block_clearance(run, result)
                                      : result.removed > 0.0 ? "cutting"
                                                             : "contact";
        text += fmt::format(
            "{:>5} {:<5} {:>4} {:>15} {:<{}} {:<9} {}\n", block.line, core::name_of(result.motion),
            result.tool ? std::to_string(core::value_of(*result.tool)) : "-", clearance,
            clipped(pair_text(run, result), pair_width), pair_width, core::name_of(result.verdict),
            clipped(trimmed(block.text), least_text + room));
    }
    return text + "\n";
}

std::string assumptions_text(const std::vector<std::string>& all, const TextOptions& options) {
    const std::vector<std::string>& shown_assumptions = options.shown_assumptions;
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
            text += wrapped("- " + assumption, 4, 2, options.width);
    return text;
}

/// A row of the summary: its name, and text that may take several lines.
std::string row_text(const std::string& name, const std::string& text, const TextOptions& options) {
    const std::string heading = fmt::format("  {:<10} ", name);
    return heading + wrapped(text, heading.size(), 0, options.width).substr(heading.size());
}

/// The headline: green only if everything was checked and is clear.
std::string headline_text(const CheckRun& run, const TextOptions& options) {
    const std::string headline = run.headline();
    const Coverage coverage = run.full_coverage();
    const bool is_good = run.verdict == core::Verdict::clear && !run.stopped && !run.has_errors();
    const bool is_whole = coverage.is_complete() && coverage.moves;
    return coloured(headline,
                    !is_good   ? bad_colour
                    : is_whole ? good_colour
                               : doubt_colour,
                    options);
}

std::string tolerances_text(const Tolerances& tolerances, const TextOptions& options) {
    if (!tolerances.refusal.empty())
        return wrapped("tolerances none: " + tolerances.refusal, 2, 11, options.width);
    std::string text = "  tolerances one value at a time; the check stays clear within:\n";
    size_t width = 0;
    for (const Tolerance& tolerance : tolerances.list)
        width = std::max(width, characters_in(title_of(tolerance.deviation)));
    for (const Tolerance& tolerance : tolerances.list) {
        const std::string title = title_of(tolerance.deviation);
        text += "    " + trimmed(title) + std::string(width - characters_in(title), ' ') + "  "
                + range_text(tolerance) + "\n";
        if (!tolerance.is_known()) continue;
        for (const auto& [sign, limit] : {std::pair("-", &tolerance.less), {"+", &tolerance.more}})
            if (const std::string why = limit_text(*limit); !why.empty())
                text += wrapped(fmt::format("{} {}", sign, why), 8, 2, options.width);
    }
    return text;
}

std::string summary_text(const CheckRun& run, const TextOptions& options) {
    size_t moving = 0;
    for (const CheckedBlock& block : run.blocks.without_texts())
        moving += block.result.motion != core::BlockMotion::none;
    std::string text;
    if (run.stopped) text += row_text("stopped", error_text(*run.stopped), options);
    if (const std::string uncovered = uncovered_text(run.full_coverage()); !uncovered.empty())
        text += row_text("unchecked", uncovered, options);
    text += fmt::format("  findings   {}\n", counts_text(run));
    text += fmt::format("  blocks     {}, {} with motion; dialect {}\n", run.blocks.size(), moving,
                        gcode::dialect(run.dialect).name);
    if (const auto block = tightest_block(run)) {
        const core::PairClearance& pair = block->result.pairs[*block->result.deciding];
        const std::string tightest =
            fmt::format("line {}: {} / {}, {}", block->line, core::part_name(run.setup, pair.pair),
                        core::body_name(run.setup, pair.pair),
                        tightest_words(block->result, ClearanceStyle::column));
        text += row_text("tightest", tightest, options);
    }
    text += fmt::format("  cycle time {}\n", duration_text(run.cycle_time));
    text += fmt::format("  removed    {:.1f} mm3\n", run.removed);
    text +=
        fmt::format("  model      mesh size {} mm, {} scan lines, {} points, {:.0f} MB; {:.2f} s\n",
                    run.setup.mesh_size, run.lines, run.points, std::ceil(1e-6 * run.memory),
                    run.times.read + run.times.model + run.times.check);
    if (run.comparison)
        text += fmt::format("  part       {}\n", facts_of(*run.comparison, *run.setup.part));
    if (run.saved_stock) text += fmt::format("  saved      {}\n", facts_of(*run.saved_stock));
    if (run.tolerances) text += tolerances_text(*run.tolerances, options);
    return text + assumptions_text(run.all_assumptions(), options);
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

std::string counts_text(const CheckRun& run) {
    std::array<size_t, core::all_severities.size()> counts{};
    for (const auto& group : grouped_by(run.findings, subject_of)) {
        const bool is_one_cause = group.worst->pair[0].empty();
        counts[static_cast<size_t>(group.worst->severity)] +=
            is_one_cause ? 1 : group.findings.size();
    }
    size_t& errors = counts[static_cast<size_t>(core::Severity::error)];
    if (run.stopped && errors == 0) errors = 1; // why it stopped
    return counts_text(errors, counts[static_cast<size_t>(core::Severity::warning)],
                       counts[static_cast<size_t>(core::Severity::note)]);
}

std::string text_report(const CheckRun& run, const TextOptions& options) {
    std::string text = finding_groups_text(run, options);
    if (options.blocks) text += printable(blocks_text(run, options));
    text += printable(trimmed(run.program_file)) + ": " + headline_text(run, options) + "\n";
    return text + printable(summary_text(run, options));
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
