#include <chrono>
#include <condition_variable>
#include <mutex>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/tolerance/tolerances.h"
#include "app/view/model/tolerance_sheet.h"
#include "app/view/model/tolerance_worker.h"
#include "app/view/model/view_model.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace {

using namespace app::viewer;

/// The holder passes the clamp at 5 mm, in line 7.
const std::string slot = "G21 G90 G17 G40 G49 G80 T1 M6\nS3000 M3\nG54\nG0 X10. Y50.\n"
                         "G43 H1 Z50.\nG0 Z2.\nG1 X60. F300\nG0 Z50.\nG28 G91 Z0.\nM30\n";

/// A window with its dialog open, without the window.
class ToleranceWatcher {
public:
    ViewModel model;
    std::optional<app::CheckJob> check;

    explicit ToleranceWatcher(const std::string& program, double clamp = 85.0) {
        test_support::SetupWriter setup;
        setup.root("mesh_size = 2\n");
        setup.fixture("clamp", "box = [[" + std::to_string(clamp) + ", 40, 0], [99, 60, 80]]\n");
        app::CheckJob job;
        job.program = folder_.write("slot.nc", program);
        job.setup = folder_.write("slot.toml", setup.text());
        check = job;
        open_again();
        model.popup = Popup::tolerances;
    }
    /// As when the worker of the session has read the program.
    void open_again() {
        SessionUpdate news;
        news.opening = model.opening + 1;
        news.opened = std::make_shared<OpenedProgram>();
        news.has_news = true;
        take_in(model, std::move(news), 0.0);
        for (uint32_t line = 1; line <= 10; ++line) {
            BlockRow row;
            row.line = line;
            model.rows.push_back(row);
        }
    }
    bool send() { return send_tolerance_orders(model, worker_, check); }
    ToleranceSheet sheet() const { return tolerance_sheet(model); }

    /// Takes in news until something is true; whether it came to be.
    template <typename Condition>
    bool wait_for(const Condition& condition) {
        // clock: gives up after 3 min
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(3);
        while (true) {
            send();
            take_in(model, worker_.take());
            if (condition()) return true;
            std::unique_lock lock(mutex_);
            // clock: as above
            if (!woken_.wait_until(lock, end, [&] { return is_woken_; })) return false;
            is_woken_ = false;
        }
    }
    bool wait_for_end() {
        return wait_for([&] { return model.tolerances.run > 0 && !model.tolerances.is_running; });
    }

private:
    test_support::ScopedFolder folder_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool is_woken_ = false;
    ToleranceWorker worker_{[this] {
        {
            const std::lock_guard lock(mutex_);
            is_woken_ = true;
        }
        woken_.notify_all();
    }};
};

TEST(ToleranceWorker, FindsTheTolerancesThatTheDialogShows) {
    ToleranceWatcher watcher(slot);
    ASSERT_TRUE(watcher.send());
    EXPECT_EQ(watcher.sheet().status, "The check is repeated with deviations: 0 %");
    ASSERT_TRUE(watcher.wait_for_end());
    const ToleranceSheet sheet = watcher.sheet();
    EXPECT_EQ(sheet.status, "");
    ASSERT_FALSE(sheet.lines.empty());
    const ToleranceLine& first = sheet.lines.front();
    EXPECT_EQ(first.name, "G54 X");
    EXPECT_EQ(first.range, "-20 or more to +2.99 mm");
    EXPECT_EQ(first.causes[0].words, "");
    EXPECT_EQ(first.causes[1].words, "line 7: holder of tool 1 near clamp");
    EXPECT_EQ(first.causes[1].block, 6U);
    watcher.model.settings.inch = true;
    EXPECT_EQ(watcher.sheet().lines.front().range, "-0.7874 or more to +0.1181 in");
}

TEST(ToleranceWorker, SearchesOnceForEachOpenedProgram) {
    ToleranceWatcher watcher(slot);
    watcher.model.popup = Popup::none;
    EXPECT_FALSE(watcher.send()) << "nothing is searched before the dialog is opened";
    watcher.model.popup = Popup::tolerances;
    ASSERT_TRUE(watcher.wait_for_end());
    const uint64_t run = watcher.model.tolerances.run;
    watcher.model.popup = Popup::none;
    EXPECT_FALSE(watcher.send());
    watcher.model.popup = Popup::tolerances;
    EXPECT_FALSE(watcher.send());
    EXPECT_EQ(watcher.model.tolerances.run, run);
    EXPECT_EQ(watcher.sheet().status, "");
    watcher.open_again();
    EXPECT_TRUE(watcher.send());
    EXPECT_GT(watcher.model.tolerances.run, run);
    EXPECT_NE(watcher.sheet().status, "") << "results of the earlier program are not shown";
}

TEST(ToleranceWorker, SaysWhyThereAreNone) {
    ToleranceWatcher crashes(slot, 70.0);
    ASSERT_TRUE(crashes.wait_for_end());
    EXPECT_EQ(crashes.sheet().status,
              "There are none: the verdict is not clear: there is nothing to keep.");
    ToleranceWatcher missing(slot);
    missing.check->setup = "/nowhere/setup.toml";
    ASSERT_TRUE(missing.wait_for_end());
    EXPECT_TRUE(missing.sheet().has_failed);
    ToleranceWatcher tried(slot);
    tried.model.changes.push_back("length of T1");
    EXPECT_FALSE(tried.send());
    EXPECT_EQ(tried.sheet().status, "There are no tolerances while a what-if is in effect.");
}

TEST(ToleranceWorker, EndsAtOnceWhenTheWindowCloses) {
    // clock: a search of this program takes far longer than its end
    const auto begin = std::chrono::steady_clock::now();
    {
        std::string program = "G21 G90 G17 G40 G49 G80 T1 M6\nS3000 M3\nG54\nG43 H1 G0 Z50.\n";
        for (int i = 0; i < 20000; ++i)
            program += "G1 X" + std::to_string(i % 60) + ". Y" + std::to_string(i % 50) + ".\n";
        ToleranceWatcher watcher(program + "M30\n", 95.0);
        ASSERT_TRUE(watcher.send());
    }
    // clock: as above
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

} // namespace
