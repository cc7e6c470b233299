// A device whose nodes hold the spheres of the paper.
#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"
#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"
#include "hwsim/search.h"
#include "hwsim/tool_model.h"
#include "tests/hwsim/random_models.h"
#include "tests/hwsim/test_device.h"
#include "tests/support/stock_oracle.h"

namespace hwsim {
namespace {

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

double reach_of(const Volume& sphere, const Record& record, Side side) {
    const core::Vec3 centre(sphere.box.min[0], sphere.box.min[1], sphere.box.min[2]);
    double farthest = 0.0;
    for (const core::Vec3& p : outermost(record, side))
        farthest = std::max(farthest, glm::length(p - centre));
    return farthest;
}

TEST(SphereRound, HoldsItsRecordsAndIsNoLargerThanItMust) {
    std::mt19937 rng(4);
    for (int i = 0; i < 2'000; ++i) {
        const Side side = i % 2 ? Side::work : Side::tool;
        std::vector<Record> records(1 + rng() % 5);
        for (Record& r : records) r = random_record(rng, i % 4 < 2 ? 20 : 3'000'000);
        const Volume sphere = sphere_round(records, side);
        ASSERT_EQ(sphere.box.min, sphere.box.max);
        double farthest = 0.0;
        for (const Record& record : records)
            farthest = std::max(farthest, reach_of(sphere, record, side));
        ASSERT_LE(farthest, sphere.radius + 1e-6);
        // The rim is sampled every 5.6 degrees, and roots are rounded up twice.
        ASSERT_GE(farthest * (side == Side::work ? 1.0 : 1.0013) + 2.0, sphere.radius);
    }
}

TEST(SphereTest, IsNeverMoreThanTheDistanceOfWhatIsInside) {
    std::mt19937 rng(3);
    int apart = 0, touching = 0;
    for (int i = 0; i < 200'000; ++i) {
        const int32_t reach = i % 2 ? 6 : 100'000;
        const Record tool = random_record(rng, reach), work = random_record(rng, reach);
        const Segment s = random_segment(rng, 2 * reach, 3);
        const uint32_t first = rng() % 5, last = first + rng() % 4;
        const auto gap =
            squared_gap_of_spheres(sphere_round({&tool, 1}, Side::tool), offset_at(s, first),
                                   offset_at(s, last), sphere_round({&work, 1}, Side::work));
        ASSERT_TRUE(gap);
        for (uint32_t k = first; k <= last; ++k)
            ASSERT_LE(*gap, squared_distance(tool, offset_at(s, k), work));
        ++(*gap > 0 ? apart : touching);
    }
    EXPECT_GT(apart, 50'000);
    EXPECT_GT(touching, 10'000);
}

TEST(SphereTest, IsTheDistanceOfTheCentresLessBothRadiiRoundedDown) {
    const Volume tool{{{3, 0, 0}, {3, 0, 0}}, 2}, work{{{0, 0, 0}, {0, 0, 0}}, 4};
    EXPECT_EQ(squared_gap_of_spheres(tool, {0, 4, 12}, {0, 4, 12}, work), 49U); // 13 - 6
    EXPECT_EQ(squared_gap_of_spheres(tool, {0, 4, 11}, {0, 4, 11}, work), 36U); // 12.08 - 6
    EXPECT_EQ(squared_gap_of_spheres(tool, {0, 4, 11}, {0, 4, 99}, work), 36U);
    EXPECT_EQ(squared_gap_of_spheres(tool, {0, 0, 2}, {0, 0, 2}, work), 0U);
    EXPECT_FALSE(squared_gap_of_spheres(tool, {0, 0, 0}, {0, 0, greatest_coordinate - 1}, work));
}

/// Walks through a tree; each sphere must hold the records below it.
class SphereWalk {
public:
    SphereWalk(std::span<const Line> memory, Side side) : memory_(memory), side_(side) {}

    std::vector<Record> visit(Reference reference) {
        std::vector<Record> records;
        if (reference.is_leaf()) {
            for (uint32_t i = 0; i < reference.count(); ++i)
                records.push_back(records_in(
                    memory_[reference.line() + i / records_per_line])[i % records_per_line]);
            return records;
        }
        const Node node = node_in(memory_[reference.line()], Volumes::spheres);
        for (size_t i = 0; i < 2; ++i) {
            if (node.child[i].is_none()) continue;
            const std::vector<Record> below = visit(node.child[i]);
            for (const Record& record : below) {
                const double outside =
                    reach_of(node.volume[i], record, side_) - node.volume[i].radius;
                EXPECT_LE(outside, 1e-6);
            }
            records.insert(records.end(), below.begin(), below.end());
            ++spheres;
        }
        return records;
    }

    int spheres = 0;

private:
    std::span<const Line> memory_;
    Side side_;
};

core::CutModel cut_stock(std::mt19937& rng) {
    const test_support::CutBox world{{{-40, -30, -10}, {40, 30, 0}}, 0.0, {}};
    core::CutModel stock = world.uncut(1.0);
    static const std::vector<core::RevolvedProfile> tools = test_support::cutters();
    for (int i = 0; i < 5; ++i) {
        const core::Vec3 from = test_support::random_point({{-40, -30, -6}, {40, 30, 0}}, rng);
        const core::Vec3 to = from + test_support::random_point({{-9, -9, -1}, {9, 9, 1}}, rng);
        core::cut(stock, {std::make_shared<core::Cutter>(
                              core::make_cutter(tools[rng() % tools.size()], 0.0)),
                          from, to});
    }
    return stock;
}

TEST(SphereTree, HoldsTheColumnsOfAStockTileByTile) {
    std::mt19937 rng(7);
    const core::CutModel stock = cut_stock(rng);
    StockModel model = stock_model(cells_of(stock), 4, Volumes::spheres);
    LineSpace space{.end = 40'000};
    const StockUpdate done = update(model, space, stock.columns).value();
    std::vector<Line> memory(40'000);
    for (const AddressedLine& line : done.lines) memory[line.address] = line.line;
    SphereWalk walk(memory, Side::work);
    EXPECT_GT(walk.visit(Reference::node(done.header)).size(), 200U);
    EXPECT_GT(walk.spheres, 100);
    // The greatest of all is no larger than half the diagonal of the stock, rounded up.
    const Volume root = node_in(memory[done.header], Volumes::spheres).volume[0];
    EXPECT_LT(length_of(root.radius), 0.5 * std::sqrt(81.0 * 81.0 + 61.0 * 61.0 + 121.0));
}

Scene with_spheres(const Scene& boxes, uint32_t leaf_size) {
    return scene_of(boxes.tools, boxes.works, boxes.query.segment, boxes.query.limit, leaf_size,
                    Volumes::spheres);
}

/// The same distance to the step, so the same permits. Of equally near pairs it may report another.
TEST(SearchBySpheres, FindsTheSameDistanceAsBoxes) {
    const std::vector<SceneKind> kinds{{},
                                       {.reach = 3, .most_records = 40},
                                       {.reach = 4 * 4096, .grid = 4096},
                                       {.reach = 5, .most_records = 80, .bare = true},
                                       {.reach = 1'500'000}};
    std::mt19937 rng(2);
    int below = 0, above = 0, zero = 0, by_other_ways = 0, out = 0;
    for (const SceneKind& kind : kinds)
        for (int i = 0; i < 1'000; ++i) {
            const Scene boxes = random_scene(rng, kind);
            const Scene scene = with_spheres(boxes, 1 + rng() % 16);
            const Answer expected = search(boxes.memory, boxes.query);
            const Answer answer = search(scene.memory, scene.query, 64, Volumes::spheres);
            if (answer.stop != Stop::none) {
                // A sphere reaches farther than what is in it.
                ASSERT_EQ(answer.stop, Stop::out_of_range);
                ASSERT_EQ(kind.reach, 1'500'000);
                ++out;
                continue;
            }
            if (expected.stop != Stop::none) {
                ASSERT_EQ(expected.stop, Stop::out_of_range);
                continue; // of boxes that spheres did not have to look at
            }
            ASSERT_EQ(answer.squared, expected.squared);
            ASSERT_EQ(answer.found, expected.found);
            ++(answer.squared == 0 ? zero : answer.found ? below : above);
            by_other_ways += answer.counts != expected.counts ? 1 : 0;
            if (!answer.found) continue;
            ASSERT_EQ(squared_distance(record_named(scene, answer.tool_record),
                                       offset_at(scene.query.segment, answer.sample),
                                       record_named(scene, answer.work_record)),
                      answer.squared);
        }
    for (const int seen : {below, above, zero}) EXPECT_GT(seen, 150);
    EXPECT_GT(by_other_ways, 2'000);
    EXPECT_GT(out, 50);
    EXPECT_LT(out, 900);
}

DeviceConfig config_with(Volumes volumes) {
    DeviceConfig config = small_config();
    config.volumes = volumes;
    config.memory_lines = 1U << 14;
    return config;
}

/// A device with a tool over a stock that is cut.
template <typename Device>
struct Job {
    Device device;
    Driver driver;
    SlotNumber tool{}, work{};

    Job(const Device& made, const core::CutModel& stock)
        : device(made), driver(open_device(port_of(device)).value()) {
        tool = load_tool(driver, {{{0, 3, 20, 3, 0}, {20, 10, 40, 10, 0}}}).value();
        work = load_stock(driver, stock).value();
    }
    PathSegment segment(const core::Vec3& from, const core::Vec3& to, double keep) const {
        return {from, to, {{tool, work, keep}}};
    }
    uint64_t squared(const PathSegment& segment) {
        const auto found = measure(driver, segment).value();
        return found ? found->squared : beyond_all_squares;
    }
    bool permits(const PathSegment& segment) {
        push(driver, segment).value();
        const bool is_permitted = wait_for_all(driver).stop == Stop::none;
        recover(driver);
        return is_permitted;
    }
};

/// The emulator, the functional model, and one with boxes give the same answers while the stock is
/// cut, and the emulator and the functional model do the same work.
TEST(DeviceWithSpheres, AnswersAsTheOneWithBoxes) {
    std::mt19937 rng(11);
    core::CutModel stock = cut_stock(rng);
    Job emulated(emulated_device(config_with(Volumes::spheres)).value(), stock);
    Job functional(functional_device(config_with(Volumes::spheres)).value(), stock);
    Job boxes(functional_device(config_with(Volumes::boxes)).value(), stock);
    int permitted = 0, refused = 0;
    for (int i = 0; i < 60; ++i) {
        const core::Vec3 from = test_support::random_point({{-45, -35, -3}, {45, 35, 6}}, rng);
        const core::Vec3 to = from + test_support::random_point({{-4, -4, -1}, {4, 4, 1}}, rng);
        const PathSegment path = boxes.segment(from, to, 0.0);
        const uint64_t squared = boxes.squared(path);
        ASSERT_EQ(functional.squared(path), squared) << i;
        ASSERT_EQ(emulated.squared(path), squared) << i;
        ASSERT_EQ(emulated.device.state.searched, functional.device.state.searched) << i;
        const PathSegment kept = boxes.segment(from, to, 1.0);
        const bool is_permitted = boxes.permits(kept);
        ASSERT_EQ(functional.permits(kept), is_permitted) << i;
        ASSERT_EQ(emulated.permits(kept), is_permitted) << i;
        ++(is_permitted ? permitted : refused);
        if (i % 10 != 0) continue;
        core::cut(stock,
                  {std::make_shared<core::Cutter>(core::make_cutter({{{0, 3, 20, 3, 0}}}, 0.0)),
                   from, to});
        for (Driver* driver : {&emulated.driver, &functional.driver, &boxes.driver})
            update_stock(*driver, boxes.work, stock).value();
    }
    EXPECT_GT(permitted, 5);
    EXPECT_GT(refused, 5);
}

} // namespace
} // namespace hwsim
