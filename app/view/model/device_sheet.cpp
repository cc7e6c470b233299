#include "app/view/model/device_sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/coproc/device_judge.h"
#include "app/coproc/study/coprocessor_report.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/view_model.h"

namespace app::viewer {
namespace {

using hwsim::Counter;

const std::string no_value = "\xE2\x80\x94";

/// The block shown by the panel, and its data.
struct Subject {
    const DeviceStudy& study;
    size_t index = 0;

    const DeviceBlock& block() const { return study.result->run.blocks[index]; }
    const BlockTiming& timing() const { return study.result->timing.blocks[index]; }
    core::BlockResult exact() const { return study.result->run.check.blocks[index].result; }
    DeviceAnswer answer() const { return answer_of(&study, index); }
    DeviceTotals before() const {
        return index == 0 ? DeviceTotals() : study.result->run.blocks[index - 1].after;
    }
};

std::string percent(double fraction) {
    if (fraction > 0.0 && fraction < 1e-4) return "< 0.01 %";
    return fmt::format("{:.{}f} %", 100.0 * fraction, fraction < 0.01 ? 2 : fraction < 0.1 ? 1 : 0);
}

std::string percent(std::optional<double> fraction) {
    return fraction ? percent(*fraction) : no_value;
}

std::string block_words(const DeviceStudy& study, size_t block) {
    return fmt::format("block {}, line {}", block, study.result->run.check.blocks[block].line);
}

std::string number_of(const Subject& subject) {
    if (subject.answer() == DeviceAnswer::refused) return "refused";
    if (subject.answer() == DeviceAnswer::not_queried) return "not checked";
    const auto slack = slack_of(&subject.study, subject.index);
    return slack ? time_text(*slack) : no_value;
}

std::string answer_words(const Subject& subject) {
    // Only valid for blocks that the run has reached.
    const auto why = [&] { return refusal(*subject.study.result, subject.index); };
    switch (subject.answer()) {
    case DeviceAnswer::unknown:
        return "The run ended before this block";
    case DeviceAnswer::nothing:
        return "Permitted: the block moves nothing";
    case DeviceAnswer::permitted:
        return slack_of(&subject.study, subject.index)
                   ? "Permitted in time"
                   : "Permitted; the machine is stopped until then";
    case DeviceAnswer::late:
        return "Permitted too late: the machine brakes and waits";
    case DeviceAnswer::refused:
        return subject.block().permit.stop == hwsim::Stop::violation
                   ? why() + " come closer than allowed"
                   : "The coprocessor has stopped: " + why();
    case DeviceAnswer::not_queried:
        return "Not permitted: " + why();
    }
    return {};
}

/// Verdict and clearance of the exact engine. Repeated here because the inspector may be hidden
/// when the coprocessor panel is open.
std::string exact_words(const ViewModel& model, const Subject& subject) {
    std::string verdict = core::name_of(subject.exact().verdict);
    const BlockRow& row = model.row();
    if (!row.is_known || !row.lower) return verdict;
    return fmt::format("{}, {} {}", verdict, clearance_at_least(model, row), length_unit(model));
}

/// Compares the result of the exact engine with the answer of the device.
void compare(const Subject& subject, const std::string& exact, DeviceSheet& sheet) {
    EngineAgreement both;
    add(both, subject.block().permit, subject.exact());
    const bool is_undecided = subject.exact().verdict == core::Verdict::undecided;
    sheet.exact = "The exact engine says " + exact;
    if (both.missed > 0) {
        sheet.exact += ": the block must not be permitted";
        sheet.exact_tone = Tone::bad;
    } else if (both.not_queried > 0 || is_undecided) {
        sheet.exact_tone = Tone::near;
    } else if (both.false_alarms > 0) {
        sheet.exact += ": a false alarm, on the safe side";
        sheet.exact_tone = Tone::near;
    } else {
        sheet.exact = "The exact engine agrees: " + exact;
    }
}

DevicePart time_part(const Subject& subject) {
    const BlockTiming& timing = subject.timing();
    DevicePart part{subject.study.held && subject.index > *subject.study.held
                        ? "Time, after a refused block"
                        : "Time",
                    {}};
    // Every block has all lines, so that nothing jumps when the user steps.
    const auto after = [&](const char* name, double time) {
        part.lines.push_back(
            {name, std::isfinite(time) ? "+" + time_text(time - timing.asked) : no_value});
    };
    part.lines.push_back(
        {"requested at", timing.asked > 0.0 ? time_text(timing.asked) : "the start"});
    after(subject.block().permit.permitted ? "permitted" : "answered", timing.permitted);
    after("due", timing.due);
    after("entered", timing.entered);
    if (subject.answer() == DeviceAnswer::late) part.lines[1].tone = Tone::bad;
    return part;
}

DevicePart work_part(const Subject& subject) {
    const DeviceBlock& block = subject.block();
    const uint64_t lines = block.after[Counter::lines_read] - subject.before()[Counter::lines_read];
    return {"Work for this block",
            {{"cycles", fmt::format("{}", block.cycles)},
             {"segments", fmt::format("{}", block.permit.segments)},
             {"nodes", fmt::format("{}", block.nodes)},
             {"pairs", fmt::format("{}", block.pairs)},
             {"lines read", fmt::format("{}", lines)},
             {"lines made", fmt::format("{}", block.lines)}},
            true};
}

DevicePart register_part(const Subject& subject) {
    const hwsim::DeviceReport& report = subject.block().permit.report;
    const bool stopped = report.stop != hwsim::Stop::none;
    DevicePart part{"Registers after the block",
                    {{"PERMIT_SEQ", fmt::format("{}", report.permitted)},
                     {"STOP", name_of(report.stop), stopped ? Tone::bad : Tone::plain}}};
    part.lines.push_back({"STOP_SEQ", fmt::format("{}", report.stop_sequence)});
    part.lines.push_back({"STOP_LINE", fmt::format("{}", report.stop_line)});
    part.lines.push_back(
        {"deepest stack", fmt::format("{}", subject.block().after[Counter::deepest])});
    return part;
}

/// What the threads of the device did since the last block.
DevicePart use_part(const Subject& subject) {
    const DeviceUse fractions =
        use_between(subject.before(), subject.block().after, subject.study.result->file.device);
    return {"Busy, waiting for, cache hits",
            {{"busy", percent(fractions.busy)},
             {"memory", percent(fractions.memory)},
             {"ports", percent(fractions.ports)},
             {"order", percent(fractions.order)},
             {"nodes", percent(fractions.node_hits)},
             {"records", percent(fractions.record_hits)}},
            true};
}

/// Adds the number of blocks that are refused or late, and where the machine stops.
void add_stops(const DeviceStudy& study, DevicePart& part) {
    const EngineAgreement& both = *study.agreement;
    const auto count = [&](const char* name, size_t blocks) {
        part.lines.push_back({name, fmt::format("{} of {}", blocks, study.size()),
                              blocks == 0 ? Tone::plain : Tone::bad});
    };
    count("refused", both.refused - both.not_queried);
    if (both.not_queried > 0) count("not checked", both.not_queried);
    if (study.held)
        part.lines.push_back(
            {"stopped before", block_words(study, *study.held), Tone::bad, *study.held});
    const size_t late = study.result->timing.missed;
    part.lines.push_back({"late", late == 0 ? "none" : fmt::format("{}", late),
                          late == 0 ? Tone::plain : Tone::bad});
    const PermitTiming& timing = study.result->timing;
    if (late > 0)
        part.lines.push_back(
            {"waited", time_text(std::max(0.0, timing.taken - timing.planned)), Tone::bad});
    if (!timing.tightest) return;
    const double slack = timing.blocks[*timing.tightest].slack();
    const Tone tone = slack < 0.0 ? Tone::bad : slack < study.near ? Tone::near : Tone::plain;
    part.lines.push_back({"least slack", time_text(slack), tone, timing.tightest});
    part.lines.push_back({"at", block_words(study, *timing.tightest), Tone::dim, timing.tightest});
}

DevicePart run_part(const ViewModel& model) {
    const DeviceStudy& study = *model.device.study;
    const hwsim::DeviceConfig& device = study.result->file.device;
    DevicePart part{"Whole run", {}};
    add_stops(study, part);
    part.lines.push_back({"latency p50", time_text(study.figures->p50)});
    part.lines.push_back({"latency max", time_text(study.figures->longest)});
    part.lines.push_back({"device busy", percent(study.figures->busy_fraction)});
    part.lines.push_back({"control busy", percent(study.figures->control_share)});
    if (study.agreement->missed > 0)
        part.lines.push_back({"missed", fmt::format("{}", study.agreement->missed), Tone::bad});
    part.lines.push_back({"false alarms", fmt::format("{}", study.agreement->false_alarms)});
    part.lines.push_back({"coprocessor", fmt::format("{} x {}, {} MHz", device.elements,
                                                     device.threads, device.clock_mhz)});
    const auto best = smallest(study.result->fits);
    std::string enough = "none of those tried";
    if (model.device.is_running)
        enough = fmt::format("searching: {:.0f} %", 100.0 * model.device.fraction);
    if (best)
        enough = fmt::format("{} element{}, {} MHz", best->elements, best->elements == 1 ? "" : "s",
                             *best->clock_mhz);
    part.lines.push_back({"sufficient", enough, best ? Tone::plain : Tone::dim});
    return part;
}

} // namespace

DeviceSheet device_sheet(const ViewModel& model) {
    const DeviceStudy& study = *model.device.study;
    const Subject subject{study, model.cursor.block};
    DeviceSheet sheet;
    if (subject.answer() == DeviceAnswer::unknown) {
        sheet.number = no_value;
        sheet.answer = answer_words(subject);
        sheet.parts = {run_part(model)};
    } else {
        sheet.number = number_of(subject);
        const auto slack = slack_of(&study, subject.index);
        if (slack && *slack < study.near) sheet.tone = Tone::near;
        if (stops_machine(subject.answer())) sheet.tone = Tone::bad;
        sheet.answer = answer_words(subject);
        compare(subject, exact_words(model, subject), sheet);
        sheet.parts = {time_part(subject), run_part(model), work_part(subject),
                       register_part(subject), use_part(subject)};
    }
    return sheet;
}

std::string device_status(const ViewModel& model) {
    const DeviceModel& device = model.device;
    if (!model.changes.empty())
        return "A what-if is in effect, but the coprocessor runs the program as the files describe "
               "it. "
               "Undo the what-if, or enter the change in the set-up.";
    if (device.failure) {
        std::string words = device.failure->message;
        if (device.failure->where.line > 0)
            words = fmt::format("line {}: {}", device.failure->where.line, words);
        if (!device.failure->file.empty()) words = device.failure->file + ", " + words;
        return words;
    }
    if (!model.program) return "Waiting for the program \xE2\x80\xA6";
    if (!device.is_running || device.study) return {};
    if (device.blocks == 0) return "Loading the stock into the coprocessor \xE2\x80\xA6";
    return fmt::format("Checking block {} \xE2\x80\xA6 {:.0f} %", device.blocks,
                       100.0 * device.fraction);
}

std::string slack_words(const ViewModel& model, size_t block) {
    const DeviceStudy* study = model.device.study.get();
    switch (answer_of(study, block)) {
    case DeviceAnswer::unknown:
    case DeviceAnswer::nothing:
        return {};
    case DeviceAnswer::refused:
        return "refused: " + refusal(*study->result, block);
    case DeviceAnswer::not_queried:
        return "not checked: " + refusal(*study->result, block);
    case DeviceAnswer::late:
        return "late by " + time_text(-*slack_of(study, block));
    case DeviceAnswer::permitted:
        break;
    }
    const auto slack = slack_of(study, block);
    return slack ? "slack " + time_text(*slack) : "permitted";
}

} // namespace app::viewer
