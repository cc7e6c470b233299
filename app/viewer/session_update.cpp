#include "app/viewer/session_update.h"

#include <algorithm>
#include <iterator>

namespace app::viewer {

void RowsUpdate::append(RowsUpdate later) {
    if (later.count)
        count = later.count;
    else if (count)
        count = std::max(*count, later.first + later.rows.size());
    if (later.rows.empty()) return;
    if (rows.empty() || later.first <= first) {
        // What came before and reaches beyond stays true.
        const size_t end = first + rows.size(), later_end = later.first + later.rows.size();
        if (!rows.empty() && end > later_end && later_end >= first)
            later.rows.insert(later.rows.end(),
                              rows.begin() + static_cast<ptrdiff_t>(later_end - first), rows.end());
        first = later.first;
        rows = std::move(later.rows);
        return;
    }
    const size_t from = later.first - first;
    if (rows.size() < from + later.rows.size()) rows.resize(from + later.rows.size());
    std::move(later.rows.begin(), later.rows.end(), rows.begin() + static_cast<ptrdiff_t>(from));
}

namespace {

template <typename T>
void take(T& known, T& later) {
    if (later) known = std::move(later);
}

} // namespace

void merge(SessionUpdate& news, SessionUpdate later) {
    if (later.opening != news.opening) {
        news = std::move(later);
        return;
    }
    take(news.opened, later.opened);
    news.rows.append(std::move(later.rows));
    take(news.findings, later.findings);
    take(news.path, later.path);
    take(news.place, later.place);
    take(news.walk, later.walk);
    take(news.breakpoints, later.breakpoints);
    if (later.changes) news.stopped.reset(); // it goes another way
    take(news.changes, later.changes);
    take(news.failure, later.failure);
    take(news.refusal, later.refusal);
    take(news.saved, later.saved);
    take(news.stopped, later.stopped);
    news.share = later.share;
    news.is_recorded = later.is_recorded;
    news.is_busy = later.is_busy;
    news.has_news = true;
}

} // namespace app::viewer
