#include <algorithm>

#include <fmt/format.h>

#include "app/prompt/command_table.h"
#include "app/prompt/location.h"
#include "app/prompt/place_text.h"
#include "app/report/text_layout.h"
#include "core/sim/bound_text.h"

namespace app {
namespace {

constexpr uint32_t lines_at_once = 11;

/// What the record knows of the lines of a file: of each the block with the worst verdict, among
/// equals with the least margin.
std::map<uint32_t, size_t> worst_blocks(const CheckRun& record, const std::string& file,
                                        uint32_t first, uint32_t last) {
    std::map<uint32_t, size_t> worst;
    const auto rank = [&](size_t block) {
        const core::BlockResult& result = record.blocks[block].result;
        const double margin = result.deciding ? result.pairs[*result.deciding].margin() : 1e9;
        return std::pair(-static_cast<int>(result.verdict), margin);
    };
    for (size_t block = 0; block < record.blocks.size(); ++block) {
        const CheckedBlock& at = record.blocks[block];
        if (at.line < first || at.line > last || at.file != file) continue;
        if (at.result.motion == core::BlockMotion::none) continue;
        const auto [known, is_new] = worst.try_emplace(at.line, block);
        if (!is_new && rank(block) < rank(known->second)) known->second = block;
    }
    return worst;
}

/// "0.420 !": how near a line comes, as short as possible.
std::string clearance_column(const PromptState& state, size_t block) {
    const core::BlockResult& result = state.session.record().blocks[block].result;
    std::string text;
    if (!result.checked)
        text = "?";
    else if (result.deciding) {
        const core::PairClearance& pair = result.pairs[*result.deciding];
        text = pair.found() ? core::clearance_at_least(pair.lower)
                            : ">" + core::clearance_at_least(pair.lower, 1);
    } else {
        const double least = least_clearance(state.session.setup_at(block), result);
        text = ">" + core::clearance_at_least(least, 0);
    }
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
    const bool has_next = has_block(state);
    const CheckedBlock* next = has_next ? &record.blocks[state.session.at()] : nullptr;
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

/// The lines round one.
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
        const CheckedBlock& block = state.session.record().blocks[state.session.at()];
        return listed_round(state, {block.line, block.file});
    }
    const auto& stopped = state.session.record().stopped;
    if (stopped && stopped->file == state.session.program().file)
        return listed_round(state, {std::max(1U, stopped->where.line), {}});
    if (state.session.at() == 0) return listed_round(state, {1, {}});
    const CheckedBlock& last = state.session.record().blocks[state.session.at() - 1];
    return listed_round(state, {last.line, last.file});
}

} // namespace app
