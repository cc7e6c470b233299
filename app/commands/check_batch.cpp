#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "app/base/file_stamp.h"
#include "app/base/stopwatch.h"
#include "app/check/check_run.h"
#include "app/commands/batch_ending.h"
#include "app/commands/check_options.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/library/run/batch_job.h"
#include "app/library/run/batch_run.h"
#include "app/library/shard/shard.h"
#include "app/library/store/database.h"
#include "app/library/store/result_key.h"
#include "app/library/store/result_store.h"
#include "app/library/store/store_file.h"
#include "app/library/watch/watched_files.h"
#include "core/base/platform.h"

namespace app {

/// Results of earlier batches, if any. Problems with the database are reported once, and the batch
/// continues: without what does not work, and without the database if it cannot be read.
class BatchStore {
public:
    /// Opens the database named by --cache, else that of the first folder or project file in the
    /// arguments, together with its sibling databases. No database if only files are named, except
    /// that a watch then keeps one in memory.
    explicit BatchStore(const CheckOptions& options);

    /// The file of the database; empty if there is none.
    const std::string& path() const { return path_; }

    /// Prepares for another run of the batch: retries a database that could not be used.
    void begin_again();

    /// Connects the hooks of a batch, which look up and store results.
    void serve(BatchHooks& hooks);

    /// Waits until all results are written.
    void flush();

    /// Whether the database did not exist before, and now holds all results.
    bool is_new() {
        const std::scoped_lock lock(guard_);
        return is_new_ && !is_announced_;
    }

    /// The number of results found in the database.
    size_t found() const { return found_; }

private:
    void give_up(const core::Error& error);
    std::optional<ProgramResult> find(const CheckJob& job);

    std::unique_ptr<ResultStore> store_;
    std::unique_ptr<SiblingStores> siblings_; // null if --cache names a database
    std::mutex guard_;
    bool is_announced_ = false;
    std::atomic<bool> is_lost_ = false; // the database cannot be read in this run
    size_t found_ = 0;
    std::string path_;
    bool is_new_ = false;
};

namespace {

/// Whether a folder belongs to an installation of this program: the package that put it there would
/// not remove a database in it.
bool is_installed(const std::filesystem::path& folder) {
    std::error_code failure;
    const std::filesystem::path prefix =
        core::platform::program_path().parent_path().parent_path() / "share" / "feeler";
    const std::filesystem::path own = whole_path(prefix, failure);
    if (failure) return false;
    const std::filesystem::path whole = whole_path(folder, failure);
    return !failure
           && std::mismatch(own.begin(), own.end(), whole.begin(), whole.end()).first == own.end();
}

/// Path of the database; empty if results are not stored.
std::string path_of_store(const CheckOptions& options) {
    if (options.no_cache) return {};
    if (!options.cache.empty()) return options.cache;
    std::error_code ignored;
    for (const std::string& word : options.programs) {
        const std::filesystem::path path(word);
        const bool is_folder = std::filesystem::is_directory(path, ignored);
        if (!is_folder && path.extension() != ".toml") continue;
        const std::filesystem::path folder = is_folder ? path : path.parent_path();
        if (is_installed(folder.empty() ? "." : folder)) return {};
        return default_store_path(folder.generic_string(), options.shard);
    }
    return {};
}

} // namespace

BatchStore::BatchStore(const CheckOptions& options) {
    path_ = path_of_store(options);
    const std::string store_path = path_.empty() && options.watch ? Database::in_memory : path_;
    if (store_path.empty()) return;
    std::error_code ignored;
    is_new_ = options.cache.empty() && !path_.empty() && !std::filesystem::exists(path_, ignored);
    auto store = ResultStore::open(store_path, build_version(),
                                   std::make_shared<RetryBudget>(is_interrupted));
    if (!store) {
        give_up(store.error());
        return;
    }
    store_ = std::make_unique<ResultStore>(*std::move(store));
    if (options.cache.empty() && !path_.empty())
        siblings_ = std::make_unique<SiblingStores>(store_path, *store_);
}

void BatchStore::give_up(const core::Error& error) {
    const std::scoped_lock lock(guard_);
    if (std::exchange(is_announced_, true)) return;
    print_error(error);
    print_note("feeler: results are not stored; the check continues\n");
}

void BatchStore::begin_again() {
    if (store_) store_->try_again();
    is_lost_ = false;
    found_ = 0;
}

std::optional<ProgramResult> BatchStore::find(const CheckJob& job) {
    if (is_lost_) return siblings_ ? siblings_->find(job) : std::nullopt;
    auto found = store_->find(job);
    if (!found) {
        is_lost_ = true;
        give_up(found.error());
    }
    if (found && *found) return *std::move(found);
    return siblings_ ? siblings_->find(job) : std::nullopt;
}

void BatchStore::flush() {
    if (!store_) return;
    if (auto written = store_->flush(); !written) give_up(written.error());
}

void BatchStore::serve(BatchHooks& hooks) {
    if (!store_) return;
    hooks.known = [this](const CheckJob& job) {
        auto found = find(job);
        const std::scoped_lock lock(guard_);
        found_ += found ? 1 : 0;
        return found;
    };
    hooks.keep = [this](const CheckJob& job, const CheckRun& run, const ProgramResult& result) {
        if (auto stored = store_->keep(job, run, result); !stored) give_up(stored.error());
    };
}

namespace {

/// Refuses options that make no sense for many programs.
core::Result<void> refuse_single_options(const CheckOptions& options) {
    const std::pair<const char*, bool> singles[] = {
        {"--save-stock", !options.stock.empty()},
        {"--save-comparison", !options.comparison.empty()},
        {"--start-line", !options.what.start_line.empty()},
        {"--blocks", options.blocks},
        {"--pairs", options.pairs},
        {"--tolerances", options.tolerances},
    };
    for (const auto& [name, is_given] : singles)
        if (is_given)
            return core::fail(core::ErrorCode::invalid_value,
                              fmt::format("{} is for one program, not for many", name));
    return {};
}

/// Half of the machine's memory: the rest is for programs, findings and other processes.
double usual_memory() {
    const double memory = core::platform::physical_memory();
    return memory > 0.0 ? 0.5 * memory : 4e9;
}

BatchLimits limits_of(const CheckOptions& options) {
    return {.jobs = options.jobs.value_or(std::max(1U, std::thread::hardware_concurrency())),
            .memory = options.memory ? *options.memory * 1e6 : usual_memory()};
}

/// The work of this computer, which may be one shard of a batch.
struct SharedWork {
    BatchPlan plan;
    std::vector<PlannedProgram> programs; // of the whole batch
    std::vector<size_t> indices;          // indices of the plan's programs in `programs`
};

SharedWork work_of(const CheckOptions& options, BatchPlan whole) {
    if (!options.shard) return {.plan = std::move(whole), .programs = {}, .indices = {}};
    SharedWork work{.plan = {}, .programs = planned_programs(whole), .indices = {}};
    work.indices = indices_of(work.programs, *options.shard);
    work.plan = part_of_plan(whole, work.indices);
    return work;
}

/// Deletes the shard file of an earlier run, so that it is not mistaken for the result of a run
/// that was killed or could not start. Any other file stays here: writing the output decides
/// whether it may be replaced.
core::Result<void> remove_old_shard(const std::vector<ReportTarget>& targets) {
    for (const ReportTarget& target : targets) {
        if (target.format != "shard" || !is_shard_file(target.path)) continue;
        std::error_code failure;
        if (!std::filesystem::remove(resolved_path(target.path), failure))
            return tl::unexpected<core::Error>(
                {core::ErrorCode::io, {}, "cannot be replaced: " + failure.message(), target.path});
    }
    return {};
}

std::string shard_text(const CheckOptions& options, const SharedWork& work) {
    if (!options.shard) return {};
    return fmt::format("shard {}: {} of {} programs", text_of(*options.shard), work.indices.size(),
                       work.programs.size());
}

Shard shard_of(const ShardId& shard_id, const SharedWork& work, const BatchResult& batch,
               double seconds) {
    Shard shard;
    shard.version = build_version();
    shard.id = shard_id;
    shard.programs = work.programs;
    shard.seconds = seconds;
    return shard_of(std::move(shard), work.indices, batch);
}

/// State that lasts from pass to pass of --watch.
struct WatchState {
    WatchedFiles* files = nullptr; // of this pass; null without --watch
    // The result last printed for each program. Known results that are equal are not printed again.
    std::map<std::string, ProgramResult> said = {};
    bool is_again = false; // not the first pass
};

/// Records the result; whether it differs from the one last printed for the program.
bool is_changed_result(WatchState& watch, ProgramResult result) {
    result.seconds = 0.0;
    const auto [entry, is_first] = watch.said.try_emplace(result.program, result);
    if (!is_first && entry->second == result) return false;
    entry->second = std::move(result);
    return true;
}

BatchResult run_aloud(const BatchPlan& plan, const BatchLimits& limits, const BatchOutput& talk,
                      BatchStore& store, WatchState& watch, ReadFiles& read) {
    ProgressLine line;
    BatchHooks hooks;
    store.serve(hooks);
    std::mutex guard;
    std::set<std::string> known; // programs
    if (hooks.known && watch.files)
        hooks.known = [&, find = hooks.known](const CheckJob& job) {
            // Note the paths as given: the database asks for the files that links led to when it
            // was opened.
            for (const std::string& path : {job.program, job.setup})
                watch.files->note({core::FileAccessKind::content, path, {}, {}});
            auto found = find(job);
            const std::scoped_lock lock(guard);
            if (found) known.insert(found->program);
            return found;
        };
    hooks.file_accessed = [&](const core::FileAccess& access) {
        read.note(access);
        if (watch.files) watch.files->note(access);
    };
    hooks.is_stopped = is_interrupted;
    hooks.waiting = [&line](const BatchProgress& progress) { line.show(progress); };
    hooks.ended = [&](const ProgramResult& result) {
        const std::scoped_lock lock(guard);
        const bool is_new = watch.files && is_changed_result(watch, result);
        if (known.contains(result.program) && !is_new) return;
        const std::string text = program_text(result, talk.style);
        if (text.empty()) return;
        line.clear();
        talk.say(text);
    };
    BatchResult batch = run_batch(plan, limits, hooks);
    line.clear();
    store.flush();
    return batch;
}

/// Nothing was found to check. Leaves old reports in place.
ExitCode all_failed(const std::vector<core::Error>& errors) {
    for (const core::Error& error : errors) print_error(error);
    return ExitCode::failed;
}

/// One run of the whole batch.
ExitCode pass(const CheckOptions& options, const CheckJob& asked,
              const std::vector<ReportTarget>& targets, BatchStore& store, WatchState& watch) {
    const Stopwatch time;
    ReadFiles read;
    read.add(store.path());
    for (const std::string& path : sibling_stores(store.path())) read.add(path);
    auto plan = plan_batch(options.programs, asked);
    if (!plan) return failed(plan.error());
    for (const CheckJob& job : plan->jobs) {
        read.add(job.program);
        read.add(job.setup);
    }
    if (const auto safe = read.check(paths_of(targets)); !safe) return failed(safe.error());
    if (plan->jobs.empty() && !plan->failures.empty()) return all_failed(plan->failures);
    const SharedWork work = work_of(options, *std::move(plan));
    const BatchOutput talk =
        output_for({.quiet = options.quiet, .verbose = options.verbose}, targets);
    BatchResult batch = run_aloud(work.plan, limits_of(options), talk, store, watch, read);
    batch.shard = shard_text(options, work);
    talk.say("\n" + batch_summary(batch, time.seconds(), talk.style));
    if (store.found() > 0 && !watch.is_again)
        talk.say(fmt::format("{} of {} results come from earlier checks: nothing has changed\n",
                             store.found(), batch.programs.size()));
    if (store.is_new() && !watch.is_again)
        talk.say(fmt::format("results are stored in {} for later runs; --no-cache stores "
                             "none\n",
                             store.path()));
    if (is_interrupted())
        print_note(fmt::format("feeler: interrupted; {} of {} programs were checked\n",
                               batch.programs.size(),
                               batch.programs.size() + batch.unchecked.size()));
    if (!options.shard) return end_batch(batch, nullptr, targets, talk, read);
    const Shard shard = shard_of(*options.shard, work, batch, time.seconds());
    return end_batch(batch, &shard, targets, talk, read);
}

} // namespace

core::Result<BatchPass> batch_pass(const CheckOptions& options,
                                   const std::vector<ReportTarget>& targets) {
    if (auto ready = remove_old_shard(targets); !ready) return tl::unexpected(ready.error());
    if (const auto allowed = refuse_single_options(options); !allowed)
        return tl::unexpected(allowed.error());
    FEELER_TRY(const CheckJob asked, job_of(options));
    stop_on_interrupt();
    const auto store = std::make_shared<BatchStore>(options);
    return [&options, &targets, asked, store, state = WatchState()](WatchedFiles* files) mutable {
        if (files) files->add_own(store->path());
        store->begin_again();
        state.files = files;
        if (const auto ready = remove_old_shard(targets); !ready) return failed(ready.error());
        const ExitCode code = pass(options, asked, targets, *store, state);
        state.is_again = true;
        return code;
    };
}

} // namespace app
