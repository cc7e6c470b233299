#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app_test {
namespace {

/// The second of two subprograms cuts without the tool length and calls the first again.
TEST(LengthMismatch, IsFollowedFromTheMiddleOfASubprogram) {
    const test_support::ScopedFolder folder;
    folder.write("O4000.nc", "O4000\nX40.\nM99\n");
    folder.write("O3000.nc", "O3000\nG0 X10. Y10.\nG49 Z50.\nG1 Z-2. F300.\nX30.\nM98 P4000\n"
                             "X60.\nG0 Z150.\nM99\n");
    const std::string program = "O1\nG21 G90 G54\nT1 M6\nM3 S1000\nG43 H1 Z50.\nG0 X5. Y5.\n"
                                "M98 P4000\nM98 P3000\nM30\n";
    const auto run =
        app::run_check({.program = folder.write("p.nc", program),
                        .setup = folder.write("s.toml", test_support::SetupWriter().text()),
                        .allowance = {},
                        .mesh_size = 2.0});
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_FALSE(run->stopped) << run->stopped->message;
    const bool tells =
        std::any_of(run->findings.begin(), run->findings.end(), [](const core::Finding& finding) {
            return finding.rule == "length-offset-cancelled";
        });
    EXPECT_TRUE(tells);
    EXPECT_FALSE(
        run->combined_findings.empty()); // crashes that do not occur with the correct length
}

} // namespace
} // namespace app_test
