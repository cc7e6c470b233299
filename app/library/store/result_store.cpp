#include "app/library/store/result_store.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <set>

#include <fmt/format.h>

#include "app/base/file_stamp.h"
#include "app/base/sha256.h"
#include "app/check/check_run.h"
#include "app/library/store/database.h"
#include "app/library/store/input_files.h"
#include "app/library/store/relative_paths.h"
#include "app/library/store/result_key.h"
#include "app/library/store/result_writer.h"
#include "app/library/store/store_file.h"

namespace app {
namespace {

InputFile input_of(const Statement& row) {
    InputFile input{static_cast<core::FileAccessKind>(row.number(0)), row.text(1), row.text(2), {}};
    if (const std::string answer = row.text(3); !answer.empty()) input.answer = answer.substr(1);
    return input;
}

/// Microseconds since 1970.
int64_t now() {
    using namespace std::chrono;
    return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

/// All paths of a job as given, each with its length.
std::string names_in(const CheckJob& job) {
    const ProgramSettings& settings = job.settings;
    std::vector<std::string> paths = settings.search_path;
    paths.insert(paths.end(),
                 {job.program, job.setup, settings.ini, settings.parameters, settings.tool_table});
    std::string text;
    for (const std::string& path : paths) text += fmt::format(" {}:{}", path.size(), path);
    return text;
}

/// Whether results of a job are stored.
bool is_stored(const CheckJob& job) { return !job.setup_text; }

/// The keys under which the result of a job may be stored.
struct JobKeys {
    std::string options;     // see options_text; with relative_paths instead of paths
    std::string by_any_name; // for results whose texts contain no paths of the job
    std::string by_this_name;
};

} // namespace

struct ResultStore::State {
    State(const std::string& path, std::string by) : version(std::move(by)), relative_paths(path) {}

    std::string version;
    RelativePaths relative_paths;
    std::shared_ptr<InputAnswers> answers;
    std::shared_ptr<RetryBudget> retries;
    std::shared_ptr<ResultWriter> writer; // that of the own store if this one is read-only
    bool is_writable = true;
    std::mutex mutex; // guards all members below
    Database database;
    Statement rows_of_key, accesses_of_row, rows_of_program, sighting;

    core::Result<void> prepare();
    std::string relative(const std::string& program) const;
    std::string content_of(const CheckJob& job) const;
    JobKeys keys_of(const CheckJob& job, const std::string& sha256) const;
    bool is_same(const StoredRow& row);
    core::Result<std::vector<StoredRow>> rows(const std::string& key);
    core::Result<std::optional<ProgramResult>> find(const std::string& key);
};

core::Result<void> ResultStore::State::prepare() {
    FEELER_TRY(rows_of_key,
               database.prepare("SELECT id, key, looks, value, seal FROM result WHERE key = ?1 "
                                "ORDER BY id DESC"));
    FEELER_TRY(accesses_of_row,
               database.prepare("SELECT question, path, name, answer FROM result_look "
                                "JOIN look ON look.id = look WHERE result = ?1"));
    FEELER_TRY(
        rows_of_program,
        database.prepare("SELECT checked_at, version, setup, options, looks, value, key, seal, "
                         "coalesce(at, 1000000 * checked_at) AS last FROM result "
                         "JOIN program ON program.id = program LEFT JOIN seen USING(key, looks) "
                         "WHERE path = ?1 ORDER BY last, result.id"));
    FEELER_TRY(sighting, database.prepare("SELECT at FROM seen WHERE key = ?1 AND looks = ?2"));
    return {};
}

/// The path of a program relative to the folder, independent of the working folder.
std::string ResultStore::State::relative(const std::string& program) const {
    std::error_code failure;
    const auto whole = whole_path(program, failure);
    return failure ? program : whole.lexically_relative(relative_paths.folder()).generic_string();
}

std::string ResultStore::State::content_of(const CheckJob& job) const {
    return answers->content_of(relative_paths.absolute(relative_paths.relative(job.program)));
}

JobKeys ResultStore::State::keys_of(const CheckJob& job, const std::string& sha256) const {
    const CheckJob there = with_relative_paths(job, relative_paths);
    JobKeys keys{
        .options = options_text(there).value_or(""), .by_any_name = {}, .by_this_name = {}};
    keys.by_any_name = result_key(version, there, sha256, keys.options);
    keys.by_this_name = sha256_of(keys.by_any_name + relative_paths.folder() + names_in(job));
    return keys;
}

bool ResultStore::State::is_same(const StoredRow& row) {
    return std::all_of(row.inputs.begin(), row.inputs.end(), [this](const InputFile& input) {
        return answers->is_same(with_absolute_paths(input, relative_paths));
    });
}

core::Result<std::vector<StoredRow>> ResultStore::State::rows(const std::string& key) {
    const std::lock_guard lock(mutex);
    std::vector<StoredRow> found;
    rows_of_key.reset();
    rows_of_key.bind(1, key);
    for (bool more = true;;) {
        FEELER_TRY(more, rows_of_key.step());
        if (!more) break;
        found.push_back({.id = rows_of_key.number(0),
                         .key = rows_of_key.text(1),
                         .accesses = rows_of_key.text(2),
                         .value = rows_of_key.text(3),
                         .seal = rows_of_key.text(4)});
    }
    rows_of_key.reset();
    for (StoredRow& row : found) {
        accesses_of_row.reset();
        accesses_of_row.bind(1, row.id);
        for (bool more = true;;) {
            FEELER_TRY(more, accesses_of_row.step());
            if (!more) break;
            row.inputs.push_back(input_of(accesses_of_row));
        }
        accesses_of_row.reset();
    }
    return found;
}

ResultStore::ResultStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResultStore::ResultStore(ResultStore&&) noexcept = default;
ResultStore& ResultStore::operator=(ResultStore&&) noexcept = default;
ResultStore::~ResultStore() = default;

core::Result<ResultStore> ResultStore::open(const std::string& path, const std::string& version,
                                            std::shared_ptr<RetryBudget> retries,
                                            std::chrono::milliseconds gathering) {
    auto state = std::make_unique<State>(path, version);
    state->answers = std::make_shared<InputAnswers>();
    state->retries = retries ? std::move(retries) : std::make_shared<RetryBudget>();
    state->writer = std::make_shared<ResultWriter>(path, state->retries, gathering);
    return open_as(path, std::move(state));
}

core::Result<ResultStore> ResultStore::open_sibling(const std::string& path,
                                                    const ResultStore& own) {
    auto state = std::make_unique<State>(path, own.state_->version);
    state->answers = own.state_->answers;
    state->retries = own.state_->retries;
    state->writer = own.state_->writer;
    state->is_writable = false;
    return open_as(path, std::move(state));
}

core::Result<ResultStore> ResultStore::open_as(const std::string& path,
                                               std::unique_ptr<State> state) {
    const auto access =
        state->is_writable ? Database::Access::read_write : Database::Access::read_only;
    FEELER_TRY(state->database, open_store_file(path, access, state->retries));
    if (auto done = state->prepare(); !done) return tl::unexpected(std::move(done).error());
    return ResultStore(std::move(state));
}

void ResultStore::try_again() { state_->writer->try_again(); }

std::vector<std::string> ResultStore::keys_of(const CheckJob& job) const {
    if (!state_->relative_paths.are_still_valid()) return {};
    const std::string sha256 = state_->content_of(job);
    if (!is_stored(job) || sha256.empty()) return {};
    const JobKeys keys = state_->keys_of(job, sha256);
    return {keys.by_any_name, keys.by_this_name};
}

core::Result<std::vector<std::string>> ResultStore::keys() {
    const std::lock_guard lock(state_->mutex);
    FEELER_TRY(Statement all, state_->database.prepare("SELECT DISTINCT key FROM result"));
    std::vector<std::string> keys;
    for (bool more = true;;) {
        FEELER_TRY(more, all.step());
        if (!more) return keys;
        keys.push_back(all.text(0));
    }
}

core::Result<std::optional<ProgramResult>> ResultStore::State::find(const std::string& key) {
    FEELER_TRY(const std::vector<StoredRow> found, rows(key));
    for (const StoredRow& row : found) {
        if (!is_same(row) || !is_sound(row)) continue;
        auto result = result_from_json(row.value);
        if (!result) continue;
        writer->put({row.key, row.accesses, now()});
        return *std::move(result);
    }
    return std::nullopt;
}

core::Result<std::optional<ProgramResult>> ResultStore::find(const CheckJob& job) {
    for (const std::string& key : keys_of(job)) {
        FEELER_TRY(std::optional<ProgramResult> found, state_->find(key));
        if (found) return renamed(*std::move(found), job);
    }
    return std::nullopt;
}

core::Result<void> ResultStore::keep(const CheckJob& job, const CheckRun& run,
                                     const ProgramResult& result) {
    const bool was_stopped = run.stopped && run.stopped->code == core::ErrorCode::io;
    if (!state_->is_writable || !is_stored(job) || was_stopped || run.sha256.empty()) return {};
    const RelativePaths& relative_paths = state_->relative_paths;
    if (!relative_paths.are_still_valid()) return {};
    const JobKeys keys = state_->keys_of(job, run.sha256);
    const bool is_named = quotes_paths(result, job, run.inputs, relative_paths.folder());
    std::set<InputFile> inputs; // a set, because two paths may give the same place
    for (const InputFile& input : run.inputs)
        inputs.insert(with_relative_paths(input, relative_paths));
    const int64_t at = now();
    StoredRow row{.program = state_->relative(job.program),
                  .setup = relative_paths.relative(job.setup),
                  .options = keys.options,
                  .version = state_->version,
                  .checked_at = at / 1'000'000,
                  .key = is_named ? keys.by_this_name : keys.by_any_name,
                  .accesses = {},
                  .value = json_of(result),
                  .seal = {},
                  .inputs = {inputs.begin(), inputs.end()}};
    row.accesses = digest_of_accesses(row.inputs);
    row.seal = seal_of(row);
    Sighting sighting{row.key, row.accesses, at};
    return state_->writer->put(std::move(row), std::move(sighting));
}

core::Result<void> ResultStore::flush() { return state_->writer->flush(); }

core::Result<std::vector<StoredVersion>> ResultStore::history(const std::string& program) {
    const std::lock_guard lock(state_->mutex);
    std::vector<StoredVersion> versions;
    Statement& rows = state_->rows_of_program;
    rows.reset();
    rows.bind(1, state_->relative(program));
    for (bool more = true;;) {
        FEELER_TRY(more, rows.step());
        if (!more) break;
        const StoredRow row{.key = rows.text(6),
                            .accesses = rows.text(4),
                            .value = rows.text(5),
                            .seal = rows.text(7)};
        auto result = result_from_json(row.value);
        if (!result || row.seal != seal_of(row)) continue;
        versions.push_back({.checked_at = rows.number(0),
                            .seen_at = rows.number(8),
                            .version = rows.text(1),
                            .setup = rows.text(2),
                            .options = rows.text(3),
                            .inputs = row.accesses,
                            .key = row.key,
                            .result = *std::move(result)});
    }
    rows.reset();
    return versions;
}

core::Result<int64_t> ResultStore::seen_at(const StoredVersion& version) {
    const std::lock_guard lock(state_->mutex);
    Statement& sighting = state_->sighting;
    sighting.reset();
    FEELER_TRY(const bool is_there, sighting.bind(1, version.key).bind(2, version.inputs).step());
    const int64_t at = is_there ? sighting.number(0) : 0;
    sighting.reset();
    return at;
}

SiblingStores::SiblingStores(const std::string& path, const ResultStore& own) : own_(own) {
    for (const std::string& sibling : sibling_stores(path)) {
        auto store = ResultStore::open_sibling(sibling, own_);
        if (!store) continue;
        const auto keys = store->keys();
        if (!keys) continue;
        for (const std::string& key : *keys) paths_of_key_.emplace(key, sibling);
    }
}

ResultStore* SiblingStores::store_at(const std::string& path) {
    constexpr size_t most_open = 64;
    if (const auto at = open_.find(path); at != open_.end()) return &at->second;
    if (open_.size() >= most_open) open_.clear();
    auto store = ResultStore::open_sibling(path, own_);
    return store ? &open_.emplace(path, *std::move(store)).first->second : nullptr;
}

std::optional<ProgramResult> SiblingStores::find_in(const std::string& path, const CheckJob& job) {
    const std::lock_guard lock(mutex_);
    if (lost_.contains(path)) return std::nullopt;
    if (ResultStore* const store = store_at(path))
        if (auto found = store->find(job)) return *std::move(found);
    lost_.insert(path);
    return std::nullopt;
}

std::optional<ProgramResult> SiblingStores::find(const CheckJob& job) {
    if (paths_of_key_.empty()) return std::nullopt;
    for (const std::string& key : own_.keys_of(job)) {
        const auto [first, last] = paths_of_key_.equal_range(key);
        for (auto at = first; at != last; ++at)
            if (auto found = find_in(at->second, job)) return found;
    }
    return std::nullopt;
}

} // namespace app
