#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace app {

/// The total time that a run waits for databases locked by others: ten seconds. Half of the time in
/// which it does not wait is added back. After a stop request, at most one second is left.
/// Thread-safe.
class RetryBudget {
public:
    explicit RetryBudget(std::function<bool()> is_stopped = {});

    /// Waits some milliseconds, longer with every attempt. False, at once, if the budget is used.
    bool wait(int attempt);

private:
    using Clock = std::chrono::steady_clock;

    bool take(Clock::duration nap);

    std::function<bool()> is_stopped_;
    std::mutex mutex_; // guards all members below
    Clock::duration left_;
    Clock::time_point last_wait_end_; // end of the last wait
};

} // namespace app

struct sqlite3;
struct sqlite3_stmt;

namespace app {

/// An SQL statement that is prepared once and can be run any number of times. Parameters count from
/// 1, columns from 0, as in SQLite.
class Statement {
public:
    /// Sets a parameter. Parameters not set since the last reset are null.
    Statement& bind(int parameter, std::string_view text);
    Statement& bind(int parameter, int64_t number);

    /// Fetches the next row. False: there are no more.
    ///
    /// Errors: io, with the file, if the statement fails. It can be run again after a reset.
    core::Result<bool> step();

    /// Runs the statement to its end and resets it.
    ///
    /// Errors: as step.
    core::Result<void> finish();

    /// Makes the statement ready to be run again, without parameters.
    void reset();

    std::string text(int column) const;
    int64_t number(int column) const;

private:
    friend class Database;
    struct Close {
        void operator()(sqlite3_stmt* statement) const;
    };

    std::unique_ptr<sqlite3_stmt, Close> statement_;
    std::string path_;
};

/// An SQLite database in a file, for one thread at a time. Several processes may have it open.
class Database {
public:
    enum class Access : uint8_t { read_only, read_write };
    static constexpr const char* in_memory = ":memory:";

    /// Opens the file; with read_write, creates it if it does not exist. There is one `in_memory`
    /// database per process, which exists while it is open. If the database is locked, waits within
    /// the retry budget; without one, within a new budget of its own.
    ///
    /// Errors: io, with the file.
    static core::Result<Database> open(const std::string& path, Access access,
                                       std::shared_ptr<RetryBudget> retries = nullptr);

    /// Runs statements that return no rows.
    ///
    /// Errors: io, with the file.
    core::Result<void> run(const std::string& sql);

    /// Prepares a statement.
    ///
    /// Errors: io, with the file, also if the database has no such tables.
    core::Result<Statement> prepare(const std::string& sql);

    /// The single number that a statement returns; 0 without a row.
    ///
    /// Errors: io, with the file.
    core::Result<int64_t> number(const std::string& sql);

private:
    struct Close {
        void operator()(sqlite3* database) const;
    };

    core::Error error() const;

    std::shared_ptr<RetryBudget> retry_budget_; // declared first: must outlive the database
    std::unique_ptr<sqlite3, Close> database_;
    std::string path_;
};

/// A transaction: all changes during its lifetime take effect if it is committed, otherwise none.
class Transaction {
public:
    /// Waits until no one else writes.
    ///
    /// Errors: io, with the file.
    static core::Result<Transaction> begin(Database& database);

    Transaction(Transaction&& other) noexcept;
    Transaction& operator=(Transaction&&) = delete;
    ~Transaction();

    core::Result<void> commit();

private:
    explicit Transaction(Database& database) : database_(&database) {}

    Database* database_; // null once it is committed
};

} // namespace app
