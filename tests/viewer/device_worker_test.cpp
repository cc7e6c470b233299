#include <chrono>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/coproc/study/coprocessor_report.h"
#include "app/view/model/device_worker.h"
#include "app/view/model/view_model.h"
#include "tests/support/scoped_folder.h"
#include "tests/viewer/rows.h"

namespace {

using namespace app::viewer;

const std::string assets = FEELER_SOURCE_DIR "/assets/";

app::CheckJob plate(const std::string& program) {
    app::CheckJob job;
    job.program = assets + "programs/" + program;
    job.setup = assets + "setups/clamped_plate.toml";
    return job;
}

/// A window with its panel open, without the window.
class DeviceWatcher {
public:
    ViewModel model;
    std::optional<app::CheckJob> check;

    explicit DeviceWatcher(const std::string& program) : check(plate(program)) {
        open_again();
        model.device.shown = true;
    }
    /// As when the worker of the session has read the program.
    void open_again() {
        SessionUpdate news;
        news.opening = model.opening + 1;
        news.opened = std::make_shared<OpenedProgram>();
        news.has_news = true;
        take_in(model, std::move(news), 0.0);
    }
    bool send() { return send_device_orders(model, worker_, check); }

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

private:
    std::mutex mutex_;
    std::condition_variable woken_;
    bool is_woken_ = false;
    DeviceWorker worker_{[this] {
        {
            const std::lock_guard lock(mutex_);
            is_woken_ = true;
        }
        woken_.notify_all();
    }};
};

TEST(DeviceWorker, PublishesTheAnswersFirstAndThenTheSmallestDevice) {
    DeviceWatcher watcher("clamped_plate_low.nc");
    const DeviceModel& device = watcher.model.device;
    ASSERT_TRUE(watcher.wait_for([&] { return device.study != nullptr; }));
    app::CoprocessorJob job;
    job.check = plate("clamped_plate_low.nc");
    const auto run = app::run_with_coprocessor(job);
    ASSERT_TRUE(run.has_value());
    ASSERT_EQ(device.study->size(), run->blocks.size());
    for (size_t i = 0; i < run->blocks.size(); ++i) {
        const app::DeviceBlock& block = device.study->result->run.blocks[i];
        EXPECT_EQ(block.permit.permitted, run->blocks[i].permit.permitted) << i;
        EXPECT_EQ(block.cycles, run->blocks[i].cycles) << i;
    }
    EXPECT_EQ(device.study->stops, (std::vector<size_t>{38, 39, 41, 42}));
    ASSERT_TRUE(watcher.wait_for([&] { return !device.is_running; }));
    EXPECT_FALSE(device.failure);
    EXPECT_EQ(device.study->result->fits.size(), 5U);
    EXPECT_TRUE(app::smallest(device.study->result->fits));
}

TEST(DeviceWorker, ASlowDeviceIsLate) {
    const test_support::ScopedFolder folder;
    DeviceWatcher watcher("clamped_plate.nc");
    watcher.model.device.file =
        folder.write("slow.toml", "[device]\nclock_mhz = 1\nelements = 1\n"
                                  "[control]\nlook_ahead = 1\nio_latency = 1.5\n");
    const DeviceModel& device = watcher.model.device;
    ASSERT_TRUE(watcher.wait_for([&] { return device.study != nullptr || device.failure; }));
    ASSERT_TRUE(device.study);
    EXPECT_EQ(device.study->result->file.device.elements, 1U);
    EXPECT_FALSE(device.study->stops.empty());
    EXPECT_EQ(answer_of(device.study.get(), device.study->stops[0]), DeviceAnswer::late);
}

TEST(DeviceWorker, ARunIsReplacedWhenTheProgramIsReadAgain) {
    DeviceWatcher watcher("clamped_plate_low.nc");
    EXPECT_TRUE(watcher.send());
    const uint64_t first = watcher.model.device.run;
    EXPECT_FALSE(watcher.send()) << "it is begun once";
    watcher.check = plate("clamped_plate.nc");
    watcher.open_again();
    EXPECT_TRUE(watcher.send());
    EXPECT_NE(watcher.model.device.run, first);
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.device.study != nullptr; }));
    EXPECT_TRUE(watcher.model.device.study->stops.empty()) << "this program is free";
}

TEST(DeviceWorker, ARunEndsWithItsPanelAndWithAWhatIf) {
    DeviceWatcher watcher("clamped_plate.nc");
    DeviceModel& device = watcher.model.device;
    EXPECT_TRUE(watcher.send());
    device.shown = false;
    EXPECT_TRUE(watcher.send());
    EXPECT_FALSE(device.is_running);
    device.shown = true;
    ASSERT_TRUE(watcher.wait_for([&] { return device.study != nullptr; }));
    device.shown = false;
    EXPECT_FALSE(watcher.send()) << "its result stays on the timeline";
    EXPECT_TRUE(device.study);
    watcher.model.changes = {"T1 is longer"};
    EXPECT_TRUE(watcher.send());
    EXPECT_FALSE(device.study);
    device.shown = true;
    EXPECT_FALSE(watcher.send()) << "nothing runs during a what-if";
    watcher.model.changes.clear();
    EXPECT_TRUE(watcher.send());
    EXPECT_TRUE(device.is_running);
}

TEST(DeviceWorker, ReportsMistakesInADeviceFile) {
    const test_support::ScopedFolder folder;
    DeviceWatcher watcher("clamped_plate.nc");
    const DeviceModel& device = watcher.model.device;
    watcher.model.device.file = folder.write("device.toml", "[device]\nelements = 0\n");
    ASSERT_TRUE(watcher.wait_for([&] { return !device.is_running; }));
    ASSERT_TRUE(device.failure);
    EXPECT_EQ(device.failure->where.line, 2U);
    EXPECT_EQ(device.failure->file, watcher.model.device.file);
    EXPECT_FALSE(device.study);
}

TEST(DeviceWorker, SaysThatModelsDoNotFit) {
    const test_support::ScopedFolder folder;
    DeviceWatcher watcher("clamped_plate.nc");
    const DeviceModel& device = watcher.model.device;
    watcher.model.device.file = folder.write("device.toml", "[device]\nmemory_lines = 16\n");
    ASSERT_TRUE(watcher.wait_for([&] { return !device.is_running; }));
    ASSERT_TRUE(device.failure);
    EXPECT_NE(device.failure->message.find("memory"), std::string::npos) << device.failure->message;
}

} // namespace
