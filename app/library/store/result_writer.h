#pragma once

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

/// A result as it lies in the database, with what its check read.
struct StoredRow {
    int64_t id = 0;
    std::string program, setup, options, version;
    int64_t checked_at = 0; // seconds since 1970
    std::string key, looks, value, seal;
    std::vector<InputFile> inputs;
};

/// The answer of a look as one text: it says whether there was one.
std::string answer_text(const InputFile& input);

/// A digest of looks: the same for the same, whatever their order.
std::string looks_of(std::vector<InputFile> inputs);

/// A digest of key, looks and value: a file that was damaged where SQLite does not see it does not
/// become another result.
std::string seal_of(const StoredRow& row);

/// Whether a row is what somebody kept.
bool is_sound(const StoredRow& row);

/// That the result of a check was seen to hold.
struct Sighting {
    std::string key, looks;
    int64_t at = 0; // microseconds since 1970
};

/// Puts results into a database, in a thread of its own and in groups: what comes within a seventh
/// of a second is written at once, wholly or not at all. Several threads may put.
class ResultWriter {
public:
    ResultWriter(std::string path, std::shared_ptr<RetryBudget> retries);

    /// Writes what was put.
    ~ResultWriter();
    ResultWriter(const ResultWriter&) = delete;
    ResultWriter& operator=(const ResultWriter&) = delete;

    /// Waits only while too much is still to be written. A sighting that cannot be written is
    /// forgotten.
    ///
    /// Errors: why something could not be written; from then on nothing is.
    core::Result<void> put(StoredRow row, Sighting sighting);
    void put(Sighting sighting);

    /// Waits until all that was put is written.
    ///
    /// Errors: as of put.
    core::Result<void> flush();

    /// From here on tries again, though something could not be written.
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
    std::unique_ptr<Connection> connection_; // of the thread alone
    std::mutex mutex_;                       // over all below
    std::condition_variable changed_;
    Group waiting_;
    bool is_writing_ = false, is_hurried_ = false, is_ending_ = false;
    std::optional<core::Error> error_;
    std::thread thread_; // begun when there is something to write
};

} // namespace app
