#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/check/setup_sheet.h"
#include "app/setup/setup_document.h"
#include "app/view/model/placing.h"
#include "app/view/model/view_model.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;
using core::Vec3;
using testing::HasSubstr;

constexpr double same = 2e-6; // mm: numbers in a set-up are rounded to 1e-6

/// A window with a program and a set-up, without a worker: reopen() does what that would do.
class Job {
public:
    explicit Job(const std::string& setup) {
        job_.program = folder_.write("p.nc", "G21 G90 G54\nT1 M6\nS8000 M3\nG43 H1 Z5\nG0 X0 Y0\n"
                                             "G1 Z-3 F200\nX40\nG0 Z5\nM30\n");
        open_document(model, app::SetupDocument(folder_ / "p.toml", setup));
        reopen();
        begin_picking(model, PickGoal::none);
    }

    ViewModel model;

    void reopen() {
        job_.setup_text = model.workspace.document.text();
        const auto check = app::read_check(job_);
        ASSERT_TRUE(check) << check.error().message << "\n" << *job_.setup_text;
        model.program = std::make_shared<const OpenedProgram>(opened_program(job_, *check));
        machine_from_stock_ = model.program->sheet->frames.at("machine").inverse();
    }
    /// After an edit that must succeed.
    void expect(bool is_done) {
        EXPECT_TRUE(is_done) << model.workspace.refusal;
        reopen();
    }
    core::Aabb box(const std::string& body) const { return bounds_of_body(model, body); }
    /// The box of a body in the frame of a work offset.
    core::Aabb box_in(const std::string& frame, const std::string& body) const {
        const core::Transform to = model.program->sheet->frames.at(frame).inverse();
        const core::Aabb in_scene = box(body);
        return {to * in_scene.min, to * in_scene.max};
    }
    Vec3 on_machine(const Vec3& in_scene) const { return machine_from_stock_ * in_scene; }

private:
    test_support::ScopedFolder folder_;
    app::CheckJob job_;
    core::Transform machine_from_stock_;
};

void expect_near(const Vec3& a, const Vec3& b, const std::string& what = {}) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], same) << what << axis;
}

void expect_near(const core::Aabb& a, const core::Aabb& b, const std::string& what = {}) {
    expect_near(a.min, b.min, what);
    expect_near(a.max, b.max, what);
}

const std::string stock = "[stock]\nbox = [[-45, -30, -25], [45, 30, 0]]\n";
const std::string vise =
    stock
    + "[[fixture]]\nname = \"vise\"\nbox = [[-80, -300, -60], [80, 80, 0]] # bed\nat = [0, 60, "
      "-40]\n[[fixture]]\nname = \"fixed\"\nbox = [[-70, 0, 0], [70, 40, 45]]\nframe = \"vise\"\n"
      "[[fixture]]\nname = \"jaw\"\nbox = [[-70, -50, 0], [70, 0, 45]]\nat = [0, -170, 0]\nframe = "
      "\"vise\"\n";

core::FeaturePick corner_at(const Vec3& point) {
    return {.kind = core::FeatureKind::corner, .point = point};
}

TEST(Placing, ClosesTheJawsOfAVise) {
    Job job(vise);
    job.expect(slide_to_contact(job.model, "vise", {0, 0, 1})); // the bed under the stock
    EXPECT_NEAR(job.box("vise").max.z, -25.0, same);
    job.expect(slide_to_contact(job.model, "vise", {0, -1, 0})); // with the fixed jaw on it
    EXPECT_NEAR(job.box("fixed").min.y, 30.0, same);
    job.expect(slide_to_contact(job.model, "jaw", {0, 1, 0}));
    EXPECT_NEAR(job.box("jaw").max.y, -30.0, same);
    EXPECT_THAT(job.model.workspace.document.text(),
                HasSubstr("at = [0, -60, 0]\nframe = \"vise\""));
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("# bed"));
    for (int i = 0; i < 3; ++i) undo(job.model, 0.0);
    EXPECT_EQ(job.model.workspace.document.text(), vise);
    EXPECT_FALSE(slide_to_contact(job.model, "jaw", {0, -1, 0}));
    EXPECT_THAT(job.model.workspace.refusal, HasSubstr("Nothing is in the way"));
}

TEST(Placing, MovesAFixtureByHandOnlyWhereTheSetupPutsIt) {
    Job job(
        stock
        + "[[fixture]]\nname = \"post\"\nbox = [[60, 0, 0], [70, 9, 9]]\n[[fixture.move]]\nline = "
          "7\nat = [5, 0, 0]\n");
    EXPECT_TRUE(can_move(job.model, "post"));
    const core::Aabb before = job.box("post");
    auto state = std::make_shared<BlockState>();
    state->scene = job.model.program->scene;
    state->mounted_fixtures = {false, true};
    job.model.block_state = state;
    EXPECT_FALSE(can_move(job.model, "post"));
    EXPECT_FALSE(move_body(job.model, "post", core::translation({1, 0, 0}), "Move"));
    expect_near(job.box("post").min, before.min + Vec3(5, 0, 0)); // it is seen where it is
    state = std::make_shared<BlockState>(*state);
    state->mounted_fixtures = {true, false};
    job.model.block_state = state;
    EXPECT_TRUE(can_move(job.model, "post"));
}

TEST(Placing, TurnsAndMovesAStockOfAnyShape) {
    const std::string offsets = "[offsets]\nG54 = { X = -300, Y = -200, Z = -400 }\n";
    for (const char* shape :
         {"", "[stock]\nbox = [[-45, -30, -25], [45, 30, 0]] # sawn\n",
          "[stock]\nbox = [[0, 0, 0], [90, 60, 25]]\nat = [5, 6, 7]\n"
          "rotate_deg = [0, 0, 30]\n",
          "[stock]\ncylinder = { radius = 20, height = 30 }\nat = [1, 2, -30]\n"}) {
        Job job(offsets + shape);
        const core::Aabb before = job.box("stock");
        job.expect(move_body(job.model, "stock", core::translation({10, 20, -5}), "Move"));
        const core::Aabb moved = job.box_in("machine", "stock");
        expect_near(job.box("stock").size(), before.size(), shape);
        if (std::string_view(shape).find("cylinder") != std::string_view::npos) continue;
        const core::Transform turn{core::rotation_xyz_deg({0, 0, 90}), {}};
        job.expect(move_body(job.model, "stock", turn, "Turn"));
        job.expect(move_body(job.model, "stock", turn.inverse(), "Turn back"));
        expect_near(job.box_in("machine", "stock"), moved, shape);
        EXPECT_EQ(job.model.workspace.refusal, "");
    }
}

TEST(Placing, MeasuresOnlyInAViewOfTheSetupAsItIs) {
    Job job(vise);
    edit_setup(job.model, "Spoil it",
               [](const std::string& t) { return "mesh_size = \"fine\"\n" + t; });
    EXPECT_FALSE(slide_to_contact(job.model, "vise", {0, 0, 1}));
    EXPECT_THAT(job.model.workspace.refusal, HasSubstr("does not show the last edit"));
}

TEST(Placing, KeepsABodyWhereItIsWhenItsFrameChanges) {
    Job job("[offsets]\nG54 = { X = -300, Y = -200, Z = -400 }\n" + stock
            + "[[fixture]]\nname = \"base\"\nbox = [[0, 0, 0], [50, 40, 30]]\nat = [80, 10, -40]\n"
              "rotate_deg = [0, 0, 30]\n[[fixture]]\nname = \"clamp\"\nbox = [[0, 0, 0], [9, 8, "
              "7]]\nat = [100, 5, 3]\nrotate_deg = [10, 20, -70]\n");
    const core::Aabb before = job.box("clamp");
    const auto frame_is = [&](const char* frame) {
        job.expect(change_frame(job.model, "clamp", frame));
        EXPECT_THAT(job.model.workspace.document.text(),
                    HasSubstr(fmt::format("frame = \"{}\"", frame)));
        expect_near(job.box("clamp"), before, frame);
    };
    for (const char* frame : {"machine", "stock", "G54"}) frame_is(frame);
    undo(job.model, 0.0);
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("frame = \"stock\"")) << "one edit";
    job.reopen();
    frame_is("base");
    job.expect(slide_to_contact(job.model, "base", {-1, 0, 0}));
    EXPECT_LT(job.box("clamp").min.x, before.min.x - 1.0) << "now it goes with the base";
}

/// Positions in inches are rounded to 1e-8: finer than those in mm, and far below 1e-6 mm.
TEST(Placing, WritesInchesInASetupInInches) {
    const std::string setup =
        "length_unit = \"inch\"\n[offsets]\nG54 = { X = -14, Y = -8, Z = -16.5 }\n[stock]\n"
        "box = [[-2, -1.25, -1], [2, 1.25, 0]]\n[[fixture]]\nname = \"vise\"\n"
        "box = [[-3, -12, -2.5], [3, 3, 0]] # bed\nat = [0, 2.5, -1.75]\n"
        "[[fixture]]\nname = \"jaw\"\nbox = [[-3, -2, 0], [3, 0, 1.5]]\nat = [0, -7, 0]\n"
        "frame = \"vise\"\n";
    Job job(setup);
    const std::string& text = job.model.workspace.document.text();
    constexpr double touching = 2e-7; // mm
    job.expect(slide_to_contact(job.model, "vise", {0, 0, 1}));
    EXPECT_NEAR(job.box("vise").max.z, -25.4, touching);
    EXPECT_THAT(text, HasSubstr("at = [0, 2.5, -1]"));
    job.expect(slide_to_contact(job.model, "jaw", {0, 1, 0}));
    EXPECT_NEAR(job.box("jaw").max.y, -31.75, touching);
    EXPECT_THAT(text, HasSubstr("at = [0, -3.75, 0]\nframe = \"vise\""));
    job.expect(move_body(job.model, "jaw", core::translation({0, 0, 10}), "Move"));
    EXPECT_THAT(text, HasSubstr("at = [0, -3.75, 0.39370079]"));
    EXPECT_NEAR(job.box("jaw").min.z, -15.4, touching);
    job.expect(set_zero(job.model, "G54", corner_at(job.box("stock").min)));
    EXPECT_THAT(text, HasSubstr("G54 = { X = -16, Y = -9.25, Z = -17.5 }"));
    EXPECT_THAT(text, HasSubstr("[stock]\nbox = [[0, 0, 0], [4, 2.5, 1]]"));
    job.expect(move_body(job.model, "stock", core::translation({12.7, 0, 0}), "Move"));
    EXPECT_THAT(text, HasSubstr("box = [[0.5, 0, 0], [4.5, 2.5, 1]]"));
    for (int i = 0; i < 5; ++i) undo(job.model, 0.0);
    EXPECT_EQ(text, setup);
}

/// A jaw of any size that was slid to a stock of any size touches it.
TEST(Placing, TouchesWithin1e6MmInInches) {
    std::mt19937 random(17);
    const auto number = [&](double least, double most) {
        return least + (most - least) * static_cast<double>(random() % 1000003) / 1000003.0;
    };
    for (int round = 0; round < 40; ++round) {
        Job job(fmt::format("length_unit = \"inch\"\n[stock]\nbox = [[0, 0, -1], [{}, 3, 0]]\n"
                            "[[fixture]]\nname = \"jaw\"\nbox = [[0, 0, -1], [{}, 2, 0.5]]\n"
                            "at = [{}, 0, 0]\n",
                            number(1, 9), number(1, 4), number(12, 40)));
        job.expect(slide_to_contact(job.model, "jaw", {-1, 0, 0}));
        EXPECT_NEAR(job.box("jaw").min.x, job.box("stock").max.x, 1e-6);
    }
}

TEST(Placing, MovesBodiesInTurnedFrames) {
    std::mt19937 random(7);
    const auto number = [&](double most) {
        return most * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
    };
    for (int round = 0; round < 60; ++round) {
        const auto vector = [&](double most) {
            return fmt::format("[{}, {}, {}]", number(most), number(most), number(most));
        };
        Job job("[stock]\nmesh = \"" FEELER_SOURCE_DIR "/assets/meshes/blank.stl\"\nat = "
                + vector(50) + "\nrotate_deg = " + vector(180)
                + "\n[[fixture]]\nname = \"base\"\nbox = [[0, 0, 0], [50, 40, 30]]\nat = "
                + vector(200) + "\nrotate_deg = " + vector(180)
                + "\nframe = \"stock\"\n[[fixture]]\nname = \"arm\"\nbox = [[0, 0, 0], [5, 6, "
                  "70]]\nat = "
                + vector(60) + "\nrotate_deg = " + vector(180) + "\nframe = \"base\"\n");
        EXPECT_EQ(moved_with(job.model, "base"), (std::vector<std::string>{"base", "arm"}));
        const core::Transform by{core::rotation_xyz_deg({number(180), number(180), number(180)}),
                                 {number(300), number(300), number(300)}};
        const auto points_of = [&](const std::string& name) {
            std::vector<Vec3> points;
            for (const SceneFace& face : faces_of(job.model, name))
                points.push_back(face.plane.point);
            return points;
        };
        const std::string moved = round % 2 == 0 ? "base" : "arm";
        const std::vector<Vec3> base = points_of("base"), arm = points_of("arm");
        ASSERT_EQ(base.size(), 6u);
        job.expect(move_body(job.model, moved, by, "Move"));
        const std::vector<Vec3> base_after = points_of("base"), arm_after = points_of("arm");
        const auto distance_to = [](const std::vector<Vec3>& points, const Vec3& wanted) {
            double nearest = core::infinity;
            for (const Vec3& point : points)
                nearest = std::min(nearest, glm::distance(point, wanted));
            return nearest;
        };
        for (const Vec3& point : base)
            EXPECT_LT(distance_to(base_after, moved == "base" ? by * point : point), 3e-5) << round;
        for (const Vec3& point : arm)
            EXPECT_LT(distance_to(arm_after, by * point), 3e-5)
                << round << ": what is in the frame of a body goes with it";
    }
}

TEST(Placing, PutsFacesTogether) {
    Job job(stock
            + "[[fixture]]\nname = \"block\"\nbox = [[0, 0, 0], [20, 30, 40]]\nat = [200, 0, "
              "0]\n");
    const auto face = [&](const std::string& body, const Vec3& normal) {
        for (const SceneFace& one : faces_of(job.model, body))
            if (glm::distance(one.plane.normal, normal) < 1e-9) return one.plane;
        ADD_FAILURE() << "no such face of " << body;
        return core::FacePlane{};
    };
    EXPECT_EQ(faces_of(job.model, "stock").front().name, "\xE2\x88\x92Z  90.00 x 60.00 at 25.00");
    job.expect(
        put_face_to_face(job.model, "block", face("block", {-1, 0, 0}), face("stock", {1, 0, 0})));
    expect_near(job.box("block"), {{45, 0, 0}, {65, 30, 40}}, "moves across the face only");
    job.model.placing.centred = true;
    job.expect(
        put_face_to_face(job.model, "block", face("block", {0, 0, -1}), face("stock", {0, 0, 1})));
    expect_near(job.box("block"), {{-10, -15, 0}, {10, 15, 40}});
    job.model.placing.centred = false;
    job.model.placing.flush = true;
    job.expect(
        put_face_to_face(job.model, "block", face("block", {0, 0, 1}), face("stock", {0, 0, 1})));
    EXPECT_NEAR(job.box("block").max.z, 0.0, same);
    job.model.placing.flush = false;
    job.expect(
        put_face_to_face(job.model, "block", face("block", {0, 0, 1}), face("stock", {1, 0, 0})));
    EXPECT_NEAR(job.box("block").min.x, 45.0, same) << "it was turned";
    EXPECT_NEAR(job.box("block").size().x, 40.0, same);
    job.expect(
        put_face_to_face(job.model, "stock", face("stock", {0, 0, 1}), face("block", {1, 0, 0})));
    EXPECT_NEAR(job.box("stock").min.x, job.box("block").max.x, same) << "the stock is turned";
}

TEST(Placing, CentresBetweenFaces) {
    Job job(vise + "[[fixture]]\nname = \"bar\"\nbox = [[0, 0, 0], [9, 10, 20]]\nat = [3, 4, 5]\n");
    const core::FacePlane a{{0, -110, 0}, {0, 1, 0}}, b{{0, 60, 0}, {0, -1, 0}};
    const core::Aabb before = job.box("bar");
    job.expect(centre_between(job.model, "bar", a, b));
    expect_near(job.box("bar").min, {before.min.x, -30, before.min.z});
    EXPECT_FALSE(centre_between(job.model, "bar", a, {{0, 0, 0}, {1, 0, 0}}));
}

TEST(Placing, SetsAZeroWithoutMovingBodiesOnTheMachine) {
    Job job("[offsets]\nG54 = { X = -350, Y = -200, Z = -420 }\nG55 = { X = -100 }\n" + vise
            + "[[fixture]]\nname = \"other\"\nbox = [[0, 0, 0], [9, 9, 9]]\nframe = \"G55\"\n"
              "[[fixture]]\nname = \"table\"\nbox = [[0, 0, 0], [9, 9, 9]]\nframe = \"machine\"\n");
    const std::vector<std::string> names = {"stock", "vise", "fixed", "jaw", "other", "table"};
    std::vector<Vec3> before;
    for (const std::string& name : names) before.push_back(job.on_machine(job.box(name).min));
    job.expect(set_zero(job.model, "G54", corner_at(job.box("stock").min)));
    for (size_t i = 0; i < names.size(); ++i)
        expect_near(job.on_machine(job.box(names[i]).min), before[i], names[i]);
    expect_near(job.box_in("G54", "stock").min, Vec3(0.0));
    EXPECT_THAT(job.model.workspace.document.text(),
                HasSubstr("G54 = { X = -395, Y = -230, Z = -445 }"));
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("G55 = { X = -100 }"));
}

TEST(Placing, SetsAZeroOfWhichThePlaceOnTheMachineIsNotKnown) {
    Job job(vise);
    const Vec3 apart = job.box("jaw").min - job.box("stock").min;
    job.expect(set_zero(job.model, "G54", corner_at(job.box("stock").max)));
    expect_near(job.box_in("G54", "stock"), {{-90, -60, -25}, {0, 0, 0}});
    expect_near(job.box("jaw").min - job.box("stock").min, apart);
    EXPECT_EQ(job.model.workspace.document.text().find("[offsets]"), std::string::npos);
    EXPECT_THAT(job.model.workspace.document.text(), HasSubstr("frame = \"vise\"\n"));
}

TEST(Placing, AFeatureSetsTheAxesThatAProbeWouldFind) {
    const auto axes = [](core::FeatureKind kind, const Vec3& direction) {
        const ZeroAxes zero = zero_axes({.kind = kind, .direction = direction});
        std::string text;
        for (int axis = 0; axis < 3; ++axis)
            if (zero.axes[axis]) text += "XYZ"[axis];
        return text;
    };
    EXPECT_EQ(axes(core::FeatureKind::corner, Vec3(0.0)), "XYZ");
    EXPECT_EQ(axes(core::FeatureKind::face, {0, 0, 1}), "Z");
    EXPECT_EQ(axes(core::FeatureKind::face, {-1, 0, 0}), "X");
    EXPECT_EQ(axes(core::FeatureKind::face, glm::normalize(Vec3(1, 1, 0))), "");
    EXPECT_EQ(axes(core::FeatureKind::edge, {0, 0, 1}), "XY");
    EXPECT_EQ(axes(core::FeatureKind::wall, {0, 0, -1}), "XY");
    EXPECT_EQ(axes(core::FeatureKind::circle, {0, 1, 0}), "XZ");
    Job job(vise);
    job.expect(
        set_zero(job.model, "G54",
                 {.kind = core::FeatureKind::face, .point = {7, 8, -25}, .direction = {0, 0, 1}}));
    expect_near(job.box_in("G54", "stock").min, {-45, -30, 0});
    EXPECT_FALSE(
        set_zero(job.model, "G54",
                 {.kind = core::FeatureKind::edge, .direction = glm::normalize(Vec3(1, 1, 0))}));
    EXPECT_THAT(job.model.workspace.refusal, HasSubstr("oblique"));
}

TEST(Placing, TakesClicksStepByStep) {
    Job job(vise);
    ViewModel& model = job.model;
    model.placing.body = "vise";
    begin_picking(model, PickGoal::own_face);
    EXPECT_THAT(pick_hint(model), HasSubstr("face of vise"));
    EXPECT_TRUE(picks_at(model, "stock", {0, 0, 0}, 1.0).empty()) << "not its own face";
    const auto own = picks_at(model, "fixed", {0, 60, -20}, 1.0); // what stands on it counts
    ASSERT_FALSE(own.empty());
    EXPECT_EQ(words_of(model, own[0].feature), "face \xE2\x88\x92Y");
    EXPECT_EQ(outline_of(model, own[0]).at(0).size(), 5u);
    take_pick(model, own[0], 0.0);
    EXPECT_EQ(model.placing.goal, PickGoal::other_face);
    EXPECT_TRUE(picks_at(model, "jaw", {0, -110, -20}, 1.0).empty()) << "it would go with it";
    const auto other = picks_at(model, "stock", {0, 30, -10}, 1.0);
    ASSERT_FALSE(other.empty());
    take_pick(model, other[0], 0.0);
    EXPECT_EQ(model.placing.goal, PickGoal::none);
    job.reopen();
    EXPECT_NEAR(job.box("fixed").min.y, 30.0, same);

    model.placing.offset = "G54";
    begin_picking(model, PickGoal::zero);
    const auto corner = picks_at(model, "stock", {45, 30, -0.1}, 2.0);
    ASSERT_FALSE(corner.empty());
    EXPECT_EQ(words_of(model, corner[0].feature), "corner");
    take_pick(model, corner[0], 0.0);
    job.reopen();
    expect_near(job.box_in("G54", "stock").max, Vec3(0.0));
}

} // namespace
