#pragma once

#include <map>
#include <mutex>
#include <set>
#include <unordered_map>

#include "app/batch/result_store.h"

namespace app {

/// What lies in the other databases of a folder, of shares and of whole batches: a program that
/// comes to another machine than before is not checked twice. They are only read, and one that
/// cannot be is as good as none.
class StoresBeside {
public:
    /// Those beside the database at `path`, which is that of `own`, as they are now. One that
    /// others have locked for longer than there is patience is not asked again.
    StoresBeside(const std::string& path, const ResultStore& own);

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
