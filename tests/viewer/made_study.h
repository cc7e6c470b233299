#pragma once

#include "app/check/check_run.h"
#include "app/coproc/study/coprocessor_report.h"
#include "app/view/model/device_worker.h"
#include "tests/viewer/rows.h"

namespace viewer_test {

/// What a device has said of a block, and when.
struct MadeAnswer {
    std::string not_queried = {};
    bool permitted = true;
    size_t segments = 3;
    hwsim::Stop stop = hwsim::Stop::none;
    double permit = 0.5, due = 2.0; // seconds after the start of the program
    core::Verdict exact = core::Verdict::clear;
};

inline MadeAnswer permitted(double slack) { return {.permit = 1.0, .due = 1.0 + slack}; }
inline MadeAnswer refused(core::Verdict exact = core::Verdict::violation) {
    return {.permitted = false, .stop = hwsim::Stop::violation, .exact = exact};
}
inline MadeAnswer not_queried() { return {.not_queried = "a body turns", .permitted = false}; }
inline MadeAnswer nothing() { return {.segments = 0, .due = core::infinity}; }

/// Answers of a device to a program, as a run would have them.
inline app::CoprocessorResult result_of(const std::vector<MadeAnswer>& answers) {
    app::CoprocessorResult result;
    app::DeviceTotals counted;
    for (size_t i = 0; i < answers.size(); ++i) {
        const MadeAnswer& answer = answers[i];
        app::DeviceBlock block;
        block.permit.permitted = answer.permitted;
        block.permit.segments = answer.segments;
        block.permit.stop = answer.stop;
        block.permit.not_queried = answer.not_queried;
        if (answer.stop == hwsim::Stop::violation) block.permit.pair = core::Pair{};
        block.permit.report = {.permitted = static_cast<uint32_t>(3 * i + 3),
                               .stop = answer.stop,
                               .stop_sequence = answer.stop == hwsim::Stop::none
                                                    ? 0U
                                                    : static_cast<uint32_t>(3 * i + 4)};
        block.cycles = 1000;
        block.nodes = 12;
        block.lines = 7;
        counted.counters[static_cast<size_t>(hwsim::Counter::cycles)] += 1000;
        counted.counters[static_cast<size_t>(hwsim::Counter::busy)] += 2000;
        block.after = counted;
        result.run.blocks.push_back(block);
        app::CheckedBlock checked;
        checked.line = static_cast<uint32_t>(10 + i);
        checked.result.verdict = answer.exact;
        checked.result.pairs.push_back({.verdict = answer.exact});
        result.run.check.blocks.push_back(checked);
        app::BlockTiming timing;
        timing.asked = 0.25;
        timing.permitted = answer.permit;
        timing.due = timing.entered = answer.due;
        result.timing.blocks.push_back(timing);
        result.timing.missed += answer.permitted && timing.is_late();
    }
    result.run.totals = counted;
    result.timing.taken = 4.0;
    result.timing.making = 1.0;
    return result;
}

/// A window in which a device has answered to the blocks of a program.
inline app::viewer::ViewModel model_with(const std::vector<MadeAnswer>& answers) {
    std::vector<app::viewer::BlockRow> rows(answers.size(), row_with(5.0));
    app::viewer::ViewModel model = model_of(std::move(rows));
    model.program = std::make_shared<app::viewer::OpenedProgram>();
    model.device.shown = true;
    model.device.opening = model.opening;
    model.device.run = 1;
    model.device.study = app::viewer::study_of(result_of(answers));
    return model;
}

} // namespace viewer_test
