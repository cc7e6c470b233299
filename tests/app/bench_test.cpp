#include <algorithm>
#include <charconv>
#include <cmath>
#include <random>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/bench/bench_table.h"
#include "app/report/text/bench_report.h"

namespace app {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Results of a scene at these mesh sizes, with each query run once.
BenchTable measured(BenchScene scene, std::vector<double> mesh_sizes) {
    scene.mesh_sizes = std::move(mesh_sizes);
    return measure(scene, 0.0).value();
}

BenchTable paper_table() { return measured(paper_scene(), {0.5, 1.0, 1.5, 2.0}); }

std::vector<BenchTable> all_tables_at(double mesh_size) {
    std::vector<BenchTable> tables;
    for (const BenchScene& scene : bench_scenes()) tables.push_back(measured(scene, {mesh_size}));
    return tables;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    return fields;
}

double number(const std::string& text) {
    double value = std::nan("");
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

TEST(PaperBench, HasThePointsOfThePaperWithinSevenInAThousand) {
    for (const auto& [mesh_size, papers, allowed] :
         {std::tuple{0.5, 47119.0, 0.007}, std::tuple{1.0, 11780.0, 0.007},
          std::tuple{1.5, 5233.0, 0.007}, std::tuple{2.0, 2904.0, 0.0}}) {
        const auto points =
            static_cast<double>(points_of(paper_scene().a, mesh_size).value().size());
        EXPECT_LE(std::abs(points - papers), allowed * papers) << mesh_size;
    }
}

TEST(PaperBench, KeepsWhatThePaperStates) {
    const BenchTable table = paper_table();
    ASSERT_EQ(table.rows.size(), 32u);
    for (const BenchRow& row : table.rows) {
        EXPECT_GE(row.paper.distance, row.separation * (1.0 - 1e-12));
        EXPECT_GT(row.paper.node_tests, row.paper.point_tests);
        EXPECT_GT(row.paper.point_tests, 0u);
        if (row.mesh_size == 0.5 && row.separation >= 20.0) {
            EXPECT_LT(row.error_percent(), 0.1);
        }
    }
    const std::vector<BenchAverages> means = averages_of(table);
    for (size_t i = 1; i < means.size(); ++i)
        EXPECT_GT(means[i].error_percent, means[i - 1].error_percent);
    for (size_t i = 1; i < 8; ++i) { // at 0.5 mm, by gap
        EXPECT_LT(table.rows[i].error_percent(), table.rows[i - 1].error_percent());
        EXPECT_GT(table.rows[i].paper.node_tests, table.rows[i - 1].paper.node_tests);
    }
}

TEST(PaperBench, TakesTestsInProportionToThePoints) {
    // Run times as in the paper; the counts are equal on every machine.
    std::vector<double> points, tests;
    for (const BenchAverages& mean : averages_of(paper_table())) {
        points.push_back(static_cast<double>(mean.points));
        tests.push_back(mean.sphere_tests + mean.point_tests);
    }
    const LineFit fit = line_fit(points, tests);
    EXPECT_GT(fit.r_squared, 0.99);
    EXPECT_LT(std::abs(fit.start), 0.1 * tests.front());
    EXPECT_GT(fit.slope, 0.0);
}

TEST(Bench, FindsTheSameDistanceByBothEnginesNeverNearerThanTheTruth) {
    for (const BenchTable& table : all_tables_at(1.0)) {
        ASSERT_EQ(table.rows.size(), table.scene.poses.size());
        for (const BenchRow& row : table.rows) {
            const std::string where = table.scene.title + fmt::format(", {}", row.separation);
            EXPECT_TRUE(row.same_answer()) << where;
            EXPECT_GE(row.paper.distance, row.separation * (1.0 - 1e-12)) << where;
            EXPECT_LT(row.paper.distance, row.separation + 0.2) << where;
            EXPECT_GT(row.paper.node_tests, row.paper.point_tests) << where;
            EXPECT_GT(row.fast.node_tests, 0u) << where;
        }
    }
}

TEST(Bench, HasWhatThePaperLeavesOut) {
    std::set<std::string> scenes;
    for (const BenchScene& scene : bench_scenes()) {
        EXPECT_TRUE(scenes.insert(scene.name + " " + scene.direction).second);
        EXPECT_EQ((scene.name + scene.direction).find(','), std::string::npos); // for the CSV
    }
    for (const char* scene :
         {"spheres axis", "spheres generic", "spheres turned", "linked-tori turned",
          "pin-in-cup turned", "holder-over-stock axis", "holder-over-stock turned"})
        EXPECT_TRUE(scenes.contains(scene)) << scene;
}

TEST(Bench, CountsMoreTestsWhereFlatFacesLieParallel) {
    const auto tests = [](const BenchScene& scene) {
        for (const BenchRow& row : measured(scene, {1.0}).rows)
            if (row.separation == 5.0) return row.paper.node_tests;
        return uint64_t{0};
    };
    EXPECT_GT(tests(bench_scenes()[5]), 10 * tests(paper_scene()));
}

/// Every line through a random point must contain it if and only if the point is inside.
template <typename Body, typename Inside>
void expect_lines(const Body& body, const Inside& inside) {
    std::mt19937 rng(41);
    std::uniform_real_distribution<double> pose(-32.0, 32.0);
    const core::Aabb box = bounds(body);
    int in = 0;
    for (int i = 0; i < 50'000; ++i) {
        const core::Vec3 p(pose(rng), pose(rng), pose(rng));
        const bool is_inside = inside(p);
        in += is_inside;
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_EQ(line_of(body, axis, p[(axis + 1) % 3], p[(axis + 2) % 3]).contains(p[axis]),
                      is_inside)
                << p.x << " " << p.y << " " << p.z << " along " << axis;
        if (is_inside) {
            EXPECT_EQ(glm::clamp(p, box.min, box.max), p);
        }
    }
    EXPECT_GT(in, 2'000);
    EXPECT_LT(in, 20'000);
}

TEST(HollowBody, TorusIsMetWhereItsPointsAre) {
    expect_lines(Torus{21.0, 8.0}, [](const core::Vec3& p) {
        return std::hypot(std::hypot(p.x, p.y) - 21.0, p.z) < 8.0;
    });
}

TEST(HollowBody, CupIsMetWhereItsPointsAre) {
    expect_lines(Cup{25.0, 40.0, 20.0, 35.0}, [](const core::Vec3& p) {
        const double from_axis = std::hypot(p.x, p.y);
        return from_axis < 25.0 && std::abs(p.z) < 20.0 && (from_axis > 20.0 || p.z < -15.0);
    });
}

TEST(LineFit, FindsALineAndSaysWhetherThereIsOne) {
    const LineFit line = line_fit({1.0, 2.0, 5.0}, {5.0, 7.0, 13.0});
    EXPECT_NEAR(line.start, 3.0, 1e-12);
    EXPECT_NEAR(line.slope, 2.0, 1e-12);
    EXPECT_NEAR(line.r_squared, 1.0, 1e-12);
    const LineFit none = line_fit({0.0, 1.0, 2.0, 3.0}, {1.0, -1.0, -1.0, 1.0});
    EXPECT_NEAR(none.slope, 0.0, 1e-12);
    EXPECT_NEAR(none.r_squared, 0.0, 1e-12);
}

TEST(BenchCsv, IsOneTableOfNumbersThatKeepsTheirBits) {
    const std::vector<BenchTable> tables = {measured(paper_scene(), {1.5, 2.0}),
                                            measured(bench_scenes()[3], {2.0})};
    const std::vector<std::string> lines = lines_of(csv_bench(tables));
    EXPECT_EQ(lines.front(), "scene,direction,mesh_size,points_a,points_b,separation,engine,"
                             "distance,error_percent,sphere_tests,box_tests,point_tests,seconds");
    size_t at = 1;
    for (const BenchTable& table : tables)
        for (const BenchRow& row : table.rows)
            for (const char* engine : {"paper", "fast"}) {
                const std::vector<std::string> fields = fields_of(lines.at(at++));
                ASSERT_EQ(fields.size(), 13u);
                const bool is_paper = std::string(engine) == "paper";
                const EngineResult& by = is_paper ? row.paper : row.fast;
                EXPECT_EQ(fields[0], table.scene.name);
                EXPECT_EQ(fields[1], table.scene.direction);
                EXPECT_EQ(fields[6], engine);
                const auto tests = static_cast<double>(by.node_tests);
                const double wanted[] = {row.mesh_size,
                                         static_cast<double>(row.points_a),
                                         static_cast<double>(row.points_b),
                                         row.separation,
                                         by.distance,
                                         row.error_percent(),
                                         is_paper ? tests : 0.0,
                                         is_paper ? 0.0 : tests,
                                         static_cast<double>(by.point_tests),
                                         by.seconds};
                const size_t columns[] = {2, 3, 4, 5, 7, 8, 9, 10, 11, 12};
                for (size_t i = 0; i < std::size(columns); ++i)
                    EXPECT_EQ(number(fields[columns[i]]), wanted[i]) << columns[i];
            }
    EXPECT_EQ(at, lines.size());
}

TEST(BenchText, FitsIntoEightyColumnsAndSaysWhereTheFiguresAre) {
    BenchTable turned = measured(bench_scenes()[2], {1.0, 1.5, 2.0});
    for (BenchRow& row : turned.rows) { // maximum widths
        row.paper.node_tests += 10'000'000;
        row.paper.seconds = 1.2;
        row.fast.seconds = 0.123;
    }
    const std::string text = text_bench(
        {measured(paper_scene(), {1.0, 1.5, 2.0}), turned, measured(bench_scenes()[5], {1.0})});
    for (const std::string& line : lines_of(text)) EXPECT_LE(line.size(), 80u) << line;
    EXPECT_THAT(text, HasSubstr("Figures 6, 7, 8   table 1.1"));
    EXPECT_THAT(text, HasSubstr("Figures 9, 10     table 1.2"));
    EXPECT_THAT(text, HasSubstr("1.1  Means over 8 gaps"));
    EXPECT_THAT(text, HasSubstr("1.2  Mesh size 1.0 mm, 11856 points each"));
    EXPECT_THAT(text, HasSubstr("1.4  Mesh size 2.0 mm, 2904 points each"));
    EXPECT_THAT(text, HasSubstr("3.1  Mesh size 1.0 mm, 32000 and 12800 points"));
    EXPECT_THAT(text, HasSubstr("grows linearly with the points"));
    EXPECT_THAT(text, HasSubstr("same distance, to the last bit, in all 53 cases"));
}

TEST(BenchText, SaysWhenTheEnginesDisagree) {
    BenchTable table = measured(paper_scene(), {2.0});
    table.rows[3].fast.distance = std::nextafter(table.rows[3].fast.distance, 0.0);
    const std::string text = text_bench({table});
    EXPECT_THAT(text, HasSubstr("DISAGREE in 1 of 8 cases"));
    EXPECT_THAT(text, Not(HasSubstr("to the last bit")));
}

} // namespace
} // namespace app
