#include "tests/bench/volume_table.h"

#include <fmt/format.h>

#include "core/dbm/solid.h"
#include "hwsim/coprocessor.h"
#include "hwsim/tool_model.h"
#include "tests/bench/box_rules.h"
#include "tests/bench/sphere_rules.h"
#include "tests/bench/volume_search.h"

namespace bench {
namespace {

using hwsim::Query;
using hwsim::Record;
using hwsim::Side;

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
            core::boundary_points(core::scan(core::Solid{cylinder, 0.0}, 0.5).value());
        points.insert(points.end(), more.begin(), more.end());
    }
    return records_of(points);
}

/// The models of a scene's tool and work.
struct Models {
    std::vector<Record> tool, work;
};

Models models_of(const MachiningScene& scene, Bodies bodies) {
    if (bodies == Bodies::points)
        return {scanned(scene.body), records_of(core::boundary_points(scene.stock.lines))};
    return {hwsim::cylinders_round(scene.body, 0.02).value(),
            hwsim::posts_of(hwsim::cells_of(scene.stock)).value()};
}

/// A device with a scene, its spheres, and the queries.
struct Questions {
    hwsim::FunctionalDevice device;
    hwsim::Driver driver;
    SphereTable spheres;
    std::vector<Query> queries;

    Questions(const MachiningScene& scene, Bodies bodies)
        : device(hwsim::functional_device({.memory_lines = 1U << 19}).value()),
          driver(hwsim::open_device(port_of(device)).value()) {
        const Models models = models_of(scene, bodies);
        const auto tool = load_records(driver, Side::tool, models.tool);
        // Columns are loaded tile by tile, as in the control.
        const auto work = bodies == Bodies::points ? load_records(driver, Side::work, models.work)
                                                   : load_stock(driver, scene.stock);
        for (hwsim::PathSegment segment : scene.segments) {
            segment.pairs = {{tool.value(), work.value(), scene.keep}};
            push(driver, segment).value();
            queries.push_back(query_of(device.state, device.state.retired.segment));
        }
        add_spheres(spheres, memory(), queries[0].tool_header, Side::tool);
        add_spheres(spheres, memory(), queries[0].work_header, Side::work);
    }

    std::span<const hwsim::Line> memory() const { return device.state.memory.lines; }
};

/// Means over the segments of a scene: the work of a thread, and its cycles.
struct Work {
    double nodes = 0.0, pairs = 0.0, lines = 0.0, cycles = 0.0;
};

/// A search, its thread, and its work so far.
template <typename Rules>
struct Contestant {
    LoneThread time;
    uint64_t nodes = 0, pairs = 0;

    uint64_t ask(const Questions& scene, const Query& query, const Rules& rules) {
        const hwsim::Answer answer = VolumeSearch(scene.memory(), query, rules, time).run();
        nodes += answer.counts.nodes;
        pairs += answer.counts.pair_tests;
        return answer.squared;
    }
    Work mean(size_t count) const {
        const auto each = [count](uint64_t sum) {
            return static_cast<double>(sum) / static_cast<double>(count);
        };
        return {each(nodes), each(pairs), each(time.lines), each(time.cycles)};
    }
};

/// Stages of the units (see hwsim/README.md, "Spheres"). With points, only the bound of a sphere
/// needs a root.
LoneThread thread_of(Bodies bodies, uint32_t volume_stages) {
    UnitStages stages{.volume = volume_stages};
    if (bodies == Bodies::points) stages.pair = 7;
    return LoneThread({}, stages);
}

constexpr std::array<const char*, 3> volumes{"boxes", "spheres", "spheres, no root"};
using Comparison = std::array<Work, volumes.size()>;

/// Runs all three searches over all queries; empty if they disagree.
std::optional<Comparison> compared(const Questions& scene, Bodies bodies, bool measures) {
    const uint32_t box_stages = bodies == Bodies::points ? 7 : hwsim::GapUnit::latency;
    Contestant<BoxRules> boxes{thread_of(bodies, box_stages)};
    Contestant<SphereRules> spheres{thread_of(bodies, 20)};
    Contestant<RootlessSphereRules> rootless{thread_of(bodies, 6)};
    for (Query query : scene.queries) {
        if (measures) query.limit = hwsim::beyond_all_squares;
        const uint64_t squared = boxes.ask(scene, query, BoxRules(query));
        const SphereRules by_roots(scene.memory(), scene.spheres, query);
        const RootlessSphereRules by_squares(scene.memory(), scene.spheres, query);
        if (spheres.ask(scene, query, by_roots) != squared
            || rootless.ask(scene, query, by_squares) != squared)
            return {};
    }
    const size_t count = scene.queries.size();
    return Comparison{boxes.mean(count), spheres.mean(count), rootless.mean(count)};
}

/// The number of records or points for tool and work.
void print_sizes(std::span<const MachiningScene> scenes, Bodies bodies) {
    fmt::print("| {} of tool, work |", name_of(bodies));
    for (const MachiningScene& scene : scenes) {
        const Models models = models_of(scene, bodies);
        fmt::print(" {}, {} |", models.tool.size(), models.work.size());
    }
    fmt::print("\n");
}

/// Rows for a kind of body: permit decisions, and distances.
bool print_rows(std::span<const MachiningScene> scenes, Bodies bodies) {
    std::array<std::string, 2 * volumes.size()> rows;
    for (const MachiningScene& scene : scenes) {
        const Questions questions(scene, bodies);
        for (const size_t measures : {0U, 1U}) {
            const auto comparison = compared(questions, bodies, measures == 1);
            if (!comparison) return false;
            for (size_t i = 0; i < volumes.size(); ++i) {
                const Work& work = (*comparison)[i];
                rows[measures * volumes.size() + i] +=
                    fmt::format(" {:.0f}, {:.0f}, {:.0f}: {:.0f} |", work.nodes, work.pairs,
                                work.lines, work.cycles);
            }
        }
    }
    for (size_t i = 0; i < rows.size(); ++i)
        fmt::print("| {}, {}{} |{}\n", name_of(bodies), i < volumes.size() ? "" : "measured, ",
                   volumes[i % volumes.size()], rows[i]);
    return true;
}

} // namespace

bool print_volumes(std::span<const MachiningScene> scenes) {
    fmt::print("\n| nodes, pairs, lines from memory: cycles |");
    for (const MachiningScene& scene : scenes) fmt::print(" {} |", scene.name);
    fmt::print("\n|---|");
    for (size_t i = 0; i < scenes.size(); ++i) fmt::print("---|");
    fmt::print("\n");
    for (const Bodies bodies : {Bodies::records, Bodies::points}) {
        print_sizes(scenes, bodies);
        if (!print_rows(scenes, bodies)) {
            fmt::print(stderr, "spheres and boxes do not agree, so this says nothing\n");
            return false;
        }
    }
    return true;
}

} // namespace bench
