#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "app/batch/batch_run.h"
#include "app/batch/result_store.h"
#include "app/batch/stores_beside.h"
#include "app/commands/check_options.h"

namespace app {

/// Results of earlier batches, as far as there are any. What is wrong with the database is told
/// once, and the batch goes on: without what it cannot do, and without the database altogether if
/// it cannot even be read.
class BatchStore {
public:
    /// The database that was asked for, else that of the first folder or project file that was
    /// named, with those beside it; none for files alone. While files are watched there is always
    /// one, in memory if nowhere else.
    explicit BatchStore(const CheckOptions& options);

    /// The file of the database; empty if there is none.
    const std::string& path() const { return path_; }

    /// For another run of the batch: a database that could not be used may be now.
    void begin_again();

    /// Lets a batch ask it, and keep in it what it finds out.
    void serve(BatchHooks& hooks);

    /// Waits until all of it is written.
    void flush();

    /// How many results were found again.
    size_t found() const { return found_; }

private:
    void give_up(const core::Error& error);
    std::optional<ProgramResult> find(const CheckJob& job);

    std::unique_ptr<ResultStore> store_;
    std::unique_ptr<StoresBeside> beside_; // null if a database was asked for
    std::mutex guard_;
    bool is_told_ = false;
    std::atomic<bool> is_lost_ = false; // the database, for this run
    size_t found_ = 0;
    std::string path_;
};

} // namespace app
