#include "app/view/model/view_model.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/setup/coverage.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/navigation.h"
#include "core/base/units.h"
#include "core/sim/verdict.h"

namespace app::viewer {
namespace {

/// A length in the unit of the window.
struct ShownLength {
    double value = 0.0;
    int decimals = 0;

    ShownLength(const ViewModel& model, double mm, int decimals_of_mm)
        : value(model.settings.inch ? mm / core::mm_per_inch : mm),
          decimals(model.settings.inch ? decimals_of_mm + 2 : decimals_of_mm) {}
};

/// The last known state of the stock, with the bodies of another set-up.
std::shared_ptr<const BlockState> with_bodies_of(const std::shared_ptr<const BlockState>& before,
                                                 const OpenedProgram& opened) {
    if (!before) return nullptr;
    auto state = std::make_shared<BlockState>(*before);
    state->scene = opened.scene;
    state->mounted_fixtures.clear();
    state->offsets_in_effect.reset(); // of the machine in the old scene
    state->is_outdated = true;
    return state;
}

/// Prepares for a new opening. If it is the same program, what the user has entered stays.
void start_anew(ViewModel& model, uint64_t opening) {
    if (model.opening != 0 && model.has_rows()) model.resume = model.row();
    model.opening = opening;
    model.program = nullptr;
    model.rows.clear();
    model.least.resize(0);
    model.bands.clear();
    model.findings.clear();
    model.groups.clear();
    model.selected.reset();
    model.offending.clear();
    model.coverage.clear();
    model.verdict = {};
    model.filtered.clear();
    model.path = nullptr;
    model.block_state = nullptr;
    model.changes.clear();
    model.failure.reset();
    model.stopped.reset();
    model.walk.reset();
    stay(model);
    model.playback.running = false;
    model.fraction = 0.0;
    model.program_verdict = core::Verdict::clear;
    model.is_recorded = false;
    model.device.study = nullptr;
}

/// Sets the worst severity of each row, and how deep its deciding pair overlaps. Findings come and
/// go until the check is complete.
void mark_rows(ViewModel& model) {
    std::vector<core::Severity> worst(model.rows.size(), core::Severity::off);
    for (const core::Finding& finding : model.findings) {
        if (!finding.block || core::value_of(*finding.block) >= worst.size()) continue;
        core::Severity& of_block = worst[core::value_of(*finding.block)];
        of_block = std::max(of_block, finding.severity);
        BlockRow& row = model.rows[core::value_of(*finding.block)];
        if (finding.overlap && finding.pair == BodyNames{row.part, row.body})
            row.overlap = finding.overlap;
    }
    for (size_t i = 0; i < worst.size(); ++i) {
        if (model.rows[i].worst == worst[i]) continue;
        model.rows[i].worst = worst[i];
        model.least.set(i, cell_of(model.rows[i]));
    }
}

void collect_offending(ViewModel& model) {
    model.offending.clear();
    for (size_t i = 0; i < model.rows.size(); ++i)
        if (is_offending(model.rows[i])) model.offending.push_back(i);
}

void take_rows(ViewModel& model, RowsUpdate& update) {
    if (update.rows.empty() && !update.count) return;
    const size_t end = update.first + update.rows.size();
    if (model.rows.size() < end) model.rows.resize(end);
    std::move(update.rows.begin(), update.rows.end(),
              model.rows.begin() + static_cast<ptrdiff_t>(update.first));
    if (update.count) model.rows.resize(*update.count);
    model.least.resize(model.rows.size());
    for (size_t i = update.first; i < std::min(end, model.rows.size()); ++i)
        model.least.set(i, cell_of(model.rows[i]));
    model.bands = tool_bands(model.rows);
    if (model.follows_timeline) model.range = whole(model.rows.size());
    if (model.has_rows() && model.cursor.block >= model.rows.size())
        go_to(model, model.rows.size() - 1);
}

/// Goes to the line that was current before the program was read again.
void resume(ViewModel& model) {
    const auto before = std::exchange(model.resume, std::nullopt);
    if (!before) return;
    model.cursor.block = std::min(model.cursor.block, model.rows.size() - 1);
    const auto same = [&](const BlockRow& row) {
        return row.line == before->line && row.file == before->file;
    };
    if (same(model.row())) return;
    const auto found = std::find_if(model.rows.begin(), model.rows.end(), same);
    if (found != model.rows.end())
        model.cursor.block = static_cast<size_t>(found - model.rows.begin());
}

std::string sentence_of(const Stop& stop) {
    switch (stop.reason) {
    case StopReason::breakpoint:
        return fmt::format("Stopped at breakpoint {}", stop.id);
    case StopReason::watch:
        return stop.message;
    case StopReason::end:
        return "End of the program";
    case StopReason::beginning:
        return "Beginning of the program";
    case StopReason::error:
        return "The control would stop here";
    case StopReason::interrupted:
        return "Stopped";
    case StopReason::found:
    case StopReason::step:
        return {};
    }
    return {};
}

void end_walk(ViewModel& model, const RunEnd& end, double now) {
    // Ignore a walk that the user has cancelled by going elsewhere.
    if (model.walking != end.walk || !model.has_rows()) return;
    model.walking.reset();
    const bool is_past = end.block >= model.rows.size();
    if (is_past) {
        go_to(model, end.block == 0 ? 0 : end.block - 1);
    } else {
        go_to(model, end.block, 0.0);
    }
    const std::string text = sentence_of(end.stop);
    if (!text.empty()) say(model, text, now);
}

/// What the check covers so far.
Coverage coverage_so_far(const ViewModel& model) {
    Coverage coverage = *model.program->coverage;
    std::set<core::ToolNumber> feeding, moving;
    std::optional<core::ToolNumber> last; // most rows have the tool of the row before
    bool last_feeds = false;
    for (const BlockRow& row : model.rows) {
        coverage.moves = coverage.moves || moves(row);
        if (!moves(row) || !row.tool) continue;
        if (row.tool == last && last_feeds) continue;
        last = row.tool;
        last_feeds = feeds(row);
        moving.insert(*row.tool);
        if (last_feeds) feeding.insert(*row.tool);
    }
    const auto has_holder = [&](core::ToolNumber number) {
        return model.program->tools_with_holder.contains(number);
    };
    count_tools(feeding, moving, has_holder, coverage);
    reduce_by(model.findings, coverage);
    return coverage;
}

std::string words_of_gaps(const Coverage& coverage) {
    const std::string uncovered = uncovered_text(coverage);
    return uncovered.empty() ? "" : "Not checked: " + uncovered;
}

VerdictWords words_of_verdict(const ViewModel& model, const Coverage& coverage) {
    using render::ClearanceState;
    if (!model.has_rows()) return {};
    Judged judged{.verdict = model.program_verdict, .is_stopped = model.stopped.has_value()};
    for (const size_t block : model.offending)
        judged.verdict = std::max(judged.verdict, model.rows[block].verdict);
    judged.has_errors =
        std::any_of(model.findings.begin(), model.findings.end(), is_error_of_program);
    judged.lacks_required =
        std::any_of(model.findings.begin(), model.findings.end(), lacks_coverage);
    const bool is_bad =
        judged.verdict != core::Verdict::clear || judged.has_errors || judged.is_stopped;
    if (!is_bad && !model.is_recorded) return {"CHECKING", ClearanceState::none};
    const bool is_clear =
        !is_bad && !judged.lacks_required && coverage.moves && coverage.is_complete();
    std::string text = headline_of(judged, coverage);
    if (const size_t errors = count_of(model.findings, core::Severity::error); errors > 0)
        text += ", " + counted(errors, "error");
    if (!model.is_recorded) text += " so far";
    return {text, is_bad     ? ClearanceState::violation
                  : is_clear ? ClearanceState::clear
                             : ClearanceState::near};
}

/// Updates what is said about the whole program.
void judge(ViewModel& model) {
    if (!model.program || !model.program->coverage) return;
    const Coverage coverage = coverage_so_far(model); // looks at all rows
    model.coverage = words_of_gaps(coverage);
    model.verdict = words_of_verdict(model, coverage);
}

} // namespace

void stay(ViewModel& model) {
    model.awaits_offending = false;
    model.wants_interrupt = model.wants_interrupt || model.walking;
    model.walking.reset();
}

void take_in(ViewModel& model, SessionUpdate news, double now) {
    if (!news.has_news) return;
    if (news.opening != model.opening) {
        const bool is_again = news.is_again && news.opened && model.program
                              && model.program->program == news.opened->program;
        const auto shown = is_again ? with_bodies_of(model.block_state, *news.opened) : nullptr;
        start_anew(model, news.opening);
        model.block_state = shown; // until the new state arrives
    }
    if (news.answered == model.reading) model.reading = 0;
    if (news.opened) {
        model.program = news.opened;
        model.workspace.error.reset();
    }
    if (news.setup_error) model.workspace.error = news.setup_error;
    if (news.opened && !model.settings.has_own_unit) model.settings.inch = news.opened->is_inch;
    const bool has_rows = !news.rows.empty();
    const bool is_first = !model.has_rows() && has_rows;
    take_rows(model, news.rows);
    if (news.findings) model.findings = *std::move(news.findings);
    if (has_rows || news.findings) {
        mark_rows(model);
        collect_offending(model);
        apply_filter(model);
        if (news.findings || !model.findings.empty())
            model.groups = grouped(model.rows, model.findings);
    }
    if (news.path) model.path = news.path;
    if (news.block_state) model.block_state = news.block_state;
    if (news.breakpoints) model.breakpoints = *std::move(news.breakpoints);
    if (news.changes) {
        model.changes = *std::move(news.changes);
        model.stopped.reset(); // the program takes another course now
    }
    if (news.failure) model.failure = news.failure;
    if (news.stopped) model.stopped = news.stopped;
    model.reading_text = std::move(news.reading);
    model.fraction = news.fraction;
    model.program_verdict = news.verdict;
    model.is_recorded = news.is_recorded;
    model.is_busy = news.is_busy;
    if (news.refusal) say(model, *news.refusal, now);
    if (has_rows || news.findings || news.opened || news.is_recorded || news.stopped) judge(model);
    if (is_first) resume(model);
    if (is_first || news.changes) go_to(model, model.cursor.block, model.cursor.fraction);
    if (news.walk) end_walk(model, *news.walk, now);
    if (!await_offending(model)) say(model, no_violation(model), now);
}

std::string no_violation(const ViewModel& model) {
    if (!model.is_recorded) return "No problem found yet";
    const bool is_judged = std::all_of(model.rows.begin(), model.rows.end(), [](const auto& row) {
        return !moves(row) || (row.is_known && row.is_judged);
    });
    if (model.stopped)
        return fmt::format("No problem up to line {}, where the check stopped",
                           model.stopped->where.line);
    return is_judged ? "No problem found"
                     : "No problem in the checked blocks; blocks marked ? cannot be checked";
}

std::string last_good_words(const ViewModel& model) {
    if (!model.workspace.error || model.shows_setup) return {};
    const core::Error& error = *model.workspace.error;
    std::string where = std::filesystem::path(error.file).filename().generic_string();
    if (error.where.line > 0) where += fmt::format(":{}", error.where.line);
    if (error.where.column > 0) where += fmt::format(":{}", error.where.column);
    return fmt::format("{}{}{}\nThe last good state is shown.", where, where.empty() ? "" : ": ",
                       error.message);
}

void say(ViewModel& model, const std::string& text, double now) {
    model.message = text;
    model.message_until = now + 5.0;
}

void apply_filter(ViewModel& model) {
    model.filter = RowFilter(model.filter_text);
    model.filtered = model.filter.passed(model.rows, model.findings);
}

std::vector<const core::Finding*> findings_of(const ViewModel& model, std::optional<size_t> block) {
    std::vector<const core::Finding*> found;
    for (const core::Finding& finding : model.findings) {
        const bool same = block ? finding.block && core::value_of(*finding.block) == *block
                                : !finding.block.has_value();
        if (same) found.push_back(&finding);
    }
    return found;
}

const SetupSheet* sheet_of(const ViewModel& model) {
    return model.program ? model.program->sheet.get() : nullptr;
}

std::string coverage_words(const ViewModel& model) {
    if (!model.program || !model.program->coverage) return {};
    return words_of_gaps(coverage_so_far(model));
}

VerdictWords verdict_words(const ViewModel& model) {
    if (!model.program || !model.program->coverage) return {};
    return words_of_verdict(model, coverage_so_far(model));
}

bool is_current(const ViewModel& model) {
    return model.program && model.reading == 0 && !model.workspace.error
           && model.program->setup_text == model.workspace.document.text();
}

std::string length_text(const ViewModel& model, double mm, int decimals) {
    const ShownLength shown(model, mm, decimals);
    return fmt::format("{:.{}f}", shown.value == 0.0 ? 0.0 : shown.value, shown.decimals);
}

std::string length_at_least(const ViewModel& model, double mm, int decimals) {
    const ShownLength shown(model, mm, decimals);
    return core::clearance_at_least(shown.value, shown.decimals);
}

std::string clearance_at_least(const ViewModel& model, const BlockRow& row) {
    const bool has_upper = row.upper.has_value();
    return lower_bound_text(length_at_least(model, *row.lower, has_upper ? 2 : 0), has_upper);
}

namespace {

/// An overlap with its depth in the unit of the window, and the number of decimals.
std::pair<core::Overlap, int> shown_overlap(const ViewModel& model, core::Overlap overlap) {
    const ShownLength least(model, overlap.least, 2);
    overlap.least = least.value;
    if (overlap.most) overlap.most = ShownLength(model, *overlap.most, 2).value;
    return {overlap, least.decimals};
}

} // namespace

std::string depth_words(const ViewModel& model, const core::Overlap& overlap) {
    const auto [shown, decimals] = shown_overlap(model, overlap);
    return core::depth_text(shown, decimals);
}

std::string clearance_words(const ViewModel& model, const BlockRow& row) {
    if (is_contact(row)) return row.removed > 0.0 ? "cutting" : "contact";
    if (row.verdict == core::Verdict::collision && row.overlap) {
        const auto [overlap, decimals] = shown_overlap(model, *row.overlap);
        return "-" + core::depth_number(overlap, decimals);
    }
    return clearance_at_least(model, row);
}

std::string length_at_most(const ViewModel& model, double mm, int decimals) {
    const ShownLength shown(model, mm, decimals);
    return core::at_most(shown.value, shown.decimals);
}

const char* length_unit(const ViewModel& model) { return model.settings.inch ? "in" : "mm"; }

namespace {

/// Whether the device can run the program. It uses the files, so not while a what-if is in effect.
bool can_run(const ViewModel& model) {
    return model.program && !model.failure && model.changes.empty();
}

/// The number of the opened program for which answers are wanted; 0: none.
uint64_t wanted_opening(const ViewModel& model) {
    const DeviceModel& device = model.device;
    if (!can_run(model)) return 0;
    if (device.shown) return model.opening;
    return device.study && device.opening == model.opening ? model.opening : 0;
}

void forget_run(DeviceModel& device) {
    device = {.file = std::move(device.file), .shown = device.shown};
}

} // namespace

void show_device(ViewModel& model, bool shown) { model.device.shown = shown; }

bool has_device(const ViewModel& model) {
    const DeviceModel& device = model.device;
    return device.shown || !device.file.empty() || device.study != nullptr;
}

void switch_off_device(ViewModel& model) {
    model.device.shown = false;
    model.device.study = nullptr;
}

void take_in(ViewModel& model, DeviceUpdate news) {
    DeviceModel& device = model.device;
    if (!news.has_news || news.run != device.run || device.run == 0) return;
    device.fraction = news.fraction;
    device.blocks = news.blocks;
    device.is_fitting = news.is_fitting;
    device.is_running = !news.is_done;
    if (news.study) device.study = std::move(news.study);
    if (news.failure) device.failure = std::move(news.failure);
}

bool send_device_orders(ViewModel& model, DeviceWorker& worker,
                        const std::optional<CheckJob>& check) {
    DeviceModel& device = model.device;
    const uint64_t wanted = check ? wanted_opening(model) : 0;
    if (wanted == device.opening) return false;
    forget_run(device);
    device.opening = wanted;
    if (wanted == 0) {
        worker.stop();
        return true;
    }
    device.run = worker.start(*check, device.file);
    device.is_running = true;
    return true;
}

bool go_to_stop(ViewModel& model, bool forward) {
    if (!model.device.study || !model.has_rows()) return false;
    const std::vector<size_t>& all = model.device.study->stops;
    if (all.empty()) return false;
    const size_t here = model.cursor.block;
    model.playback.running = false;
    const auto above = std::upper_bound(all.begin(), all.end(), here);
    const auto below = std::lower_bound(all.begin(), all.end(), here);
    if (forward)
        go_to(model, above == all.end() ? all.front() : *above);
    else
        go_to(model, below == all.begin() ? all.back() : *(below - 1));
    return true;
}

namespace {

const char* words_of(DeviceAnswer answer) {
    switch (answer) {
    case DeviceAnswer::unknown:
        return "no answer";
    case DeviceAnswer::nothing:
        return "no motion";
    case DeviceAnswer::permitted:
        return "permitted";
    case DeviceAnswer::late:
        return "late";
    case DeviceAnswer::refused:
        return "refused";
    case DeviceAnswer::not_queried:
        return "not checked";
    }
    return "";
}

std::string device_words(const ViewModel& model) {
    const DeviceModel& device = model.device;
    if (!device.shown) return {};
    if (device.failure) return ", coprocessor: failed";
    if (!device.study) return device.is_running ? ", coprocessor: running" : ", coprocessor";
    return std::string(", coprocessor: ")
           + words_of(answer_of(device.study.get(), model.cursor.block));
}

} // namespace

std::string window_title(const ViewModel& model) {
    if (model.failure || (model.is_recorded && !model.has_rows()))
        return "Program could not be opened - feeler";
    if (!model.program) return "feeler";
    std::string title = model.workspace.document.is_modified() ? "* " : "";
    title += std::filesystem::path(model.program->program).filename().generic_string();
    const auto state_words = [](const BlockRow& row) -> std::string {
        if (!is_offending(row)) return {};
        return std::string(", ")
               + (row.verdict != core::Verdict::clear ? core::name_of(row.verdict) : "error");
    };
    if (model.has_rows())
        title += fmt::format(", line {} (block {} of {}{})", model.row().line, model.cursor.block,
                             model.rows.size() - 1, state_words(model.row()));
    title += device_words(model);
    if (!model.missing.empty()) title += ", file missing or empty";
    if (model.stopped) title += fmt::format(", stopped at line {}", model.stopped->where.line);
    if (model.workspace.error) title += ", last good state";
    return title + " - feeler";
}

} // namespace app::viewer
