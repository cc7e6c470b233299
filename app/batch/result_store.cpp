#include "app/batch/result_store.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <mutex>

#include <fmt/format.h>

#include "app/batch/database.h"
#include "app/batch/input_files.h"
#include "app/batch/result_key.h"
#include "app/batch/store_file.h"
#include "app/session/digest.h"

namespace app {
namespace {

/// A result as it lies in the database, with what its check read.
struct KeptRow {
    int64_t id = 0;
    std::string key, looks, value, seal;
    std::vector<InputFile> inputs;
};

std::string answer_text(const InputFile& input) { return input.answer ? "=" + *input.answer : ""; }

InputFile input_of(const Statement& row) {
    InputFile input{static_cast<core::FileQuestion>(row.number(0)), row.text(1), row.text(2), {}};
    if (const std::string answer = row.text(3); !answer.empty()) input.answer = answer.substr(1);
    return input;
}

/// The same for the same inputs, whatever their order.
std::string digest_of(std::vector<InputFile> inputs) {
    std::sort(inputs.begin(), inputs.end());
    std::string text;
    for (const InputFile& input : inputs) {
        text += fmt::format("{}", static_cast<int>(input.question));
        for (const std::string& part : {input.path, input.name, answer_text(input)})
            text += fmt::format(" {}:{}", part.size(), part);
    }
    return sha256_of(text);
}

/// A file that was damaged where SQLite does not see it does not become another result.
std::string seal_of(const KeptRow& row) { return sha256_of(row.key + row.looks + row.value); }

bool is_sound(const KeptRow& row) {
    return row.seal == seal_of(row) && row.looks == digest_of(row.inputs);
}

int64_t now() {
    using namespace std::chrono;
    return duration_cast<seconds>(system_clock::now().time_since_epoch()).count();
}

} // namespace

struct ResultStore::State {
    std::string version;
    std::filesystem::path folder; // that the database is for
    std::shared_ptr<InputAnswers> answers;
    std::mutex mutex; // over all below
    Database database;
    Statement rows_of_key, looks_of_row, rows_of_program, add_program, add_row, add_look, add_link;

    core::Result<void> prepare();
    std::string place_of(const std::string& program) const;
    core::Result<std::vector<KeptRow>> rows(const std::string& key);
    core::Result<void> add(const std::string& place, const std::string& setup,
                           const std::string& options, const KeptRow& row);
};

core::Result<void> ResultStore::State::prepare() {
    FEELER_TRY(rows_of_key,
               database.prepare("SELECT id, key, looks, value, seal FROM result WHERE key = ?1 "
                                "ORDER BY id DESC"));
    FEELER_TRY(looks_of_row,
               database.prepare("SELECT question, path, name, answer FROM result_look "
                                "JOIN look ON look.id = look WHERE result = ?1"));
    FEELER_TRY(rows_of_program,
               database.prepare("SELECT checked_at, version, setup, options, looks, value, key, "
                                "seal FROM result JOIN program ON program.id = program "
                                "WHERE path = ?1 ORDER BY result.id"));
    FEELER_TRY(add_program, database.prepare("INSERT OR IGNORE INTO program(path) VALUES(?1)"));
    FEELER_TRY(
        add_row,
        database.prepare("INSERT OR IGNORE INTO result(program, key, looks, setup, options, "
                         "version, checked_at, value, seal) VALUES((SELECT id FROM program WHERE "
                         "path = ?1), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9) RETURNING id"));
    FEELER_TRY(add_look,
               database.prepare("INSERT OR IGNORE INTO look(question, path, name, answer) "
                                "VALUES(?1, ?2, ?3, ?4)"));
    FEELER_TRY(add_link, database.prepare(
                             "INSERT INTO result_look SELECT ?1, id FROM look WHERE question = ?2 "
                             "AND path = ?3 AND name = ?4 AND answer = ?5"));
    return {};
}

/// A program's path as seen from the folder: the same from wherever one calls.
std::string ResultStore::State::place_of(const std::string& program) const {
    std::error_code failure;
    const auto whole = std::filesystem::weakly_canonical(program, failure);
    return failure ? program : whole.lexically_relative(folder).string();
}

core::Result<std::vector<KeptRow>> ResultStore::State::rows(const std::string& key) {
    const std::lock_guard lock(mutex);
    std::vector<KeptRow> found;
    rows_of_key.reset();
    rows_of_key.bind(1, key);
    for (bool more = true;;) {
        FEELER_TRY(more, rows_of_key.step());
        if (!more) break;
        found.push_back({rows_of_key.number(0),
                         rows_of_key.text(1),
                         rows_of_key.text(2),
                         rows_of_key.text(3),
                         rows_of_key.text(4),
                         {}});
    }
    rows_of_key.reset();
    for (KeptRow& row : found) {
        looks_of_row.reset();
        looks_of_row.bind(1, row.id);
        for (bool more = true;;) {
            FEELER_TRY(more, looks_of_row.step());
            if (!more) break;
            row.inputs.push_back(input_of(looks_of_row));
        }
        looks_of_row.reset();
    }
    return found;
}

core::Result<void> ResultStore::State::add(const std::string& place, const std::string& setup,
                                           const std::string& options, const KeptRow& row) {
    const std::lock_guard lock(mutex);
    FEELER_TRY(Transaction adding, Transaction::begin(database));
    if (auto done = add_program.bind(1, place).finish(); !done)
        return tl::unexpected(std::move(done).error());
    add_row.bind(1, place).bind(2, row.key).bind(3, row.looks).bind(4, setup).bind(5, options);
    add_row.bind(6, version).bind(7, now()).bind(8, row.value).bind(9, row.seal);
    FEELER_TRY(const bool is_new, add_row.step());
    const int64_t id = is_new ? add_row.number(0) : 0;
    if (auto done = add_row.finish(); !done) return tl::unexpected(std::move(done).error());
    if (!is_new) return {}; // somebody else has kept the same meanwhile
    for (const InputFile& input : row.inputs) {
        const auto question = static_cast<int64_t>(input.question);
        const std::string answer = answer_text(input);
        add_look.bind(1, question).bind(2, input.path).bind(3, input.name).bind(4, answer);
        if (auto done = add_look.finish(); !done) return tl::unexpected(std::move(done).error());
        add_link.bind(1, id).bind(2, question).bind(3, input.path).bind(4, input.name);
        if (auto done = add_link.bind(5, answer).finish(); !done)
            return tl::unexpected(std::move(done).error());
    }
    return adding.commit();
}

ResultStore::ResultStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResultStore::ResultStore(ResultStore&&) noexcept = default;
ResultStore& ResultStore::operator=(ResultStore&&) noexcept = default;
ResultStore::~ResultStore() = default;

core::Result<ResultStore> ResultStore::open(const std::string& path, const std::string& version) {
    return open_as(path, version, Database::Access::read_write, std::make_shared<InputAnswers>());
}

core::Result<ResultStore> ResultStore::open_to_read(const std::string& path,
                                                    const std::string& version,
                                                    std::shared_ptr<InputAnswers> answers) {
    return open_as(path, version, Database::Access::read_only, std::move(answers));
}

core::Result<ResultStore> ResultStore::open_as(const std::string& path, const std::string& version,
                                               Database::Access access,
                                               std::shared_ptr<InputAnswers> answers) {
    auto state = std::make_unique<State>();
    state->version = version;
    state->answers = std::move(answers);
    FEELER_TRY(state->database, open_store_file(path, access));
    std::error_code failure;
    state->folder =
        std::filesystem::weakly_canonical(std::filesystem::absolute(path), failure).parent_path();
    if (state->folder.filename() == ".feeler") state->folder = state->folder.parent_path();
    if (auto done = state->prepare(); !done) return tl::unexpected(std::move(done).error());
    return ResultStore(std::move(state));
}

std::shared_ptr<InputAnswers> ResultStore::answers() const { return state_->answers; }

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

core::Result<std::optional<ProgramResult>> ResultStore::find(const CheckJob& job) {
    const auto options = options_text(job);
    const std::string sha256 = state_->answers->content_of(job.program);
    if (!options || sha256.empty()) return std::nullopt;
    FEELER_TRY(const std::vector<KeptRow> rows,
               state_->rows(result_key(state_->version, job, sha256, *options)));
    for (const KeptRow& row : rows) {
        const bool is_same =
            std::all_of(row.inputs.begin(), row.inputs.end(),
                        [&](const InputFile& input) { return state_->answers->is_same(input); });
        if (!is_same || !is_sound(row)) continue;
        if (auto result = result_from_json(row.value)) return *std::move(result);
    }
    return std::nullopt;
}

core::Result<void> ResultStore::keep(const CheckJob& job, const CheckRun& run,
                                     const ProgramResult& result) {
    const auto options = options_text(job);
    const bool was_stopped = run.stopped && run.stopped->code == core::ErrorCode::io;
    if (!options || was_stopped || run.sha256.empty()) return {};
    KeptRow row{.key = result_key(state_->version, job, run.sha256, *options),
                .looks = digest_of(run.inputs),
                .value = json_of(result),
                .inputs = run.inputs};
    row.seal = seal_of(row);
    return state_->add(state_->place_of(job.program), job.setup, *options, row);
}

core::Result<std::vector<KeptVersion>> ResultStore::history(const std::string& program) {
    const std::lock_guard lock(state_->mutex);
    std::vector<KeptVersion> versions;
    Statement& rows = state_->rows_of_program;
    rows.reset();
    rows.bind(1, state_->place_of(program));
    for (bool more = true;;) {
        FEELER_TRY(more, rows.step());
        if (!more) break;
        const KeptRow row{.key = rows.text(6),
                          .looks = rows.text(4),
                          .value = rows.text(5),
                          .seal = rows.text(7)};
        auto result = result_from_json(row.value);
        if (!result || row.seal != seal_of(row)) continue;
        versions.push_back({rows.number(0), rows.text(1), rows.text(2), rows.text(3), row.looks,
                            *std::move(result)});
    }
    rows.reset();
    return versions;
}

} // namespace app
