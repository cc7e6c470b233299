#include "app/report/text/bench_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/bench/bench_table.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

const char* const preface =
    "The data of the figures in Uddin and Yamazaki, Study of Distance Computation between Objects "
    "Represented by Discrete Boundary Model (2010), and cases that the paper omits.";

const char* const figures =
    "  Figures 6, 7, 8   table 1.1: error and time by mesh size, time by points\n"
    "  Figures 9, 10     table 1.2: tests and error by gap, at 0.5 mm\n";

const char* const legend =
    "gap: between the surfaces. distance: between the closest points. tests and ms: paper's "
    "engine, a sphere tree with one point per leaf. fast: our engine; ratio: its speed-up. Times "
    "are CPU times of one query without an initial guess, excluding the building of trees; best of "
    "several runs.";

/// The number of points that the paper gives for its spheres; empty for other mesh sizes.
std::string paper_points(double mesh_size) {
    constexpr std::pair<double, int> counted[] = {
        {0.5, 47119}, {1.0, 11780}, {1.5, 5233}, {2.0, 2904}};
    for (const auto& [size, points] : counted)
        if (size == mesh_size) return fmt::format("{}", points);
    return "";
}

std::string means_text(const std::vector<BenchAverages>& means, bool with_the_papers) {
    const char* const papers = with_the_papers ? "paper's" : "";
    std::string text =
        fmt::format("{:>6}{:>8}{:>9}{:>10}{:>10}{:>8}{:>9}{:>10}{:>8}\n", "mesh", "points", papers,
                    "error", "sphere", "point", "paper", "fast", "ratio");
    text += fmt::format("{:>6}{:>8}{:>9}{:>10}{:>10}{:>8}{:>9}{:>10}\n", "mm", "",
                        with_the_papers ? "points" : "", "%", "tests", "tests", "ms", "us");
    for (const BenchAverages& mean : means)
        text += fmt::format(
            "{:>6.1f}{:>8}{:>9}{:>10.3f}{:>10.0f}{:>8.0f}{:>9.3f}{:>10.1f}{:>8.1f}\n",
            mean.mesh_size, mean.points, with_the_papers ? paper_points(mean.mesh_size) : "",
            mean.error_percent, mean.sphere_tests, mean.point_tests, 1e3 * mean.paper_seconds,
            1e6 * mean.fast_seconds, mean.ratio);
    return text;
}

std::string growth_text(const std::vector<BenchAverages>& means) {
    const LineFit fit = time_by_points(means);
    return wrapped(fmt::format("The paper's time grows linearly with the points: {:.1f} ns for "
                               "each point plus {:.3f} ms (R2 = {:.4f}).",
                               1e9 * fit.slope, 1e3 * fit.start, fit.r_squared),
                   2);
}

std::string row_text(const BenchRow& row) {
    return fmt::format("{:>6.1f}{:>11.6f}{:>10.4f}{:>11}{:>9}{:>11.3f}{:>11.1f}{:>9.1f}\n",
                       row.separation, row.paper.distance, row.error_percent(),
                       row.paper.node_tests, row.paper.point_tests, 1e3 * row.paper.seconds,
                       1e6 * row.fast.seconds, row.ratio());
}

std::string rows_text(const BenchTable& table, const BenchAverages& mean) {
    std::string text =
        fmt::format("{:>6}{:>11}{:>10}{:>11}{:>9}{:>11}{:>11}{:>9}\n", "gap", "distance", "error",
                    "sphere", "point", "paper", "fast", "ratio");
    text += fmt::format("{:>6}{:>11}{:>10}{:>11}{:>9}{:>11}{:>11}\n", "mm", "mm", "%", "tests",
                        "tests", "ms", "us");
    for (const BenchRow& row : table.rows)
        if (row.mesh_size == mean.mesh_size) text += row_text(row);
    return text + fmt::format("{:>69}{:>9.1f}\n", "geometric mean", mean.ratio);
}

std::string points_text(const BenchTable& table, double mesh_size) {
    const auto row = std::find_if(table.rows.begin(), table.rows.end(),
                                  [&](const BenchRow& r) { return r.mesh_size == mesh_size; });
    if (row->points_a == row->points_b) return fmt::format("{} points each", row->points_a);
    return fmt::format("{} and {} points", row->points_a, row->points_b);
}

std::string scene_text(const BenchTable& table, size_t number) {
    std::string text = wrapped(fmt::format("{}. {}", number, table.scene.title), 0, 3);
    const std::vector<BenchAverages> means = averages_of(table);
    size_t part = 0;
    if (means.size() > 2)
        text += fmt::format("\n{}.{}  Means over {} gaps (of the ratios: geometric)\n\n{}{}",
                            number, ++part, table.scene.poses.size(),
                            means_text(means, number == 1), growth_text(means));
    for (const BenchAverages& mean : means)
        text +=
            fmt::format("\n{}.{}  Mesh size {:.1f} mm, {}\n\n{}", number, ++part, mean.mesh_size,
                        points_text(table, mean.mesh_size), rows_text(table, mean));
    return text + "\n";
}

std::string agreement_text(const std::vector<BenchTable>& tables) {
    size_t rows = 0, same = 0;
    for (const BenchTable& table : tables)
        for (const BenchRow& row : table.rows) {
            ++rows;
            same += row.same_answer();
        }
    if (same == rows)
        return wrapped(fmt::format("Both engines found the same distance, to the last bit, in "
                                   "all {} cases.",
                                   rows),
                       0);
    return wrapped(fmt::format("THE ENGINES DISAGREE in {} of {} cases: one of them is wrong.",
                               rows - same, rows),
                   0);
}

std::string csv_row(const BenchScene& scene, const BenchRow& row, bool is_paper) {
    const EngineResult& by = is_paper ? row.paper : row.fast;
    return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene.name, scene.direction,
                       row.mesh_size, row.points_a, row.points_b, row.separation,
                       is_paper ? "paper" : "fast", by.distance, row.error_percent(),
                       is_paper ? by.node_tests : 0, is_paper ? 0 : by.node_tests, by.point_tests,
                       by.seconds);
}

} // namespace

std::string text_bench(const std::vector<BenchTable>& tables) {
    std::string text = wrapped(preface, 0) + "\n" + figures + "\n" + wrapped(legend, 0) + "\n";
    size_t number = 0;
    for (const BenchTable& table : tables) text += scene_text(table, ++number);
    return text + agreement_text(tables);
}

std::string csv_bench(const std::vector<BenchTable>& tables) {
    std::string text = "scene,direction,mesh_size,points_a,points_b,separation,engine,distance,"
                       "error_percent,sphere_tests,box_tests,point_tests,seconds\n";
    for (const BenchTable& table : tables)
        for (const BenchRow& row : table.rows)
            for (const bool is_paper : {true, false}) text += csv_row(table.scene, row, is_paper);
    return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json json_point(const core::Vec3& p) { return Json::array({p.x, p.y, p.z}); }

} // namespace

std::string json_distance(const BodyPairDistance& found) {
    Json json;
    json["engine"] = found.engine;
    json["distance"] = found.distance;
    json["lower"] = found.lower;
    json["upper"] = found.upper;
    if (found.deviation > 0.0) json["deviation"] = found.deviation;
    json["witness"] = Json::array({json_point(found.on_a), json_point(found.on_b)});
    json["at"] = found.at;
    json["points"] = {found.points_a, found.points_b};
    json["sphere_tests"] = found.node_tests;
    json["point_tests"] = found.point_tests;
    json["poses"] = 1; // one search covers a whole sweep
    json["seconds"] = {{"model", found.model_seconds},
                       {"build", found.build_seconds},
                       {"query", found.query_seconds},
                       {"exact", found.exact_seconds}};
    return json.dump(1) + "\n";
}

std::string text_distance(const BodyPairDistance& found, const std::string& a, const std::string& b,
                          bool swept) {
    std::string text = fmt::format("{} to {}\n", trimmed(a), trimmed(b));
    if (found.upper == 0.0)
        text += "  distance      0: they touch or overlap\n";
    else
        text += fmt::format("  distance      {:.6f} mm, guaranteed between {} and {}\n",
                            found.upper - found.deviation, core::clearance_at_least(found.lower, 9),
                            core::at_most(found.upper, 9));
    text += fmt::format("  scan points   closest pair {} mm apart, of {} and {} points\n",
                        core::at_least(found.distance, 6), found.points_a, found.points_b);
    text += fmt::format("  nearest       ({:.4f}, {:.4f}, {:.4f}) and ({:.4f}, {:.4f}, {:.4f})",
                        found.on_a.x, found.on_a.y, found.on_a.z, found.on_b.x, found.on_b.y,
                        found.on_b.z);
    if (swept) text += fmt::format("\n                at {:.1f} % of the sweep", 100.0 * found.at);
    text += fmt::format("\n  search        {}: {} {} tests, {} point tests\n", found.engine,
                        found.node_tests, found.engine == "paper" ? "sphere" : "box",
                        found.point_tests);
    text += fmt::format("  seconds       model {:.3f}, tree {:.3f}, query {:.6f}, exact {:.6f}\n",
                        found.model_seconds, found.build_seconds, found.query_seconds,
                        found.exact_seconds);
    return printable(text);
}

} // namespace app
