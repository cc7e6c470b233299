#include "app/commands/batch_store.h"

#include <filesystem>

#include "app/batch/result_key.h"
#include "app/batch/store_file.h"
#include "app/commands/output.h"

namespace app {
namespace {

/// Empty: results are not kept.
std::string place_of_store(const CheckOptions& options) {
    if (options.no_cache) return {};
    if (!options.cache.empty()) return options.cache;
    std::error_code ignored;
    for (const std::string& word : options.programs) {
        if (std::filesystem::is_directory(word, ignored)) return default_store_path(word);
        const std::filesystem::path path(word);
        if (path.extension() == ".toml") return default_store_path(path.parent_path().string());
    }
    return {};
}

} // namespace

BatchStore::BatchStore(const CheckOptions& options) {
    path_ = place_of_store(options);
    const std::string place = path_.empty() && options.watch ? ":memory:" : path_;
    if (place.empty()) return;
    auto store = ResultStore::open(place, build_version());
    if (store)
        store_ = std::make_unique<ResultStore>(*std::move(store));
    else
        give_up(store.error());
}

void BatchStore::give_up(const core::Error& error) {
    const std::scoped_lock lock(guard_);
    if (std::exchange(is_told_, true)) return;
    print_error(error);
    std::fputs("feeler: results are not kept; the check goes on\n", stderr);
}

void BatchStore::look_again() {
    if (store_) store_->look_again();
    found_ = 0;
}

void BatchStore::serve(BatchHooks& hooks) {
    if (!store_) return;
    hooks.known = [this](const CheckJob& job) -> std::optional<ProgramResult> {
        auto found = store_->find(job);
        if (!found) {
            give_up(found.error());
            return std::nullopt;
        }
        const std::scoped_lock lock(guard_);
        found_ += found->has_value() ? 1 : 0;
        return *std::move(found);
    };
    hooks.keep = [this](const CheckJob& job, const CheckRun& run, const ProgramResult& result) {
        if (auto kept = store_->keep(job, run, result); !kept) give_up(kept.error());
    };
}

} // namespace app
