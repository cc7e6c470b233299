#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/distance/measurement.h"
#include "tests/support/meshes.h"

namespace core {
namespace {

using testing::HasSubstr;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const Result<MeasuredBody>& result) {
    return result ? "taken" : result.error().message;
}

SolidMesh cube_mesh(double half) {
    return solid_mesh(test_support::box_mesh(Vec3(-half), Vec3(half)));
}

RevolvedProfile rod(double radius, double height) { return {{{0.0, radius, height, radius, 0.0}}}; }

TEST(MeasuredBody, RefusesEmptyBodies) {
    EXPECT_THAT(refusal(measured_body(RevolvedProfile{}, 1.0)), HasSubstr("empty body"));
    EXPECT_THAT(refusal(measured_body(SolidMesh{}, 1.0)), HasSubstr("empty body"));
    EXPECT_THAT(refusal(measured_body(solid_mesh(Mesh{}), 1.0)), HasSubstr("empty body"));
    const Dbm lines = empty_dbm({Vec3(-5.0), Vec3(5.0)}, 1.0).value();
    EXPECT_THAT(refusal(measured_body(lines)), HasSubstr("no scan line holds matter"));
}

TEST(MeasuredBody, RefusesSizesThatAreNone) {
    for (const double size : {0.0, -1.0, not_a_number, infinity}) {
        EXPECT_FALSE(measured_body(Primitive(Sphere{size}), 1.0)) << size;
        EXPECT_FALSE(measured_body(Primitive(Box{{4.0, size, 4.0}}), 1.0)) << size;
        EXPECT_FALSE(measured_body(Primitive(Cylinder{size, 4.0}), 1.0)) << size;
        EXPECT_FALSE(measured_body(Primitive(Cylinder{4.0, size}), 1.0)) << size;
        EXPECT_FALSE(measured_body(rod(size, 4.0), 1.0)) << size;
        EXPECT_THAT(refusal(measured_body(Primitive(Sphere{5.0}), size)), HasSubstr("mesh size"))
            << size;
    }
    EXPECT_THAT(refusal(measured_body(rod(4.0, not_a_number), 1.0)), HasSubstr("piece 1"));
    EXPECT_THAT(refusal(measured_body(RevolvedProfile{{{0.0, 3.0, 5.0, 3.0, 1.0}}}, 1.0)),
                HasSubstr("piece 1"));
}

TEST(MeasuredBody, RefusesCornersOfAMeshThatAreNoPlace) {
    for (const double wrong : {not_a_number, infinity, -infinity}) {
        Mesh mesh = test_support::box_mesh(Vec3(-5.0), Vec3(5.0));
        const SolidMesh whole = solid_mesh(mesh);
        mesh.vertices[3].y = wrong;
        const SolidMesh broken{std::make_shared<const Mesh>(mesh), whole.bvh};
        EXPECT_THAT(refusal(measured_body(broken, 1.0)), HasSubstr("not finite"));
    }
}

TEST(MeasuredBody, RefusesLengthsBeyondAThousandMillionMetres) {
    EXPECT_THAT(refusal(measured_body(Primitive(Sphere{1e13}), 1e12)), HasSubstr("1e+12 mm"));
    EXPECT_THAT(refusal(measured_body(cube_mesh(1e13), 1e12)), HasSubstr("1e+12 mm"));
    EXPECT_THAT(refusal(measured_body(rod(1e13, 1.0), 1e12)), HasSubstr("1e+12 mm"));
    EXPECT_EQ(refusal(measured_body(Primitive(Sphere{1e11}), 1e10)), "taken");
}

TEST(MeasuredBody, RefusesAMeshSizeLargerThanTheBody) {
    EXPECT_THAT(refusal(measured_body(Primitive(Sphere{1.0}), 40.0)),
                HasSubstr("no scan line meets it"));
    EXPECT_THAT(refusal(measured_body(rod(1.0, 1.0), 40.0)), HasSubstr("no scan line meets it"));
    EXPECT_THAT(refusal(measured_body(cube_mesh(1.0), 40.0)), HasSubstr("no scan line meets it"));
}

TEST(MeasuredBody, SaysWhatItWouldNeedBeforeTryingToTakeTooMuchMemory) {
    const Primitive house(Box{{1e4, 1e4, 1e4}}); // at 0.001 mm: 3e14 lines
    const std::string said = refusal(measured_body(house, 0.001));
    EXPECT_THAT(said, HasSubstr("GiB of memory (the limit is 8 GiB)"));
    EXPECT_THAT(said, HasSubstr("mm would do"));
}

TEST(MeasuredBody, TakesWhatTheRefusalSaidWouldDo) {
    const double limit = 1e6;
    for (const BodyShape& shape : {BodyShape(Primitive(Box{{40.0, 30.0, 20.0}})),
                                   BodyShape(rod(20.0, 30.0)), BodyShape(cube_mesh(20.0))}) {
        const std::string said = refusal(measured_body(shape, 0.1, limit));
        const size_t at = said.rfind("; ");
        ASSERT_NE(at, std::string::npos) << said;
        const double would_do = std::stod(said.substr(at + 2));
        EXPECT_GT(would_do, 0.1);
        EXPECT_EQ(refusal(measured_body(shape, 1.01 * would_do, limit)), "taken");
        EXPECT_FALSE(measured_body(shape, 0.85 * would_do, limit));
    }
    const Dbm lines = scan(Primitive(Box{{40.0, 30.0, 20.0}}), 0.2).value();
    EXPECT_THAT(refusal(measured_body(lines, {}, limit)), HasSubstr("GiB of memory"));
}

/// A scanned box of 10 mm with its outer model.
struct ScannedBox {
    Aabb box{Vec3(-5.0), Vec3(5.0)};
    Dbm lines = scan(Primitive(Box{Vec3(10.0)}), 1.0).value();
    OuterModel outer = outer_model(box, lines.grid, columns_of(Primitive(Box{Vec3(10.0)})));
};

TEST(MeasuredBody, RefusesScanLinesThatDoNotFitTheirGrid) {
    for (const double wrong : {not_a_number, infinity, 0.0, -1.0}) {
        ScannedBox box;
        box.lines.grid.spacing = wrong;
        EXPECT_THAT(refusal(measured_body(box.lines)), HasSubstr("do not fit their grid"));
    }
    ScannedBox box;
    box.lines.grid.centre.x = not_a_number;
    EXPECT_THAT(refusal(measured_body(box.lines)), HasSubstr("do not fit their grid"));
    ScannedBox other;
    other.lines.families[1] = ScanLines(1, 2, 2);
    EXPECT_THAT(refusal(measured_body(other.lines)), HasSubstr("do not fit their grid"));
}

TEST(MeasuredBody, RefusesMatterThatEndsAtNoNumber) {
    ScannedBox box;
    box.lines.families[2].edit(3, 3) = IntervalList({-5.0, infinity});
    EXPECT_THAT(refusal(measured_body(box.lines)), HasSubstr("ends at no number"));
}

TEST(MeasuredBody, RefusesAnOuterModelThatIsNone) {
    const ScannedBox box;
    EXPECT_EQ(refusal(measured_body(box.lines, box.outer)), "taken");
    OuterModel outer = box.outer;
    outer.families.clear();
    EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("no columns"));
    outer = box.outer;
    outer.grid.spacing = 0.9;
    EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("another grid"));
    outer = box.outer;
    outer.families[1] = ScanLines(outer.families[1].axis(), 3, 3);
    EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("another grid"));
    outer = box.outer;
    outer.families[1] = outer.families[0];
    EXPECT_FALSE(measured_body(box.lines, outer)); // two families along one axis
    outer = box.outer;
    outer.box.max.y = not_a_number;
    EXPECT_FALSE(measured_body(box.lines, outer));
    outer = box.outer;
    outer.families[0].edit(4, 4) = IntervalList({-infinity, 6.0});
    EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("not finite"));
}

TEST(MeasuredBody, RefusesAnOuterModelThatDoesNotHoldTheLines) {
    const ScannedBox box;
    for (size_t family = 0; family < 3; ++family)
        for (const int u : {0, 4, box.outer.families[family].u_count() - 1})
            for (const int v : {0, 4, box.outer.families[family].v_count() - 1}) {
                OuterModel outer = box.outer;
                outer.families[family].edit(u, v) = IntervalList({-5.0, 4.9});
                EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("does not hold"));
            }
    OuterModel outer = box.outer;
    outer.box.max.x = 4.9;
    EXPECT_THAT(refusal(measured_body(box.lines, outer)), HasSubstr("does not hold"));
}

/// Two balls of 5 mm as the program has them.
class Measuring : public testing::Test {
protected:
    Result<Measurement> at(const Transform& pose, const MeasureGoal& goal = {}) {
        return measure(*engine_, ball_, ball_, pose, goal);
    }

    std::unique_ptr<DistanceEngine> engine_ = paper_engine();
    MeasuredBody ball_ =
        taken_into(*engine_, measured_body(Primitive(Sphere{5.0}), 1.0).value()).value();
};

TEST_F(Measuring, RefusesTransformsThatAreNotRigid) {
    std::vector<Mat3> turns(6, Mat3(1.0));
    turns[0] = Mat3(0.0);
    turns[1][2][2] = 0.0;
    turns[2][0][0] = -1.0;
    turns[3] = Mat3(1.001);
    turns[4][0][1] = not_a_number;
    turns[5][1][0] = 0.001;
    for (const Mat3& turn : turns)
        EXPECT_FALSE(at({turn, {20.0, 0.0, 0.0}})) << turn[0][0] << " " << turn[2][2];
    for (const double wrong : {not_a_number, infinity, 1e13})
        EXPECT_FALSE(at(translation({0.0, wrong, 0.0}))) << wrong;
    EXPECT_TRUE(at(translation({20.0, 0.0, 0.0})));
}

TEST_F(Measuring, RefusesGoalsThatAreNoLengths) {
    const Transform pose = translation({20.0, 0.0, 0.0});
    for (const double wrong : {not_a_number, -1.0}) {
        EXPECT_FALSE(at(pose, {.limit = wrong}));
        EXPECT_FALSE(at(pose, {.tolerance = wrong}));
    }
    for (const double wrong : {not_a_number, infinity, 1e13})
        EXPECT_FALSE(at(pose, {.sweep = {wrong, 0.0, 0.0}}));
}

TEST_F(Measuring, AllowsForATransformThatIsNotQuiteARotation) {
    Mat3 turn(1.0);
    turn[0][0] = 1.0 + 4e-10; // still taken
    const Measurement exact = at(translation({20.0, 0.0, 0.0})).value();
    const Measurement wider = at({turn, {20.0, 0.0, 0.0}}).value();
    EXPECT_GT(wider.upper - wider.lower, exact.upper - exact.lower + 1e-9);
}

TEST(MeasuredBody, OfOneLineIsMeasured) {
    Dbm lines = empty_dbm({Vec3(-2.0), Vec3(2.0)}, 1.0).value();
    lines.families[2].edit(1, 1) = IntervalList({-1.0, 1.0});
    const auto engine = paper_engine();
    const MeasuredBody stick = taken_into(*engine, measured_body(lines).value()).value();
    ASSERT_EQ(stick.points.size(), 2U);
    const Measurement found = measure(*engine, stick, stick, translation({3.0, 0.0, 0.0})).value();
    EXPECT_NEAR(found.upper, 3.0, 1e-6);
    EXPECT_EQ(found.lower, 0.0);
    EXPECT_THAT(found.reason, HasSubstr("both bodies are known by scan lines only"));
}

} // namespace
} // namespace core
