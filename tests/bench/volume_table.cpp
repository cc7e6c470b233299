#include "tests/bench/volume_table.h"

#include <fmt/format.h>

#include "core/dbm/solid.h"
#include "hwsim/tool_model.h"
#include "tests/bench/scene_device.h"

namespace bench {
namespace {

using hwsim::Record;
using hwsim::Side;
using hwsim::SlotNumber;
using hwsim::Volumes;

constexpr double mesh_size = 0.5;

/// What models consist of: records, or points, as in the paper.
enum class Bodies : uint8_t { records, points };

constexpr const char* name_of(Bodies bodies) {
    return bodies == Bodies::points ? "points" : "records";
}

/// Points, rounded to the nearest step.
std::vector<Record> records_of(const std::vector<core::Vec3>& points) {
    std::vector<Record> records;
    for (const core::Vec3& p : points) {
        Record record;
        for (int axis = 0; axis < 3; ++axis)
            record.base[static_cast<size_t>(axis)] =
                hwsim::fixed(p[axis], hwsim::Rounding::nearest).value();
        records.push_back(record);
    }
    return records;
}

/// The points of a tool whose pieces are cylinders.
std::vector<Record> scanned(const core::RevolvedProfile& body) {
    std::vector<core::Vec3> points;
    for (const core::ProfileElement& piece : body.elements) {
        const core::SolidCylinder cylinder{{0, 0, piece.z0}, piece.r0, piece.z1 - piece.z0};
        const auto more =
            core::boundary_points(core::scan(core::Solid{cylinder, 0.0}, mesh_size).value());
        points.insert(points.end(), more.begin(), more.end());
    }
    return records_of(points);
}

/// A device that never gives up a search.
hwsim::DeviceConfig config_with(Volumes volumes) {
    return {.volumes = volumes, .memory_lines = 1U << 19, .search_limit = UINT32_MAX};
}

/// `count` of them, evenly spaced.
std::vector<hwsim::PathSegment> some_of(const std::vector<hwsim::PathSegment>& all, size_t count) {
    std::vector<hwsim::PathSegment> chosen;
    for (size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
    return chosen;
}

/// Loads the scene with `count` of its segments, evenly spaced.
void load(SceneDevice& device, const MachiningScene& scene, Bodies bodies, size_t count) {
    if (bodies == Bodies::records) {
        device.segments = load(device.driver, scene, 4);
    } else {
        device.driver.leaf_size = 1; // as in the paper
        const auto points = records_of(core::boundary_points(scene.stock.lines));
        const SlotNumber tool =
            load_records(device.driver, Side::tool, scanned(scene.body)).value();
        const SlotNumber work = load_records(device.driver, Side::work, points).value();
        device.segments = with_pair(device.driver, scene.segments, {tool, work, scene.keep});
    }
    device.segments = some_of(device.segments, count);
}

/// Cells of the table, and the distances that were measured.
struct Row {
    std::string permits, measurements;
    std::vector<uint64_t> squares;
};

std::string cell_of(const SearchWork& work, double cycles) {
    return fmt::format(" {:.0f}, {:.0f}, {:.0f}: {:.0f}", work.nodes, work.pairs, work.lines,
                       cycles);
}

bool is_well(SceneDevice& device) {
    const hwsim::DeviceReport now = report(device.driver);
    if (now.stop != hwsim::Stop::none)
        fmt::print(stderr, "the device has stopped: {}\n", name_of(now.stop));
    return now.stop == hwsim::Stop::none;
}

/// Many segments one after the other, then some alone; false if one is refused, as none should be.
bool add_permits(Row& row, const MachiningScene& scene, Bodies bodies, Volumes volumes) {
    SceneDevice device(config_with(volumes));
    load(device, scene, bodies, 128);
    const double together = device.run();
    const SearchWork work = device.work();
    device.segments = some_of(device.segments, 16);
    row.permits += fmt::format("{} / {:.0f} |", cell_of(work, device.run_alone()), together);
    return is_well(device);
}

void add_measurements(Row& row, const MachiningScene& scene, Bodies bodies, Volumes volumes) {
    SceneDevice device(config_with(volumes));
    load(device, scene, bodies, 8);
    uint64_t cycles = 0;
    for (const uint64_t squared : device.measure_all(cycles)) row.squares.push_back(squared);
    const double count = static_cast<double>(device.segments.size());
    row.measurements += cell_of(device.work(), static_cast<double>(cycles) / count) + " |";
}

bool print_rows(std::span<const MachiningScene> scenes, Bodies bodies) {
    std::array<Row, 2> rows;
    for (const Volumes volumes : {Volumes::boxes, Volumes::spheres})
        for (const MachiningScene& scene : scenes) {
            Row& row = rows[static_cast<size_t>(volumes)];
            if (!add_permits(row, scene, bodies, volumes)) return false;
            add_measurements(row, scene, bodies, volumes);
        }
    for (const Volumes volumes : {Volumes::boxes, Volumes::spheres})
        fmt::print("| {}, {} |{}\n", name_of(bodies), name_of(volumes),
                   rows[static_cast<size_t>(volumes)].permits);
    for (const Volumes volumes : {Volumes::boxes, Volumes::spheres})
        fmt::print("| {}, measured, {} |{}\n", name_of(bodies), name_of(volumes),
                   rows[static_cast<size_t>(volumes)].measurements);
    return rows[0].squares == rows[1].squares;
}

bool print_scenes(std::span<const MachiningScene> scenes) {
    fmt::print("\n| nodes, pairs, lines from memory: cycles |");
    for (const MachiningScene& scene : scenes) fmt::print(" {} |", scene.name);
    fmt::print("\n|---|");
    for (size_t i = 0; i < scenes.size(); ++i) fmt::print("---|");
    fmt::print("\n");
    return print_rows(scenes, Bodies::records) && print_rows(scenes, Bodies::points);
}

/// The case study of the paper: two balls of 50 mm, eight gaps between their surfaces, along X and
/// along a direction parallel to nothing.
bool print_case_study() {
    const std::vector<Record> ball =
        records_of(core::boundary_points(core::scan(core::Sphere{25.0}, mesh_size).value()));
    fmt::print("\n| {} points each: nodes, pairs, lines from memory: cycles |", ball.size());
    const std::array<core::Vec3, 2> directions{core::Vec3(1, 0, 0), core::Vec3(0.48, 0.6, 0.64)};
    fmt::print(" boxes, along X | spheres, along X | boxes, generic | spheres, generic |\n");
    fmt::print("|---|---|---|---|---|\n");
    for (const double gap : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0}) {
        fmt::print("| gap of {} mm |", gap);
        for (const core::Vec3& direction : directions) {
            std::array<uint64_t, 2> squares{};
            for (const Volumes volumes : {Volumes::boxes, Volumes::spheres}) {
                SceneDevice device(config_with(volumes));
                device.driver.leaf_size = 1;
                const SlotNumber tool = load_records(device.driver, Side::tool, ball).value();
                const SlotNumber work = load_records(device.driver, Side::work, ball).value();
                const core::Vec3 at = (50.0 + gap) * direction;
                device.segments = with_pair(device.driver, {{at, at, {}}}, {tool, work, 0.0});
                uint64_t cycles = 0;
                squares[static_cast<size_t>(volumes)] = device.measure_all(cycles)[0];
                fmt::print("{} |", cell_of(device.work(), static_cast<double>(cycles)));
            }
            if (squares[0] != squares[1]) return false;
        }
        fmt::print("\n");
    }
    return true;
}

} // namespace

bool print_volumes(std::span<const MachiningScene> scenes) {
    if (print_scenes(scenes) && print_case_study()) return true;
    fmt::print(stderr, "a segment was refused, or devices do not agree, so this says nothing\n");
    return false;
}

} // namespace bench
