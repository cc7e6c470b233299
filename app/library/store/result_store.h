#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "app/check/check_job.h"
#include "app/library/result/program_result.h"

namespace app {

struct CheckJob;
struct CheckRun;
class RetryBudget;

/// A stored result, with its time and inputs.
struct StoredVersion {
    int64_t checked_at = 0; // seconds since 1970
    int64_t seen_at = 0;    // when last confirmed as still valid, microseconds since 1970
    std::string version;    // of Feeler that made the check
    std::string setup;      // place of the set-up, see RelativePaths; empty: inferred
    std::string options;    // of the job: see options_text
    std::string inputs;     // a digest of all file accesses
    std::string key;        // see result_key
    ProgramResult result;
};

/// Results of earlier checks in a database, each with everything that it depends on. A result is
/// found again only if none of that has changed. Several threads may use one store, and several
/// processes one file.
class ResultStore {
public:
    ResultStore(ResultStore&&) noexcept;
    ResultStore& operator=(ResultStore&&) noexcept;
    ~ResultStore();

    /// Opens a store. `version`: of this Feeler; results of other versions are not found. Waits for
    /// other processes within the retry budget. `gathering`: how long results are collected before
    /// they are written in one transaction.
    ///
    /// Errors: io, with the file; unsupported for a database of another program or a newer version.
    static core::Result<ResultStore>
    open(const std::string& path, const std::string& version,
         std::shared_ptr<RetryBudget> retries = nullptr,
         std::chrono::milliseconds gathering = std::chrono::milliseconds(150));

    /// Opens a store for reading only. It shares cached file accesses and the retry budget with
    /// `own`. When it finds a result, it records in `own` that the result is still valid.
    ///
    /// Errors: as open.
    static core::Result<ResultStore> open_sibling(const std::string& path, const ResultStore& own);

    /// The keys under which the result of a job may be stored; empty if its results are not stored.
    std::vector<std::string> keys_of(const CheckJob& job) const;

    /// The keys of all stored results, see result_key.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<std::string>> keys();

    /// The stored result of this job, if nothing has changed since; otherwise empty. The paths of
    /// the job and the working folder may differ, unless a text of the result contains a path.
    /// Records that a found result is still valid, if the database is writable.
    ///
    /// Errors: io, with the database.
    core::Result<std::optional<ProgramResult>> find(const CheckJob& job);

    /// Resumes writing after an earlier error.
    void try_again();

    /// Stores the result of a job, completely or not at all. Another thread writes it, within a
    /// fifth of a second unless the disk is slow; from then on it is found. Results that depend on
    /// more than files and options are not stored: of a run that was stopped or could not read a
    /// file, and of a job with edits.
    ///
    /// Errors: io, with the database: also that an earlier result could not be written.
    core::Result<void> keep(const CheckJob& job, const CheckRun& run, const ProgramResult& result);

    /// Waits until everything is written, as does the destructor.
    ///
    /// Errors: io, with the database.
    core::Result<void> flush();

    /// All stored results of a program; the one confirmed last is at the end.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<StoredVersion>> history(const std::string& program);

    /// When a check with this database last confirmed a version, which may be stored in another
    /// database, as still valid; 0 if never.
    ///
    /// Errors: io, with the database.
    core::Result<int64_t> seen_at(const StoredVersion& version);

private:
    struct State;
    static core::Result<ResultStore> open_as(const std::string& path, std::unique_ptr<State> state);
    explicit ResultStore(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// The other databases in the folder, of shards and of whole batches, so that a program that moves
/// to another computer is not checked twice. They are only read; unreadable ones are ignored.
class SiblingStores {
public:
    /// Opens those next to `path`, the database of `own`, that exist now. A database that stays
    /// locked beyond the retry budget is not used again.
    SiblingStores(const std::string& path, const ResultStore& own);

    /// The stored result of this job, see ResultStore::find. Thread-safe.
    std::optional<ProgramResult> find(const CheckJob& job);

private:
    ResultStore* store_at(const std::string& path);
    std::optional<ProgramResult> find_in(const std::string& path, const CheckJob& job);

    const ResultStore& own_;
    std::unordered_multimap<std::string, std::string> paths_of_key_;
    std::mutex mutex_; // guards all members below
    std::map<std::string, ResultStore> open_;
    std::set<std::string> lost_; // paths of unusable databases
};

} // namespace app
