#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "core/base/result.h"

namespace app {
struct CheckJob;
struct Tolerances;
} // namespace app

namespace app::viewer {

/// What a search has produced since the last update.
struct ToleranceUpdate {
    uint64_t run = 0; // number of the search
    double fraction = 0.0;
    std::shared_ptr<const Tolerances> found; // at the end
    std::optional<core::Error> failure;      // likewise
    bool has_news = false;
};

/// Searches the tolerances of a set-up, always the last one requested, in a separate thread.
/// Requests return at once.
class ToleranceWorker {
public:
    /// `wake` is called from the thread whenever there is an update.
    explicit ToleranceWorker(std::function<void()> wake);
    /// Aborts the current search.
    ~ToleranceWorker();

    /// Aborts the current search and starts another one. Returns its number, above 0.
    uint64_t start(const CheckJob& check);
    /// Aborts the current search.
    void stop();
    /// Everything new since the last call.
    ToleranceUpdate take();

private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

} // namespace app::viewer
