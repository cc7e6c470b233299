#include "app/view/model/tolerance_sheet.h"

#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/tolerance/tolerances.h"
#include "app/view/model/tolerance_worker.h"
#include "app/view/model/view_model.h"

namespace app::viewer {
namespace {

/// The first block of a line of a file; empty if none was executed.
std::optional<size_t> block_of(const ViewModel& model, const ToleranceLimit& limit) {
    if (limit.line == 0) return std::nullopt;
    for (size_t i = 0; i < model.rows.size(); ++i)
        if (model.rows[i].line == limit.line && model.rows[i].file == limit.file) return i;
    return std::nullopt;
}

ToleranceCause cause_of(const ViewModel& model, const ToleranceLimit& limit) {
    const std::string words = limit_text(limit);
    if (words.empty()) return {};
    return {words, block_of(model, limit)};
}

std::string status_of(const ViewModel& model) {
    const ToleranceModel& state = model.tolerances;
    if (state.failure) return state.failure->message;
    if (!model.changes.empty()) return "There are no tolerances while a what-if is in effect.";
    if (!state.found)
        return fmt::format("The check is repeated with deviations: {:.0f} %",
                           100.0 * state.fraction);
    if (!state.found->refusal.empty()) return "There are none: " + state.found->refusal + ".";
    return {};
}

} // namespace

ToleranceSheet tolerance_sheet(const ViewModel& model) {
    const ToleranceModel& state = model.tolerances;
    ToleranceSheet sheet{.status = status_of(model), .has_failed = state.failure.has_value()};
    if (!sheet.status.empty()) return sheet;
    for (const Tolerance& tolerance : state.found->list)
        sheet.lines.push_back(
            {.name = title_of(tolerance.deviation),
             .range = range_text(tolerance, model.settings.inch),
             .is_known = tolerance.is_known(),
             .causes = {cause_of(model, tolerance.less), cause_of(model, tolerance.more)}});
    return sheet;
}

void take_in(ViewModel& model, ToleranceUpdate news) {
    ToleranceModel& state = model.tolerances;
    if (!news.has_news || news.run != state.run || state.run == 0) return;
    state.fraction = news.fraction;
    if (news.found) state.found = std::move(news.found);
    if (news.failure) state.failure = std::move(news.failure);
    state.is_running = !state.found && !state.failure;
}

bool send_tolerance_orders(ViewModel& model, ToleranceWorker& worker,
                           const std::optional<CheckJob>& check) {
    ToleranceModel& state = model.tolerances;
    const bool can_run = check && model.program && !model.failure && model.changes.empty();
    const bool is_wanted = model.popup == Popup::tolerances || state.opening == model.opening;
    const uint64_t wanted = can_run && is_wanted ? model.opening : 0;
    if (wanted == state.opening) return false;
    state = {};
    worker.stop();
    if (wanted == 0) return true;
    state.opening = wanted;
    state.run = worker.start(*check);
    state.is_running = true;
    return true;
}

} // namespace app::viewer
