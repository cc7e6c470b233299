#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/debug/inspected_value.h"
#include "app/debug/prompt/command_table.h"
#include "app/debug/prompt/location.h"
#include "app/debug/prompt/state_text.h"
#include "app/setup/coverage.h"
#include "core/base/text.h"
#include "core/sim/verdict.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using Control = gcode::InterpreterState;

std::string table_of(const std::vector<NamedValue>& values, const char* nothing) {
    std::string text;
    for (const auto& [name, value] : values)
        text += fmt::format("{:<16} {}{}\n", name, value.text,
                            value.meaning.empty() ? "" : " (" + value.meaning + ")");
    return text.empty() ? std::string(nothing) + "\n" : text;
}

const Control& control_of(const PromptState& state) { return state.session.control(); }

CommandResult show_modal(PromptState& state, const std::string&) {
    return table_of(modal_values(control_of(state), state.session.environment()), "");
}

CommandResult show_axes(PromptState& state, const std::string&) {
    return table_of(axis_values(control_of(state)), "");
}

CommandResult show_parameters(PromptState& state, const std::string&) {
    return table_of(parameter_values(control_of(state), state.session.environment()),
                    "no parameter is set");
}

CommandResult show_offsets(PromptState& state, const std::string&) {
    return table_of(offset_values(control_of(state)), "no offset is set");
}

CommandResult show_tools(PromptState& state, const std::string&) {
    const core::Setup& setup = state.session.setup_at(state.session.at());
    std::string text;
    for (const auto& [number, tool] : setup.tools) {
        const core::ToolDescription& described = tool.description;
        text += fmt::format("T{:<4} {:<10} d {} mm, {} mm long{}{}\n", core::value_of(number),
                            core::name_of(described.shape), number_text(described.diameter),
                            number_text(tool.length), described.name.empty() ? "" : ", ",
                            trimmed(described.name));
        if (state.session.tool() == number) text.insert(text.size() - 1, " <- in the spindle");
    }
    return text.empty() ? "the set-up has no tools\n" : text;
}

/// The bounding box of a fixture in the frame of the stock, with all axes at 0.
core::Aabb box_of(const core::Setup& setup, const core::Fixture& fixture) {
    const core::Transform stock_from_body =
        setup.stock_mount.link_from_body.inverse() * fixture.mount.link_from_body;
    const core::Aabb own = core::bounds(fixture.body);
    core::Aabb box{core::Vec3(core::infinity), core::Vec3(-core::infinity)};
    for (int corner = 0; corner < 8; ++corner) {
        core::Vec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = (corner >> axis & 1) != 0 ? own.max[axis] : own.min[axis];
        p = stock_from_body * p;
        box.min = glm::min(box.min, p);
        box.max = glm::max(box.max, p);
    }
    return box;
}

CommandResult show_fixtures(PromptState& state, const std::string&) {
    const core::Setup& setup = state.session.setup_at(state.session.at());
    const auto& there = state.session.mounted_fixtures();
    std::string text;
    for (size_t i = 0; i < setup.fixtures.size(); ++i) {
        const core::Fixture& fixture = setup.fixtures[i];
        if (fixture.is_machine) continue;
        const core::Aabb box = box_of(setup, fixture);
        text += fmt::format("{:<16} X {} to {}, Y {} to {}, Z {} to {}{}{}\n", fixture.name,
                            number_text(box.min.x), number_text(box.max.x), number_text(box.min.y),
                            number_text(box.max.y), number_text(box.min.z), number_text(box.max.z),
                            there[i] ? "" : ", not mounted now",
                            fixture.expendable ? ", may be cut" : "");
    }
    if (text.empty()) return std::string("the set-up has no fixtures\n");
    return "in the frame of the stock, mm\n" + text;
}

CommandResult show_block(PromptState& state, const std::string&) {
    std::string text = location_text(state);
    if (!has_block(state)) return text;
    const core::BlockResult result = state.session.record().blocks[state.session.at()].result;
    const core::Setup& setup = state.session.setup_at(state.session.at());
    text +=
        fmt::format("    begins at {:.2f} s, removes {:.1f} mm3\n", result.time, result.removed);
    for (const core::PairClearance& pair : result.pairs)
        text += fmt::format("    {} / {}: {}, minimum {} mm, {}\n",
                            core::part_name(setup, pair.pair), core::body_name(setup, pair.pair),
                            clearance_text(shown_clearance(pair), ClearanceStyle::sentence),
                            pair.allowance.distance, core::name_of(pair.verdict));
    return text;
}

CommandResult show_program(PromptState& state, const std::string&) {
    const CheckRun& record = state.session.record();
    std::string text = fmt::format("{}, dialect {}\n", trimmed(record.program_file),
                                   gcode::dialect(record.dialect).name);
    text += fmt::format(
        "{} checked ({:.0f} % of the program), {}\n", counted(record.blocks.size(), "block"),
        100.0 * state.session.recorded_fraction(), counted(record.findings.size(), "finding"));
    const bool is_clear = record.verdict == core::Verdict::clear;
    text += fmt::format("so far: {}\n",
                        is_clear ? "no collision, no near miss" : verdict_text(record.verdict));
    if (const std::string uncovered = uncovered_text(record.full_coverage()); !uncovered.empty())
        text += wrapped("not checked: " + uncovered, 0, 2);
    if (state.session.is_recorded())
        text += fmt::format("cycle time {}\n", duration_text(record.cycle_time));
    for (const std::string& assumed : record.all_assumptions())
        text += wrapped("assumed: " + assumed, 0, 2);
    return text;
}

CommandResult show_changes(PromptState& state, const std::string&) {
    std::string text;
    for (const AppliedChange& made : state.session.changes())
        text += fmt::format("from block {} on: {}\n", made.block, text_of(made.change));
    return text.empty() ? "no changes\n" : text;
}

struct Topic {
    const char* name;
    CommandResult (*show)(PromptState& state, const std::string& arguments);
};

constexpr Topic topics[] = {
    {"axes", show_axes},
    {"block", show_block},
    {"breakpoints", show_breakpoints},
    {"changes", show_changes},
    {"display", show_displays},
    {"findings", show_findings},
    {"fixtures", show_fixtures},
    {"modal", show_modal},
    {"offsets", show_offsets},
    {"parameters", show_parameters},
    {"program", show_program},
    {"stack", show_calls},
    {"tools", show_tools},
    {"watchpoints", show_watches},
};

} // namespace

std::vector<std::string> info_topics() {
    std::vector<std::string> names;
    for (const Topic& topic : topics) names.emplace_back(topic.name);
    return names;
}

CommandResult show_info(PromptState& state, const std::string& arguments) {
    const auto [name, rest] = split_word(arguments);
    const Topic* found = nullptr;
    size_t beginning = 0;
    for (const Topic& topic : topics) {
        if (name.empty() || !std::string_view(topic.name).starts_with(name)) continue;
        found = &topic;
        ++beginning;
    }
    if (beginning == 1) return found->show(state, rest);
    std::string list;
    for (const Topic& topic : topics) list += (list.empty() ? "" : ", ") + std::string(topic.name);
    if (name.empty()) return "info about what? " + list + "\n";
    return core::fail(core::ErrorCode::syntax,
                      fmt::format("'info {}' {}; the topics are {}", name,
                                  beginning > 1 ? "is ambiguous" : "is unknown", list));
}

CommandResult show_findings(PromptState& state, const std::string&) {
    const CheckRun& record = state.session.record();
    std::string text;
    for (const core::Finding& finding : record.findings) {
        std::string where = "the program as a whole";
        if (finding.block && core::value_of(*finding.block) < record.blocks.size()) {
            const size_t block = core::value_of(*finding.block);
            where = fmt::format("{}block {}, {}", block == state.session.at() ? "-> " : "", block,
                                line_text(record.blocks[block]));
        }
        text += where + "\n" + finding_text(finding, 4);
    }
    if (!state.session.is_recorded())
        text += fmt::format("checked up to block {}; 'goto end' checks the rest\n",
                            record.blocks.size());
    return text.empty() ? "no findings\n" : text;
}

CommandResult show_calls(PromptState& state, const std::string&) {
    if (!has_block(state)) return std::string("the program has ended: no block is left\n");
    const CheckedBlock block = state.session.record().blocks[state.session.at()];
    const auto& frames = control_of(state).frames;
    std::string text = fmt::format("#0  {}: {}\n", line_text(block), trimmed(block.text));
    size_t level = 0;
    for (auto call = block.calls.rbegin(); call != block.calls.rend(); ++call) {
        ++level;
        const size_t caller = block.calls.size() - level; // index among the frames
        const std::string name = caller == 0 ? "the main program"
                                 : caller < frames.size() && !frames[caller].name.empty()
                                     ? frames[caller].name
                                     : "a subprogram";
        text += fmt::format("#{}  line {} of {}\n", level, *call, name);
    }
    return text;
}

namespace {

constexpr uint32_t lines_at_once = 11;

/// For each line of a file in the record, the block with the worst verdict; among equals the one
/// with the least margin.
std::map<uint32_t, size_t> worst_blocks(const CheckRun& record, const std::string& file,
                                        uint32_t first, uint32_t last) {
    std::map<uint32_t, size_t> worst;
    const auto rank = [&](size_t block) {
        const core::BlockResult result = record.blocks[block].result;
        const double margin = result.deciding ? result.pairs[*result.deciding].margin() : 1e9;
        return std::pair(-static_cast<int>(result.verdict), margin);
    };
    for (size_t block = 0; block < record.blocks.size(); ++block) {
        const CheckedBlock at = record.blocks[block];
        if (at.line < first || at.line > last || at.file != file) continue;
        if (at.result.motion == core::BlockMotion::none) continue;
        const auto [known, is_new] = worst.try_emplace(at.line, block);
        if (!is_new && rank(block) < rank(known->second)) known->second = block;
    }
    return worst;
}

/// The clearance of a block as a column: "0.420 !".
std::string clearance_column(const PromptState& state, size_t block) {
    const core::BlockResult result = state.session.record().blocks[block].result;
    const std::string text = clearance_text(shown_clearance(state.session.setup_at(block), result),
                                            ClearanceStyle::lower_bound);
    return text + (result.verdict == core::Verdict::clear && result.checked ? "  " : " !");
}

bool has_breakpoint(const PromptState& state, const std::string& file, uint32_t line) {
    const auto& all = state.session.breakpoints();
    return std::any_of(all.begin(), all.end(), [&](const Breakpoint& breakpoint) {
        return breakpoint.line == line && breakpoint.file == file;
    });
}

CommandResult listed(PromptState& state, const std::string& file, uint32_t first, uint32_t last) {
    FEELER_TRY(const gcode::Program* program, program_of(state, file));
    const CheckRun& record = state.session.record();
    const auto worst = worst_blocks(record, file, first, last);
    std::optional<CheckedBlock> next;
    if (has_block(state)) next = record.blocks[state.session.at()];
    std::string text;
    for (uint32_t line = first; line <= last; ++line) {
        FEELER_TRY(const auto written, program->find_line(line));
        if (!written) break;
        const bool is_next = next && next->line == line && next->file == file;
        const auto known = worst.find(line);
        text +=
            fmt::format("{}{} {:>5} {:>11}  {}\n", has_breakpoint(state, file, line) ? '*' : ' ',
                        is_next ? "->" : "  ", line,
                        known == worst.end() ? "" : clearance_column(state, known->second),
                        clipped(trimmed(*written), 58));
        state.listed_to = line;
    }
    if (text.empty())
        return core::fail(core::ErrorCode::invalid_value, "the file has no more lines");
    state.listed_file = file;
    return text;
}

/// Lists the lines around one.
CommandResult listed_round(PromptState& state, const Location& location) {
    const uint32_t half = lines_at_once / 2;
    const uint32_t first = location.line > half ? location.line - half : 1;
    return listed(state, location.file, first, first + lines_at_once - 1);
}

} // namespace

CommandResult list_lines(PromptState& state, const std::string& arguments) {
    const size_t comma = arguments.find(',');
    if (comma != std::string::npos) {
        FEELER_TRY(const size_t first, number_in(trimmed(arguments.substr(0, comma))));
        FEELER_TRY(const size_t last, number_in(trimmed(arguments.substr(comma + 1))));
        return listed(state, {}, static_cast<uint32_t>(std::clamp<size_t>(first, 1, 1U << 30)),
                      static_cast<uint32_t>(std::clamp<size_t>(last, 1, 1U << 30)));
    }
    if (!arguments.empty()) {
        FEELER_TRY(const Location location, location_in(state, arguments));
        return listed_round(state, location);
    }
    if (state.listed_to > 0 && arguments.empty())
        return listed(state, state.listed_file, state.listed_to + 1,
                      state.listed_to + lines_at_once);
    if (has_block(state)) {
        const CheckedBlock block = state.session.record().blocks[state.session.at()];
        return listed_round(state, {block.line, block.file});
    }
    const auto& stopped = state.session.record().stopped;
    if (stopped && stopped->file == state.session.program().file)
        return listed_round(state, {std::max(1U, stopped->where.line), {}});
    if (state.session.at() == 0) return listed_round(state, {1, {}});
    const CheckedBlock last = state.session.record().blocks[state.session.at() - 1];
    return listed_round(state, {last.line, last.file});
}

} // namespace app
