#include "app/commands/batch_store.h"

#include <filesystem>

#include "app/batch/build_version.h"
#include "app/batch/store_file.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"

namespace app {
namespace {

/// Empty: results are not kept.
std::string place_of_store(const CheckOptions& options) {
    if (options.no_cache) return {};
    if (!options.cache.empty()) return options.cache;
    std::error_code ignored;
    for (const std::string& word : options.programs) {
        if (std::filesystem::is_directory(word, ignored))
            return default_store_path(word, options.share);
        const std::filesystem::path path(word);
        if (path.extension() == ".toml")
            return default_store_path(path.parent_path().string(), options.share);
    }
    return {};
}

} // namespace

BatchStore::BatchStore(const CheckOptions& options) {
    path_ = place_of_store(options);
    const std::string place = path_.empty() && options.watch ? Database::in_memory : path_;
    if (place.empty()) return;
    auto store =
        ResultStore::open(place, build_version(), std::make_shared<Patience>(is_interrupted));
    if (!store) {
        give_up(store.error());
        return;
    }
    store_ = std::make_unique<ResultStore>(*std::move(store));
    if (options.cache.empty() && !path_.empty())
        beside_ = std::make_unique<StoresBeside>(place, *store_);
}

void BatchStore::give_up(const core::Error& error) {
    const std::scoped_lock lock(guard_);
    if (std::exchange(is_told_, true)) return;
    print_error(error);
    print_note("feeler: results are not kept; the check goes on\n");
}

void BatchStore::begin_again() {
    if (store_) store_->try_again();
    is_lost_ = false;
    found_ = 0;
}

std::optional<ProgramResult> BatchStore::find(const CheckJob& job) {
    if (is_lost_) return beside_ ? beside_->find(job) : std::nullopt;
    auto found = store_->find(job);
    if (!found) {
        is_lost_ = true;
        give_up(found.error());
    }
    if (found && *found) return *std::move(found);
    return beside_ ? beside_->find(job) : std::nullopt;
}

void BatchStore::flush() {
    if (!store_) return;
    if (auto written = store_->flush(); !written) give_up(written.error());
}

void BatchStore::serve(BatchHooks& hooks) {
    if (!store_) return;
    hooks.known = [this](const CheckJob& job) {
        auto found = find(job);
        const std::scoped_lock lock(guard_);
        found_ += found ? 1 : 0;
        return found;
    };
    hooks.keep = [this](const CheckJob& job, const CheckRun& run, const ProgramResult& result) {
        if (auto kept = store_->keep(job, run, result); !kept) give_up(kept.error());
    };
}

} // namespace app
