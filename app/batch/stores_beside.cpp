#include "app/batch/stores_beside.h"

#include "app/batch/result_key.h"
#include "app/batch/store_file.h"

namespace app {

StoresBeside::StoresBeside(const std::string& path, std::string version,
                           std::shared_ptr<InputAnswers> answers)
    : version_(std::move(version)), answers_(std::move(answers)) {
    for (const std::string& place : stores_beside(path)) {
        auto store = ResultStore::open_to_read(place, version_, answers_);
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
    auto store = ResultStore::open_to_read(path, version_, answers_);
    return store ? &open_.emplace(path, *std::move(store)).first->second : nullptr;
}

std::optional<ProgramResult> StoresBeside::find(const CheckJob& job) {
    const auto options = options_text(job);
    if (paths_of_key_.empty() || !options) return std::nullopt;
    const auto [first, last] = paths_of_key_.equal_range(
        result_key(version_, job, answers_->content_of(job.program), *options));
    for (auto at = first; at != last; ++at) {
        const std::lock_guard lock(mutex_);
        ResultStore* const store = store_at(at->second);
        if (!store) continue;
        if (auto found = store->find(job); found && *found) return *std::move(found);
    }
    return std::nullopt;
}

} // namespace app
