#include "tests/bench/scenes.h"

#include <stdexcept>

#include <fmt/format.h>

#include "tests/bench/bodies.h"
#include "tests/support/meshes.h"

namespace bench {
namespace {

/// The points, if their number is the one for which the targets are stated.
Points counted(Points points, size_t count) {
    if (points.size() != count)
        throw std::runtime_error(
            fmt::format("a body has {} points where {} were expected", points.size(), count));
    return points;
}

core::PairGoal within(double limit, bool any) {
    core::PairGoal goal;
    goal.limit = limit;
    goal.any = any;
    return goal;
}

/// Two balls of 50 mm. The special queries are measured at h = 0.5 only.
Scene spheres(const std::string& h, double spacing, size_t count) {
    const auto rows = [h](const Query&) {
        const std::vector<Pose> generic = gap_poses(50.0, generic_direction());
        std::vector<Row> all = {{"spheres-" + h, generic, {}, true}};
        if (h != "h0.5") return all;
        all.push_back({"axis-" + h, gap_poses(50.0, {1.0, 0.0, 0.0})});
        all.push_back({"turned-" + h, gap_poses(50.0, generic_direction(), {30.0, 45.0, 17.0})});
        all.push_back({"limit-10-" + h, generic, within(10.0, false)});
        all.push_back({"closer-than-5.5-" + h, generic, within(5.5, true)});
        return all;
    };
    const auto bodies = [spacing, count]() -> Bodies {
        const Points ball = counted(scanned(core::Sphere{25.0}, spacing), count);
        return {ball, ball};
    };
    return {h, bodies, rows, true, path_round_a_ball()};
}

/// A holder above a stock, flat face above flat face.
Scene flat() {
    const auto bodies = []() -> Bodies {
        return {counted(scanned(core::Box{{100.0, 100.0, 30.0}}, 0.5), 128'000),
                counted(scanned(core::Box{{40.0, 40.0, 60.0}}, 0.5), 51'200)};
    };
    const auto rows = [](const Query&) -> std::vector<Row> {
        const core::Vec3 part_of_a_cell(0.137, 0.0711, 0.0);
        return {{"flat-aligned", faces_apart(45.0, 0.0, core::Vec3(0.0))},
                {"flat-shifted", faces_apart(45.0, 0.0, part_of_a_cell)},
                {"flat-turned", faces_apart(45.0, 20.0, part_of_a_cell)}};
    };
    return {"flat", bodies, rows};
}

Scene tori() {
    const auto bodies = []() -> Bodies {
        const Points ring = scanned(test_support::torus_mesh(30.0, 8.0, 240, 80), 0.5);
        return {ring, ring};
    };
    const auto rows = [](const Query& exact) -> std::vector<Row> {
        return {{"tori-apart", approaches(exact, 6)}, {"tori-linked", linked_poses()}};
    };
    return {"tori", bodies, rows};
}

Scene pin_in_cup() {
    const auto bodies = []() -> Bodies {
        return {scanned(cup_mesh(), 0.5), scanned(pin_mesh(), 0.5)};
    };
    const auto rows = [](const Query&) -> std::vector<Row> {
        return {{"pin-in-cup", pin_poses()}};
    };
    return {"pin-in-cup", bodies, rows};
}

Scene lumps() {
    const auto bodies = []() -> Bodies {
        return {scanned(lump_mesh(0.4), 0.5), scanned(lump_mesh(2.9), 0.5)};
    };
    const auto rows = [](const Query& exact) -> std::vector<Row> {
        return {{"lumps", approaches(exact, 12)}};
    };
    return {"lumps", bodies, rows};
}

Scene gears() {
    const auto bodies = []() -> Bodies {
        const Points gear = scanned(gear_mesh(), 0.25);
        return {gear, gear};
    };
    const auto rows = [](const Query& exact) -> std::vector<Row> {
        return {{"gears", approaches(exact, 12)}};
    };
    return {"gears", bodies, rows};
}

} // namespace

std::vector<Scene> scenes() {
    return {spheres("h1", 1.0, 11'856),
            spheres("h0.5", 0.5, 47'160),
            spheres("h0.1", 0.1, 1'178'184),
            flat(),
            tori(),
            pin_in_cup(),
            lumps(),
            gears()};
}

} // namespace bench
