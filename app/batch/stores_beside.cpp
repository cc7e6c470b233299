#include "app/batch/stores_beside.h"

#include "app/batch/store_file.h"

namespace app {

StoresBeside::StoresBeside(const std::string& path, const ResultStore& own) : own_(own) {
    for (const std::string& place : stores_beside(path)) {
        auto store = ResultStore::open_beside(place, own_);
        if (!store) continue;
        const auto keys = store->keys();
        if (!keys) continue;
        for (const std::string& key : *keys) paths_of_key_.emplace(key, place);
    }
}

ResultStore* StoresBeside::store_at(const std::string& path) {
    constexpr size_t most_open = 64;
    if (const auto at = open_.find(path); at != open_.end()) return &at->second;
    if (open_.size() >= most_open) open_.clear();
    auto store = ResultStore::open_beside(path, own_);
    return store ? &open_.emplace(path, *std::move(store)).first->second : nullptr;
}

std::optional<ProgramResult> StoresBeside::find_in(const std::string& path, const CheckJob& job) {
    const std::lock_guard lock(mutex_);
    if (lost_.contains(path)) return std::nullopt;
    if (ResultStore* const store = store_at(path))
        if (auto found = store->find(job)) return *std::move(found);
    lost_.insert(path);
    return std::nullopt;
}

std::optional<ProgramResult> StoresBeside::find(const CheckJob& job) {
    if (paths_of_key_.empty()) return std::nullopt;
    for (const std::string& key : own_.keys_of(job)) {
        const auto [first, last] = paths_of_key_.equal_range(key);
        for (auto at = first; at != last; ++at)
            if (auto found = find_in(at->second, job)) return found;
    }
    return std::nullopt;
}

} // namespace app
