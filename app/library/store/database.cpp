#include "app/library/store/database.h"

#include <algorithm>
#include <thread>
#include <utility>

#include <sqlite3.h>

namespace app {
namespace {

using namespace std::chrono_literals;

constexpr auto whole_budget = 10s;
constexpr auto when_stopped = 1s;

} // namespace

RetryBudget::RetryBudget(std::function<bool()> is_stopped)
    : is_stopped_(std::move(is_stopped)), left_(whole_budget), last_wait_end_(Clock::now()) {}

bool RetryBudget::take(Clock::duration nap) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now > last_wait_end_)
        left_ = std::min<Clock::duration>(whole_budget, left_ + (now - last_wait_end_) / 2);
    if (is_stopped_ && is_stopped_()) left_ = std::min<Clock::duration>(left_, when_stopped);
    if (left_ < nap) return false;
    left_ -= nap;
    last_wait_end_ = now + nap;
    return true;
}

bool RetryBudget::wait(int attempt) {
    const auto nap = std::chrono::milliseconds(std::clamp(attempt + 1, 1, 20));
    if (!take(nap)) return false;
    std::this_thread::sleep_for(nap);
    return true;
}

namespace {

core::Error error_of(sqlite3* database, const std::string& path) {
    const char* message = database ? sqlite3_errmsg(database) : "there is not enough memory";
    return {core::ErrorCode::io, {}, message, path};
}

/// Busy handler, called by SQLite while others write.
int wait_for_others(void* retries, int attempt) {
    return static_cast<RetryBudget*>(retries)->wait(attempt) ? 1 : 0;
}

} // namespace

void Statement::Close::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement& Statement::bind(int parameter, std::string_view text) {
    // An empty view may have a null pointer, which SQLite would take for NULL.
    sqlite3_bind_text64(statement_.get(), parameter, text.data() ? text.data() : "", text.size(),
                        SQLITE_TRANSIENT, SQLITE_UTF8);
    return *this;
}

Statement& Statement::bind(int parameter, int64_t number) {
    sqlite3_bind_int64(statement_.get(), parameter, number);
    return *this;
}

core::Result<bool> Statement::step() {
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    const core::Error error = error_of(sqlite3_db_handle(statement_.get()), path_);
    sqlite3_reset(statement_.get());
    return tl::unexpected(error);
}

core::Result<void> Statement::finish() {
    for (bool more = true; more;) {
        FEELER_TRY(more, step());
    }
    reset();
    return {};
}

void Statement::reset() {
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
}

std::string Statement::text(int column) const {
    const auto* bytes =
        reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    const auto size = static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column));
    return bytes ? std::string(bytes, size) : std::string();
}

int64_t Statement::number(int column) const {
    return sqlite3_column_int64(statement_.get(), column);
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

core::Error Database::error() const { return error_of(database_.get(), path_); }

core::Result<Database> Database::open(const std::string& path, Access access,
                                      std::shared_ptr<RetryBudget> retries) {
    const int flags = access == Access::read_only ? SQLITE_OPEN_READONLY
                                                  : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    sqlite3* opened = nullptr;
    // With "./", no name can be mistaken for a URI or for a special name of SQLite. On Windows, a
    // path with a root need not be absolute: D:jobs, \jobs.
    const std::filesystem::path stated(path);
    std::error_code ignored;
    const std::string name = path == in_memory ? "file:/feeler?vfs=memdb"
                             : stated.has_root_path()
                                 ? std::filesystem::absolute(stated, ignored).generic_string()
                                 : "./" + path;
    const int code = sqlite3_open_v2(name.c_str(), &opened,
                                     path == in_memory ? flags | SQLITE_OPEN_URI : flags, nullptr);
    Database database;
    database.path_ = path;
    database.database_.reset(opened);
    if (code != SQLITE_OK) return tl::unexpected(database.error());
    database.retry_budget_ = retries ? std::move(retries) : std::make_shared<RetryBudget>();
    sqlite3_busy_handler(opened, wait_for_others, database.retry_budget_.get());
    return database;
}

core::Result<void> Database::run(const std::string& sql) {
    if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
        return tl::unexpected(error());
    return {};
}

core::Result<Statement> Database::prepare(const std::string& sql) {
    sqlite3_stmt* prepared = nullptr;
    const int code = sqlite3_prepare_v3(database_.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                        &prepared, nullptr);
    Statement statement;
    statement.statement_.reset(prepared);
    statement.path_ = path_;
    if (code != SQLITE_OK) return tl::unexpected(error());
    return statement;
}

core::Result<int64_t> Database::number(const std::string& sql) {
    FEELER_TRY(Statement statement, prepare(sql));
    FEELER_TRY(const bool found, statement.step());
    return found ? statement.number(0) : 0;
}

core::Result<Transaction> Transaction::begin(Database& database) {
    if (auto begun = database.run("BEGIN IMMEDIATE"); !begun)
        return tl::unexpected(std::move(begun).error());
    return Transaction(database);
}

Transaction::Transaction(Transaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

Transaction::~Transaction() {
    // If this fails, SQLite has already rolled back.
    if (database_) (void)database_->run("ROLLBACK");
}

core::Result<void> Transaction::commit() {
    if (auto done = database_->run("COMMIT"); !done) return done;
    database_ = nullptr;
    return {};
}

} // namespace app
