#include <algorithm>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

TEST(BenchOutput, IsTheWholeTableOfTheEngines) {
    const test_support::Ran ran = feeler({"bench", "paper", "--format", "csv"});
    EXPECT_EQ(ran.status, 0);
    EXPECT_EQ(ran.err, "");
    EXPECT_EQ(ran.out.find("scene,direction,mesh_size,"), 0u);
    // A header, and for each engine: 96 positions of the spheres, 22 of hollow bodies, 10 of flat
    // faces.
    EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1 + 2 * 128);
    EXPECT_NE(ran.out.find("\nspheres,axis,0.5,47160,47160,20,paper,20.005"), std::string::npos);
    EXPECT_NE(ran.out.find("\nholder-over-stock,turned,0.5,128000,51200,5,fast,5.000"),
              std::string::npos);
}

} // namespace
} // namespace app_test
