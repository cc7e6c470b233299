#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/geom/mesh_file.h"
#include "tests/app/checked.h"
#include "tests/support/program_writer.h"

namespace app_test {
namespace {

using test_support::program;
using test_support::ScopedFolder;
using test_support::SetupWriter;

/// A slot of 10 mm through the block of the example, 5 mm deep.
const std::string slot = program({"G0 X-20. Y50.", "Z-5.", "G1 X120. F2000.", "G0 Z60."});

test_support::Ran save(const ScopedFolder& folder, const std::string& part, const std::string& to,
                       const std::string& format = "text") {
    return feeler({"check", folder.write("part.nc", part), "--setup",
                   folder.write("setup.toml", SetupWriter().text()), "--save-stock", to, "--format",
                   format});
}

TEST(SaveStock, WritesAClosedMeshOfWhatIsLeft) {
    const ScopedFolder folder;
    for (const char* name : {"left.stl", "left.PLY"}) {
        const auto ran = save(folder, slot, folder / name, "json");
        EXPECT_EQ(ran.status, 0) << ran.err;
        const auto mesh = core::read_mesh(folder / name);
        ASSERT_TRUE(mesh) << mesh.error().message;
        EXPECT_TRUE(mesh->repairs.empty());
        EXPECT_NEAR(core::signed_volume(mesh->mesh), 100.0 * (100.0 * 30.0 - 10.0 * 5.0), 1.0);
        const auto saved = nlohmann::json::parse(ran.out)["saved_stock"];
        EXPECT_EQ(saved["triangles"], mesh->mesh.triangles.size());
        EXPECT_LT(saved["error"].get<double>(), 1e-4);
        EXPECT_EQ(saved["lost_points"], 0);
    }
}

TEST(SaveStock, StatesItsErrorInTheFileAndInTheReport) {
    const ScopedFolder folder;
    const auto ran = save(folder, slot, folder / "left.ply");
    EXPECT_NE(ran.out.find("triangles, within"), std::string::npos) << ran.out;
    const std::string bytes = test_support::bytes_of(folder.path() / "left.ply");
    EXPECT_NE(bytes.find("comment error: the points of the model lie within"), std::string::npos);
    save(folder, slot, folder / "left.stl");
    EXPECT_EQ(test_support::bytes_of(folder.path() / "left.stl").find("feeler stock, mm; error"),
              0u);
}

TEST(SaveStock, IsTheSameFileEveryTime) {
    const ScopedFolder folder;
    save(folder, slot, folder / "one.stl");
    save(folder, slot, folder / "two.stl");
    EXPECT_EQ(test_support::bytes_of(folder.path() / "one.stl"),
              test_support::bytes_of(folder.path() / "two.stl"));
}

TEST(SaveStock, RefusesAnEndingItDoesNotKnow) {
    const ScopedFolder folder;
    const auto ran = save(folder, slot, folder / "left.step");
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("must end in .stl, .ply or .feeler"), std::string::npos);
    EXPECT_EQ(ran.out, "");
}

TEST(SaveStock, WritesNothingForAProgramThatStops) {
    const ScopedFolder folder;
    const auto ran = save(folder, program({"G1 X10. F100.", "G999"}), folder / "left.stl");
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("did not run to its end"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "left.stl"));
}

TEST(SaveStock, DoesNotWriteOverWhatItReads) {
    const ScopedFolder folder;
    const std::string part = folder.write("part.stl", slot);
    const auto ran =
        feeler({"check", part, "--setup", folder.write("setup.toml", SetupWriter().text()),
                "--save-stock", part});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(test_support::bytes_of(part), slot);
}

/// The volume that a second program removes from the block left by the first.
double removed_after(const ScopedFolder& folder, const std::string& stock,
                     const std::string& second) {
    const auto ran = feeler({"check", folder.write("second.nc", second), "--setup",
                             folder.write("second.toml", SetupWriter().stock(stock).text()),
                             "--format", "json"});
    EXPECT_EQ(ran.status, 0) << ran.err << ran.out;
    double removed = 0.0;
    const auto report = nlohmann::json::parse(ran.out);
    for (const auto& block : report["blocks"]) removed += block["removed"].get<double>();
    return removed;
}

TEST(SaveStock, IsTheStockOfALaterSetUp) {
    const ScopedFolder folder;
    ASSERT_EQ(save(folder, slot, folder / "op10.feeler").status, 0);
    EXPECT_NEAR(removed_after(folder, "model = \"op10.feeler\"", slot), 0.0, 1e-6);
    const std::string across = program({"G0 X50. Y-20.", "Z-5.", "G1 Y120. F2000.", "G0 Z60."});
    EXPECT_NEAR(removed_after(folder, "model = \"op10.feeler\"", across), 90.0 * 10.0 * 5.0, 1.0);
}

TEST(SaveStock, CanBeTurnedOverForTheOtherSide) {
    const ScopedFolder folder;
    ASSERT_EQ(save(folder, slot, folder / "op10.feeler").status, 0);
    // Turned over about X: Y0 becomes Y100, Z0 becomes Z-30.
    const std::string over =
        "model = \"op10.feeler\"\nrotate_deg = [180, 0, 0]\nat = [0, 100, -30]";
    // A slot across the other side, 27 deep: it meets the first one 2 mm above its floor.
    std::vector<std::string> blocks = {"G0 X50. Y-20."};
    for (int depth = 9; depth <= 27; depth += 9) {
        blocks.push_back("G0 Z-" + std::to_string(depth) + ".");
        blocks.push_back("G1 Y120. F2000.");
        blocks.push_back("G0 Z60.");
        blocks.push_back("G0 Y-20.");
    }
    const double removed = removed_after(folder, over, program(blocks));
    EXPECT_NEAR(removed, 10.0 * (100.0 * 27.0 - 10.0 * 2.0), 2.0);
}

TEST(SaveStock, OfAnotherProgramThatIsDamagedIsRefused) {
    const ScopedFolder folder;
    folder.write("bad.feeler", "feeler stock 1\nabcdefghijkl");
    const auto ran =
        feeler({"check", folder.write("part.nc", slot), "--setup",
                folder.write("setup.toml", SetupWriter().stock("model = \"bad.feeler\"").text())});
    EXPECT_EQ(ran.status, 2);
    EXPECT_NE(ran.err.find("bad.feeler\": is damaged"), std::string::npos) << ran.err;
}

} // namespace
} // namespace app_test
