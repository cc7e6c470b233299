#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "app/batch/batch_run.h"
#include "app/batch/result_store.h"
#include "app/commands/check_options.h"

namespace app {

/// Results of earlier batches, as far as there are any. What is wrong with the database is told
/// once, and the batch goes on without it.
class BatchStore {
public:
    /// The database that was asked for, else that of the first folder or project file that was
    /// named; none for files alone.
    explicit BatchStore(const CheckOptions& options);

    /// Lets a batch ask it, and keep in it what it finds out.
    void serve(BatchHooks& hooks);

    /// How many results were found again.
    size_t found() const { return found_; }

private:
    void give_up(const core::Error& error);

    std::unique_ptr<ResultStore> store_;
    std::mutex guard_;
    bool is_told_ = false;
    size_t found_ = 0;
};

} // namespace app
