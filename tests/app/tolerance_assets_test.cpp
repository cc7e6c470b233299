#include <gtest/gtest.h>

#include "tests/app/tolerance_cases.h"

namespace app_test {
namespace {

/// Checks at both ends of each tolerance of an asset.
void expect_clear_at_ends(const std::string& program, const std::string& setup, size_t least) {
    const std::string assets = FEELER_SOURCE_DIR "/assets/";
    app::CheckJob job;
    job.program = assets + "programs/" + program;
    job.setup = assets + "setups/" + setup;
    job.detail = core::Detail::verdict;
    job.mesh_size = 1.0;
    const auto run = app::run_check(job);
    ASSERT_TRUE(run.has_value());
    const auto all = app::tolerances_of(job, *run);
    ASSERT_TRUE(all.has_value());
    ASSERT_EQ(all->refusal, "");
    size_t known = 0;
    for (const app::Tolerance& tolerance : all->list) {
        if (!tolerance.is_known()) continue;
        ++known;
        for (const double by : {-tolerance.less.by, tolerance.more.by}) {
            const auto end = checked_with(job, tolerance.deviation, by);
            ASSERT_TRUE(end.has_value()) << title_of(tolerance.deviation) << " by " << by;
            EXPECT_FALSE(end->is_wrong()) << title_of(tolerance.deviation) << " by " << by;
        }
    }
    EXPECT_GE(known, least);
}

TEST(ToleranceOfAssets, HoldsForAClampedPlate) {
    expect_clear_at_ends("clamped_plate.nc", "clamped_plate.toml", 50);
}

TEST(ToleranceOfAssets, HoldsForABarThatTurns) {
    expect_clear_at_ends("indexed_flats.nc", "indexed_flats.toml", 12);
}

} // namespace
} // namespace app_test
