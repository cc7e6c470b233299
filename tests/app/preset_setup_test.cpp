#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/presets/preset.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/stated_setup.h"
#include "core/base/units.h"
#include "tests/support/scoped_folder.h"

/// Presets in set-ups.

namespace app_test {
namespace {

using app::BodyPath;
using app::Preset;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

core::Result<app::SetupFile> read(const std::string& text) {
    return app::read_setup_text(text, "s.toml", {});
}

std::string error_of(const std::string& text) {
    const auto file = read(text);
    return file ? std::string() : app::error_text(file.error());
}

std::string fixture(const std::string& lines) { return "[[fixture]]\nname = \"a\"\n" + lines; }

std::string preset_line(std::string_view name) { return fmt::format("preset = \"{}\"\n", name); }

/// The assumptions about presets.
std::vector<std::string> assumptions_of(const std::string& text) {
    std::vector<std::string> found;
    const app::SetupFile file = read(text).value();
    for (const std::string& assumption : file.assumptions)
        if (assumption.find("preset") != std::string::npos) found.push_back(assumption);
    return found;
}

const core::Mesh& mesh_of(const core::ExactBody& body) {
    return *std::get<core::SolidMesh>(body).mesh;
}

TEST(PresetInSetup, IsTheBodyOfThePresetInItsPlace) {
    for (const Preset& preset : app::presets()) {
        const auto file = read(
            fixture(preset_line(preset.name) + "at = [10, 20, 30]\nrotate_deg = [0, 0, 90]\n"));
        ASSERT_TRUE(file) << app::error_text(file.error());
        const core::Mesh expected = app::preset_mesh(preset).value();
        const core::Mesh& mesh = mesh_of(file->setup.fixtures.at(0).body);
        ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
        for (size_t i = 0; i < mesh.vertices.size(); ++i) {
            const core::Vec3& p = expected.vertices[i];
            const core::Vec3 off = mesh.vertices[i] - core::Vec3(10 - p.y, 20 + p.x, 30 + p.z);
            EXPECT_LT(glm::length(off), 1e-9);
        }
    }
}

TEST(PresetInSetup, TakesSizesInTheUnitOfTheFile) {
    std::mt19937 random(4);
    size_t lengths = 0;
    for (const Preset& preset : app::presets())
        for (const app::PresetParameter& p : preset.parameters) {
            // A length with few digits in inches that the preset accepts.
            const double value =
                p.measure == app::PresetMeasure::count
                    ? p.standard
                    : std::ceil(p.standard / 25.4 * 64 + 1e-9 + random() % 2) / 64 * 25.4;
            const auto expected = app::preset_mesh(preset, {{std::string(p.key), value}});
            const std::string body = fixture(preset_line(preset.name)) + std::string(p.key) + " = ";
            const bool is_count = p.measure == app::PresetMeasure::count;
            const auto in_mm = read(body + app::toml_number(value));
            const auto in_inch = read("length_unit = \"inch\"\n" + body
                                      + app::toml_number(is_count ? value : value / 25.4));
            ASSERT_EQ(in_mm.has_value(), expected.has_value()) << preset.name << " " << p.key;
            ASSERT_EQ(in_inch.has_value(), expected.has_value()) << preset.name << " " << p.key;
            if (!expected) continue;
            EXPECT_EQ(mesh_of(in_mm->setup.fixtures.at(0).body).vertices, expected->vertices);
            EXPECT_EQ(mesh_of(in_inch->setup.fixtures.at(0).body).vertices, expected->vertices)
                << preset.name << " " << p.key;
            const auto standard = app::preset_mesh(preset);
            if (value != p.standard) {
                ++lengths;
                EXPECT_NE(expected->vertices, standard->vertices) << preset.name << " " << p.key;
            }
        }
    EXPECT_GT(lengths, 200u);
}

TEST(PresetInSetup, IsAMachineBodyToo) {
    const auto file = read("[[machine.axis]]\nname = \"X\"\nside = \"table\"\n[[machine.body]]\n"
                           "name = \"table\"\naxis = \"X\"\npreset = \"t-slot-table-14\"\n"
                           "slots = 5\nwidth = 400\n");
    ASSERT_TRUE(file) << app::error_text(file.error());
    ASSERT_EQ(file->setup.machine.bodies.size(), 1u);
    EXPECT_EQ(core::bounds(file->setup.machine.bodies[0].body).max, core::Vec3(300, 200, 0));
    EXPECT_THAT(file->assumptions,
                testing::Contains("table: sizes other than slots, width are those of the preset "
                                  "t-slot-table-14, not measured"));
}

TEST(PresetInSetup, SaysOnceWhichSizesAreNotMeasured) {
    EXPECT_THAT(assumptions_of(fixture("preset = \"vise-6\"\n")),
                ElementsAre("a: all sizes are those of the preset vise-6, not measured"));
    EXPECT_THAT(assumptions_of(fixture("preset = \"vise-6\"\nopening = 50\n")),
                ElementsAre("a: sizes other than opening are those of the preset vise-6, not "
                            "measured"));
    EXPECT_THAT(assumptions_of(fixture("preset = \"parallel\"\nlength = 1\nwidth = 2\n"
                                       "height = 3\n")),
                IsEmpty());
    EXPECT_THAT(assumptions_of(fixture("preset = \"parallel\"\n[[fixture.move]]\nline = 3\n"
                                       "at = [1, 0, 0]\n")),
                testing::SizeIs(1));
}

TEST(PresetInSetup, RefusesMistakesWithTheirPlace) {
    const std::string vise = fixture("preset = \"vise-6\"\n");
    EXPECT_THAT(error_of(fixture("preset = \"vice-6\"\n")),
                HasSubstr("s.toml:3:10: [[fixture]] 1: preset = \"vice-6\": there is no preset "
                          "\"vice-6\"; did you mean \"vise-6\"?"));
    EXPECT_THAT(error_of(fixture("preset = 6\n")), HasSubstr("s.toml:3:10:"));
    EXPECT_THAT(error_of(fixture("preset = \"\"\n")), HasSubstr("there is no preset \"\""));
    EXPECT_THAT(error_of(vise + "openin = 50\n"),
                HasSubstr("s.toml:4:1: [[fixture]] 1: unknown key \"openin\"; did you mean "
                          "\"opening\"?"));
    EXPECT_THAT(error_of(vise + "colour = 50\n"), HasSubstr("jaw_height jaw_width"));
    for (const char* value : {"0", "-1", "-0.0", "231", "999999", "-999999"})
        EXPECT_THAT(error_of(vise + "opening = " + value + "\n"),
                    HasSubstr("s.toml:4:11: [[fixture]] 1: opening of vise-6 must be between 0.5 "
                              "mm and 230 mm"));
    for (const char* value : {"nan", "inf", "-inf", "\"50\"", "[50]", "{}"})
        EXPECT_THAT(error_of(vise + "opening = " + value + "\n"), HasSubstr("s.toml:4:11:"))
            << value;
    EXPECT_THAT(error_of(vise + "opening = 1e300\n"), HasSubstr("s.toml:4:11:"));
    EXPECT_THAT(error_of("length_unit = \"inch\"\n" + vise + "opening = 10\n"),
                HasSubstr("must be between 0.02 in and 9.055 in"));
    EXPECT_THAT(error_of(fixture("preset = \"step-block\"\nsteps = 2.5\n")),
                HasSubstr("s.toml:4:9: [[fixture]] 1: steps of step-block must be a whole number "
                          "from 1 to 40"));
    EXPECT_THAT(error_of(vise + "opening = 220\nfront_length = 200\n"),
                HasSubstr("s.toml:3:10: [[fixture]] 1: preset = \"vise-6\": opening must be less "
                          "than front_length"));
    EXPECT_THAT(error_of(vise + "screw_size = 80\n"),
                HasSubstr("screw_size must be less than bed_height"));
}

TEST(PresetInSetup, ExcludesOtherShapesAndOtherBodies) {
    const std::string vise = "preset = \"vise-6\"\n", box = "box = [[0, 0, 0], [1, 1, 1]]\n";
    EXPECT_THAT(error_of(fixture(vise + box)), HasSubstr("a single shape"));
    EXPECT_THAT(error_of(fixture(box + "opening = 50\n")), HasSubstr("unknown key \"opening\""));
    EXPECT_THAT(error_of(fixture(vise + "mesh_unit = \"inch\"\n")), HasSubstr("mesh_unit"));
    EXPECT_THAT(error_of(fixture("")), HasSubstr("one of box, cylinder, mesh, preset"));
    for (const char* body : {"[stock]\n", "[part]\n"})
        for (const std::string& other : {std::string(), box})
            EXPECT_THAT(error_of(body + vise + other),
                        HasSubstr("s.toml:2:10: "
                                  + std::string(body).substr(0, std::string(body).size() - 1)
                                  + ": preset applies only to fixtures and machine bodies"));
}

// --- what a text states, and its edits ---

const std::string text = R"(# my vise
length_unit = "inch"
[[fixture]]
name = "vise"      # on the left
preset = "vise-6"  # the new one
opening = 2.0      # measured
jaw_height = 1.75
at = [1, 2, 3]
)";
const BodyPath vise{"fixture", size_t{0}};

TEST(StatedPreset, IsRead) {
    const app::StatedSetup stated = app::stated_in(text);
    ASSERT_EQ(stated.fixtures.size(), 1u);
    const app::StatedBody& body = stated.fixtures[0];
    EXPECT_TRUE(body.has_shape());
    EXPECT_EQ(body.preset, "vise-6");
    EXPECT_EQ(body.preset_values,
              (app::PresetValues{{"opening", 50.8}, {"jaw_height", 1.75 * 25.4}}));
    const app::StatedSetup other =
        app::stated_in(fixture("preset = \"no-such\"\nopening = 5\nsteps = 3\n"));
    EXPECT_EQ(other.fixtures.at(0).preset, "no-such");
    EXPECT_THAT(other.fixtures.at(0).preset_values, IsEmpty());
    const app::StatedSetup block = app::stated_in(
        "length_unit = \"inch\"\n" + fixture("preset = \"step-block\"\nsteps = 3\n"));
    EXPECT_EQ(block.fixtures.at(0).preset_values, (app::PresetValues{{"steps", 3.0}}));
}

TEST(StatedPreset, IsReplacedWithTheSizesThatBothHave) {
    const std::string smaller = app::with_preset(text, vise, "vise-4").value();
    EXPECT_THAT(smaller,
                HasSubstr("preset = \"vise-4\"  # the new one\nopening = 2.0      # measured\n"));
    const std::string block = app::with_preset(text, vise, "1-2-3-block").value();
    EXPECT_THAT(block, HasSubstr("preset = \"1-2-3-block\"  # the new one\nat = [1, 2, 3]\n"));
    EXPECT_EQ(error_of(block + "[offsets]\nG54 = { X = 1 }\n"), "");
    const auto unknown = app::with_preset(text, vise, "vice-6");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().message, HasSubstr("did you mean \"vise-6\"?"));
}

TEST(StatedPreset, TakesThePlaceOfOtherShapesAndLeavesItToThem) {
    core::Aabb unit;
    unit.extend(core::Vec3(0.0));
    unit.extend(core::Vec3(25.4));
    const std::string box = app::with_box(text, vise, unit).value();
    EXPECT_EQ(box, "# my vise\nlength_unit = \"inch\"\n[[fixture]]\nname = \"vise\"      # on the "
                   "left\nat = [1, 2, 3]\nbox = [[0, 0, 0], [1, 1, 1]]\n");
    for (const auto& changed :
         {app::with_cylinder(text, vise, 5, 5, 2), app::with_mesh(text, vise, "a.stl")})
        for (const char* key : {"preset", "opening", "jaw_height"})
            EXPECT_THAT(changed.value(), Not(HasSubstr(key)));
    const std::string back = app::with_preset(box, vise, "vise-5").value();
    EXPECT_THAT(back, HasSubstr("preset = \"vise-5\"\n"));
    EXPECT_THAT(back, Not(HasSubstr("box")));
    const std::string mesh = fixture("mesh = \"a.stl\"\nmesh_unit = \"inch\"\n");
    EXPECT_EQ(app::with_preset(mesh, vise, "vise-5").value(), fixture("preset = \"vise-5\"\n"));
}

TEST(StatedPreset, TakesValues) {
    const auto changed = [](std::string_view key, std::optional<double> value) {
        const auto result = app::with_preset_value(text, vise, key, value);
        return result ? *result : result.error().message;
    };
    EXPECT_THAT(changed("opening", 63.5), HasSubstr("opening = 2.5      # measured\n"));
    EXPECT_THAT(changed("bed_width", 127.0), HasSubstr("bed_width = 5\n"));
    EXPECT_THAT(changed("opening", {}), Not(HasSubstr("opening")));
    EXPECT_EQ(changed("bed_width", {}), text);
    EXPECT_THAT(changed("opening", 500.0), HasSubstr("opening must be from 0.5 to 230 mm"));
    EXPECT_THAT(changed("opening", std::nan("")), HasSubstr("opening must be"));
    EXPECT_THAT(changed("steps", 5.0), HasSubstr("vise-6 has no size steps; it has: opening"));
    EXPECT_THAT(changed("at", {}), HasSubstr("vise-6 has no size at"));
    const std::string block = "length_unit = \"inch\"\n" + fixture("preset = \"step-block\"\n");
    EXPECT_THAT(app::with_preset_value(block, vise, "steps", 7.0).value(),
                HasSubstr("steps = 7\n"));
    const auto plain =
        app::with_preset_value(fixture("box = [[0, 0, 0], [1, 1, 1]]\n"), vise, "opening", 5.0);
    ASSERT_FALSE(plain);
    EXPECT_THAT(plain.error().message, HasSubstr("this body has no preset"));
}

TEST(StatedPreset, AndAllItsValuesComeBack) {
    for (const Preset& preset : app::presets()) {
        std::string edited =
            app::with_fixture("length_unit = \"inch\"\n", "a", preset_line(preset.name)).value();
        app::PresetValues values;
        for (const app::PresetParameter& p : preset.parameters) {
            edited = app::with_preset_value(edited, vise, p.key, p.standard).value();
            values.emplace(p.key, p.standard);
        }
        const app::StatedSetup stated = app::stated_in(edited);
        for (const auto& [key, value] : stated.fixtures.at(0).preset_values)
            EXPECT_NEAR(value, values.at(key), 1e-6) << edited;
        EXPECT_EQ(stated.fixtures.at(0).preset_values.size(), values.size());
        EXPECT_EQ(error_of(edited), "") << edited;
        EXPECT_THAT(assumptions_of(edited), IsEmpty());
    }
}

} // namespace
} // namespace app_test
