#include "app/library/store/result_writer.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/base/sha256.h"
#include "app/library/store/store_file.h"

namespace app {
namespace {

constexpr size_t most_bytes = size_t{64} << 20; // of rows waiting to be written

size_t row_size(const StoredRow& row) {
    size_t bytes = sizeof row + row.value.size() + row.options.size();
    for (const InputFile& input : row.inputs)
        bytes += sizeof input + input.path.size() + input.name.size();
    return bytes;
}

} // namespace

/// An open database with its prepared statements.
struct ResultWriter::Connection {
    Database database;
    Statement add_program, add_row, add_access, add_link, add_sighting;

    static core::Result<Connection> open(const std::string& path,
                                         std::shared_ptr<RetryBudget> retries);
    core::Result<void> write(const Group& group);

private:
    core::Result<void> add(const StoredRow& row);
    core::Result<void> add(const InputFile& input, int64_t row);
};

core::Result<ResultWriter::Connection>
ResultWriter::Connection::open(const std::string& path, std::shared_ptr<RetryBudget> retries) {
    Connection made;
    FEELER_TRY(made.database,
               open_store_file(path, Database::Access::read_write, std::move(retries)));
    FEELER_TRY(made.add_program,
               made.database.prepare("INSERT OR IGNORE INTO program(path) VALUES(?1)"));
    FEELER_TRY(made.add_row,
               made.database.prepare(
                   "INSERT OR IGNORE INTO result(program, key, looks, setup, options, "
                   "version, checked_at, value, seal) VALUES((SELECT id FROM program WHERE "
                   "path = ?1), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9) RETURNING id"));
    FEELER_TRY(made.add_access,
               made.database.prepare("INSERT OR IGNORE INTO look(question, path, name, answer) "
                                     "VALUES(?1, ?2, ?3, ?4)"));
    FEELER_TRY(made.add_link,
               made.database.prepare("INSERT INTO result_look SELECT ?1, id FROM look WHERE "
                                     "question = ?2 AND path = ?3 AND name = ?4 AND answer = ?5"));
    FEELER_TRY(made.add_sighting,
               made.database.prepare("INSERT INTO seen(key, looks, at) VALUES(?1, ?2, ?3) "
                                     "ON CONFLICT DO UPDATE SET at = max(at, excluded.at)"));
    return made;
}

core::Result<void> ResultWriter::Connection::add(const InputFile& input, int64_t row) {
    const auto question = static_cast<int64_t>(input.question);
    const std::string answer = answer_text(input);
    add_access.bind(1, question).bind(2, input.path).bind(3, input.name).bind(4, answer);
    if (auto done = add_access.finish(); !done) return done;
    add_link.bind(1, row).bind(2, question).bind(3, input.path).bind(4, input.name);
    return add_link.bind(5, answer).finish();
}

core::Result<void> ResultWriter::Connection::add(const StoredRow& row) {
    if (auto done = add_program.bind(1, row.program).finish(); !done) return done;
    add_row.bind(1, row.program).bind(2, row.key).bind(3, row.accesses).bind(4, row.setup);
    add_row.bind(5, row.options).bind(6, row.version).bind(7, row.checked_at);
    add_row.bind(8, row.value).bind(9, row.seal);
    FEELER_TRY(const bool is_new, add_row.step());
    const int64_t id = is_new ? add_row.number(0) : 0;
    if (auto done = add_row.finish(); !done) return done;
    if (!is_new) return {}; // another process has stored the same result meanwhile
    for (const InputFile& input : row.inputs)
        if (auto done = add(input, id); !done) return done;
    return {};
}

core::Result<void> ResultWriter::Connection::write(const Group& group) {
    FEELER_TRY(Transaction writing, Transaction::begin(database));
    for (const StoredRow& row : group.rows)
        if (auto done = add(row); !done) return done;
    for (const Sighting& each : group.sightings) {
        add_sighting.bind(1, each.key).bind(2, each.accesses).bind(3, each.at);
        if (auto done = add_sighting.finish(); !done) return done;
    }
    return writing.commit();
}

ResultWriter::ResultWriter(std::string path, std::shared_ptr<RetryBudget> retries,
                           std::chrono::milliseconds gathering)
    : path_(std::move(path)), retry_budget_(std::move(retries)), gathering_(gathering) {}

ResultWriter::~ResultWriter() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
        changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
}

core::Result<void> ResultWriter::put(StoredRow row, Sighting sighting) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.bytes < most_bytes || error_; });
    if (error_) return tl::unexpected(*error_);
    const bool is_first = waiting_.is_empty();
    waiting_.bytes += row_size(row);
    waiting_.rows.push_back(std::move(row));
    waiting_.sightings.push_back(std::move(sighting));
    tell(is_first);
    return {};
}

void ResultWriter::put(Sighting sighting) {
    const std::lock_guard lock(mutex_);
    if (error_) return;
    const bool is_first = waiting_.is_empty();
    waiting_.sightings.push_back(std::move(sighting));
    tell(is_first);
}

void ResultWriter::tell(bool is_first) {
    if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
    if (is_first || waiting_.bytes >= most_bytes) changed_.notify_all();
}

core::Result<void> ResultWriter::flush() {
    std::unique_lock lock(mutex_);
    is_hurried_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return error_ || (waiting_.is_empty() && !is_writing_); });
    is_hurried_ = false;
    if (error_) return tl::unexpected(*error_);
    return {};
}

void ResultWriter::try_again() {
    const std::lock_guard lock(mutex_);
    error_.reset();
}

void ResultWriter::work() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return is_ending_ || !waiting_.is_empty(); });
        if (waiting_.is_empty()) return;
        changed_.wait_for(lock, gathering_, [&] {
            return is_ending_ || is_hurried_ || waiting_.bytes >= most_bytes;
        });
        write(lock);
    }
}

void ResultWriter::write(std::unique_lock<std::mutex>& lock) {
    const Group group = std::exchange(waiting_, {});
    is_writing_ = true;
    changed_.notify_all();
    lock.unlock();
    core::Result<void> done;
    if (!connection_) {
        auto opened = Connection::open(path_, retry_budget_);
        if (opened)
            connection_ = std::make_unique<Connection>(*std::move(opened));
        else
            done = tl::unexpected(opened.error());
    }
    if (connection_) done = connection_->write(group);
    lock.lock();
    is_writing_ = false;
    // Lost sightings, as in a read-only database, need not be reported.
    if (!done && !group.rows.empty()) error_ = done.error();
    if (error_) waiting_ = {};
    changed_.notify_all();
}

std::string answer_text(const InputFile& input) { return input.answer ? "=" + *input.answer : ""; }

std::string digest_of_accesses(std::vector<InputFile> inputs) {
    std::sort(inputs.begin(), inputs.end());
    std::string text;
    for (const InputFile& input : inputs) {
        text += fmt::format("{}", static_cast<int>(input.question));
        for (const std::string& part : {input.path, input.name, answer_text(input)})
            text += fmt::format(" {}:{}", part.size(), part);
    }
    return sha256_of(text);
}

std::string seal_of(const StoredRow& row) { return sha256_of(row.key + row.accesses + row.value); }

bool is_sound(const StoredRow& row) {
    return row.seal == seal_of(row) && row.accesses == digest_of_accesses(row.inputs);
}

} // namespace app
