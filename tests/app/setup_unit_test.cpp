#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_length.h"
#include "app/setup/setup_text.h"
#include "app/setup/stated_setup.h"
#include "app/setup/toml_file.h"
#include "core/base/file_reads.h"
#include "gcode/language/modal_state.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/stl_writer.h"

/// The unit of the lengths in a set-up.

namespace app_test {
namespace {

using gcode::LengthUnit;
using testing::HasSubstr;
using testing::Not;

constexpr double mm_per_inch = 25.4;
const std::string inch = "length_unit = \"inch\"\n";

/// Texts in which each length in inches is written as <0.5>. Keys exclude each other, so there are
/// several. The files that they name are `machine.toml` and `holders.toml`.
const std::vector<std::string> templates = {
    // clang-format off
    R"(mesh_size = <0.02>
allowance = <0.08>
[program]
dialect = "fanuc"
start = { X = <-1.5>, Y = <-2.25>, Z = <-0.125>, A = 30, U = <0.75> }
values = { "#500" = 2.5 }
[control]
"1240" = { X = <0.1>, Y = <0.2>, Z = <12>, A = 5 }
"1241" = { X = <0.2>, Y = <0.3>, Z = <11> }
"1242" = { X = <0.3>, Y = <0.4>, Z = <10> }
"1243" = { X = <0.4>, Y = <0.5>, Z = <9> }
"5440" = { X = <0.02>, Y = <0.03>, Z = <0> }
"5114" = <0.05>
"5115" = <0.06>
"3410" = <0.0005>
"5410" = 45
"5411" = 2.5
"12322" = 1.5
[machine]
corner_tolerance = <0.003>
rapid_corner_tolerance = <0.007>
[[machine.axis]]
name = "X"
min = <-20>
max = <3>
home = <0.5>
rapid = <400>
acceleration = <60>
[[machine.axis]]
name = "Y"
min = <-16>
max = <0.25>
[[machine.axis]]
name = "Z"
min = <-30>
max = <0.125>
[[machine.axis]]
name = "U"
side = "table"
min = <-2>
max = <2>
[[machine.axis]]
name = "A"
direction = [1, 0, 0]
point = [<1>, <2>, <-3>]
point_tolerance = <0.004>
direction_tolerance = 0.01
min = -120
max = 120
home = 10
rapid = 3600
acceleration = 900
[[machine.body]]
name = "nose"
axis = "Z"
cylinder = { radius = <2.5>, height = <6> }
at = [<0.01>, <0.02>, <0.03>]
rotate_deg = [10, 20, 30]
[offsets]
G54 = { X = <-13.7>, Y = <-7.9>, Z = <-16.5>, A = 15 }
"G54.1 P1" = { X = <-12>, W = <0.5> }
[[length_offset]]
number = 3
length = <5.125>
wear = <-0.004>
diameter = <0.25>
[stock]
box = [[<0>, <0>, <-1.25>], [<4>, <3>, <0>]]
at = [<0.5>, <0.25>, <0.125>]
tolerance = <0.03>
[[fixture]]
name = "clamp"
box = [[<0>, <0>, <0>], [<1>, <2>, <3>]]
at = [<4>, <5>, <6>]
rotate_deg = [0, 0, 90]
[[fixture.move]]
line = 2
at = [<7>, <8>, <9>]
rotate_deg = [0, 0, 45]
[[fixture]]
name = "stud"
cylinder = { radius = <0.25>, height = <2>, axis = "X" }
[part]
box = [[<0>, <0>, <-1>], [<3>, <2>, <0>]]
at = [<0.25>, <0.5>, <0.75>]
tolerance = <0.004>
)",
    R"([[allowance]]
distance = <0.08>
[[allowance]]
between = ["holder", "stock"]
distance = <0.25>
contact = <0.002>
[program]
dialect = "haas"
[control]
"second home" = [<1>, <2>, <3>]
"setting 22" = <0.04>
"setting 52" = <0.05>
"setting 35" = <0.02>
"setting 85" = <0.001>
"setting 72" = 30
[stock]
cylinder = { radius = <2>, height = <5> }
at = [<1>, <2>, <-5>]
[machine]
file = "machine.toml"
)",
    R"([program]
dialect = "siemens"
[control]
MD30600 = { X = <1>, Y = <2>, Z = <3>, B = 4 }
"CYCLE800 X" = <5>
"CYCLE800 Y" = <6>
"CYCLE800 Z" = <7>
[stock]
margin = <0.25>
tolerance = <0.01>
)",
    R"([[tool]]
number = 1
shape = "bull"
diameter = <0.5>
corner_radius = <0.06>
flute_length = <1.25>
neck_diameter = <0.4>
neck_length = <0.5>
shank_diameter = <0.5>
stick_out = <2.75>
gauge_length = <6>
touched_off = <4.5>
cuts_at_centre = false
centre_diameter = <0.1>
[[tool]]
number = 2
shape = "taper"
diameter = <0.5>
tip_diameter = <0.25>
corner_radius = <0.03>
angle_deg = 10
flute_length = <1.5>
shank = [[<0.5>, <0.75>, <1>], [<0.75>, <0.75>, <0.5>]]
holder = [[<1.5>, <2>, <1.25>]]
[[tool]]
number = 3
shape = "threadmill"
diameter = <0.375>
pitch = <0.05>
teeth = 4
thread_deg = 60
flute_length = <0.5>
stick_out = <2>
holder = [[<1>, <0>], [<1.25>, <2>], [<2.5>, <2.5>]]
[[tool]]
number = 4
shape = "profile"
profile = [[<0>, <0>], [<0.25>, <0.125>], [<0.5>, <1>]]
shank = [[<0.5>, <0>], [<0.5>, <2>]]
stick_out = <3>
holder = "A"
holder_file = "holders.toml"
[[tool]]
number = 5
shape = "drill"
diameter = <0.25>
point_deg = 135
flute_length = <2>
stick_out = <2.5>
[[tool]]
number = 6
stick_out = <1.5>
touched_off = "unknown"
)"};
// clang-format on

/// A template with its lengths in a unit. `changed`: the number of a length that is larger.
std::string written(const std::string& form, LengthUnit unit,
                    std::optional<size_t> changed = std::nullopt) {
    std::string text = unit == LengthUnit::inch ? inch : "";
    size_t count = 0;
    for (size_t at = 0; at < form.size(); ++at) {
        if (form[at] != '<') {
            text += form[at];
            continue;
        }
        const size_t end = form.find('>', at);
        double value = std::stod(form.substr(at + 1, end - at - 1));
        if (changed == count++) value += 0.0078125; // a power of two
        text += app::toml_number(unit == LengthUnit::inch ? value : value * mm_per_inch);
        at = end;
    }
    return text;
}

size_t lengths_in(const std::string& form) {
    return static_cast<size_t>(std::count(form.begin(), form.end(), '<'));
}

/// The values of a set-up as text, exact to the last bit.
class SetupValues {
public:
    explicit SetupValues(const app::SetupFile& file) {
        const core::Setup& setup = file.setup;
        const gcode::Environment& environment = file.environment;
        add("mesh", setup.mesh_size, setup.allowance);
        for (const core::AllowanceRule& rule : setup.allowances)
            add(rule.between[0], rule.distance, rule.contact);
        for (const auto& start : environment.start) add("start", start);
        add_axes("home", environment.home);
        add("machine", setup.machine.corner_tolerance, setup.machine.rapid_corner_tolerance);
        for (const core::MachineAxis& axis : setup.machine.axes) {
            add("axis", axis.min, axis.max, axis.home, axis.rapid, axis.acceleration);
            add_point("direction", axis.direction);
            add_point("point", axis.point);
            add("tolerance", axis.point_tolerance, axis.direction_tolerance);
        }
        for (const core::MachineBody& body : setup.machine.bodies)
            add_box(body.name, core::bounds(body.body));
        for (size_t i = 0; i < gcode::plain_offset_count; ++i)
            add_axes("offset", environment.work_offsets[i]);
        for (const auto& [index, origin] : environment.extended_offsets) add_axes("offset", origin);
        for (const auto& [number, row] : environment.length_offsets)
            add("row", row.length, row.wear, row.diameter);
        for (const auto& [number, value] : environment.control.values) add("variable", value);
        for (const auto& [key, value] : file.control.parameters) add(key, value);
        for (const auto& [key, value] : file.control.settings) {
            if (const auto* number = std::get_if<double>(&value)) add(key, *number);
            if (const auto* position = std::get_if<gcode::Position>(&value))
                for (const auto& coordinate : *position) add(key, coordinate);
        }
        add_box("stock", core::bounds(setup.stock));
        add("stock", setup.stock.tolerance, file.stock_margin);
        add_point("mount", setup.stock_mount.link_from_body.translation);
        for (const core::Fixture& fixture : setup.fixtures)
            add_box(fixture.name, core::bounds(fixture.body));
        if (setup.part) {
            add_box("part", core::bounds(setup.part->solid));
            add("part", setup.part->tolerance);
        }
        for (const auto& [number, tool] : setup.tools) add_tool(tool.description);
        for (const auto& [number, tool] : file.partial_tools) add_tool(tool.tool);
    }

    const std::string& text() const { return text_; }

private:
    void put(const std::string& words) { text_ += " " + words; }
    void put(double value) { text_ += fmt::format(" {}", value); }
    void put(const std::optional<double>& value) { value ? put(*value) : put("-"); }
    template <typename... Values>
    void add(const std::string& name, const Values&... values) {
        put(name);
        (put(values), ...);
        text_ += '\n';
    }
    void add_point(const std::string& name, const core::Vec3& p) { add(name, p.x, p.y, p.z); }
    void add_axes(const std::string& name, const std::optional<gcode::AxisValues>& values) {
        for (const double value : values.value_or(gcode::AxisValues{})) add(name, value);
    }
    void add_box(const std::string& name, const core::Aabb& box) {
        add_point(name, box.min);
        add_point(name, box.max);
    }
    void add_cones(const std::string& name, const std::vector<core::ConeStep>& cones) {
        for (const core::ConeStep& cone : cones)
            add(name, cone.lower_diameter, cone.upper_diameter, cone.length);
    }
    void add_tool(const core::ToolDescription& tool) {
        for (const core::ToolSize& size : core::tool_sizes()) add(size.key, size.of(tool));
        add("tool", tool.touched_off, tool.centre_radius);
        for (const auto& [r, z] : tool.outline) add("outline", r, z);
        add_cones("shank", tool.shank);
        add_cones("holder", tool.holder);
    }

    std::string text_;
};

/// A folder with the files that the templates name, which are in mm whatever the set-up is in.
struct SetupFolder {
    test_support::ScopedFolder folder;

    SetupFolder() {
        folder.write("machine.toml", "[[axis]]\nname = \"X\"\nhome = -400\nrapid = 9000\n");
        folder.write("holders.toml",
                     "[[holder]]\nname = \"A\"\ncones = [[20, 30, 40], [30, 40, 25]]\n");
    }
    core::Result<app::SetupFile> read(const std::string& text) const {
        return app::read_setup_text(text, folder / "s.toml", {});
    }
    std::string values(const std::string& text) const {
        const auto file = read(text);
        EXPECT_TRUE(file) << (file ? "" : app::error_text(file.error())) << "\n" << text;
        return file ? SetupValues(*file).text() : "";
    }
    std::string error(const std::string& text) const {
        const auto file = read(text);
        EXPECT_FALSE(file) << text;
        return file ? "" : app::error_text(file.error());
    }
};

TEST(SetupUnit, OfEveryLengthIsThatOfTheFile) {
    const SetupFolder folder;
    for (const std::string& form : templates) {
        const std::string plain = folder.values(written(form, LengthUnit::inch));
        EXPECT_EQ(plain, folder.values(written(form, LengthUnit::mm)));
        for (size_t i = 0; i < lengths_in(form); ++i) {
            const auto in_inch = folder.read(written(form, LengthUnit::inch, i));
            const auto in_mm = folder.read(written(form, LengthUnit::mm, i));
            // Some lengths contradict others when they change.
            ASSERT_EQ(in_inch.has_value(), in_mm.has_value()) << i;
            if (!in_inch) continue;
            const std::string changed = SetupValues(*in_inch).text();
            EXPECT_EQ(changed, SetupValues(*in_mm).text()) << i;
            EXPECT_NE(changed, plain) << written(form, LengthUnit::inch, i);
        }
    }
}

/// The keys in the first column of the tables of a page of the manual.
std::set<std::string> keys_of_page(const std::string& page) {
    const auto text = core::file_bytes(FEELER_SOURCE_DIR "/docs/manual/" + page);
    EXPECT_TRUE(text) << page;
    const std::regex row(R"(\n\|([^|]*)\|)"), key(R"re(`"?(\w+( \w+)*)"?`)re");
    std::set<std::string> keys;
    const std::string all = text.value_or("");
    for (std::sregex_iterator at(all.begin(), all.end(), row), end; at != end; ++at) {
        const std::string cell = (*at)[1];
        for (std::sregex_iterator word(cell.begin(), cell.end(), key); word != end; ++word)
            keys.insert((*word)[1]);
    }
    return keys;
}

/// Keys that hold no length, and words in the first column that are no keys.
const std::set<std::string> other_keys = {
    "length_unit",
    "fixtures",
    "assumed",
    "memory_limit",
    "tool_library",
    "dialect",
    "block_delete",
    "unit",
    "units_at_start",
    "no_decimal_point",
    "ini",
    "parameters",
    "tool_table",
    "search_path",
    "max_blocks",
    "machine_codes",
    "tool_at_start",
    "spindle_at_start",
    "measured_offsets",
    "speed_by_hand",
    "values",
    "number",
    "between",
    "allow_comments",
    "name",
    "shape",
    "angle_deg",
    "point_deg",
    "teeth",
    "thread_deg",
    "holder_file",
    "holder_mesh",
    "spindle",
    "single_point",
    "cuts_at_centre",
    "mesh",
    "mesh_unit",
    "solid",
    "mesh_deviation", // a length, in cad_setup_test.cpp
    "preset",
    "model",
    "rotate_deg",
    "frame",
    "expendable",
    "line",
    "code",
    "remove",
    "file",
    "other_axes",
    "kind",
    "side",
    "parent",
    "direction",
    "direction_tolerance",
    "shortest_way",
    "axis",
    // a rapid of [machine] is a word
};

/// The keys of `[control]` whose row says mm, but for those of LinuxCNC.
std::set<std::string> lengths_of_controls() {
    const auto text = core::file_bytes(FEELER_SOURCE_DIR "/docs/manual/controls-and-dialects.md");
    EXPECT_TRUE(text);
    const std::regex row(R"re(\n\| (Fanuc|Haas|Siemens) \| `"?([^`"]+)"?`[^|]*\|([^|]*)\|)re"),
        in_mm(R"(\bmm( and degrees)?( *$|;))");
    std::set<std::string> keys;
    const std::string all = text.value_or("");
    for (std::sregex_iterator at(all.begin(), all.end(), row), end; at != end; ++at)
        if (std::regex_search((*at)[3].str(), in_mm)) keys.insert((*at)[2]);
    return keys;
}

TEST(SetupUnit, IsDecidedForEveryKeyOfTheManual) {
    std::set<std::string> keys;
    for (const char* page :
         {"set-up-file.md", "tools-and-holders.md", "stock-and-fixtures.md", "machines.md"})
        keys.merge(keys_of_page(page));
    EXPECT_TRUE(keys.contains("stick_out"));
    const std::set<std::string> of_controls = lengths_of_controls();
    EXPECT_GE(of_controls.size(), 9u);
    keys.insert(of_controls.begin(), of_controls.end());
    std::string all;
    for (const std::string& form : templates) all += form;
    for (const std::string& key : keys) {
        const bool is_length =
            std::regex_search(all, std::regex("(^|[\n {\"])" + key + "\"? = [^\n]*<"));
        EXPECT_TRUE(is_length || other_keys.contains(key))
            << key << " is neither in a template of this test, as a length, nor among other_keys";
    }
}

TEST(SetupUnit, DoesNotReachOtherFiles) {
    const SetupFolder folder;
    const auto file = folder.read(written(templates[1], LengthUnit::inch));
    ASSERT_TRUE(file);
    EXPECT_EQ(file->setup.machine.axes[0].home, -400.0);
    folder.folder.write("machine.toml", inch + "[[axis]]\nname = \"X\"\nhome = -16\nrapid = 400\n");
    const auto other = folder.read(written(templates[1], LengthUnit::mm));
    ASSERT_TRUE(other);
    EXPECT_EQ(other->setup.machine.axes[0].home, -16 * mm_per_inch);
    EXPECT_EQ(other->setup.machine.axes[0].rapid, 400 * mm_per_inch);
    EXPECT_EQ(other->length_unit, LengthUnit::mm);
    folder.folder.write("holders.toml",
                        inch + "[[holder]]\nname = \"A\"\nprofile = [[0.5, 0], [1, 2.5]]\n");
    const auto tools = folder.read(written(templates[3], LengthUnit::mm));
    ASSERT_TRUE(tools);
    const auto& holder = tools->setup.tools.at(core::ToolNumber{4}).description.holder;
    ASSERT_EQ(holder.size(), 1u);
    EXPECT_EQ(holder[0].lower_diameter, 25.4);
    EXPECT_EQ(holder[0].length, 63.5);
}

TEST(SetupUnit, OfAMeshIsItsOwn) {
    const SetupFolder folder;
    const core::Aabb inches{core::Vec3(-0.5, 0.25, 0.0), core::Vec3(2.0, 1.0, 1.5)};
    folder.folder.write("block.stl", test_support::binary_stl(core::mesh_of(inches)));
    const auto bounds_of = [&](const std::string& text) {
        const auto file = folder.read(text);
        EXPECT_TRUE(file) << text;
        return file ? core::bounds(file->setup.fixtures.at(0).body) : core::Aabb{};
    };
    const std::string body = "[[fixture]]\nname = \"block\"\nmesh = \"block.stl\"\n";
    for (const std::string& unit : {std::string(), inch}) {
        EXPECT_EQ(bounds_of(unit + body).min, inches.min);
        EXPECT_EQ(bounds_of(unit + body + "mesh_unit = \"mm\"\n").max, inches.max);
        const core::Aabb mm = bounds_of(unit + body + "mesh_unit = \"inch\"\n");
        EXPECT_EQ(mm.min, mm_per_inch * inches.min);
        EXPECT_EQ(mm.max, mm_per_inch * inches.max);
    }
    // Everything that takes a mesh takes its unit.
    const auto in_inches =
        folder.read("[stock]\nmesh = \"block.stl\"\nmesh_unit = \"inch\"\n"
                    "[part]\nmesh = \"block.stl\"\nmesh_unit = \"inch\"\n"
                    "[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
                    "holder_mesh = \"block.stl\"\nmesh_unit = \"inch\"\n");
    ASSERT_TRUE(in_inches);
    EXPECT_EQ(core::bounds(in_inches->setup.stock).max, mm_per_inch * inches.max);
    EXPECT_EQ(in_inches->setup.part->solid.mesh->bounds().max, mm_per_inch * inches.max);
    const auto& tool = in_inches->setup.tools.at(core::ToolNumber{1}).description;
    EXPECT_NEAR(tool.holder.at(0).length, 1.5 * mm_per_inch, 1e-3);
    // It applies to meshes only, and a size beyond 1 km is one in inches, too.
    EXPECT_THAT(folder.error("[[fixture]]\nname = \"a\"\nbox = [[0, 0, 0], [1, 1, 1]]\n"
                             "mesh_unit = \"inch\"\n"),
                HasSubstr(":4:"));
    EXPECT_THAT(folder.error(body + "mesh_unit = \"cm\"\n"), HasSubstr("mesh_unit"));
    folder.folder.write("block.stl", test_support::binary_stl(
                                         core::mesh_of({core::Vec3(0.0), core::Vec3(50'000.0)})));
    EXPECT_EQ(bounds_of(body).max.x, 50'000.0);
    EXPECT_THAT(folder.error(body + "mesh_unit = \"inch\"\n"), HasSubstr("beyond"));
}

TEST(SetupUnit, OfMessagesIsThatOfTheFile) {
    const SetupFolder folder;
    const auto expect = [&](const std::string& text, const std::string& words) {
        EXPECT_THAT(folder.error(inch + text), HasSubstr(words)) << text;
    };
    expect("allowance = 40\n", ":2:13: set-up: allowance must lie between 0 and 39.37 in");
    expect("[stock]\nmargin = 40\n", "margin must lie between 0 and 39.37 in");
    expect("[[allowance]]\ndistance = -1\n", "between 0 and 39.37 in");
    expect("[control]\n\"5114\" = 50\n", "must lie between 0 in and 39.37 in");
    const std::string tool = "[[tool]]\nnumber = 1\ndiameter = 0.5\nflute_length = 1\n";
    expect(tool + "shape = \"flat\"\nstick_out = 0.75\n",
           "flutes and neck are 1 in long, but stick_out leaves 0.75 in below the holder");
    expect(tool + "shape = \"flat\"\nstick_out = 100\n",
           "stick_out = 100 in is implausible: the maximum is 78.7402 in");
    expect(tool + "shape = \"ball\"\ncorner_radius = 0.125\n", "0.25 in, not 0.125");
    expect(tool + "shape = \"flat\"\nholder = [[1, 0], [1, 2], [1, 1.5]]\n",
           "z falls from 2 to 1.5");
    expect("mesh_size = 1e308\n", "mesh_size must be a number");
    expect("[control]\n\"second home\" = [0, 0, 1e308]\n", "must be a list of numbers");
    expect("[program]\nstart = { X = -1e308 }\n", "X must be a number");
    EXPECT_THAT(folder.error("allowance = 1001\n"), HasSubstr("between 0 and 1000 mm"));
}

TEST(SetupUnit, IsRefusedWhereItIsNotMeant) {
    const SetupFolder folder;
    EXPECT_THAT(folder.error("length_unit = \"cm\"\n"),
                HasSubstr("is \"cm\", but must be one of: mm inch"));
    EXPECT_THAT(folder.error("length_unit = 1\n"), HasSubstr("must be a text in quotes"));
    EXPECT_THAT(folder.error("unit = \"inch\"\n"),
                HasSubstr("s.toml:1:8: set-up: unit is a key of [program]; the unit of the "
                          "lengths in this file is length_unit"));
    EXPECT_THAT(folder.error("[stock]\nbox = [[0, 0, -1], [1, 1, 0]]\nlength_unit = \"inch\"\n"),
                HasSubstr("write it before the first table"));
    EXPECT_THAT(folder.error("[program]\nlength_unit = \"inch\"\n"),
                HasSubstr("write it before the first table"));
    EXPECT_TRUE(folder.read("length_unit = \"mm\"\nmesh_size = 1\n"));
}

TEST(SetupLength, ComesBackAsItWasEntered) {
    std::mt19937 random(11);
    for (int i = 0; i < 200000; ++i) {
        const int decimals = static_cast<int>(random() % 7);
        const double steps = std::pow(10.0, decimals);
        const double entered =
            (static_cast<double>(random() % 4000001) - 2000000.0) / 1000.0 / (1 + random() % 9);
        const double value = std::round(entered * steps) / steps;
        const std::string text = app::setup_length(value * mm_per_inch, LengthUnit::inch);
        EXPECT_EQ(text, app::toml_number(value + 0.0));
        EXPECT_EQ(text, app::exact_length(value * mm_per_inch, LengthUnit::inch));
        EXPECT_EQ(std::stod(text) * mm_per_inch, value * mm_per_inch);
    }
}

TEST(SetupLength, IsNearWhatWasComputed) {
    std::mt19937 random(12);
    for (int i = 0; i < 200000; ++i) {
        const double mm =
            (static_cast<double>(random()) / 4294967296.0 - 0.5) * (i % 2 == 0 ? 4000.0 : 20.0);
        const double written = std::stod(app::setup_length(mm, LengthUnit::inch)) * mm_per_inch;
        EXPECT_NEAR(written, mm, 1.28e-7);
        EXPECT_NEAR(std::stod(app::assumed_length(mm, LengthUnit::inch)) * mm_per_inch, mm,
                    1.28e-5);
        EXPECT_NEAR(std::stod(app::setup_length(mm, LengthUnit::mm)), mm, 5.01e-7);
        // The nearest of all numbers near the quotient, found the slow way.
        const double exact = std::stod(app::exact_length(mm, LengthUnit::inch)) * mm_per_inch;
        double least = std::numeric_limits<double>::infinity();
        double candidate = mm / mm_per_inch;
        for (int step = 0; step < 4; ++step) candidate = std::nextafter(candidate, -1e9);
        for (int step = 0; step < 9; ++step, candidate = std::nextafter(candidate, 1e9))
            least = std::min(least, std::abs(candidate * mm_per_inch - mm));
        EXPECT_LE(std::abs(exact - mm), std::max(least, 1e-11)) << mm;
    }
    EXPECT_EQ(app::exact_length(0.375 * 25.4 * (1.0 - 2e-16), LengthUnit::mm), "9.525");
    EXPECT_EQ(app::setup_length(-0.0, LengthUnit::inch), "0");
    EXPECT_EQ(app::setup_length(1e300, LengthUnit::mm), "1e+300");
    EXPECT_EQ(app::setup_length(12.7, LengthUnit::inch), "0.5");
    EXPECT_EQ(app::setup_length(10.0, LengthUnit::inch), "0.39370079");
    EXPECT_EQ(app::assumed_length(10.0, LengthUnit::inch), "0.393701");
    EXPECT_EQ(app::setup_point({25.4, -31.75, 0}, LengthUnit::inch), "[1, -1.25, 0]");
}

TEST(SetupChanges, AreWrittenInTheUnitOfTheText) {
    const std::string text = inch
                             + "allowance = 0.1 # wide\n[offsets]\nG54 = { X = 1, Y = 2 }\n"
                               "[[fixture]]\nname = \"jaw\"\nbox = [[0, 0, 0], [1, 2, 3]]\n";
    const auto changed = [](const core::Result<std::string>& result) {
        EXPECT_TRUE(result) << (result ? "" : result.error().message);
        return result.value_or("");
    };
    const auto jaw = *app::path_of_fixture(text, "jaw");
    EXPECT_THAT(changed(app::with_box(text, jaw, {{0, 0, 0}, {31.75, 12.7, 10}})),
                HasSubstr("box = [[0, 0, 0], [1.25, 0.5, 0.39370079]]"));
    EXPECT_THAT(changed(app::with_cylinder(text, jaw, 12.7, 25.4, 2)),
                HasSubstr("cylinder = { radius = 0.5, height = 1, axis = \"Z\" }"));
    EXPECT_THAT(changed(app::with_pose(text, jaw, {2.54, 0, 0}, {0, 0, 90})),
                HasSubstr("at = [0.1, 0, 0]\nrotate_deg = [0, 0, 90]"));
    EXPECT_THAT(changed(app::with_offset(text, "G54", {-25.4, 0, 63.5})),
                HasSubstr("G54 = { X = -1, Y = 0, Z = 2.5 }"));
    EXPECT_THAT(changed(app::with_offset(text, "G55", {-25.4, 0, 63.5})),
                HasSubstr("G55 = { X = -1, Y = 0, Z = 2.5 }"));
    EXPECT_THAT(changed(app::with_allowance(text, 5.08)), HasSubstr("allowance = 0.2 # wide"));
    EXPECT_THAT(changed(app::with_part_tolerance(text, 0.254)), HasSubstr("tolerance = 0.01"));
    const core::Solid stock{core::SolidBox{{{0, 0, -25.4}, {50.8, 25.4, 0}}}, 0.0};
    EXPECT_THAT(changed(app::with_stock(text, stock, "G54")),
                HasSubstr("box = [[0, 0, -1], [2, 1, 0]]"));
    for (const core::ToolSize& size : core::tool_sizes())
        EXPECT_THAT(changed(app::with_tool_size(text, core::ToolNumber{1}, size, 12.7)),
                    HasSubstr(fmt::format("{} = {}\n", size.key, size.is_angle() ? 12.7 : 0.5)));
}

TEST(StatedSetup, IsInMmWhateverTheUnitOfTheText) {
    const std::string body = "box = [[<0>, <0>, <-1.25>], [<4>, <3>, <0>]]\nat = [<0.5>, <1>, <2>]"
                             "\nrotate_deg = [10, 20, 30]\ntolerance = <0.01>\nmargin = <0.5>\n";
    const std::string form = "[stock]\n" + body + "[part]\n" + body + "[[fixture]]\nname = \"a\"\n"
                             + body
                             + "[[fixture]]\nname = \"b\"\ncylinder = { radius = <0.25>, "
                               "height = <2> }\n";
    const app::StatedSetup in_inch = app::stated_in(written(form, LengthUnit::inch)),
                           in_mm = app::stated_in(written(form, LengthUnit::mm));
    EXPECT_EQ(in_inch.length_unit, LengthUnit::inch);
    EXPECT_EQ(in_mm.length_unit, LengthUnit::mm);
    const auto expect_same = [](const app::StatedBody& a, const app::StatedBody& b) {
        ASSERT_EQ(a.box.has_value(), b.box.has_value());
        if (a.box) {
            EXPECT_EQ(a.box->min, b.box->min);
            EXPECT_EQ(a.box->max, b.box->max);
        }
        ASSERT_EQ(a.cylinder.has_value(), b.cylinder.has_value());
        if (a.cylinder) {
            EXPECT_EQ(a.cylinder->radius, 6.35);
            EXPECT_EQ(a.cylinder->radius, b.cylinder->radius);
            EXPECT_EQ(a.cylinder->height, b.cylinder->height);
        }
        EXPECT_EQ(a.at, b.at);
        EXPECT_EQ(a.rotate_deg, b.rotate_deg);
        EXPECT_EQ(a.tolerance, b.tolerance);
        EXPECT_EQ(a.margin, b.margin);
    };
    expect_same(*in_inch.stock, *in_mm.stock);
    expect_same(*in_inch.part, *in_mm.part);
    for (size_t i = 0; i < 2; ++i) expect_same(in_inch.fixtures[i], in_mm.fixtures[i]);
    EXPECT_EQ(in_inch.stock->at, core::Vec3(12.7, 25.4, 50.8));
}

/// The tools of a set-up, written into another one.
std::string with_tools_of(const app::SetupFile& file) {
    std::string text = inch;
    for (const auto& [number, tool] : file.setup.tools) {
        const auto more = app::with_tool(text, tool.description);
        EXPECT_TRUE(more) << (more ? "" : more.error().message);
        text = more.value_or(text);
    }
    return text;
}

/// Tools of round inches are written as they were entered, as often as one likes.
TEST(StatedTool, InInchesIsTheSameTool) {
    const SetupFolder folder;
    folder.folder.write("holders.toml",
                        inch + "[[holder]]\nname = \"A\"\ncones = [[0.75, 1.25, 1.5]]\n");
    const auto read = folder.read(written(templates[3], LengthUnit::inch));
    ASSERT_TRUE(read);
    const std::string text = with_tools_of(*read);
    for (const char* line :
         {"diameter = 0.5\n", "corner_radius = 0.06\n", "pitch = 0.05\n", "touched_off = 4.5 ",
          "centre_diameter = 0.1\n", "point_deg = 135\n", "gauge_length = 6\n",
          "profile = [[0, 0], [0.25, 0.125], [0.5, 1]]\n", "holder = [[0.75, 1.25, 1.5]]\n",
          "shank = [[0.5, 0.75, 1], [0.75, 0.75, 0.5]]\n", "holder = [[2, 2.5, 2], [2.5, 5, 0.5]]"})
        EXPECT_THAT(text, HasSubstr(line));
    EXPECT_FALSE(std::regex_search(text, std::regex("\\.[0-9]{5}"))) << text;
    const auto again = folder.read(text);
    ASSERT_TRUE(again) << app::error_text(again.error()) << text;
    EXPECT_EQ(with_tools_of(*again), text);
}

/// Sizes of other tools are rounded, unless they then contradict each other.
TEST(StatedTool, InInchesIsAsRoundAsItCanBe) {
    const SetupFolder folder;
    core::ToolDescription tool;
    tool.number = core::ToolNumber{7};
    tool.shape = core::ToolShape::bull;
    std::mt19937 random(13);
    int rounded = 0;
    constexpr int count = 300;
    for (int i = 0; i < count; ++i) {
        tool.diameter = 2.0 + static_cast<double>(random() % 10000) / 777.0;
        tool.corner_radius = 0.5 * tool.diameter; // cannot be larger
        tool.flute_length = 3.0 * tool.diameter;
        tool.stick_out = tool.flute_length;
        const auto text = app::with_tool(inch, tool);
        ASSERT_TRUE(text);
        const auto again = folder.read(*text);
        ASSERT_TRUE(again) << app::error_text(again.error()) << *text;
        const core::ToolDescription& same = again->setup.tools.at(core::ToolNumber{7}).description;
        EXPECT_NEAR(same.diameter, tool.diameter, 1.28e-7);
        EXPECT_NEAR(*same.corner_radius, *tool.corner_radius, 1.28e-7);
        const bool is_rounded = !std::regex_search(*text, std::regex("\\.[0-9]{9}"));
        EXPECT_TRUE(is_rounded || std::abs(same.diameter - tool.diameter) < 1e-14 * tool.diameter);
        rounded += is_rounded ? 1 : 0;
    }
    EXPECT_GT(rounded, count / 3);
    EXPECT_LT(rounded, count);
}

} // namespace
} // namespace app_test
