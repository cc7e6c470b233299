#include <random>

#include <gtest/gtest.h>

#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "app/debug/debug_session.h"
#include "tests/session/walked_program.h"

namespace session_test {
namespace {

/// Applies random what-ifs and keeps track of those still in effect.
class Trying {
public:
    Trying(const ProgramFiles& files, unsigned seed) : files_(files), random_(seed) {
        session_ = opened();
    }

    void go_on() {
        app::DebugSession& session = *session_;
        switch (below(8)) {
        case 0:
        case 1:
            change();
            break;
        case 2:
            take_back();
            break;
        case 3:
            session.step_back(1 + below(60));
            break;
        case 4:
            session.next_finding();
            break;
        case 5:
            while (session.record_for(1.0)) {
            }
            break;
        default:
            (void)session.go_to(below(300));
            break;
        }
    }

    /// Expects a session with only the what-ifs in effect to be at the same block with the same
    /// record.
    void expect_what_counts() {
        const auto other = opened();
        for (const app::AppliedChange& made : made_) {
            ASSERT_TRUE(other->go_to(made.block));
            ASSERT_TRUE(other->change(made.change));
        }
        ASSERT_TRUE(other->go_to(session_->at()));
        EXPECT_EQ(app::digest_of(session_->state()), app::digest_of(other->state()))
            << shown_assumptions();
        while (session_->record_for(1.0) || other->record_for(1.0)) {
        }
        EXPECT_EQ(report_of(session_->record()), report_of(other->record())) << shown_assumptions();
    }

    size_t most_made() const { return most_made_; }

private:
    size_t below(size_t count) { return random_() % count; }
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(below(1000)) / 1000.0;
    }
    std::unique_ptr<app::DebugSession> opened() const {
        auto session = app::DebugSession::open(files_.job(), 8 << 20);
        EXPECT_TRUE(session) << session.error().message;
        return session ? *std::move(session) : nullptr;
    }
    app::WhatIf any_change() {
        const int number = static_cast<int>(1 + below(2));
        switch (below(5)) {
        case 0:
            return app::ToolLengthChange{core::ToolNumber{number}, between(90.0, 105.0)};
        case 1:
            return app::LengthOffsetOverride{core::OffsetNumber{number}, between(80.0, 110.0)};
        case 2:
            return app::WorkOffsetChange{0, 2, between(-430.0, -410.0)};
        case 3:
            return app::AllowanceChange{between(0.0, 30.0)};
        default:
            return app::MovedFixture{"clamp-1", {between(-20.0, 20.0), between(-20.0, 20.0), 0.0}};
        }
    }
    void change() {
        const app::AppliedChange made{session_->at(), any_change()};
        if (!session_->change(made.change)) return;
        std::erase_if(made_, [&](const auto& other) { return other.block > made.block; });
        made_.push_back(made);
        most_made_ = std::max(most_made_, made_.size());
    }
    void take_back() {
        EXPECT_EQ(session_->take_back().has_value(), !made_.empty());
        if (made_.empty()) return;
        EXPECT_EQ(session_->at(), made_.back().block);
        made_.pop_back();
    }
    std::string shown_assumptions() const {
        std::string text;
        for (const app::AppliedChange& made : made_)
            text += std::to_string(made.block) + ": " + app::text_of(made.change) + "\n";
        return text;
    }

    const ProgramFiles& files_;
    std::mt19937 random_;
    std::unique_ptr<app::DebugSession> session_;
    std::vector<app::AppliedChange> made_ = {};
    size_t most_made_ = 0;
};

TEST(WhatIf, DependsOnlyOnTheCurrentChanges) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    size_t most = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        Trying trying(files, seed);
        for (int round = 0; round < 3; ++round) {
            for (int i = 0; i < 12; ++i) trying.go_on();
            trying.expect_what_counts();
            if (testing::Test::HasFailure()) FAIL() << "seed " << seed << ", round " << round;
        }
        most = std::max(most, trying.most_made());
    }
    EXPECT_GE(most, 3U);
}

} // namespace
} // namespace session_test
