#include <cmath>
#include <map>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/machines/machine_preset.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/stated_setup.h"
#include "core/geom/mesh.h"
#include "core/motion/event.h"
#include "tests/support/scoped_folder.h"

/// The presets of machines in set-ups.

namespace app_test {
namespace {

using app::MachineKind;
using app::MachinePreset;
using core::MachineAxis;
using testing::Contains;
using testing::HasSubstr;

core::Result<app::SetupFile> read(const std::string& text) {
    return app::read_setup_text(text + "[offsets]\nG54 = { X = 0 }\n", "s.toml", {});
}

std::string named(std::string_view name, const std::string& lines = {}) {
    return fmt::format("[machine]\npreset = \"{}\"\n{}", name, lines);
}

core::Machine machine_of(const std::string& text) {
    const auto file = read(text);
    EXPECT_TRUE(file) << (file ? "" : app::error_text(file.error()));
    return file ? file->setup.machine : core::Machine{};
}

std::string error_of(const std::string& text) {
    const auto file = read(text);
    return file ? std::string() : app::error_text(file.error());
}

const MachineAxis& axis(const core::Machine& machine, char letter) {
    return machine.axes[core::axis_letters.find(letter)];
}

const core::MachineBody* body(const core::Machine& machine, const std::string& name) {
    for (const core::MachineBody& each : machine.bodies)
        if (each.name == name) return &each;
    return nullptr;
}

/// The sizes that a rotary axis and its table need.
std::string places(const MachinePreset& preset) {
    std::string lines;
    for (const char* key : {"centre_x", "centre_y", "centre_z"})
        if (preset.size(key)) lines += fmt::format("{} = {}\n", key, key[7] == 'z' ? -500 : -150);
    for (const char* key : {"pivot_length", "centre_to_table", "spindle_to_table"})
        if (preset.size(key)) lines += fmt::format("{} = 60\n", key);
    return lines;
}

TEST(MachinePresets, AreOfAllKindsAndMostlyOfAMake) {
    std::set<MachineKind> kinds;
    size_t named_ones = 0;
    for (const MachinePreset& preset : app::machine_presets()) {
        kinds.insert(preset.kind);
        if (!preset.is_generic) ++named_ones;
        EXPECT_EQ(app::find_machine_preset(preset.name), &preset);
        EXPECT_FALSE(preset.source.empty() || preset.zero.empty() || preset.title.empty());
        EXPECT_EQ(preset.is_generic, preset.source.starts_with("No make"));
    }
    EXPECT_EQ(kinds.size(), app::machine_kinds.size());
    EXPECT_GE(named_ones, 15u);
}

TEST(MachinePresets, HaveSizesThatASetUpCanHold) {
    const std::set<std::string_view> taken = {"file", "rapid",       "corner_tolerance",
                                              "axis", "other_axes",  "rapid_corner_tolerance",
                                              "body", "length_unit", "preset"};
    for (const MachinePreset& preset : app::machine_presets()) {
        std::set<std::string_view> keys;
        for (const app::MachineSize& size : preset.sizes) {
            EXPECT_TRUE(keys.insert(size.key).second) << preset.name << " " << size.key;
            EXPECT_FALSE(taken.contains(size.key));
            EXPECT_LT(size.least, size.greatest);
            EXPECT_TRUE(!size.standard || app::fits(size, *size.standard)) << size.key;
            EXPECT_TRUE(size.standard || !size.is_typical) << size.key;
        }
    }
}

/// Travels from the texts that the presets cite, in the unit of the text.
struct Travel {
    double x, y, z, unit;
};
const std::map<std::string_view, Travel> travels = {
    {"tormach-xstech", {8.8, 6.5, 2.5, 25.4}},
    {"tormach-440", {10, 6.25, 10, 25.4}},
    {"tormach-770m", {14, 7.5, 13.25, 25.4}},
    {"tormach-1100-3", {18, 9.5, 16.25, 25.4}},
    {"tormach-1100mx", {18, 11, 16.25, 25.4}},
    {"smithy-1240", {22, 12, 12, 25.4}},
    {"bridgeport-boss", {18, 12, 4.75, 25.4}},
    {"longmill-mk2-12x30", {792, 345, 114.3, 1}},
    {"longmill-mk2-30x30", {792, 845, 114.3, 1}},
    {"longmill-mk2-48x30", {1279.9, 845, 114.3, 1}},
    {"sienci-mill-one", {258, 185, 90, 1}},
    {"onefinity", {819.15, 819.15, 113.35, 1}},
    {"shapeoko-3-xl", {33, 16, 3, 25.4}},
    {"haas-desktop-mill", {152, 254, 76, 1}},
    {"haas-vf-2", {762, 406, 508, 1}},
    {"haas-vf-4", {1270, 508, 635, 1}},
    {"haas-vf-5", {1270, 660, 635, 1}},
    {"haas-umc-750", {762, 508, 508, 1}},
    {"dmg-dmu-50", {500, 450, 400, 1}},
    {"linuxcnc-max5", {300, 120, 150, 1}},
    {"linuxcnc-bridgemill", {1000, 1000, 600, 1}},
};

TEST(MachinePresets, HaveTheTravelsOfTheirSources) {
    for (const MachinePreset& preset : app::machine_presets()) {
        const core::Machine machine = machine_of(named(preset.name));
        const auto found = travels.find(preset.name);
        EXPECT_EQ(found == travels.end(), preset.is_generic) << preset.name;
        if (found == travels.end()) continue;
        const double expected[] = {found->second.x, found->second.y, found->second.z};
        for (int i = 0; i < 3; ++i) {
            const MachineAxis& a = axis(machine, "XYZ"[i]);
            EXPECT_NEAR(*a.max - *a.min, expected[i] * found->second.unit, 1e-5) << preset.name;
            EXPECT_LE(*a.min, 0.0);
            EXPECT_GE(*a.max, 0.0);
        }
    }
    const core::Machine fast = machine_of(named("tormach-1100mx"));
    EXPECT_NEAR(*axis(fast, 'X').rapid, 300 * 25.4, 1e-6);
    EXPECT_NEAR(*axis(fast, 'Z').acceleration, 19.167 * 25.4, 1e-6);
    EXPECT_FALSE(axis(machine_of(named("haas-vf-2")), 'X').acceleration);
}

TEST(MachinePresets, DescribeAMachineThatIsUsable) {
    for (const MachinePreset& preset : app::machine_presets())
        for (const bool is_placed : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", preset.name, is_placed));
            const auto file = read(named(preset.name, is_placed ? places(preset) : ""));
            ASSERT_TRUE(file) << app::error_text(file.error());
            const core::Machine& machine = file->setup.machine;
            const bool has_rotary = preset.rotary != 0;
            EXPECT_EQ(file->has_axes, is_placed || !has_rotary);
            for (const char letter : {preset.tilt, preset.rotary})
                EXPECT_TRUE(letter == 0 || axis(machine, letter).present == is_placed);
            const core::AxisPosition home = machine.home();
            for (size_t i = 0; i < 3; ++i) EXPECT_EQ(home[i], 0.0);
            ASSERT_NE(body(machine, "nose"), nullptr);
            EXPECT_EQ(body(machine, "nose")->link, machine.spindle);
            const bool is_router = preset.kind == MachineKind::router;
            const core::LinkId end = is_router ? core::LinkId::base : machine.table;
            const core::MachineBody* const table = body(machine, "table");
            EXPECT_TRUE(!table || table->link == end);
        }
}

TEST(MachinePresets, HaveTheNoseAtItsDistanceFromTheTable) {
    const std::map<std::string_view, double> distances = {
        {"haas-vf-2", 610}, {"haas-vf-4", 742}, {"haas-vf-5", 742}, {"haas-desktop-mill", 80}};
    for (const auto& [name, distance] : distances) {
        const core::Machine machine = machine_of(named(name));
        const core::Aabb table = core::bounds(body(machine, "table")->body);
        const core::Aabb nose = core::bounds(body(machine, "nose")->body);
        EXPECT_NEAR(*axis(machine, 'Z').max + nose.min.z - table.max.z, distance, 1e-9);
        EXPECT_NEAR(nose.min.z, 0.0, 1e-12); // the gauge line
        EXPECT_NEAR(table.min.x + table.max.x, *axis(machine, 'X').min + *axis(machine, 'X').max,
                    1e-9);
        EXPECT_NEAR(table.min.y + table.max.y, *axis(machine, 'Y').min + *axis(machine, 'Y').max,
                    1e-9);
        EXPECT_GT(distance, *axis(machine, 'Z').max - *axis(machine, 'Z').min); // it stays above
    }
    const core::Aabb table = core::bounds(body(machine_of(named("haas-vf-2")), "table")->body);
    EXPECT_NEAR(table.max.x - table.min.x, 914, 1e-9);
    EXPECT_NEAR(table.max.y - table.min.y, 356, 1e-9);
}

TEST(MachinePresets, TakeSizes) {
    const core::Machine machine =
        machine_of(named("haas-vf-2", "x_min = -700\nz_max = 10\nrapid_x = 25000\n"
                                      "acceleration_z = 4000\nnose_diameter = 90\n"
                                      "table_length = 1000\nnose_to_table = 620\n"));
    EXPECT_EQ(axis(machine, 'X').min, -700);
    EXPECT_EQ(axis(machine, 'X').rapid, 25000);
    EXPECT_EQ(axis(machine, 'Z').acceleration, 4000);
    EXPECT_NEAR(core::bounds(body(machine, "nose")->body).max.x, 45, 1e-9);
    const core::Aabb table = core::bounds(body(machine, "table")->body);
    EXPECT_NEAR(table.max.z, 10 - 620, 1e-9);
    EXPECT_NEAR(table.min.x, -350 - 500, 1e-9);
}

TEST(MachinePresets, TakeSizesInInches) {
    std::mt19937 random(2);
    for (const MachinePreset& preset : app::machine_presets()) {
        std::string in_mm, in_inch;
        for (const app::MachineSize& size : preset.sizes) {
            const bool is_place = size.key.find("_m") != std::string_view::npos;
            if (is_place || random() % 2 == 0) continue;
            const double value =
                std::ceil(std::fmax(size.least, size.standard.value_or(16)) / 4) * 4;
            const double mm = app::is_angle(size.unit) ? value : value * 25.4;
            if (!app::fits(size, mm)) continue;
            in_mm += fmt::format("{} = {}\n", size.key, mm);
            in_inch += fmt::format("{} = {}\n", size.key, value);
        }
        for (const char* key : {"centre_x", "centre_y", "centre_z"})
            if (preset.size(key) && in_mm.find(key) == std::string::npos) {
                in_mm += fmt::format("{} = {}\n", key, -4 * 25.4);
                in_inch += fmt::format("{} = -4\n", key);
            }
        const core::Machine a = machine_of(named(preset.name, in_mm));
        const core::Machine b =
            machine_of("length_unit = \"inch\"\n" + named(preset.name, in_inch));
        for (size_t i = 0; i < core::axis_count; ++i) {
            EXPECT_EQ(a.axes[i].rapid, b.axes[i].rapid) << preset.name;
            EXPECT_EQ(a.axes[i].acceleration, b.axes[i].acceleration);
            EXPECT_EQ(a.axes[i].point, b.axes[i].point);
        }
        ASSERT_EQ(a.bodies.size(), b.bodies.size());
        for (size_t i = 0; i < a.bodies.size(); ++i)
            EXPECT_EQ(core::bounds(a.bodies[i].body).max, core::bounds(b.bodies[i].body).max);
    }
}

TEST(MachinePresets, TurnAboutTheirCentre) {
    const core::Machine trunnion =
        machine_of(named("haas-umc-750", "centre_x = -380\ncentre_y = -250\ncentre_z = -550\n"
                                         "centre_to_table = 50\n"));
    EXPECT_EQ(axis(trunnion, 'B').point, core::Vec3(-380, -250, -550));
    EXPECT_EQ(axis(trunnion, 'B').direction, core::Vec3(0, 1, 0));
    EXPECT_EQ(axis(trunnion, 'B').min, -35);
    EXPECT_EQ(axis(trunnion, 'B').max, 120);
    EXPECT_EQ(axis(trunnion, 'C').carrier, core::link_of(core::axis_letters.find('B')));
    EXPECT_FALSE(axis(trunnion, 'C').min);
    const core::Aabb table = core::bounds(body(trunnion, "table")->body);
    EXPECT_NEAR(table.max.z, -600, 1e-9);
    EXPECT_NEAR(table.max.x + 380, 250, 1e-9);

    const core::Machine heads = machine_of(named("linuxcnc-bridgemill", "pivot_length = 250\n"));
    EXPECT_EQ(axis(heads, 'B').side, core::Side::tool);
    EXPECT_EQ(axis(heads, 'B').point, core::Vec3(0, 0, 250));
    EXPECT_EQ(heads.spindle, core::link_of(core::axis_letters.find('B')));

    const core::Machine both =
        machine_of(named("linuxcnc-max5", "pivot_length = 120\ncentre_x = 20\ncentre_y = 5\n"));
    EXPECT_EQ(axis(both, 'B').side, core::Side::tool);
    EXPECT_EQ(axis(both, 'C').side, core::Side::table);
    EXPECT_EQ(axis(both, 'C').point, core::Vec3(20, 5, 0));
}

TEST(MachinePresets, GiveWayToAxesOfTheSetUp) {
    const core::Machine machine =
        machine_of(named("haas-vf-2", "[[machine.axis]]\nname = \"A\"\ndirection = [1, 0, 0]\n"
                                      "point = [-400, -200, -500]\n"));
    EXPECT_EQ(axis(machine, 'A').carrier, core::link_of(1));
    EXPECT_EQ(axis(machine, 'X').min, -762);
    EXPECT_EQ(body(machine, "table")->link, core::link_of(1)); // what moves in X and Y
    EXPECT_EQ(axis(machine, 'Y').carrier, core::link_of(0));
    const core::Machine other = machine_of(named(
        "haas-vf-2", "[[machine.axis]]\nname = \"X\"\nside = \"table\"\nmin = -500\nmax = 0\n"));
    EXPECT_EQ(axis(other, 'X').min, -500);
}

TEST(MachinePresets, SayWhatIsNotMeasured) {
    const auto lines = [](const std::string& text) { return read(text)->assumptions; };
    EXPECT_THAT(lines(named("haas-vf-2")),
                Contains("x_min, x_max, y_min, y_max, z_min, z_max, nose_to_table, table_length "
                         "and table_width are those of the preset haas-vf-2, not measured"));
    EXPECT_THAT(lines(named("haas-vf-2", "nose_diameter = 90\n")),
                Contains("table_thickness, nose_length, head_width, head_depth and head_height "
                         "are typical of such machines, not stated by the source of haas-vf-2"));
    EXPECT_THAT(lines(named("tormach-440")),
                Contains("nothing states nose_to_table, table_length and table_width of "
                         "tormach-440, so its table is not checked"));
    EXPECT_THAT(lines(named("haas-umc-750")),
                Contains("nothing states centre_x, centre_y and centre_z of haas-umc-750, so where "
                         "B and C turn is not known, and blocks that move them are undecided"));
    EXPECT_THAT(lines(named("generic-knee-mill")),
                Contains(HasSubstr("are typical of such machines, not stated by the maker")));
}

TEST(MachinePresets, RefuseMistakesWithTheirPlace) {
    EXPECT_THAT(error_of("[machine]\npreset = \"haas-vf-3\"\n"),
                HasSubstr("s.toml:2:10: [machine]: preset = \"haas-vf-3\": there is no machine "
                          "\"haas-vf-3\"; did you mean \"haas-vf-2\"?"));
    EXPECT_THAT(error_of("[machine]\npreset = 5\n"), HasSubstr("s.toml:2:10:"));
    EXPECT_THAT(error_of("[machine]\npreset = \"\"\n"), HasSubstr("there is no machine \"\""));
    EXPECT_THAT(error_of(named("haas-vf-2", "x_mim = 5\n")),
                HasSubstr("s.toml:3:1: [machine]: unknown key \"x_mim\"; did you mean \"x_min\"?"));
    EXPECT_THAT(error_of("[machine]\nx_min = -5\n"), HasSubstr("unknown key \"x_min\""));
    EXPECT_THAT(error_of(named("haas-vf-2", "file = \"a.toml\"\n")),
                HasSubstr("s.toml:2:10: [machine]: preset cannot be combined with file"));
    EXPECT_THAT(error_of(named("haas-vf-2", "x_min = 5\n")),
                HasSubstr("s.toml:2:10: [machine]: preset = \"haas-vf-2\": x_min must be below "
                          "x_max"));
    EXPECT_THAT(error_of(named("haas-umc-750", "centre_x = 5\n")),
                HasSubstr("centre_x, centre_y and centre_z belong together: centre_y and centre_z "
                          "are missing"));
    EXPECT_THAT(error_of(named("haas-vf-2", "rapid_x = 0\n")),
                HasSubstr("s.toml:3:11: [machine]: rapid_x must be from 1 to 1000000 mm/min"));
    EXPECT_THAT(error_of("length_unit = \"inch\"\n" + named("haas-vf-2", "x_min = -9999\n")),
                HasSubstr("between -3937.008 in and 3937.008 in"));
    for (const char* value : {"nan", "inf", "-inf", "\"5\"", "[5]", "{}", "1e300", "-1e300"})
        for (const char* key : {"x_min", "rapid_x", "acceleration_y", "nose_diameter"})
            EXPECT_THAT(error_of(named("haas-vf-2", fmt::format("{} = {}\n", key, value))),
                        HasSubstr("s.toml:3:"))
                << key << value;
}

TEST(MachinePresets, AreTheSameFromTheirFile) {
    const test_support::ScopedFolder folder;
    for (const MachinePreset& preset : app::machine_presets()) {
        const auto made = app::machine_text(preset);
        ASSERT_TRUE(made);
        const core::Machine a = machine_of(named(preset.name));
        const core::Machine b = machine_of(
            fmt::format("[machine]\nfile = \"{}\"\n", folder.write("machine.toml", made->toml)));
        for (size_t i = 0; i < core::axis_count; ++i) {
            EXPECT_EQ(a.axes[i].min, b.axes[i].min);
            EXPECT_EQ(a.axes[i].rapid, b.axes[i].rapid);
            EXPECT_EQ(a.axes[i].carrier, b.axes[i].carrier);
        }
        EXPECT_EQ(a.bodies.size(), b.bodies.size());
    }
}

TEST(MachinePresets, WithAnySizesAreAMachineOrAnError) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> share(0, 1);
    int made = 0, refused = 0;
    for (const MachinePreset& preset : app::machine_presets())
        for (int i = 0; i < 100; ++i) {
            app::PresetValues values;
            for (const app::MachineSize& size : preset.sizes)
                if (share(random) < 0.3)
                    values.emplace(size.key, std::fmax(size.least, -1500)
                                                 + (std::fmin(size.greatest, 1500)
                                                    - std::fmax(size.least, -1500))
                                                       * share(random));
            const auto text = app::machine_text(preset, values);
            if (!text) {
                ++refused;
                EXPECT_THAT(text.error().message, testing::AnyOf(HasSubstr("must be below"),
                                                                 HasSubstr("belong together")));
                continue;
            }
            ++made;
            std::string lines;
            for (const auto& [key, value] : values) lines += fmt::format("{} = {}\n", key, value);
            EXPECT_EQ(error_of(named(preset.name, lines)), "");
        }
    EXPECT_GT(made, 500);
    EXPECT_GT(refused, 100);
}

// --- what a text states, and its edits ---

const std::string text = R"(length_unit = "inch"
[machine]          # in the corner
preset = "haas-vf-2"  # the old one
x_min = -30.5      # measured
head_depth = 12
)";

TEST(StatedMachine, IsRead) {
    const app::StatedSetup stated = app::stated_in(text);
    EXPECT_EQ(stated.machine_preset, "haas-vf-2");
    EXPECT_EQ(stated.machine_values,
              (app::PresetValues{{"x_min", -30.5 * 25.4}, {"head_depth", 12 * 25.4}}));
    EXPECT_EQ(app::stated_in("[machine]\npreset = \"no-such\"\nx_min = 3\n").machine_values.size(),
              0u);
    EXPECT_EQ(app::stated_in("machine = 5\n").machine_preset, "");
}

TEST(StatedMachine, IsReplacedWithTheSizesThatBothHave) {
    const std::string router = app::with_machine_preset(text, "onefinity").value();
    EXPECT_THAT(router, HasSubstr("preset = \"onefinity\"  # the old one\nx_min = -30.5      # "
                                  "measured\n"));
    EXPECT_THAT(router, testing::Not(HasSubstr("head_depth")));
    EXPECT_EQ(error_of(router), "");
    const std::string file = app::with_machine_file(text, "m.toml").value();
    EXPECT_THAT(file, HasSubstr("file = \"m.toml\""));
    EXPECT_THAT(file, testing::Not(HasSubstr("x_min")));
    EXPECT_THAT(
        app::with_machine_preset(file, "haas-vf-4").value(),
        testing::AllOf(HasSubstr("preset = \"haas-vf-4\""), testing::Not(HasSubstr("m.toml"))));
    EXPECT_THAT(app::with_machine_preset("", "haas-vf-2").value(),
                HasSubstr("[machine]\npreset = \"haas-vf-2\"\n"));
    EXPECT_FALSE(app::with_machine_preset(text, "haas-vf-3"));
}

TEST(StatedMachine, TakesValuesInTheUnitOfTheText) {
    const std::string wide = app::with_machine_value(text, "nose_diameter", 127.0).value();
    EXPECT_THAT(wide, HasSubstr("nose_diameter = 5\n"));
    EXPECT_THAT(app::with_machine_value(wide, "nose_diameter", std::nullopt).value(),
                testing::Not(HasSubstr("nose_diameter")));
    EXPECT_THAT(app::with_machine_value(text, "x_min", -800.1).value(),
                HasSubstr("x_min = -31.5      # measured\n"));
    EXPECT_FALSE(app::with_machine_value(text, "x_min", 1e9));
    EXPECT_FALSE(app::with_machine_value(text, "jaw", 5.0));
    EXPECT_FALSE(app::with_machine_value("", "x_min", 5.0));
}

} // namespace
} // namespace app_test
