#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cad/cad_file.h"
#include "core/formats/freecad_document.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/zip_writer.h"

namespace core {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string sample(const std::string& name) {
    return std::string(FEELER_SOURCE_DIR) + "/tests/cad/freecad/" + name;
}

class FreeCad : public ::testing::Test {
protected:
    FreeCad() { set_cad_reader(FEELER_CAD_READER); }

    CadFile read(const std::string& path) const {
        const auto file = read_cad(path);
        EXPECT_TRUE(file) << (file ? "" : file.error().message);
        return file ? **file : CadFile{};
    }

    CadBody body(const std::string& name) const {
        const auto found = body_of(read(sample("bodies.FCStd")), name);
        EXPECT_TRUE(found) << (found ? "" : found.error().message);
        return found.value_or(CadBody{});
    }

    std::string refusal_of(const std::string& name) const {
        const auto found = body_of(read(sample("bodies.FCStd")), name);
        return found ? "" : found.error().message;
    }

    test_support::ScopedFolder folder_;
};

void expect_box(const Mesh& mesh, const Vec3& low, const Vec3& high, double within) {
    const Aabb box = mesh.bounds();
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(box.min[axis], low[axis], within) << "XYZ"[axis];
        EXPECT_NEAR(box.max[axis], high[axis], within) << "XYZ"[axis];
    }
}

TEST_F(FreeCad, PlacesBodiesInTheirParts) {
    // The corners were turned by hand, and FreeCAD's box of the outer part is the same.
    const CadBody jaw = body("Spannbacke \u00e4");
    expect_box(jaw.mesh, {78.648373216211, 20, 41.202014332567},
               {100.397138175456, 50, 61.718210957487}, 1e-9);
    EXPECT_NEAR(signed_volume(jaw.mesh), 6000.0, 1e-8);
    EXPECT_LT(jaw.deviation, 1e-6);
    const CadBody vise = body("vise");
    EXPECT_EQ(vise.solids, 2u);
    expect_box(vise.mesh, {-1.7101007166, 0, 7}, {100.397138175456, 50, 61.718210957487}, 1e-9);
    EXPECT_EQ(body("jaws").solids, 1u);
}

TEST_F(FreeCad, ReadsCutsAndBodiesMadeInSteps) {
    // Volumes are those of FreeCAD, of the exact shapes.
    const CadBody cut = body("Cut");
    EXPECT_NEAR(signed_volume(cut.mesh), 841.6753348255, 842 * 0.005);
    EXPECT_LE(cut.deviation, 0.01);
    EXPECT_TRUE(cut.is_proven);
    const CadBody filleted = body("Body");
    EXPECT_NEAR(signed_volume(filleted.mesh), 991.4159265359, 0.5);
    expect_box(filleted.mesh, {-50, 0, 0}, {-40, 10, 10}, 1e-9);
    EXPECT_EQ(body("Cylinder").solids, 1u);
    EXPECT_THAT(refusal_of("Block"), HasSubstr("no solid has the name \"Block\""));
    EXPECT_THAT(refusal_of("Fillet"), HasSubstr("no solid has the name"));
}

TEST_F(FreeCad, WantsANameOfItsBodies) {
    EXPECT_THAT(refusal_of(""), HasSubstr("several bodies: name the one that is meant"));
    EXPECT_THAT(refusal_of(""), HasSubstr("\"vise\", \"jaws\", \"Spannbacke"));
}

TEST_F(FreeCad, RefusesANameThatIncludesALink) {
    EXPECT_THAT(refusal_of("copies"), HasSubstr("Link is a link to another object"));
    EXPECT_EQ(body("spare").solids, 1u);
}

TEST_F(FreeCad, ReadsShapesAsTextAndBinary) {
    for (const char* name : {"cut.brep", "cut_binary.brep"}) {
        const CadFile file = read(sample(name));
        ASSERT_EQ(file.solids.size(), 1u) << name;
        EXPECT_FALSE(file.bodies_are_apart);
        EXPECT_NEAR(signed_volume(file.solids[0].mesh), 841.6753348255, 842 * 0.005) << name;
        // The place of the object is in its shape.
        expect_box(file.solids[0].mesh, {-4, -3, -37}, {6, 7, -17}, 0.1);
    }
    const auto other = read_cad(folder_.write("a.brp", "solid a\nendsolid a\n"));
    EXPECT_THAT(other.error().message, HasSubstr("is no BREP file"));
}

std::string bytes_of(const std::string& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

TEST_F(FreeCad, FilesThatEndEarlyAreRefused) {
    std::mt19937 random(20261128);
    for (const char* name : {"cut.brep", "cut_binary.brep", "bodies.FCStd"}) {
        const std::string intact = bytes_of(sample(name));
        for (int round = 0; round < 12; ++round) {
            const size_t size = random() % (intact.size() - 100);
            const auto file =
                read_cad(folder_.write(std::string("early-") + name, intact.substr(0, size)));
            EXPECT_FALSE(file) << name << " of " << size << " bytes";
        }
    }
}

/// A document with these objects, and files.
std::string document_with(const test_support::ScopedFolder& folder, const std::string& objects,
                          std::vector<std::pair<std::string, std::string>> files = {}) {
    files.insert(files.begin(),
                 {"Document.xml", "<Document><ObjectData>" + objects + "</ObjectData></Document>"});
    return folder.write("made.FCStd", test_support::packed_zip_of(files));
}

std::string object_of(const std::string& name, const std::string& properties) {
    return "<Object name='" + name + "'><Properties>" + properties + "</Properties></Object>";
}

std::string shape_property(const std::string& file) {
    return "<Property name='Shape'><Part file='" + file + "'/></Property>";
}

std::string group_property(const std::string& member) {
    return "<Property name='Group'><LinkList><Link value='" + member + "'/></LinkList></Property>";
}

TEST_F(FreeCad, LeavesOutWhatCannotBeReadAndReadsTheRest) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const std::string strange_place = "<Property name='Placement'><PropertyPlacement Px='x'/>"
                                      "</Property>";
    const CadFile file = read(document_with(
        folder_,
        object_of("Good", shape_property("good.brp")) + object_of("Bad", shape_property("bad.brp"))
            + object_of("None", shape_property("none.brp"))
            + object_of("Lost", group_property("In") + strange_place)
            + object_of("In", shape_property("good.brp"))
            + object_of("Bit", shape_property("good.brp") + "<Property name='BitShape'/>")
            + object_of("Empty", shape_property("empty.brp")) + object_of("A", group_property("B"))
            + object_of("B", group_property("A")),
        {{"good.brp", shape}, {"bad.brp", shape.substr(0, 2000)}, {"empty.brp", ""}}));
    ASSERT_EQ(file.solids.size(), 1u);
    EXPECT_THAT(file.solids[0].names, ElementsAre("Good"));
    std::vector<std::string> left_out;
    for (const CadSurfaces& each : file.left_out) left_out.push_back(each.what);
    EXPECT_THAT(left_out, ElementsAre("Bad has a damaged shape", "None has a damaged shape",
                                      "the place of Lost cannot be read"));
    EXPECT_FALSE(body_of(file, "Bad").has_value());
    EXPECT_TRUE(body_of(file, "Good").has_value());
}

} // namespace
} // namespace core
