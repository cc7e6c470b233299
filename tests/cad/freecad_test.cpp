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
    EXPECT_THAT(refusal_of("copies"), HasSubstr("Link is a link to other objects"));
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
    const std::string types = "<Objects><Object type='App::Part' name='Part'/>"
                              "<Object type='App::Part' name='Other'/>"
                              "<Object type='App::Part' name='Lost'/>"
                              "<Object type='PartDesign::Body' name='Body'/></Objects>";
    files.insert(files.begin(), {"Document.xml", "<Document>" + types + "<ObjectData>" + objects
                                                     + "</ObjectData></Document>"});
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

std::string property(const std::string& name, const std::string& value) {
    return "<Property name='" + name + "'>" + value + "</Property>";
}

std::string place_property(const std::string& x) {
    return property("Placement", "<PropertyPlacement Px='" + x + "'/>");
}

std::string label_property(const std::string& label) {
    return property("Label", "<String value='" + label + "'/>");
}

std::vector<std::string> left_out_of(const CadFile& file) {
    std::vector<std::string> left_out;
    for (const CadSurfaces& each : file.left_out) left_out.push_back(each.what);
    return left_out;
}

const std::string good_shape = shape_property("good.brp");

TEST_F(FreeCad, LeavesOutWhatCannotBeReadAndReadsTheRest) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const CadFile file = read(document_with(
        folder_,
        object_of("Good", good_shape) + object_of("Bad", shape_property("bad.brp"))
            + object_of("None", shape_property("none.brp"))
            + object_of("Lost", group_property("In") + place_property("x"))
            + object_of("In", good_shape)
            + object_of("Bit", good_shape + "<Property name='BitShape'/>")
            + object_of("Empty", shape_property("empty.brp"))
            + object_of("Null", "<Property name='Shape'><Part file=''/></Property>")
            + object_of("A", group_property("B")) + object_of("B", group_property("A"))
            + object_of("Round", good_shape) + object_of("C", group_property("D"))
            + object_of("D", property("Group", "<LinkList><Link value='C'/><Link value='Round'/>"
                                               "</LinkList>")),
        {{"good.brp", shape}, {"bad.brp", shape.substr(0, 2000)}, {"empty.brp", ""}}));
    ASSERT_EQ(file.solids.size(), 1u);
    EXPECT_THAT(file.solids[0].names, ElementsAre("Good"));
    EXPECT_THAT(left_out_of(file),
                ElementsAre("Bad has a damaged shape", "None has a damaged shape",
                            "In: the place of Lost cannot be read",
                            "Empty has no shape: recompute the document in FreeCAD",
                            "Null has no shape: recompute the document in FreeCAD",
                            "Round: its groups contain each other"));
    EXPECT_FALSE(body_of(file, "Bad").has_value());
    EXPECT_FALSE(body_of(file, "Lost").has_value());
    EXPECT_TRUE(body_of(file, "Good").has_value());
}

TEST_F(FreeCad, ABodyThatIsReadInPartIsRefusedByEachOfItsNames) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const auto group = [](const std::string& members) {
        return property("Group", "<LinkList>" + members + "</LinkList>");
    };
    const std::string links = "<Link value='Jaw'/><Link value='Array'/>";
    const CadFile file = read(document_with(
        folder_,
        object_of("Part", label_property("vise") + group(links) + place_property("0"))
            + object_of("Jaw", label_property("jaw") + good_shape)
            + object_of("Array", "<Property name='Shape'><Part file=''/></Property>"
                                     + property("ElementList", "<LinkList/>"))
            + object_of("Links", property("ElementList", "<LinkList><Link value='Far'/></LinkList>")
                                     + place_property("500"))
            + object_of("Far", good_shape),
        {{"good.brp", shape}}));
    EXPECT_THAT(left_out_of(file), ElementsAre("Array is a link to other objects: not read",
                                               "Links is a link to other objects: not read",
                                               "Far is in a group of links: not read"));
    EXPECT_THAT(body_of(file, "vise").error().message, HasSubstr("Array is a link"));
    EXPECT_TRUE(body_of(file, "jaw").has_value());
    EXPECT_FALSE(body_of(file, "Far").has_value());
}

TEST_F(FreeCad, TellsObjectsOfOneLabelApart) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const CadFile file =
        read(document_with(folder_,
                           object_of("Box", label_property("jaw") + good_shape)
                               + object_of("Box001", label_property("jaw") + good_shape)
                               + object_of("Box002", label_property("jaw ") + good_shape),
                           {{"good.brp", shape}}));
    EXPECT_FALSE(body_of(file, "jaw").has_value());
    for (const char* name : {"jaw (Box)", "jaw (Box001)", "jaw "})
        EXPECT_EQ(body_of(file, name)->solids, 1u) << name;
}

TEST_F(FreeCad, APartCountsWhateverGroupsItsBodiesAreIn) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const std::string document = object_of("Early", group_property("Box"))
                                 + object_of("Part", group_property("Box") + place_property("100"))
                                 + object_of("Box", good_shape);
    const CadFile file = read(document_with(folder_, document, {{"good.brp", shape}}));
    ASSERT_EQ(file.solids.size(), 1u);
    EXPECT_THAT(file.solids[0].names, ElementsAre("Early", "Part", "Box"));
    expect_box(file.solids[0].mesh, {96, -3, -37}, {106, 7, -17}, 0.1);
    const auto twice = read_cad(document_with(
        folder_, document + object_of("Other", group_property("Box") + place_property("50")),
        {{"good.brp", shape}}));
    EXPECT_THAT(twice.error().message, HasSubstr("Box: it is in several parts"));
}

TEST_F(FreeCad, APlaceThatIsNotKnownIsRefused) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const auto refusal = [&](const std::string& objects) {
        const auto file = read_cad(
            document_with(folder_, objects + object_of("Box", good_shape), {{"good.brp", shape}}));
        return file ? "it was read" : file.error().message;
    };
    // A part in a group of links, which has a place of its own.
    EXPECT_THAT(refusal(object_of("Links", property("ElementList", "<LinkList><Link value='Part'/>"
                                                                   "</LinkList>"))
                        + object_of("Part", group_property("Box"))),
                HasSubstr("Box: it is in a group of links"));
    // A floor of Arch, which has moved its members already.
    EXPECT_THAT(refusal(object_of("Floor", group_property("Box") + place_property("100"))),
                HasSubstr("Box: Floor has a place and is no part"));
    EXPECT_EQ(refusal(object_of("Floor", group_property("Box") + place_property("0"))),
              "it was read");
}

TEST_F(FreeCad, OnlyMembersOfAPartDesignBodyAreSteps) {
    const std::string shape = bytes_of(sample("cut.brep"));
    const std::string members = object_of("Site", good_shape + group_property("Box"))
                                + object_of("Body", good_shape + group_property("Pad"))
                                + object_of("Box", good_shape) + object_of("Pad", good_shape);
    const CadFile file = read(document_with(folder_, members, {{"good.brp", shape}}));
    EXPECT_EQ(body_of(file, "Site")->solids, 2u);
    EXPECT_EQ(body_of(file, "Body")->solids, 1u);
    EXPECT_FALSE(body_of(file, "Pad").has_value());
}

TEST_F(FreeCad, DeepGroupsEndSoon) {
    std::string document;
    for (int i = 0; i < 20000; ++i)
        document += object_of("G" + std::to_string(i), group_property("G" + std::to_string(i + 1)));
    const auto file = read_cad(document_with(folder_, document + object_of("G20000", good_shape),
                                             {{"good.brp", bytes_of(sample("cut.brep"))}}));
    EXPECT_THAT(file.error().message, HasSubstr("nested more than 100 deep"));
}

} // namespace
} // namespace core
