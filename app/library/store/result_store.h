#pragma once

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

/// A result that was kept, and of when and what.
struct StoredVersion {
    int64_t checked_at = 0; // seconds since 1970
    int64_t seen_at = 0;    // when it was last seen to hold, microseconds since 1970
    std::string version;    // of the program that checked
    std::string setup;      // where it lies: see RelativePaths; empty: inferred
    std::string options;    // of the job: see options_text
    std::string inputs;     // a digest of all that was read
    std::string key;        // see result_key
    ProgramResult result;
};

/// Results of earlier checks in a database, each with everything it hangs on. A result is found
/// again only while all of that is as it was. Several threads may use one store, several processes
/// one file.
class ResultStore {
public:
    ResultStore(ResultStore&&) noexcept;
    ResultStore& operator=(ResultStore&&) noexcept;
    ~ResultStore();

    /// `version` is that of the program that checks; results of others are not found.
    ///
    /// Waits for other processes within the retry budget.
    ///
    /// Errors: io, with the file; unsupported for a database of another program or a newer version.
    static core::Result<ResultStore> open(const std::string& path, const std::string& version,
                                          std::shared_ptr<RetryBudget> retries = nullptr);

    /// One that nothing is kept in. It shares with `own` what the disk has answered, and its
    /// patience; what is found is put down as seen in that.
    ///
    /// Errors: as open.
    static core::Result<ResultStore> open_beside(const std::string& path, const ResultStore& own);

    /// Under what the result of a job may be kept here; nothing for one whose results are not.
    std::vector<std::string> keys_of(const CheckJob& job) const;

    /// Under what results are kept: see result_key.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<std::string>> keys();

    /// What the check of this job gave, if it was kept and nothing has changed since; empty if not.
    /// By what paths the job names its files, and from where, is no matter, unless a text of the
    /// result has one of them. What is found is put down as seen, where somebody may write.
    ///
    /// Errors: io, with the database.
    core::Result<std::optional<ProgramResult>> find(const CheckJob& job);

    /// From here on what could not be written before is no reason not to write.
    void try_again();

    /// Keeps what the check of a job gave, wholly or not at all. It is written by another thread,
    /// within a fifth of a second unless the disk is slow, and is found from then on. What hangs on
    /// more than files and options is not kept: a run that somebody stopped or that could not read
    /// a file, and a job with edits.
    ///
    /// Errors: io, with the database: also that an earlier result could not be written.
    core::Result<void> keep(const CheckJob& job, const CheckRun& run, const ProgramResult& result);

    /// Waits until all that was kept and seen is written; so does the end of the store.
    ///
    /// Errors: io, with the database.
    core::Result<void> flush();

    /// Everything that was kept of a program, what was seen last at the end.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<StoredVersion>> history(const std::string& program);

    /// When a version that may lie in another database was last seen to hold in a check that had
    /// this one; 0 if it was not.
    ///
    /// Errors: io, with the database.
    core::Result<int64_t> seen_at(const StoredVersion& version);

private:
    struct State;
    static core::Result<ResultStore> open_as(const std::string& path, std::unique_ptr<State> state);
    explicit ResultStore(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// What lies in the other databases of a folder, of shares and of whole batches: a program that
/// comes to another machine than before is not checked twice. They are only read, and one that
/// cannot be is as good as none.
class SiblingStores {
public:
    /// Those beside the database at `path`, which is that of `own`, as they are now. One that
    /// others have locked for longer than there is patience is not asked again.
    SiblingStores(const std::string& path, const ResultStore& own);

    /// What the check of this job gave; see ResultStore. Several threads may ask.
    std::optional<ProgramResult> find(const CheckJob& job);

private:
    ResultStore* store_at(const std::string& path);
    std::optional<ProgramResult> find_in(const std::string& path, const CheckJob& job);

    const ResultStore& own_;
    std::unordered_multimap<std::string, std::string> paths_of_key_;
    std::mutex mutex_; // over all below
    std::map<std::string, ResultStore> open_;
    std::set<std::string> lost_; // paths
};

} // namespace app
