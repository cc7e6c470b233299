#pragma once

#include "app/view/model/view_model.h"

namespace viewer_test {

/// A block that feeds for a second with so much clearance, of which it must keep 1 mm.
inline app::viewer::BlockRow row_with(double clearance) {
    app::viewer::BlockRow row;
    row.motion = core::BlockMotion::feed;
    row.is_known = true;
    row.duration = 1.0;
    row.lower = row.upper = clearance;
    row.allowance = 1.0;
    if (clearance < 1.0) row.verdict = core::Verdict::violation;
    return row;
}

/// A model that was told of rows as a worker tells of them.
inline app::viewer::ViewModel model_of(std::vector<app::viewer::BlockRow> rows) {
    app::viewer::ViewModel model;
    app::viewer::SessionUpdate news;
    news.opening = 1;
    for (size_t i = 0; i < rows.size(); ++i) {
        rows[i].time = static_cast<double>(i);
        if (rows[i].line == 0) rows[i].line = static_cast<uint32_t>(10 + i);
    }
    news.rows.rows = std::move(rows);
    news.is_recorded = news.has_news = true;
    app::viewer::take_in(model, std::move(news), 0.0);
    return model;
}

} // namespace viewer_test
