#include "app/check/check_run.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/sha256.h"
#include "app/base/stopwatch.h"
#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/coproc/device_judge.h"
#include "app/setup/coverage.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"
#include "core/sim/run/simulator.h"

namespace app {

const char* name_of(Engine engine) { return engine == Engine::exact ? "exact" : "coprocessor"; }

bool CheckRun::has_errors() const {
    return std::any_of(findings.begin(), findings.end(), [](const core::Finding& finding) {
        return finding.severity == core::Severity::error;
    });
}

Coverage CheckRun::full_coverage() const {
    Coverage full = coverage ? *coverage : Coverage();
    std::set<core::ToolNumber> feeding, moving;
    for (const CheckedBlock& block : blocks.without_texts()) {
        const core::BlockMotion motion = block.result.motion;
        full.moves = full.moves || motion != core::BlockMotion::none;
        if (motion == core::BlockMotion::none || !block.result.tool) continue;
        moving.insert(*block.result.tool);
        if (motion != core::BlockMotion::rapid) feeding.insert(*block.result.tool);
    }
    const auto has_holder = [&](core::ToolNumber number) {
        const auto tool = setup.tools.find(number);
        return tool != setup.tools.end() && !tool->second.description.holder.empty();
    };
    count_tools(feeding, moving, has_holder, full);
    reduce_by(findings, full);
    return full;
}

std::string CheckRun::headline() const {
    const bool in_program = std::any_of(findings.begin(), findings.end(), is_error_of_program);
    return headline_of(
        {.verdict = verdict,
         .is_stopped = stopped.has_value(),
         .has_errors = in_program,
         .lacks_required = std::any_of(findings.begin(), findings.end(), lacks_coverage)},
        full_coverage());
}

std::vector<std::string> CheckRun::all_assumptions() const {
    std::vector<std::string> all = assumptions;
    all.insert(all.end(), later_assumptions.begin(), later_assumptions.end());
    return all;
}

double least_clearance(const core::Setup& setup, const core::BlockResult& result) {
    double lower = result.checked ? setup.search_limit : 0.0;
    for (const core::PairClearance& pair : result.pairs) lower = std::min(lower, pair.lower);
    return lower;
}

ShownClearance shown_clearance(const core::Setup& setup, const core::BlockResult& result) {
    if (!result.checked) return {.is_known = false};
    if (result.deciding) return shown_clearance(result.pairs[*result.deciding]);
    return {.lower = least_clearance(setup, result)};
}

bool is_permitted_contact(const core::BlockResult& result) {
    if (!result.deciding) return false;
    const core::PairClearance& pair = result.pairs[*result.deciding];
    return pair.verdict == core::Verdict::clear && pair.allowance.distance <= core::resolution
           && pair.lower <= core::resolution;
}

std::string tightest_words(const core::BlockResult& result, ClearanceStyle style) {
    if (is_permitted_contact(result)) return "permitted contact only";
    const core::PairClearance& pair = result.pairs[*result.deciding];
    return fmt::format("{}{} (minimum {} mm)", clearance_text(shown_clearance(pair), style),
                       style == ClearanceStyle::sentence ? "" : " mm",
                       core::at_most(pair.allowance.distance));
}

std::optional<CheckedBlock> tightest_block(const CheckRun& run) {
    std::optional<CheckedBlock> tightest;
    const auto is_tighter = [](const CheckedBlock& block, const CheckedBlock& than) {
        const bool touches = is_permitted_contact(block.result);
        const bool other_touches = is_permitted_contact(than.result);
        if (touches != other_touches) return other_touches;
        const core::PairClearance& pair = block.result.pairs[*block.result.deciding];
        const core::PairClearance& other = than.result.pairs[*than.result.deciding];
        return pair.verdict != other.verdict ? pair.verdict > other.verdict
                                             : pair.margin() < other.margin();
    };
    size_t at = 0, i = 0;
    for (const CheckedBlock& block : run.blocks.without_texts()) {
        if (block.result.deciding && (!tightest || is_tighter(block, *tightest))) {
            tightest = block;
            at = i;
        }
        ++i;
    }
    if (tightest) tightest = run.blocks[at];
    return tightest;
}

std::string setup_path(const CheckJob& job) {
    if (!job.setup.empty()) return job.setup;
    return std::filesystem::path(job.program).replace_extension(".toml").generic_string();
}

void find_setup_next_to(CheckJob& job) {
    if (!job.setup.empty() || job.program.empty()) return;
    job.setup = setup_next_to(job.program);
    job.setup_was_found = !job.setup.empty();
}

namespace {

/// Records each distinct file access of this thread while the object exists. A file that changes
/// between two reads is recorded twice.
class InputRecorder {
public:
    InputRecorder() : observer_([this](const core::FileAccess& access) { note(access); }) {}

    std::vector<InputFile> inputs() const { return {inputs_.begin(), inputs_.end()}; }

private:
    void note(const core::FileAccess& access);

    std::set<InputFile> inputs_;
    core::FileAccessObserver observer_;
};

void InputRecorder::note(const core::FileAccess& access) {
    InputFile input{access.question, access.path, access.name, std::nullopt};
    if (access.answer)
        input.answer = access.question == core::FileAccessKind::content
                           ? sha256_of(*access.answer)
                           : std::string(*access.answer);
    inputs_.insert(std::move(input));
}

void use_coprocessor(CheckInput& input) {
    input.engine = Engine::coprocessor;
    input.assumptions.push_back(
        "the coprocessor alone judges clearances and may refuse a clear block: its models are "
        "larger than the bodies by about a mesh size");
}

} // namespace

core::Result<CheckRun> run_check(const CheckJob& job) {
    const InputRecorder recorder;
    FEELER_TRY(PreparedCheck check, prepare_check(job));
    if (job.engine == Engine::coprocessor) use_coprocessor(check.run);
    const Stopwatch checking;
    ProgramRunner runner(check);
    runner.after_block = job.after_block;
    runner.use_threads(job.threads);
    std::optional<DeviceJudge> device;
    if (job.engine == Engine::coprocessor) {
        FEELER_TRY(device, DeviceJudge::with(check.run.setup, runner.machine().stock));
        runner.use_judge(
            [&](std::span<const core::Event> block, const auto& before, const std::string& doubt) {
                return device->judge(block, before, doubt);
            });
    }
    if (!job.start_line.empty())
        if (const auto begun = runner.start_at(job.start_line); !begun)
            return tl::unexpected(core::in_file(begun.error(), job.program));
    runner.run_to_end();
    check.run.times.check = checking.seconds();
    runner.conclude(job.needs_surface);
    check.run.inputs = recorder.inputs();
    return std::move(check.run);
}

} // namespace app
