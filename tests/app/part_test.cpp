#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/geom/mesh_file.h"
#include "tests/app/checked.h"
#include "tests/support/meshes.h"
#include "tests/support/program_writer.h"
#include "tests/support/stl_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// A slot of 10 mm through the block of the example, 5 mm deep, from line 8 on.
const std::string slot = program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F2000.", "G0 Z60."});

const std::string idle = program({"G0 Z60."});

/// A part equal to the block of the example, up to a height.
SetupWriter part_up_to(const std::string& height, const std::string& more = "") {
    return SetupWriter().also("[part]\nbox = [[0, 0, -30], [100, 100, " + height + "]]\n" + more);
}

nlohmann::json part_of(const std::string& text, const SetupWriter& setup) {
    const ScopedFolder folder;
    const auto ran = feeler({"check", folder.write("part.nc", text), "--setup",
                             folder.write("setup.toml", setup.text()), "--format", "json"});
    return nlohmann::json::parse(ran.out)["part"];
}

TEST(Part, IsMadeWhenTheResultIsThePart) {
    const Checked checked = check(part_up_to("0"), idle);
    EXPECT_EQ(checked.status, 0);
    EXPECT_TRUE(checked.findings.empty());
    const auto part = part_of(idle, part_up_to("0"));
    EXPECT_LT(part["largest_gouge"].get<double>(), 1e-6);
    EXPECT_LT(part["largest_excess"].get<double>(), 1e-6);
    EXPECT_TRUE(part["regions"].empty());
}

TEST(Part, IsAnErrorWhereItIsGouged) {
    const Checked checked = check(part_up_to("0"), slot);
    EXPECT_EQ(checked.status, 1);
    ASSERT_EQ(checked.findings.size(), 1u);
    EXPECT_EQ(checked.findings[0].rule, "gouge");
    EXPECT_EQ(checked.findings[0].severity, "error");
    EXPECT_EQ(checked.findings[0].line, test_support::first_line + 2);
    EXPECT_EQ(checked.findings[0].message.find("5.000 mm of the part is missing"), 0u);
    const auto part = part_of(slot, part_up_to("0"));
    EXPECT_NEAR(part["largest_gouge"].get<double>(), 5.0, 1e-6);
    ASSERT_EQ(part["regions"].size(), 1u);
    EXPECT_EQ(part["regions"][0]["kind"], "gouge");
    EXPECT_EQ(part["regions"][0]["line"], test_support::first_line + 2);
    EXPECT_NEAR(part["regions"][0]["at"][1].get<double>(), 50.0, 5.01);
}

TEST(Part, ObeysTheRules) {
    const Checked checked = check(part_up_to("0").also("[rules]\ngouge = \"warning\""), slot);
    EXPECT_EQ(checked.status, 0);
    EXPECT_EQ(checked.findings.at(0).severity, "warning");
}

TEST(Part, IsANoteWhereMaterialIsLeft) {
    const Checked checked = check(part_up_to("-0.3"), idle);
    EXPECT_EQ(checked.status, 0);
    ASSERT_EQ(checked.findings.size(), 1u);
    EXPECT_EQ(checked.findings[0].rule, "rest-material");
    EXPECT_EQ(checked.findings[0].severity, "note");
    EXPECT_EQ(checked.findings[0].message.find("0.300 mm of excess material is left"), 0u);
    EXPECT_TRUE(check(part_up_to("-0.3", "tolerance = 0.31"), idle).findings.empty());
}

TEST(Part, IsPlacedInItsFrame) {
    const ScopedFolder folder;
    folder.write("cube.stl",
                 test_support::binary_stl(test_support::box_mesh({0, 0, -30}, {100, 100, 0})));
    const std::string moved = SetupWriter()
                                  .also("[part]\nmesh = \"cube.stl\"\nat = [0.2, 0, 0]\n"
                                        "frame = \"stock\"\ntolerance = 0.05")
                                  .text();
    const auto ran = feeler({"check", folder.write("part.nc", idle), "--setup",
                             folder.write("setup.toml", moved), "--format", "json"});
    const auto part = nlohmann::json::parse(ran.out)["part"];
    EXPECT_NEAR(part["largest_gouge"].get<double>(), 0.2, 1e-6);
    EXPECT_NEAR(part["largest_excess"].get<double>(), 0.2, 1e-6);
    EXPECT_EQ(part["regions"].size(), 2u);
    EXPECT_EQ(part["tolerance"], 0.05);
}

TEST(Part, IsSavedInColours) {
    const ScopedFolder folder;
    const auto save = [&](const SetupWriter& setup, const std::string& name) {
        return feeler({"check", folder.write("part.nc", slot), "--setup",
                       folder.write("setup.toml", setup.text()), "--save-comparison",
                       folder / name});
    };
    EXPECT_EQ(save(part_up_to("0"), "seen.ply").status, 1);
    const auto mesh = core::read_mesh(folder / "seen.ply");
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_NEAR(core::signed_volume(mesh->mesh), 300'000.0 - 5'000.0, 1.0);
    const std::string bytes = test_support::bytes_of(folder.path() / "seen.ply");
    EXPECT_NE(bytes.find("comment yellow to red: gouged, 0.1 to 0.5 mm"), std::string::npos);
    EXPECT_NE(bytes.find("property uchar red"), std::string::npos);
    const auto none = save(SetupWriter(), "none.ply");
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find("has no [part]"), std::string::npos);
    EXPECT_EQ(save(part_up_to("0"), "seen.stl").status, 2);
}

TEST(Part, IsReportedInTheText) {
    const ScopedFolder folder;
    const auto ran = feeler({"check", folder.write("part.nc", slot), "--setup",
                             folder.write("setup.toml", part_up_to("0").text())});
    EXPECT_NE(ran.out.find("part       gouges up to 5.000 mm"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("may deviate from the part by 0.1 mm"), std::string::npos) << ran.out;
}

TEST(Part, NeedsAMeshOrABox) {
    const ScopedFolder folder;
    const auto ran =
        feeler({"check", folder.write("part.nc", idle), "--setup",
                folder.write("setup.toml", SetupWriter().also("[part]\ntolerance = 1.0").text())});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("one of mesh, box"), std::string::npos) << ran.err;
}

} // namespace
} // namespace app_test
