#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/database.h"
#include "app/batch/input_files.h"
#include "app/batch/program_result.h"

namespace app {

/// A result that was kept, and of when and what.
struct KeptVersion {
    int64_t checked_at = 0; // seconds since 1970
    std::string version;    // of the program that checked
    std::string setup;      // its path as it was given; empty: inferred
    std::string options;    // of the job: see options_text
    std::string inputs;     // a digest of all that was read
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
    /// Errors: io, with the file; unsupported for a database of another program or a newer version.
    static core::Result<ResultStore> open(const std::string& path, const std::string& version);

    /// One that nothing is kept in. Stores that share answers ask the disk once for all of them.
    ///
    /// Errors: as open.
    static core::Result<ResultStore> open_to_read(const std::string& path,
                                                  const std::string& version,
                                                  std::shared_ptr<InputAnswers> answers);

    std::shared_ptr<InputAnswers> answers() const;

    /// Under what results are kept: see result_key.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<std::string>> keys();

    /// What the check of this job gave, if it was kept and nothing has changed since; empty if not.
    ///
    /// Errors: io, with the database.
    core::Result<std::optional<ProgramResult>> find(const CheckJob& job);

    /// Keeps what the check of a job gave, wholly or not at all. What hangs on more than files and
    /// options is not kept: a run that somebody stopped or that could not read a file, and a job
    /// with edits.
    ///
    /// Errors: io, with the database.
    core::Result<void> keep(const CheckJob& job, const CheckRun& run, const ProgramResult& result);

    /// Everything that was kept of a program, the oldest first.
    ///
    /// Errors: io, with the database.
    core::Result<std::vector<KeptVersion>> history(const std::string& program);

private:
    struct State;
    static core::Result<ResultStore> open_as(const std::string& path, const std::string& version,
                                             Database::Access access,
                                             std::shared_ptr<InputAnswers> answers);
    explicit ResultStore(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

} // namespace app
