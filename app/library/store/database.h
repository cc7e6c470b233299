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

/// How long one run waits for databases that others have, in all: ten seconds, and of what it has
/// waited it gets back half of the time that it then need not wait. Who is to stop gives others a
/// second more. Several threads may wait.
class RetryBudget {
public:
    explicit RetryBudget(std::function<bool()> is_stopped = {});

    /// Waits some milliseconds, longer with every attempt; false, at once, when there is no
    /// patience left.
    bool wait(int attempt);

private:
    using Clock = std::chrono::steady_clock;

    bool take(Clock::duration nap);

    std::function<bool()> is_stopped_;
    std::mutex mutex_; // over all below
    Clock::duration left_;
    Clock::time_point told_; // when the last wait ends
};

} // namespace app

struct sqlite3;
struct sqlite3_stmt;

namespace app {

/// A statement of SQL, prepared once and run as often as one likes. Parameters count from 1,
/// columns from 0, as with SQLite.
class Statement {
public:
    /// A parameter that was not given since the last reset is null.
    Statement& bind(int parameter, std::string_view text);
    Statement& bind(int parameter, int64_t number);

    /// Whether there is a (further) row.
    ///
    /// Errors: io, with the file: whatever keeps the statement from being carried out. It can be
    ///         run again after a reset.
    core::Result<bool> step();

    /// Runs it to its end and makes it ready for the next time.
    ///
    /// Errors: as step.
    core::Result<void> finish();

    /// Ready for the next time, without parameters.
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

/// An SQLite database in a file. Of one thread at a time; several processes may have it open.
class Database {
public:
    enum class Access : uint8_t { read_only, read_write };
    static constexpr const char* in_memory = ":memory:";

    /// Opens the file; with read_write it is made when it is not there. Of `in_memory` there is one
    /// for the whole process, as long as somebody has it open. Whoever finds it in use
    /// retries within the budget: that of a run of its own if none is given.
    ///
    /// Errors: io, with the file.
    static core::Result<Database> open(const std::string& path, Access access,
                                       std::shared_ptr<RetryBudget> retries = nullptr);

    /// Runs statements that give no rows.
    ///
    /// Errors: io, with the file.
    core::Result<void> run(const std::string& sql);

    /// Errors: io, with the file, also when the database has no such tables.
    core::Result<Statement> prepare(const std::string& sql);

    /// The one number that a statement gives.
    ///
    /// Errors: io, with the file.
    core::Result<int64_t> number(const std::string& sql);

private:
    struct Close {
        void operator()(sqlite3* database) const;
    };

    core::Error error() const;

    std::shared_ptr<RetryBudget> retry_budget_; // outlives the database
    std::unique_ptr<sqlite3, Close> database_;
    std::string path_;
};

/// Everything done while it lives is done wholly when it is committed, else not at all.
class Transaction {
public:
    /// Waits until nobody else writes.
    ///
    /// Errors: io, with the file.
    static core::Result<Transaction> begin(Database& database);

    Transaction(Transaction&& other) noexcept;
    Transaction& operator=(Transaction&&) = delete;
    ~Transaction();

    core::Result<void> commit();

private:
    explicit Transaction(Database& database) : database_(&database) {}

    Database* database_; // null when it is over
};

} // namespace app
