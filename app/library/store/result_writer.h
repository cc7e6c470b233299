#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/check/input_file.h"
#include "app/library/store/database.h"

namespace app {

/// A result as in the database, with the file accesses of its check.
struct StoredRow {
    int64_t id = 0;
    std::string program, setup, options, version;
    int64_t checked_at = 0; // seconds since 1970
    std::string key, accesses, value, seal;
    std::vector<InputFile> inputs;
};

/// The answer to a file access as one text, which also says whether there was one.
std::string answer_text(const InputFile& input);

/// A digest of file accesses; it does not depend on their order.
std::string digest_of_accesses(std::vector<InputFile> inputs);

/// A digest of key, looks and value. It detects damage to the file that SQLite does not notice.
std::string seal_of(const StoredRow& row);

/// Whether a row is undamaged.
bool is_sound(const StoredRow& row);

/// A record that a stored result was found still valid.
struct Sighting {
    std::string key, accesses;
    int64_t at = 0; // microseconds since 1970
};

/// Writes results into a database in a separate thread and in groups: what arrives within the
/// gathering time is written in one transaction. Thread-safe.
class ResultWriter {
public:
    ResultWriter(std::string path, std::shared_ptr<RetryBudget> retries,
                 std::chrono::milliseconds gathering);

    /// Writes everything that is waiting.
    ~ResultWriter();
    ResultWriter(const ResultWriter&) = delete;
    ResultWriter& operator=(const ResultWriter&) = delete;

    /// Adds a row or a sighting to be written. A row waits only if too much is still to be written.
    /// A sighting that cannot be written is dropped.
    ///
    /// Errors: why something could not be written; after that nothing is written until try_again.
    core::Result<void> put(StoredRow row, Sighting sighting);
    void put(Sighting sighting);

    /// Waits until everything is written.
    ///
    /// Errors: as put.
    core::Result<void> flush();

    /// Resumes writing after an error.
    void try_again();

private:
    struct Group {
        std::vector<StoredRow> rows;
        std::vector<Sighting> sightings;
        size_t bytes = 0;

        bool is_empty() const { return rows.empty() && sightings.empty(); }
    };
    struct Connection;

    void tell(bool is_first);
    void work();
    void write(std::unique_lock<std::mutex>& lock);

    std::string path_;
    std::shared_ptr<RetryBudget> retry_budget_;
    std::chrono::milliseconds gathering_;
    std::unique_ptr<Connection> connection_; // used by the thread only
    std::mutex mutex_;                       // guards all members below
    std::condition_variable changed_;
    Group waiting_;
    bool is_writing_ = false, is_hurried_ = false, is_ending_ = false;
    std::optional<core::Error> error_;
    std::thread thread_; // started when there is something to write
};

} // namespace app
