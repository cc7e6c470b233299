#include <random>

#include <gtest/gtest.h>

#include "app/view/model/view_model.h"

namespace {

using namespace app::viewer;

RowsUpdate update_of(size_t first, size_t count, uint32_t line) {
    RowsUpdate update;
    update.first = first;
    update.rows.resize(count);
    for (BlockRow& row : update.rows) row.line = line;
    return update;
}

void put(const RowsUpdate& update, std::vector<uint32_t>& lines) {
    if (lines.size() < update.first + update.rows.size())
        lines.resize(update.first + update.rows.size());
    for (size_t i = 0; i < update.rows.size(); ++i) lines[update.first + i] = update.rows[i].line;
    if (update.count) lines.resize(*update.count);
}

TEST(RowsUpdate, TwoTogetherDoWhatTheyDoOneAfterTheOther) {
    std::mt19937 random(3);
    int overlapping = 0, apart = 0;
    for (int round = 0; round < 2000; ++round) {
        const size_t known = 40;
        const auto a = update_of(random() % 30, 1 + random() % 10, 1);
        const auto b = update_of(random() % 30, 1 + random() % 10, 2);
        const bool touch = a.first <= b.first + b.rows.size() && b.first <= a.first + a.rows.size();
        if (!touch) {
            ++apart; // the worker tells rows in order: what it changes later is never apart
            continue;
        }
        ++overlapping;
        std::vector<uint32_t> one_by_one(known), together(known);
        put(a, one_by_one);
        put(b, one_by_one);
        RowsUpdate both = a;
        both.append(b);
        put(both, together);
        ASSERT_EQ(together, one_by_one) << round;
    }
    EXPECT_GT(overlapping, 500);
    EXPECT_GT(apart, 100);
}

TEST(RowsUpdate, ACountIsOfTheRowsThatWereKnownThen) {
    RowsUpdate both = update_of(5, 10, 1);
    both.count = 15;
    both.append(update_of(15, 1, 2)); // a block more, of an alarm
    std::vector<uint32_t> lines(40);
    put(both, lines);
    ASSERT_EQ(lines.size(), 16U);
    EXPECT_EQ(lines.back(), 2U);

    RowsUpdate shorter;
    shorter.count = 12;
    both.append(shorter);
    put(both, lines);
    EXPECT_EQ(lines.size(), 12U);
}

TEST(SessionUpdate, AProgramThatGoesAnotherWayIsNotStopped) {
    const auto stopped = [] {
        SessionUpdate news;
        news.stopped = core::Error{core::ErrorCode::syntax, {}, "too short"};
        news.has_news = true;
        return news;
    };
    SessionUpdate changed;
    changed.changes = {"T1 is 95 mm long"};
    changed.has_news = true;

    ViewModel model;
    take_in(model, stopped(), 0.0);
    EXPECT_TRUE(model.stopped);
    take_in(model, changed, 0.0);
    EXPECT_FALSE(model.stopped);

    SessionUpdate together = stopped();
    merge(together, changed);
    EXPECT_FALSE(together.stopped);
    merge(together, stopped());
    take_in(model, together, 0.0);
    EXPECT_TRUE(model.stopped) << "it is stopped again";
}

} // namespace
