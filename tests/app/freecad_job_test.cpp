#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/freecad_job.h"
#include "app/setup/inference/imported_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "core/sim/tool_assembly.h"
#include "gcode/text/source.h"
#include "tests/support/cad_reader.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/zip_writer.h"

namespace app {
namespace {

using core::ToolNumber;

const test_support::ScopedFolder& job_folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

std::string sample(const std::string& name) {
    return std::string(FEELER_SOURCE_DIR) + "/tests/app/freecad/" + name + ".FCStd";
}

FreeCadJob job_in(const std::string& path) {
    auto read = read_freecad_job(path);
    EXPECT_TRUE(read.has_value()) << error_text(read.error());
    return read.value_or(FreeCadJob{});
}

bool notes_say(const FreeCadJob& job, const std::string& words) {
    return std::any_of(job.notes.begin(), job.notes.end(), [&](const std::string& note) {
        return note.find(words) != std::string::npos;
    });
}

TEST(FreeCadJob, ReadsJobsThatFreeCadMade) {
    for (const char* name : {"box", "cylinder", "base"}) {
        const FreeCadJob job = job_in(sample(name));
        EXPECT_EQ(job.name, "Job");
        EXPECT_EQ(job.post_processor, "linuxcnc");
        EXPECT_EQ(job.work_offsets, (std::vector<std::string>{"G54", "G55"}));
        ASSERT_EQ(job.tools.size(), 3u); // that of the template has number 1
        const core::ToolDescription& mill = job.tools.at(ToolNumber{7}).tool;
        EXPECT_EQ(mill.shape, core::ToolShape::flat);
        EXPECT_EQ(mill.diameter, 5.0);
        EXPECT_EQ(mill.flute_length, 30.0);
        EXPECT_EQ(mill.shank_diameter, 3.0);
        const core::ToolDescription& chamfer = job.tools.at(ToolNumber{12}).tool;
        EXPECT_EQ(chamfer.shape, core::ToolShape::chamfer);
        EXPECT_EQ(chamfer.angle_deg, 22.5);
        EXPECT_EQ(chamfer.tip_diameter, 5.0);
        EXPECT_EQ(job.part_body, "Model");
    }
}

TEST(FreeCadJob, ReadsTheStock) {
    const auto box = job_in(sample("box")).stock;
    ASSERT_TRUE(box.has_value());
    EXPECT_EQ(core::bounds(*box).min, core::Vec3(-5, -5, -8));
    EXPECT_EQ(core::bounds(*box).max, core::Vec3(55, 45, 12));
    const auto round = job_in(sample("cylinder")).stock;
    ASSERT_TRUE(round && std::holds_alternative<core::SolidCylinder>(round->shape));
    EXPECT_EQ(std::get<core::SolidCylinder>(round->shape).radius, 40.0);
    EXPECT_EQ(std::get<core::SolidCylinder>(round->shape).base, core::Vec3(25, 20, 0));
    const FreeCadJob base = job_in(sample("base"));
    EXPECT_FALSE(base.stock.has_value());
    EXPECT_EQ(base.stock_body, "Stock001");
    EXPECT_TRUE(base.stock_is_its_box);
}

/// The set-up of a program with tool 7, which FreeCAD's job completes, as a text.
std::string text_with(const std::string& document) {
    const auto program = gcode::read_program(job_folder().write(
        "part.ngc", "G21 G90 G54\nT7 M6\nS3000 M3\nG43 H7\nG0 X0 Y0 Z20\nG1 Z9 F100\nM2\n"));
    const auto setup = infer_setup_with(*program, {}, document);
    EXPECT_TRUE(setup.has_value()) << error_text(setup.error());
    return setup ? setup_text(*setup, {"part.ngc", {}, job_folder().path().string()}) : "";
}

TEST(FreeCadJob, TakesThePartAndTheBoxAroundIt) {
    if (!test_support::use_cad_reader()) {
        EXPECT_THAT(text_with(sample("base")), ::testing::HasSubstr("without Open CASCADE"));
        return;
    }
    const std::string text = text_with(sample("base"));
    EXPECT_THAT(text, ::testing::HasSubstr("tools, stock and part are those of the job"));
    const auto setup = read_setup(job_folder().write("base.toml", text), {});
    ASSERT_TRUE(setup.has_value()) << error_text(setup.error());
    // The box of the part from 0 to (50, 40, 10), with the margins of the job.
    EXPECT_EQ(core::bounds(setup->setup.stock).min, core::Vec3(-1, -2, -3));
    EXPECT_EQ(core::bounds(setup->setup.stock).max, core::Vec3(54, 45, 16));
    ASSERT_TRUE(setup->setup.part.has_value());
    EXPECT_EQ(setup->setup.part->solid.mesh->bounds().max, core::Vec3(50, 40, 10));
}

TEST(FreeCadJob, TakesAStockThatIsABodyOfTheDocument) {
    if (!test_support::use_cad_reader()) GTEST_SKIP() << "built without Open CASCADE";
    const std::string text = text_with(sample("own"));
    EXPECT_THAT(text, ::testing::HasSubstr("[stock]\nmesh = "));
    const auto setup = read_setup(job_folder().write("own.toml", text), {});
    ASSERT_TRUE(setup.has_value()) << error_text(setup.error());
    // A bar of radius 12, along X.
    const core::Aabb box = core::bounds(setup->setup.stock);
    EXPECT_NEAR(box.min.x, -3.0, 1e-9);
    EXPECT_NEAR(box.max.x, 57.0, 1e-9);
    EXPECT_NEAR(box.max.z, 17.0, 0.01);
    EXPECT_GT(setup->setup.stock.deviation, 0.0);
}

TEST(FreeCadJob, CompletesTheSetUpOfAProgram) {
    const auto program = gcode::read_program(job_folder().write(
        "part.ngc",
        "G21 G90 G54\nT7 M6\nS3000 M3\nG43 H7\nG0 X0 Y0 Z20\nG1 Z9 F100\nX50\nG0 Z30\nM2\n"));
    ASSERT_TRUE(program.has_value());
    const auto setup = infer_setup_with(*program, {}, sample("box"));
    ASSERT_TRUE(setup.has_value()) << error_text(setup.error());
    EXPECT_EQ(core::bounds(setup->setup.stock).max, core::Vec3(55, 45, 12));
    EXPECT_EQ(setup->setup.tools.at(ToolNumber{7}).description.diameter, 5.0);
    EXPECT_EQ(setup->setup.tools.size(), 1u);
    EXPECT_NE(std::find_if(setup->assumptions.begin(), setup->assumptions.end(),
                           [](const std::string& text) {
                               return text.starts_with("tools, stock")
                                      || text.starts_with("tools and stock");
                           }),
              setup->assumptions.end());
    const auto library = infer_setup_with(
        *program, {}, job_folder().write("mine.json", R"({"data": [{"type": "drill", "unit":
        "millimeters", "geometry": {"DC": 4}, "post-process": {"number": 7}}]})"));
    ASSERT_TRUE(library.has_value()) << error_text(library.error());
    EXPECT_EQ(library->setup.tools.at(ToolNumber{7}).description.diameter, 4.0);
    EXPECT_FALSE(infer_setup_with(*program, {}, "none.FCStd").has_value());
}

/// A document with these objects.
std::string document_with(const std::string& objects) {
    return job_folder().write(
        "made.FCStd", test_support::packed_zip_of(
                          {{"Document.xml", "<?xml version='1.0' encoding='utf-8'?>\n<Document>"
                                            "<ObjectData>\n"
                                                + objects + "</ObjectData></Document>"}}));
}

std::string object_of(const std::string& name, const std::string& properties) {
    return "<Object name=\"" + name + "\"><Properties>" + properties + "</Properties></Object>\n";
}

std::string property_of(const std::string& name, const std::string& value) {
    return "<Property name=\"" + name + "\">" + value + "</Property>";
}

std::string link_to(const std::string& name, const std::string& target) {
    return property_of(name, "<Link value=\"" + target + "\"/>");
}

std::string number_of_property(const std::string& name, const std::string& value) {
    return property_of(name, "<Float value=\"" + value + "\"/>");
}

const std::string job_object =
    object_of("Job", link_to("PostProcessor", "") + link_to("Stock", "S") + link_to("Tools", "T"));

TEST(FreeCadJob, SaysWhatItLeavesOut) {
    const std::string tools =
        object_of("T", property_of("Group", "<LinkList><Link value=\"A\"/><Link value=\"B\"/><Link "
                                            "value=\"C\"/><Link value=\"none\"/></LinkList>"))
        + object_of("A", number_of_property("ToolNumber", "0"))
        + object_of("B", number_of_property("ToolNumber", "2"))
        + object_of("C", number_of_property("ToolNumber", "3") + link_to("Tool", "bit"))
        + object_of("bit", number_of_property("Diameter", "-1"));
    const FreeCadJob job = job_in(document_with(job_object + tools + job_object));
    EXPECT_TRUE(job.tools.empty());
    EXPECT_TRUE(notes_say(job, "it has no tool number"));
    EXPECT_TRUE(notes_say(job, "older kind than tool bits"));
    EXPECT_TRUE(notes_say(job, "its bit has no diameter"));
    EXPECT_EQ(job.stock_body, "S");
    EXPECT_TRUE(notes_say(job, "the document has 2 jobs"));
    const std::string turned =
        property_of("Placement", "<PropertyPlacement Px=\"1\" Py=\"2\" Pz=\"3\" Q0=\"0\" Q1=\"0\" "
                                 "Q2=\"0.7\" Q3=\"0.7\"/>");
    const auto stock = [&](const std::string& properties) {
        return job_in(document_with(job_object + object_of("S", properties)));
    };
    const std::string size = number_of_property("Length", "1") + number_of_property("Width", "2");
    const auto made = [](const std::string& kind) {
        return property_of("Proxy", "<Python class=\"" + kind + "\"/>");
    };
    const std::string box = made("StockCreateBox"), round = made("StockCreateCylinder");
    const FreeCadJob askew = stock(box + turned + size + number_of_property("Height", "3"));
    EXPECT_FALSE(askew.stock.has_value());
    EXPECT_EQ(askew.stock_body, "S");
    EXPECT_FALSE(askew.stock_is_its_box);
    for (const char* height : {"0", "-1", "nan", "inf", "1e300", "x", ""})
        EXPECT_TRUE(
            notes_say(stock(box + size + number_of_property("Height", height)), "has no size"))
            << height;
    const FreeCadJob pad = stock(size + number_of_property("Height", "3"));
    EXPECT_FALSE(pad.stock.has_value())
        << "only a stock that FreeCAD's jobs make is one by numbers";
    EXPECT_EQ(pad.stock_body, "S");
    const FreeCadJob moved = job_in(document_with(
        job_object + object_of("S", box + size + number_of_property("Height", "3"))
        + object_of("P", property_of("Group", "<LinkList><Link value=\"S\"/></LinkList>")
                             + property_of("Placement", "<PropertyPlacement Px=\"100\"/>"))));
    EXPECT_FALSE(moved.stock.has_value());
    EXPECT_TRUE(notes_say(moved, "in a part that is placed elsewhere"));
    EXPECT_TRUE(
        notes_say(stock(round + number_of_property("Radius", "-1")), "cylinder of its stock"));
}

TEST(FreeCadJob, RefusesOtherFiles) {
    const auto mistake = [](const std::string& path) {
        const auto read = read_freecad_job(path);
        return read ? std::string() : error_text(read.error());
    };
    EXPECT_NE(mistake(document_with("")).find("without a CAM job"), std::string::npos);
    EXPECT_NE(mistake(job_folder().write("a.FCStd", "PK")).find("is no zip archive"),
              std::string::npos);
    EXPECT_NE(mistake(job_folder().write("b.FCStd", test_support::zip_of({{"x", "y"}})))
                  .find("Document.xml in the archive is missing"),
              std::string::npos);
    EXPECT_NE(mistake(job_folder().write(
                          "c.FCStd", test_support::zip_of({{"Document.xml", "<Document>\n<a>"}})))
                  .find("c.FCStd:2:"),
              std::string::npos);
}

TEST(FreeCadJob, DamagedDocumentsAreReadOrRefused) {
    const std::string tool =
        object_of("T", property_of("Group", "<LinkList><Link value=\"C\"/></LinkList>"))
        + object_of("C", number_of_property("ToolNumber", "3") + link_to("Tool", "bit"))
        + object_of("bit", number_of_property("Diameter", "6")
                               + property_of("ShapeName", "<String value=\"endmill\"/>"));
    const std::string stock =
        object_of("S", number_of_property("Length", "10") + number_of_property("Width", "20")
                           + number_of_property("Height", "30"));
    const std::string good = job_object + tool + stock;
    std::mt19937 random(9);
    size_t accepted = 0;
    for (int round = 0; round < 300; ++round) {
        std::string text = good;
        for (unsigned change = 0; change < 1 + random() % 3; ++change)
            text[random() % text.size()] = "0123456789.-\"<>/aTSC"[random() % 20];
        const auto read = read_freecad_job(document_with(text));
        accepted += read ? 1 : 0;
        EXPECT_TRUE(!read || !read->stock || core::bounds(*read->stock).size().x > 0.0);
    }
    EXPECT_GT(accepted, 20u);
}

} // namespace
} // namespace app
