#include <gtest/gtest.h>

#include "core/base/vec.h"
#include "tests/bench/box_rules.h"
#include "tests/bench/sphere_rules.h"
#include "tests/bench/volume_search.h"
#include "tests/hwsim/test_device.h"

namespace bench {
namespace {

using hwsim::Answer;
using hwsim::Record;
using hwsim::SceneKind;
using hwsim::Side;
using hwsim::Stop;

const std::vector<SceneKind> kinds{{},
                                   {.reach = 3, .most_records = 40},
                                   {.reach = 4 * 4096, .grid = 4096},
                                   {.reach = 5, .most_records = 80, .bare = true},
                                   {.reach = 3'000'000}};

template <typename Rules>
Answer by_spheres(const hwsim::Scene& scene) {
    SphereTable table;
    add_spheres(table, scene.memory, scene.query.tool_header, Side::tool);
    add_spheres(table, scene.memory, scene.query.work_header, Side::work);
    LoneThread time{hwsim::DeviceConfig{}};
    const Rules rules(scene.memory, table, scene.query);
    return VolumeSearch(scene.memory, scene.query, rules, time).run();
}

Answer by_boxes(std::span<const hwsim::Line> memory, const hwsim::Query& query, LoneThread& time) {
    const BoxRules rules(query);
    return VolumeSearch(memory, query, rules, time).run();
}

Record record_named(const hwsim::Scene& scene, uint32_t name) {
    return hwsim::records_in(
        scene.memory[name / hwsim::records_per_line])[name % hwsim::records_per_line];
}

TEST(VolumeSearch, ByBoxesIsTheDevicesOwn) {
    std::mt19937 rng(1);
    for (const SceneKind& kind : kinds)
        for (int i = 0; i < 300; ++i) {
            const hwsim::Scene scene = hwsim::random_scene(rng, kind);
            LoneThread time{hwsim::DeviceConfig{}};
            ASSERT_EQ(by_boxes(scene.memory, scene.query, time),
                      hwsim::search(scene.memory, scene.query));
        }
}

/// The outcomes of scenes.
struct Tally {
    int below = 0, above = 0, zero = 0, out = 0, by_other_ways = 0;

    void note(const Answer& boxes, const Answer& spheres) {
        const bool answered = boxes.stop == Stop::none;
        ++(!answered ? out : boxes.squared == 0 ? zero : boxes.found ? below : above);
        by_other_ways += spheres.counts != boxes.counts ? 1 : 0;
    }
};

/// The same distance to the step, so the same permits. Of equally near pairs it may report another.
void expect_the_same_distance(const hwsim::Scene& scene, const Answer& boxes,
                              const Answer& spheres) {
    ASSERT_EQ(spheres.stop, boxes.stop);
    if (boxes.stop != Stop::none) return;
    ASSERT_EQ(spheres.squared, boxes.squared);
    ASSERT_EQ(spheres.found, boxes.found);
    if (!boxes.found) return;
    const hwsim::FixedVec offset = hwsim::offset_at(scene.query.segment, spheres.sample);
    ASSERT_EQ(hwsim::squared_distance(record_named(scene, spheres.tool_record), offset,
                                      record_named(scene, spheres.work_record)),
              boxes.squared);
}

template <typename Rules>
void expect_the_same_distances(uint32_t seed) {
    std::mt19937 rng(seed);
    Tally tally;
    for (const SceneKind& kind : kinds)
        for (int i = 0; i < 1'000 && !testing::Test::HasFatalFailure(); ++i) {
            const hwsim::Scene scene = hwsim::random_scene(rng, kind);
            const Answer boxes = hwsim::search(scene.memory, scene.query);
            const Answer spheres = by_spheres<Rules>(scene);
            expect_the_same_distance(scene, boxes, spheres);
            tally.note(boxes, spheres);
        }
    for (const int seen : {tally.below, tally.above, tally.zero, tally.out}) EXPECT_GT(seen, 150);
    EXPECT_GT(tally.by_other_ways, 2'000);
}

TEST(VolumeSearch, BySpheresFindsTheSameDistance) { expect_the_same_distances<SphereRules>(2); }

TEST(VolumeSearch, BySpheresWithoutARootFindsTheSameDistance) {
    expect_the_same_distances<RootlessSphereRules>(6);
}

/// Squares may be compared instead: floor(root(d2)) - r with the best's root, and d2 with the
/// square of both.
TEST(RootlessSphereRules, DecidesAsTheRootDoes) {
    for (int64_t square = 0; square < 600; ++square)
        for (int64_t radii = 0; radii < 30; ++radii)
            for (int64_t best = 1; best < 200; ++best) {
                int64_t root = hwsim::root_up(square);
                if (root * root > square) --root;
                const int64_t bound = std::max(root - radii, int64_t{0});
                const int64_t reach = hwsim::root_up(best) + radii;
                ASSERT_EQ(bound * bound < best, square < reach * reach);
            }
}

/// Submits one segment to a device and returns the cycles from the request for its descriptor to
/// its permit.
uint64_t cycles_of(hwsim::TestDevice& device, const hwsim::Segment& segment) {
    const size_t before = device.retired.size();
    device.push(segment);
    while (device.retired.size() == before) device.clock();
    return device.state.cycle - device.retired.back().asked;
}

TEST(LoneThread, TakesTheCyclesOfAnEmulatedOne) {
    std::mt19937 rng(3);
    uint64_t slow = 0;
    for (int round = 0; round < 20; ++round) {
        hwsim::DeviceConfig config = hwsim::small_config();
        config.elements = config.threads = 1;
        hwsim::TestDevice device(config);
        std::vector<Record> tools, works;
        for (int i = 0; i < 40; ++i) tools.push_back(hwsim::random_record(rng, 5'000));
        for (int i = 0; i < 90; ++i) works.push_back(hwsim::random_record(rng, 5'000));
        device.set_models(tools, works);
        ASSERT_TRUE(device.finish());
        LoneThread time(config);
        for (int i = 0; i < 40; ++i) {
            const hwsim::Segment segment =
                question(1, hwsim::random_segment(rng, 12'000, static_cast<uint8_t>(rng() % 7)), 0,
                         hwsim::SegmentKind::measure);
            const uint64_t cycles = cycles_of(device, segment);
            const uint64_t before = time.cycles;
            const Answer answer =
                by_boxes(device.state.memory.lines, hwsim::query_of(device.state, segment), time);
            ASSERT_EQ(answer, device.retired.back().answer);
            // From the host to the FIFO, to the thread, and from there to the permit unit.
            ASSERT_EQ(time.cycles - before + config.host_latency + 7 + 3, cycles);
            slow = std::max(slow, cycles);
        }
        ASSERT_EQ(time.lines, device.read(hwsim::Counter::lines_read));
    }
    EXPECT_GT(slow, 1'000U);
}

/// Corners of posts, rims of cylinders.
std::vector<core::Vec3> outermost(const Record& r, Side side) {
    std::vector<core::Vec3> points;
    for (const int z : {r.base[2], r.base[2] + r.run})
        for (int i = 0; i < 64; ++i) {
            const double angle = 2.0 * 3.14159265358979 * i / 64;
            core::Vec3 aside(std::cos(angle), std::sin(angle), 0.0);
            if (side == Side::work) aside = {i % 2 ? 1.0 : -1.0, i % 4 < 2 ? 1.0 : -1.0, 0.0};
            points.push_back(core::Vec3(r.base[0], r.base[1], z) + double(r.half) * aside);
        }
    return points;
}

TEST(SphereRound, HoldsItsRecordsAndIsNoLargerThanItMust) {
    std::mt19937 rng(4);
    for (int i = 0; i < 2'000; ++i) {
        const Side side = i % 2 ? Side::work : Side::tool;
        std::vector<Record> records(1 + rng() % 5);
        for (Record& r : records) r = hwsim::random_record(rng, i % 4 < 2 ? 20 : 3'000'000);
        const Sphere sphere = sphere_round(records, side);
        const core::Vec3 centre(sphere.centre[0], sphere.centre[1], sphere.centre[2]);
        double farthest = 0.0;
        for (const Record& record : records)
            for (const core::Vec3& p : outermost(record, side))
                farthest = std::max(farthest, glm::length(p - centre));
        ASSERT_LE(farthest, sphere.radius + 1e-6);
        // The rim is sampled every 5.6 degrees, and roots are rounded up twice.
        ASSERT_GE(farthest * (side == Side::work ? 1.0 : 1.0013) + 2.0, sphere.radius);
    }
}

TEST(SphereStretch, HoldsEverySample) {
    std::mt19937 rng(5);
    for (int i = 0; i < 2'000; ++i) {
        hwsim::Scene scene = hwsim::scene_of({{}}, {{}}, {}, 1);
        scene.query.segment =
            hwsim::random_segment(rng, i % 2 ? 30 : 1'000'000, static_cast<uint8_t>(rng() % 8));
        SphereTable table(scene.memory.size());
        const SphereRules rules(scene.memory, table, scene.query);
        const uint32_t count = (1U << scene.query.segment.log2_steps) + 1;
        const uint32_t first = rng() % count, last = first + rng() % (count - first);
        const Sphere stretch = rules.stretch(first, last);
        for (uint32_t k = first; k <= last; ++k) {
            const hwsim::FixedVec at = hwsim::offset_at(scene.query.segment, k);
            int64_t square = 0;
            for (size_t axis = 0; axis < 3; ++axis) {
                const int64_t apart = int64_t{at[axis]} - stretch.centre[axis];
                square += apart * apart;
            }
            ASSERT_LE(square, int64_t{stretch.radius} * stretch.radius);
        }
    }
}

} // namespace
} // namespace bench
