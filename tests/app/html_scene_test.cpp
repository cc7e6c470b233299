#include <cstring>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/report/html/html_report.h"
#include "app/report/html/pictured_run.h"
#include "render/body_mesh.h"
#include "render/camera.h"
#include "render/scene.h"
#include "tests/support/program_writer.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app {
namespace {

using nlohmann::json;

const std::string folder = std::string(FEELER_SOURCE_DIR) + "/assets/";

std::string decoded(const std::string& text) {
    std::string bytes;
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        const uint32_t six = c >= 'a'   ? static_cast<uint32_t>(c - 'a' + 26)
                             : c >= 'A' ? static_cast<uint32_t>(c - 'A')
                             : c >= '0' ? static_cast<uint32_t>(c - '0' + 52)
                             : c == '+' ? 62U
                                        : 63U;
        bits = bits << 6 | six;
        if ((count += 6) < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xFF);
    }
    return bytes;
}

template <typename Number>
Number number_at(const std::string& bytes, size_t at) {
    Number number;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

TEST(MeshJson, HoldsAllCornersToAStepOfItsBox) {
    const render::TriangleMesh mesh = render::mesh_of(core::Primitive(core::Cylinder{5, 40}));
    const json written = json::parse(mesh_json(mesh));
    const std::string bytes = decoded(written["data"]);
    const size_t count = mesh.vertices.size();
    ASSERT_EQ(written["count"], count);
    ASSERT_EQ(written["triangles"], mesh.triangles.size());
    ASSERT_EQ(bytes.size(), 10 * count + 6 * mesh.triangles.size());
    for (size_t v = 0; v < count; ++v) {
        for (size_t k = 0; k < 3; ++k) {
            const double position =
                written["origin"][k].get<double>()
                + written["step"][k].get<double>() * number_at<uint16_t>(bytes, 2 * (3 * v + k));
            EXPECT_NEAR(position, mesh.vertices[v].position[static_cast<int>(k)], 40.0 / 65535);
            EXPECT_EQ(number_at<int8_t>(bytes, 6 * count + 4 * v + k), mesh.vertices[v].normal[k]);
        }
        EXPECT_EQ(number_at<uint8_t>(bytes, 6 * count + 4 * v + 3), mesh.vertices[v].tint);
    }
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (size_t k = 0; k < 3; ++k)
            EXPECT_EQ(number_at<uint16_t>(bytes, 10 * count + 2 * (3 * t + k)),
                      mesh.triangles[t][k]);
}

TEST(SceneWriter, WritesWhatScenesShareOnce) {
    const auto mesh = std::make_shared<render::TriangleMesh>(
        render::mesh_of(core::Primitive(core::Box{{10, 20, 30}})));
    render::Scene scene;
    for (const char* name : {"clamp-1", "clamp-2"}) {
        render::Body body;
        body.name = name;
        body.mesh = mesh;
        scene.bodies.push_back(body);
    }
    scene.bodies[1].stock_from_body = core::translation({1, 2, 3.0005});
    scene.bodies[1].side = render::PairSide::body;
    scene.bodies[1].mark = render::ClearanceState::violation;
    scene.witness = render::Witness{{1, 2, 3}, {4, 5, 6.12345}, render::ClearanceState::near};
    SceneWriter writer;
    const json first = json::parse(writer.add(scene, {})),
               again = json::parse(writer.add(scene, {}));
    EXPECT_EQ(first, again);
    EXPECT_EQ(json::parse(writer.meshes()).size(), 1U);
    ASSERT_EQ(first["bodies"].size(), 2U);
    EXPECT_EQ(first["bodies"][1]["at"], json({1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3.001}));
    EXPECT_EQ(first["bodies"][1]["state"], "violation");
    EXPECT_FALSE(first["bodies"][0].contains("state"));
    EXPECT_EQ(first["bodies"][1]["pair"], "body");
    EXPECT_FALSE(first["bodies"][0].contains("pair"));
    EXPECT_EQ(first["witness"], json({1, 2, 3, 4, 5, 6.123}));
    EXPECT_EQ(first["state"], "near");
}

CheckJob clamped_plate() {
    return {.program = folder + "programs/clamped_plate_low.nc",
            .setup = folder + "setups/clamped_plate.toml",
            .detail = core::Detail::deciding_pair};
}

TEST(PicturedRun, FindsWhatACheckFindsAndShowsTheWorstBlocks) {
    const CheckRun plain = *run_check(clamped_plate());
    ReportViews views;
    const CheckRun run = *run_pictured_check(clamped_plate(), views);
    EXPECT_EQ(run.verdict, plain.verdict);
    EXPECT_EQ(run.blocks.size(), plain.blocks.size());
    EXPECT_EQ(run.findings.size(), plain.findings.size());
    EXPECT_EQ(run.removed, plain.removed);
    std::vector<ShownMoment> moments;
    for (const BlockView& view : views.views) {
        moments.push_back(view.moment);
        const json scene = json::parse(view.scene);
        EXPECT_GT(scene["bodies"].size(), 3U);
        EXPECT_TRUE(scene.contains("witness"));
        if (!views.no_pictures.empty()) continue;
        EXPECT_EQ(view.picture.substr(0, 2), "\xFF\xD8");
        EXPECT_EQ(view.picture.substr(view.picture.size() - 2), "\xFF\xD9");
    }
    EXPECT_EQ(moments, moments_to_show(plain, 12));
    EXPECT_EQ(moments.size(), 4U);
}

TEST(PicturedRun, ShowsEachPairOfABlockAtItsOwnMoment) {
    // The plunge takes first the flutes and then the holder into a jaw.
    const test_support::ScopedFolder files;
    const CheckJob job{
        .program = files.write(
            "p.nc", test_support::program({"G0 X50. Y97.", "Z20.", "G1 Z-28. F200.", "G0 Z60."})),
        .setup =
            files.write("s.toml", test_support::SetupWriter()
                                      .fixture("jaw", "box = [[-40, 100, -60], [140, 130, 18]]")
                                      .text()),
        .detail = core::Detail::deciding_pair};
    ReportViews views;
    const CheckRun run = *run_pictured_check(job, views);
    std::map<std::string, std::string> scenes; // by the part that meets the jaw in the plunge
    for (const BlockView& view : views.views)
        if (view.moment.pair[1] == "jaw" && run.blocks[view.moment.block].text == "G1 Z-28. F200.")
            scenes[view.moment.pair[0]] = view.scene;
    ASSERT_TRUE(scenes.contains("flutes") && scenes.contains("holder"));
    EXPECT_NE(scenes["flutes"], scenes["holder"]);
    for (const auto& [part, text] : scenes) {
        const json scene = json::parse(text);
        for (const json& body : scene["bodies"])
            EXPECT_EQ(body.contains("state"), body["name"] == part || body["name"] == "jaw")
                << part << " " << body["name"];
    }
}

TEST(PicturedRun, EndsEarlyOnRequest) {
    CheckJob job = clamped_plate();
    job.after_block = [](const CheckProgress& progress) { return progress.blocks < 10; };
    ReportViews views;
    const CheckRun run = *run_pictured_check(job, views);
    EXPECT_EQ(run.blocks.size(), 10U);
    ASSERT_TRUE(run.stopped);
    EXPECT_EQ(run.stopped->message, run_check(job)->stopped->message);
}

TEST(PicturedRun, ReportsAProgramThatCannotBeRead) {
    ReportViews views;
    EXPECT_FALSE(run_pictured_check({.program = folder + "programs/none.nc"}, views));
}

} // namespace
} // namespace app
