#include <gtest/gtest.h>

#include "app/base/stopwatch.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/report/html/html_batch.h"
#include "app/report/html/html_report.h"
#include "tests/support/large_batch.h"
#include "tests/support/lengthened_run.h"

namespace {

using app::Stopwatch;

const std::string folder = std::string(FEELER_SOURCE_DIR) + "/assets/";

TEST(PageSpeed, WritesAHundredThousandBlocksWithinThreeSeconds) {
    const auto plate = app::run_check({.program = folder + "programs/clamped_plate_low.nc",
                                       .setup = folder + "setups/clamped_plate.toml",
                                       .detail = core::Detail::deciding_pair});
    ASSERT_TRUE(plate);
    const app::CheckRun run = test_support::lengthened(*plate, 100'000);
    const Stopwatch watch;
    EXPECT_FALSE(app::html_report(run, {}).empty());
    EXPECT_LT(watch.seconds(), 3.0);
}

TEST(PageSpeed, WritesTenThousandProgramsWithinThreeSeconds) {
    for (const size_t findings : {8, 100}) {
        const app::BatchResult batch = test_support::large_batch(10'000, findings);
        const Stopwatch watch;
        EXPECT_FALSE(app::batch_html_report(batch).empty());
        EXPECT_LT(watch.seconds(), 3.0) << findings;
    }
}

} // namespace
