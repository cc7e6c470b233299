#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/batch_store.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/commands/watch.h"
#include "app/report/batch_report.h"
#include "app/report/batch_text.h"
#include "app/report/junit_report.h"
#include "app/report/sarif_report.h"
#include "app/session/stopwatch.h"

namespace app {
namespace {

/// Options that mean nothing for many programs.
core::Result<void> refuse_single_options(const CheckOptions& options) {
    const std::pair<const char*, bool> singles[] = {
        {"--save-stock", !options.stock.empty()},
        {"--save-comparison", !options.comparison.empty()},
        {"--start-line", !options.what.start_line.empty()},
        {"--blocks", options.blocks},
        {"--pairs", options.pairs},
    };
    for (const auto& [name, is_given] : singles)
        if (is_given)
            return core::fail(core::ErrorCode::invalid_value,
                              fmt::format("{} is for one program, not for many", name));
    return {};
}

/// Half of the machine's memory: the rest is for programs, findings, and everybody else.
double usual_memory() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGE_SIZE);
    return pages > 0 && size > 0 ? 0.5 * static_cast<double>(pages) * static_cast<double>(size)
                                 : 4e9;
}

BatchLimits limits_of(const CheckOptions& options) {
    return {.jobs = options.jobs.value_or(std::max(1U, std::thread::hardware_concurrency())),
            .memory = options.memory ? *options.memory * 1e6 : usual_memory()};
}

core::Result<void> refuse_lost_input(const BatchPlan& plan,
                                     const std::vector<ReportTarget>& targets) {
    std::error_code ignored;
    for (const ReportTarget& target : targets) {
        if (!std::filesystem::is_regular_file(target.path, ignored)) continue;
        for (const CheckJob& job : plan.jobs)
            if (auto safe = check_output(target.path, {job.program, job.setup}); !safe) return safe;
    }
    return {};
}

std::string report_of(const BatchResult& batch, const std::string& format,
                      const BatchStyle& style) {
    std::error_code ignored;
    if (format == "json") return batch_json_report(batch);
    if (format == "jsonl") return batch_lines_report(batch);
    if (format == "csv") return batch_csv_report(batch);
    if (format == "junit") return junit_report(batch);
    if (format == "sarif")
        return sarif_report(batch, std::filesystem::current_path(ignored).string());
    return batch_text(batch, {.quiet = style.quiet, .verbose = style.verbose});
}

/// Where lines for a person go: to standard output, unless a report for others does.
struct Talk {
    std::FILE* stream = stdout;
    BatchStyle style;

    void say(const std::string& text) const {
        std::fputs(text.c_str(), stream);
        std::fflush(stream);
    }
};

bool goes_to_standard_output(const ReportTarget& target) { return target.path.empty(); }

Talk talk_of(const CheckOptions& options, const std::vector<ReportTarget>& targets) {
    Talk talk{.style = {.quiet = options.quiet, .verbose = options.verbose}};
    for (const ReportTarget& target : targets)
        if (goes_to_standard_output(target) && target.format != "text") talk.stream = stderr;
    const char* no_colour = std::getenv("NO_COLOR");
    const bool may_colour = !no_colour || *no_colour == '\0';
    talk.style.colour = may_colour && ::isatty(::fileno(talk.stream)) == 1;
    return talk;
}

/// Between the passes of --watch.
struct Watch {
    WatchedFiles* files = nullptr; // of this pass; null: nothing is watched
    bool is_again = false;         // not the first pass: what is known already is not said
};

BatchResult run_aloud(const BatchPlan& plan, const BatchLimits& limits, const Talk& talk,
                      BatchStore& store, const Watch& watch) {
    stop_on_interrupt();
    ProgressLine line;
    BatchHooks hooks;
    store.serve(hooks);
    std::mutex guard;
    std::set<std::string> known; // programs
    if (hooks.known && watch.is_again)
        hooks.known = [&, find = hooks.known](const CheckJob& job) {
            auto found = find(job);
            const std::scoped_lock lock(guard);
            if (found) known.insert(found->program);
            return found;
        };
    if (watch.files) hooks.looked = [&](const core::FileLook& look) { watch.files->note(look); };
    hooks.is_stopped = is_interrupted;
    hooks.waiting = [&line](const BatchProgress& progress) { line.show(progress); };
    hooks.ended = [&](const ProgramResult& result) {
        const std::scoped_lock lock(guard);
        const std::string text =
            known.contains(result.program) ? "" : program_text(result, talk.style);
        if (text.empty()) return;
        line.clear();
        talk.say(text);
    };
    return run_batch(plan, limits, hooks);
}

/// Each report, whole or not at all; whether all could be written.
bool write_reports(const BatchResult& batch, const std::vector<ReportTarget>& targets,
                   const BatchStyle& style) {
    bool all = true;
    for (const ReportTarget& target : targets) {
        const bool was_said = goes_to_standard_output(target) && target.format == "text";
        if (was_said) continue;
        const auto written = write_output(target.path, report_of(batch, target.format, style));
        if (!written) print_error(written.error());
        all = all && written.has_value();
    }
    return all;
}

ExitCode failed(const core::Error& error) {
    print_error(error);
    return ExitCode::failed;
}

/// Nothing was found to check: old reports stay.
ExitCode failed(const std::vector<core::Error>& errors) {
    for (const core::Error& error : errors) print_error(error);
    return ExitCode::failed;
}

/// Once through the whole batch.
ExitCode pass(const CheckOptions& options, const CheckJob& asked,
              const std::vector<ReportTarget>& targets, BatchStore& store, const Watch& watch) {
    const Stopwatch time;
    const auto plan = plan_batch(options.programs, asked);
    if (!plan) return failed(plan.error());
    if (const auto safe = refuse_lost_input(*plan, targets); !safe) return failed(safe.error());
    if (plan->jobs.empty() && !plan->failures.empty()) return failed(plan->failures);
    const Talk talk = talk_of(options, targets);
    const BatchResult batch = run_aloud(*plan, limits_of(options), talk, store, watch);
    talk.say("\n" + batch_summary(batch, time.seconds(), talk.style));
    if (store.found() > 0 && !watch.is_again)
        talk.say(fmt::format("{} of {} results are those of earlier checks: nothing has changed\n",
                             store.found(), batch.programs.size()));
    if (is_interrupted())
        fmt::print(stderr, "feeler: interrupted; {} of {} programs were checked\n",
                   batch.programs.size(), batch.programs.size() + batch.unchecked.size());
    bool all_written = write_reports(batch, targets, talk.style);
    if (std::ferror(talk.stream) != 0) {
        print_error({core::ErrorCode::io, {}, "cannot be written", "standard output"});
        all_written = false;
    }
    return all_written ? static_cast<ExitCode>(status_of(batch)) : ExitCode::failed;
}

} // namespace

ExitCode check_batch(const CheckOptions& options, const std::vector<ReportTarget>& targets) {
    if (const auto allowed = refuse_single_options(options); !allowed)
        return failed(allowed.error());
    auto asked = job_of(options.what);
    if (!asked) return failed(asked.error());
    asked->engine = options.engine;
    asked->detail = detail_of(options);
    BatchStore store(options);
    if (!options.watch) return pass(options, *asked, targets, store, {});
    std::vector<std::string> own = paths_of(targets);
    own.push_back(store.path());
    bool is_again = false;
    return watch(own, [&](WatchedFiles& files) {
        store.look_again();
        return pass(options, *asked, targets, store, {&files, std::exchange(is_again, true)});
    });
}

} // namespace app
