#include <random>

#include <gtest/gtest.h>

#include "app/view/model/scene_of.h"
#include "app/view/model/section.h"
#include "render/picking.h"
#include "tests/viewer/rows.h"

namespace viewer_test {
namespace {

using namespace app::viewer;
using core::Vec3;

/// A block whose stock fills a box.
std::shared_ptr<const BlockState> state_with_stock(const core::Aabb& box) {
    auto brick = std::make_shared<render::StockBrick>();
    brick->mesh.bounds = box;
    auto state = std::make_shared<BlockState>();
    state->scene = make_scene_setup({});
    state->stock = {brick};
    return state;
}

ViewModel with_stock(const core::Aabb& box) {
    ViewModel model = model_of({row_with(5.0)});
    model.block_state = state_with_stock(box);
    return model;
}

const core::Aabb plate{{-40, -20, -10}, {60, 30, 5}};

/// The fraction of the stock that the section leaves, along its normal.
double rest_of(const ViewModel& model, const core::Aabb& box) {
    const render::SectionPlane& plane = model.section->plane;
    const double middle = glm::dot(plane.normal, box.center());
    const double reach = glm::dot(glm::abs(plane.normal), 0.5 * box.size());
    return (plane.offset - (middle - reach)) / (2.0 * reach);
}

TEST(Section, CutsTheHalfOnTheSideOfTheEye) {
    ViewModel model = with_stock(plate);
    model.camera.target = plate.center();
    for (const render::StandardView view :
         {render::StandardView::front, render::StandardView::back, render::StandardView::left,
          render::StandardView::right}) {
        model.section.reset();
        model.camera = render::seen_from(model.camera, view);
        ASSERT_TRUE(open_section(model));
        EXPECT_GT(glm::dot(model.section->plane.normal, render::axes(model.camera).backward), 0.99);
    }
}

TEST(Section, NeverTakesTheWholeStockAway) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-400.0, 400.0);
    ViewModel model = with_stock(plate);
    for (int i = 0; i < 500; ++i) {
        // The closest pair is anywhere, also far from the stock.
        model.rows[0].on_tool = model.rows[0].on_body = Vec3(place(random), place(random), 0);
        model.camera.yaw = place(random);
        model.section.reset();
        ASSERT_TRUE(open_section(model));
        EXPECT_GE(rest_of(model, plate), 0.2 - 1e-9);
        EXPECT_LE(rest_of(model, plate), 0.8 + 1e-9);
        set_section_axis(model, SectionAxis::z);
        set_section_position(model, place(random));
        EXPECT_GE(rest_of(model, plate), 0.02 - 1e-9);
        flip_section(model);
        EXPECT_GE(rest_of(model, plate), 0.02 - 1e-9);
        set_section_plane(model, Vec3(place(random), place(random), place(random)),
                          Vec3(place(random), place(random), place(random)));
        EXPECT_GE(rest_of(model, plate), 0.02 - 1e-9);
        EXPECT_NEAR(glm::length(model.section->plane.normal), 1.0, 1e-12);
        set_section_position(model, place(random));
        EXPECT_GE(rest_of(model, plate), 0.02 - 1e-9);
    }
}

TEST(Section, GoesThroughTheClosestPairIfItIsWithinTheStock) {
    ViewModel model = with_stock(plate);
    model.rows[0].on_tool = model.rows[0].on_body = Vec3(12, 8, 5);
    model.camera = render::seen_from(model.camera, render::StandardView::right);
    ASSERT_TRUE(open_section(model));
    EXPECT_EQ(model.section->axis, SectionAxis::x);
    EXPECT_NEAR(section_position(model), 12.0, 1e-9);
}

TEST(Section, PositionsCountAlongTheAxisOnBothSides) {
    ViewModel model = with_stock(plate);
    model.camera = render::seen_from(model.camera, render::StandardView::left);
    ASSERT_TRUE(open_section(model));
    ASSERT_EQ(model.section->axis, SectionAxis::x);
    EXPECT_TRUE(model.section->is_flipped());
    set_section_position(model, 10.0);
    EXPECT_EQ(section_position(model), 10.0);
    EXPECT_EQ(model.section->plane.offset, -10.0);
    flip_section(model);
    EXPECT_FALSE(model.section->is_flipped());
    EXPECT_EQ(section_position(model), 10.0);
    EXPECT_EQ(model.section->plane.offset, 10.0);
}

TEST(Section, RangeEndsWhereSomeStockIsLeft) {
    ViewModel model = with_stock(plate);
    model.camera = render::seen_from(model.camera, render::StandardView::right);
    ASSERT_TRUE(open_section(model));
    EXPECT_NEAR(section_range(model).least, -38.0, 1e-9);
    EXPECT_NEAR(section_range(model).most, 60.0, 1e-9);
    flip_section(model);
    EXPECT_NEAR(section_range(model).least, -40.0, 1e-9);
    EXPECT_NEAR(section_range(model).most, 58.0, 1e-9);
    set_section_position(model, std::nan(""));
    EXPECT_TRUE(std::isfinite(section_position(model)));
}

TEST(Section, StepsAreRoundInTheUnitOfTheWindow) {
    ViewModel model = with_stock(plate);
    model.camera = render::seen_from(model.camera, render::StandardView::right);
    ASSERT_TRUE(open_section(model));
    EXPECT_NEAR(section_step(model), 0.5, 1e-12); // of 100 mm
    model.settings.inch = true;
    EXPECT_NEAR(section_step(model), 0.02 * 25.4, 1e-12);
}

TEST(Section, IsParallelToAFaceThatIsClicked) {
    ViewModel model = with_stock(plate);
    ASSERT_TRUE(open_section(model));
    EXPECT_FALSE(take_section_click(model, {}, 0.0));
    pick_section(model, SectionPick::face);
    EXPECT_TRUE(take_section_click(model, {1.0, {0, 0, 5}, glm::normalize(Vec3(0, 1, 1))}, 0.0));
    EXPECT_EQ(model.section->pick, SectionPick::none);
    EXPECT_EQ(model.section->axis, SectionAxis::any);
    EXPECT_NEAR(section_position(model), 0.0, 1e-9);
    set_section_position(model, -3.0);
    EXPECT_NEAR(model.section->plane.offset, 5.0 / std::sqrt(2.0) - 3.0, 1e-9);
}

TEST(Section, GoesThroughThreePointsThatAreNotOnOneLine) {
    ViewModel model = with_stock(plate);
    ASSERT_TRUE(open_section(model));
    pick_section(model, SectionPick::points);
    for (const Vec3& point : {Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(20, 0, 0)})
        EXPECT_TRUE(take_section_click(model, {1.0, point, {0, 0, 1}}, 0.0));
    EXPECT_EQ(model.section->picked.size(), 2u);
    EXPECT_FALSE(model.message.empty());
    EXPECT_EQ(scene_of(model).measured.size(), 2u); // they are marked in the view
    EXPECT_TRUE(take_section_click(model, {1.0, {0, 5, 5}, {0, 0, 1}}, 0.0));
    EXPECT_EQ(model.section->axis, SectionAxis::any);
    for (const Vec3& point : {Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(0, 5, 5)})
        EXPECT_NEAR(glm::dot(model.section->plane.normal, point), model.section->plane.offset,
                    1e-9);
    pick_section(model, SectionPick::face);
    pick_section(model, SectionPick::face); // again: ends it
    EXPECT_EQ(model.section->pick, SectionPick::none);
}

TEST(Section, HasNothingToCutWithoutAProgram) {
    ViewModel model;
    EXPECT_FALSE(open_section(model));
    EXPECT_FALSE(model.section);
    flip_section(model);
    set_section_position(model, 1.0);
    set_section_axis(model, SectionAxis::x);
    pick_section(model, SectionPick::face);
    EXPECT_FALSE(model.section);
    EXPECT_EQ(section_position(model), 0.0);
}

TEST(SceneOf, MarksBothBodiesOfAPairOnlyIfItIsTooClose) {
    ViewModel model = with_stock(plate);
    model.rows[0].part = "holder";
    model.rows[0].body = "stock";
    EXPECT_EQ(scene_of(model).stock_side, render::PairSide::none);
    model.rows[0] = row_with(0.5);
    model.rows[0].part = "holder";
    model.rows[0].body = "stock";
    EXPECT_EQ(scene_of(model).stock_side, render::PairSide::body);
}

TEST(SceneOf, DrawsAMeasuredOverlapAsLongAsItIsDeep) {
    ViewModel model = with_stock(plate);
    BlockRow& row = model.rows[0];
    row.verdict = core::Verdict::collision;
    row.on_tool = row.on_body = Vec3(1, 2, 3);
    row.overlap = core::Overlap{2.9, 3.0, {0, 0, 1}};
    const auto witness = scene_of(model).witness;
    ASSERT_TRUE(witness);
    EXPECT_TRUE(witness->is_depth);
    EXPECT_NEAR(glm::distance(witness->a, witness->b), 3.0, 1e-12);
    row.overlap->most.reset(); // no way out was found
    EXPECT_FALSE(scene_of(model).witness->is_depth);
}

TEST(SceneOf, TellsIntendedContactFromACrash) {
    ViewModel model = with_stock(plate);
    BlockRow& row = model.rows[0];
    row.lower = row.upper = row.allowance = 0.0;
    row.verdict = core::Verdict::clear;
    ASSERT_TRUE(scene_of(model).witness);
    EXPECT_TRUE(scene_of(model).witness->is_contact);
    row.verdict = core::Verdict::collision;
    EXPECT_FALSE(scene_of(model).witness->is_contact);
}

TEST(SceneOf, SeesTheWorkThroughAPartOfTheMachineInFrontOfIt) {
    core::Setup setup;
    const auto machine_box = [&](const char* name, const Vec3& low, const Vec3& high) {
        core::Fixture fixture;
        fixture.name = name;
        fixture.body = core::convex(core::Aabb{low, high});
        fixture.is_machine = true;
        setup.fixtures.push_back(fixture);
    };
    machine_box("door", {-200, -120, -100}, {200, -110, 100});
    machine_box("table", {-200, -100, -30}, {200, 100, -10});
    ViewModel model = with_stock(plate);
    auto state = std::make_shared<BlockState>(*model.block_state);
    state->scene = make_scene_setup(setup);
    state->standing = core::AxisValues{};
    model.block_state = state;
    model.camera.target = plate.center();
    const auto alphas = [&](render::StandardView view) {
        model.camera = render::seen_from(model.camera, view);
        const render::Scene scene = scene_of(model);
        return std::pair(scene.bodies.at(0).alpha, scene.bodies.at(1).alpha);
    };
    EXPECT_EQ(alphas(render::StandardView::top), std::pair(1.0, 1.0));
    EXPECT_LT(alphas(render::StandardView::front).first, 0.5);
    EXPECT_LT(alphas(render::StandardView::bottom).second, 0.5);
    const render::Scene scene = scene_of(model);
    EXPECT_EQ(scene.ground->scene_from_ground.translation.z, -10.0); // the top of the table
}

TEST(SceneOf, PutsTheGroundBelowTheWorkWithoutATable) {
    ViewModel model = with_stock(plate);
    const render::Scene scene = scene_of(model);
    ASSERT_TRUE(scene.ground);
    EXPECT_EQ(scene.ground->scene_from_ground.translation.z, -10.0);
    model.settings.inch = true;
    EXPECT_TRUE(scene_of(model).ground->inch);
    EXPECT_FALSE(scene_of(ViewModel()).ground);
    model.settings.shown.ground = false;
    EXPECT_FALSE(scene_of(model).ground);
}

TEST(ViewModel, LearnsHowDeepAPairOverlapsFromTheFindings) {
    BlockRow row = row_with(0.0);
    row.verdict = core::Verdict::collision;
    row.part = "flutes";
    row.body = "clamp";
    ViewModel model = model_of({row, row});
    SessionUpdate news;
    news.opening = model.opening;
    news.has_news = news.is_recorded = true;
    core::Finding finding;
    finding.rule = "collision";
    finding.block = core::BlockIndex(1);
    finding.pair = {"flutes", "clamp"};
    finding.overlap = core::Overlap{8.0, 8.0, {1, 0, 0}};
    core::Finding other = finding; // of another pair
    other.block = core::BlockIndex(0);
    other.pair = {"shank", "clamp"};
    news.findings = {finding, other};
    take_in(model, std::move(news), 0.0);
    EXPECT_FALSE(model.rows[0].overlap);
    ASSERT_TRUE(model.rows[1].overlap);
    EXPECT_EQ(clearance_words(model, model.rows[1]), "-8.00");
}

TEST(ViewModel, HasAnIconForTheCoprocessorOnlyOnRequest) {
    ViewModel model;
    EXPECT_FALSE(has_device(model));
    show_device(model, true);
    EXPECT_TRUE(has_device(model));
    show_device(model, false);
    EXPECT_FALSE(has_device(model));
    model.device.file = "device.toml";
    EXPECT_TRUE(has_device(model));
}

} // namespace
} // namespace viewer_test
