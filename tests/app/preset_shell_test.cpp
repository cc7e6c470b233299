#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/setup/holders/holder_preset.h"
#include "app/setup/machines/machine_preset.h"
#include "app/setup/presets/preset.h"
#include "core/base/file_reads.h"
#include "core/base/text.h"
#include "core/geom/mesh_file.h"
#include "core/geom/triangle_distance.h"
#include "tests/app/checked.h"
#include "tests/support/scoped_folder.h"

/// Presets on the command line and in checks.

namespace app_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

TEST(PresetsCommand, ListsAllByKind) {
    const test_support::Ran list = feeler({"presets"});
    EXPECT_EQ(list.status, 0);
    size_t last = 0;
    for (const app::Preset& preset : app::presets()) {
        const size_t at = list.out.find(fmt::format("\n  {} ", preset.name));
        ASSERT_NE(at, std::string::npos) << preset.name;
        EXPECT_GT(at, last);
        last = at;
    }
    const json all = json::parse(feeler({"presets", "--format", "json"}).out);
    EXPECT_EQ(all["presets"].size(), app::presets().size());
}

TEST(PresetsCommand, ShowsTheSizesOfOne) {
    const test_support::Ran text =
        feeler({"presets", "vise-6", "--set", "opening=40", "--set", "jaw_height=50"});
    EXPECT_EQ(text.status, 0);
    EXPECT_THAT(text.out, HasSubstr("opening                    40   0.5 to 230 "));
    EXPECT_THAT(text.out, HasSubstr("Z -73 to 50\n"));
    EXPECT_THAT(text.out, HasSubstr("    preset = \"vise-6\"\n    jaw_height = 50\n"));
    const json one =
        json::parse(feeler({"presets", "vise-6", "--format", "json", "--set", "opening=40"}).out);
    EXPECT_EQ(one["name"], "vise-6");
    EXPECT_EQ(one["parameters"][0]["value"], 40.0);
    EXPECT_EQ(one["parameters"][0]["standard"], 100.0);
    EXPECT_EQ(one["parameters"][0]["unit"], "mm");
    EXPECT_EQ(one["box"][1][2], 45.0);
}

TEST(PresetsCommand, WritesMeshes) {
    const test_support::ScopedFolder folder;
    for (const char* ending : {".stl", ".PLY"}) {
        const std::string path = folder / ("block" + std::string(ending));
        EXPECT_EQ(feeler({"presets", "step-block", "--set", "steps=2", "-o", path}).status, 0);
        const core::MeshFile read = core::read_mesh(path).value();
        EXPECT_THAT(read.repairs, testing::IsEmpty());
        EXPECT_EQ(read.mesh.bounds().max, core::Vec3(24, 15, 20));
    }
}

TEST(PresetsCommand, RefusesMistakes) {
    const auto expect_refused = [](const std::vector<std::string>& words, const std::string& why) {
        std::vector<std::string> all{"presets"};
        all.insert(all.end(), words.begin(), words.end());
        const test_support::Ran run = feeler(all);
        EXPECT_EQ(run.status, 2);
        EXPECT_THAT(run.err, HasSubstr(why));
        EXPECT_EQ(run.out, "");
    };
    expect_refused({"vice-6"}, "there is no preset \"vice-6\"; did you mean \"vise-6\"?");
    expect_refused({"vise-6", "--set", "openin=5"}, "did you mean opening?");
    expect_refused({"vise-6", "--set", "opening=0"}, "opening must be from 0.5 to 230 mm");
    expect_refused({"vise-6", "--set", "opening=5", "--set", "opening=6"}, "given twice");
    for (const char* value :
         {"opening", "opening=", "opening=nan", "opening=5mm", "=5", "", "=", "opening=1e999"})
        expect_refused({"vise-6", "--set", value}, "feeler: ");
    expect_refused({"vise-6", "--set", "front_length=50"}, "less than front_length");
    expect_refused({"--set", "opening=5"}, "--set needs the name of a preset");
    expect_refused({"-o", "all.stl"}, "needs the name of a preset");
    expect_refused({"vise-6", "-o", "/no/such/folder/a.stl"}, "/no/such/folder/a.stl");
}

TEST(PresetsCommand, ListsHoldersAsATableAndMachinesByKind) {
    const std::string list = feeler({"presets"}).out;
    for (const app::HolderTaper& taper : app::holder_tapers())
        EXPECT_THAT(list, HasSubstr(fmt::format("\n  {:8}  ", taper.name)));
    for (const app::HolderAttachment& attachment : app::holder_attachments())
        EXPECT_THAT(list, testing::ContainsRegex("[ :]" + attachment.name + "[ \n]"));
    for (const app::MachinePreset& machine : app::machine_presets())
        EXPECT_THAT(list, HasSubstr(fmt::format("\n    {} ", machine.name)));
    EXPECT_LT(std::count(list.begin(), list.end(), '\n'), 130);
    const json all = json::parse(feeler({"presets", "--format", "json"}).out);
    EXPECT_EQ(all["holders"].size(), app::holder_presets().size());
    EXPECT_EQ(all["machines"].size(), app::machine_presets().size());
}

TEST(PresetsCommand, ShowsAHolderAndWritesItsMesh) {
    const test_support::ScopedFolder folder;
    const test_support::Ran text = feeler({"presets", "CAT40-ER16-85", "--set", "nut_diameter=30"});
    EXPECT_EQ(text.status, 0);
    EXPECT_THAT(text.out,
                HasSubstr("holder = { preset = \"CAT40-ER16-85\", nut_diameter = 30 }\n"));
    EXPECT_THAT(text.out, HasSubstr("Z 0 to 85\n"));
    const std::string path = folder / "holder.stl";
    EXPECT_EQ(feeler({"presets", "BT40-ER32-100", "-o", path}).status, 0);
    const auto mesh = core::read_mesh(path);
    ASSERT_TRUE(mesh);
    EXPECT_NEAR(mesh->mesh.bounds().max.z, 100, 1e-4);
    EXPECT_GE(mesh->mesh.bounds().max.x, 31.5 - 1e-4);
}

TEST(PresetsCommand, ShowsAMachineAndWritesItsFile) {
    const test_support::ScopedFolder folder;
    const test_support::Ran text = feeler({"presets", "haas-vf-2", "--set", "x_min=-700"});
    EXPECT_EQ(text.status, 0);
    EXPECT_THAT(text.out, HasSubstr("-700 mm       stated   lower limit of X\n"));
    EXPECT_THAT(text.out, HasSubstr("    preset = \"haas-vf-2\"\n    x_min = -700\n"));
    const json one = json::parse(feeler({"presets", "haas-vf-2", "--format", "json"}).out);
    EXPECT_EQ(one["kind"], "vertical");
    EXPECT_EQ(one["sizes"][0]["origin"], "source");
    EXPECT_TRUE(one["sizes"][2]["value"].is_null());
    const std::string path = folder / "vf2.toml";
    EXPECT_EQ(feeler({"presets", "haas-vf-2", "-o", path}).status, 0);
    EXPECT_EQ(core::file_bytes(path).value(), one["file"].get<std::string>());
}

TEST(PresetsCommand, RefusesMistakesWithHoldersAndMachines) {
    const auto error = [](std::vector<std::string> words) {
        words.insert(words.begin(), "presets");
        const test_support::Ran run = feeler(words);
        EXPECT_EQ(run.status, 2);
        return run.err;
    };
    EXPECT_THAT(error({"BT40-ER33"}), HasSubstr("did you mean \"BT40-ER32\"?"));
    EXPECT_THAT(error({"ISO20-ER40"}), HasSubstr("ER40 is too large for ISO20"));
    EXPECT_THAT(error({"haas-vf-3"}), HasSubstr("did you mean \"haas-vf-2\"?"));
    EXPECT_THAT(error({"haas-vf-2", "-o", "x.stl"}), HasSubstr("is a machine and has no mesh"));
    EXPECT_THAT(error({"haas-vf-2", "--set", "x_mim=5"}), HasSubstr("did you mean x_min?"));
    EXPECT_THAT(error({"haas-vf-2", "--set", "x_min=5"}), HasSubstr("x_min must be below x_max"));
    EXPECT_THAT(error({"haas-vf-2", "--set", "x_min=-5", "--set", "x_min=-6"}),
                HasSubstr("x_min is given twice"));
    EXPECT_THAT(error({"BT40-ER32-80", "--set", "length=90"}),
                HasSubstr("length is part of the name already"));
}

/// The row of a size in the manual, for the presets with the same generator.
std::string manual_row(const std::vector<const app::Preset*>& presets, size_t parameter) {
    const app::PresetParameter& first = presets[0]->parameters[parameter];
    std::string standards, greatest;
    for (const app::Preset* preset : presets) {
        const app::PresetParameter& p = preset->parameters[parameter];
        standards += fmt::format(" {} |", core::number_text(p.standard, 3));
        EXPECT_EQ(p.least, first.least);
        const std::string text = core::number_text(p.greatest, 3);
        if (p.greatest != first.greatest || preset == presets[0])
            greatest += (greatest.empty() ? "" : ", ") + text;
    }
    return fmt::format("\n| `{}` |{} {} to {} | {} |\n", first.key, standards,
                       core::number_text(first.least, 3), greatest, first.meaning);
}

TEST(PresetsManual, HasARowForEachSizeAndAPictureForEachForm) {
    const std::string page = core::file_bytes(FEELER_SOURCE_DIR "/docs/manual/presets.md").value();
    std::vector<std::vector<const app::Preset*>> forms;
    for (const app::Preset& preset : app::presets()) {
        const auto form = std::find_if(forms.begin(), forms.end(), [&](const auto& others) {
            return others[0]->generate == preset.generate;
        });
        form == forms.end() ? forms.push_back({&preset}) : form->push_back(&preset);
    }
    for (const auto& form : forms) {
        std::string names;
        bool has_picture = false;
        for (const app::Preset* preset : form) {
            names += fmt::format(" `{}` |", preset->name);
            has_picture = has_picture
                          || page.find(fmt::format("images/presets/{}.png", preset->name))
                                 != std::string::npos;
        }
        EXPECT_TRUE(has_picture) << names;
        EXPECT_THAT(page, HasSubstr("| size |" + names + " range | meaning |\n"));
        for (size_t i = 0; i < form[0]->parameters.size(); ++i)
            EXPECT_THAT(page, HasSubstr(manual_row(form, i)));
    }
}

TEST(PresetsManual, HasARowAndAPictureOfEachMachine) {
    const std::string page =
        core::file_bytes(FEELER_SOURCE_DIR "/docs/manual/machine-presets.md").value();
    for (const app::MachinePreset& machine : app::machine_presets()) {
        const auto range = [&](const std::string& axis) {
            return fmt::format("{} to {}",
                               core::number_text(*machine.size(axis + "_min")->standard, 3),
                               core::number_text(*machine.size(axis + "_max")->standard, 3));
        };
        EXPECT_THAT(page,
                    HasSubstr(fmt::format("\n| `{}` | {} | {} | {} | {} |", machine.name,
                                          machine.title, range("x"), range("y"), range("z"))));
        EXPECT_THAT(page, HasSubstr(fmt::format("(../images/presets/{}.png)", machine.name)));
        EXPECT_THAT(page, HasSubstr(machine.source));
        EXPECT_THAT(page, HasSubstr(machine.zero));
        for (const app::MachineSize& size : machine.sizes) {
            const std::string key(size.key);
            const bool is_listed = page.find(fmt::format("`{}`", key)) != std::string::npos;
            EXPECT_TRUE(is_listed || key[0] == 'y' || key[0] == 'z') << key;
        }
    }
}

TEST(PresetsManual, HasARowOfEachTaperAndAttachment) {
    const std::string page =
        core::file_bytes(FEELER_SOURCE_DIR "/docs/manual/holder-presets.md").value();
    for (const app::HolderTaper& taper : app::holder_tapers()) {
        EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}`", taper.name)));
        EXPECT_THAT(page, HasSubstr(fmt::format("(../images/presets/{}-", taper.name)));
        if (taper.flange_height == 0) continue;
        EXPECT_THAT(
            page, HasSubstr(fmt::format("| {} | {} |", core::number_text(taper.flange_diameter, 3),
                                        core::number_text(taper.flange_height, 3))));
    }
    for (const app::HolderAttachment& attachment : app::holder_attachments()) {
        const size_t digits = attachment.name.find_first_of("0123456789");
        const std::string letters = attachment.name.substr(0, digits);
        const std::string size = core::number_text(attachment.size, 3);
        const std::regex row("\\| `" + letters + "[^|]*\\b" + size + "\\b[^|]*\\|");
        EXPECT_TRUE(std::regex_search(page, row)) << attachment.name;
        EXPECT_THAT(page, testing::ContainsRegex("presets/[A-Z0-9-]*-" + letters + "[0-9]*.png"));
    }
}

TEST(PresetDistance, AgreesWithEveryTriangle) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> place(-250, 250);
    for (const char* argument : {"vise-6,opening=40", "step-clamp-m12,height=40", "3-jaw-chuck-6",
                                 "t-slot-table-14", "dividing-head", "stud-m8"}) {
        const std::string name = std::string(argument).substr(0, std::string(argument).find(','));
        app::PresetValues values;
        if (name == "vise-6") values["opening"] = 40;
        if (name == "step-clamp-m12") values["height"] = 40;
        const core::Mesh mesh = app::preset_mesh(*app::find_preset(name), values).value();
        const core::Vec3 at(place(random), place(random), 60 + std::abs(place(random)));
        double nearest = core::infinity;
        for (size_t i = 0; i < mesh.triangles.size(); ++i)
            nearest =
                std::fmin(nearest, glm::length(at - core::nearest_point(mesh.triangle(i), at)));
        const json found =
            json::parse(feeler({"distance", "preset:" + std::string(argument), "sphere:5", "--move",
                                fmt::format("{},{},{}", at.x, at.y, at.z), "--mesh-size", "5",
                                "--format", "json"})
                            .out);
        EXPECT_LE(found["lower"].get<double>(), nearest - 5 + 1e-9);
        EXPECT_NEAR(found["upper"].get<double>(), nearest - 5, 1e-6) << argument;
    }
}

TEST(PresetDistance, RefusesMistakes) {
    const auto error = [](const std::string& argument) {
        const test_support::Ran run = feeler({"distance", argument, "sphere:5"});
        EXPECT_EQ(run.status, 2) << argument;
        return run.err;
    };
    EXPECT_THAT(error("preset:vice-6"), HasSubstr("did you mean \"vise-6\"?"));
    EXPECT_THAT(error("preset:"), HasSubstr("there is no preset \"\""));
    EXPECT_THAT(error("preset:vise-6,"), HasSubstr("\"\" is not a size"));
    EXPECT_THAT(error("preset:vise-6,opening"), HasSubstr("write KEY=VALUE"));
    EXPECT_THAT(error("preset:vise-6,opening=900"), HasSubstr("opening must be from 0.5 to 230"));
    EXPECT_THAT(error("vise-6"), HasSubstr("write preset:vise-6"));
    EXPECT_THAT(error("preset:haas-vf-2"), HasSubstr("haas-vf-2 is a machine"));
    EXPECT_THAT(error("preset:BT40-ER32-80,length=90"), HasSubstr("length is given twice"));
    EXPECT_THAT(error("BT40-ER32-100"), HasSubstr("write preset:BT40-ER32-100"));
    EXPECT_THAT(error("vice-6"), Not(HasSubstr("preset:")));
}

/// A pocket in a block of 60 x 40 x 25 and a rapid that is this high above it, across to Y -200.
const char* const program = R"(G21 G90 G54
T1 M6
S8000 M3
G43 H1 Z30
G0 X0 Y0
Z2
G1 Z-3 F300
X10
G0 Z{0}
Y-200
Z30
M30
)";

std::string setup_with(const std::string& unit, const std::string& fixtures) {
    const double k = unit == "inch" ? 25.4 : 1.0;
    const auto length = [&](double mm) { return fmt::format("{:.17g}", mm / k); };
    return "length_unit = \"" + unit + "\"\n[program]\ndialect = \"fanuc\"\n[stock]\nbox = [["
           + length(-30) + ", " + length(-20) + ", " + length(-25) + "], [" + length(30) + ", "
           + length(20) + ", " + length(0) + "]]\n[[tool]]\nnumber = 1\nshape = \"flat\"\n"
           + "diameter = " + length(10) + "\nflute_length = " + length(20)
           + "\nstick_out = " + length(60) + "\nholder = [[" + length(40) + ", " + length(40) + ", "
           + length(50) + "]]\n" + fixtures;
}

/// The least clearance of all blocks to a fixture.
double least_clearance(const Checked& checked, const std::string& fixture) {
    double least = core::infinity;
    for (const BlockLine& block : checked.blocks)
        for (const PairLine& pair : block.pairs)
            if (pair.upper && pair.name.ends_with(" " + fixture))
                least = std::fmin(least, *pair.upper);
    return least;
}

TEST(PresetCheck, HoldsThePartAndCountsItsClearance) {
    const test_support::ScopedFolder folder;
    // The block reaches 20 mm into jaws of 45 mm: the bed is at Z -50, the jaws end at Z -5.
    for (const std::string unit : {"mm", "inch"}) {
        const double k = unit == "inch" ? 25.4 : 1.0;
        const std::string vise = fmt::format(
            "[[fixture]]\nname = \"vise\"\npreset = \"vise-6\"\nopening = {:.17g}\nat = "
            "[0, {:.17g}, {:.17g}]\n",
            40 / k, 20 / k, -50 / k);
        const std::string setup = folder.write("s.toml", setup_with(unit, vise));
        const std::string nc = folder.write("p.nc", fmt::format(fmt::runtime(program), "5"));
        const Checked checked = check_files(nc, setup);
        EXPECT_NEAR(least_clearance(checked, "vise"), 10.0, 1e-6) << unit << checked.err;
        EXPECT_THAT(checked.assumptions,
                    testing::Contains("vise: sizes other than opening are those of the preset "
                                      "vise-6, not measured"));
        const std::string low = folder.write("low.nc", fmt::format(fmt::runtime(program), "-4.5"));
        EXPECT_EQ(feeler({"check", low, "--setup", setup}).status, 1);
    }
}

TEST(PresetCheck, TakesEveryPresetAsFixture) {
    const test_support::ScopedFolder folder;
    std::string fixtures;
    double z = 0;
    for (const app::Preset& preset : app::presets()) {
        const core::Aabb box = app::preset_mesh(preset).value().bounds();
        fixtures += fmt::format("[[fixture]]\nname = \"{}-x\"\npreset = \"{}\"\nat = [{}, {}, "
                                "{}]\n",
                                preset.name, preset.name, -45 - box.max.x, -200 - box.max.y,
                                -box.max.z + z);
        z -= 1.5;
    }
    const std::string setup = folder.write("s.toml", setup_with("mm", fixtures));
    const std::string nc = folder.write("p.nc", fmt::format(fmt::runtime(program), "5"));
    const Checked checked = check_files(nc, setup);
    EXPECT_NE(checked.status, 2) << checked.err;
    EXPECT_FALSE(checked.blocks.empty());
    size_t told = 0;
    for (const std::string& assumption : checked.assumptions)
        if (assumption.find("-x: all sizes are those of the preset") != std::string::npos) ++told;
    EXPECT_EQ(told, app::presets().size());
}

TEST(PresetCheck, TakesHoldersAndCountsTheirClearance) {
    const test_support::ScopedFolder folder;
    const std::string program = folder.write(
        "p.ngc",
        "G21 G90 G17 G49 G61 T1 M6\nG53 G0 Z300\nM3 S900\nG53 G0 X-100 Y0\nG53 G0 Z30\nM2\n");
    for (size_t i = 0; i < app::holder_presets().size(); i += 5) {
        const app::HolderPreset& holder = app::holder_presets()[i];
        const double length = holder.preset.parameter("length")->standard;
        const double lowest = 30 - length; // of the holder, with its gauge line at 30
        const std::string setup = folder.write(
            "s.toml",
            fmt::format(
                "[program]\nstart = {{ X = 0, Y = 0, Z = 300 }}\n[offsets]\nG54 = {{ Z = {} "
                "}}\n[stock]\nbox = [[0, -10, -40], [10, 10, -30]]\n[[fixture]]\nname = "
                "\"plate\"\nbox = [[-200, -100, -20], [-50, 100, -10]]\n[[tool]]\nnumber = "
                "1\nshape = \"flat\"\ndiameter = 4\nflute_length = 4\nstick_out = 5\n"
                "holder = \"{}\"\n",
                lowest, holder.preset.name));
        const Checked checked = check_files(program, setup, {"--dialect", "linuxcnc"});
        const PairLine pair = checked.at_line(5).pair("holder plate");
        expect_encloses(pair, 10.0, 1e-4);
    }
}

// --- machines ---

/// A set-up with a machine, and a small stock below its travel.
std::string setup_on(const app::MachinePreset& machine) {
    const auto at = [&](const char* key) { return *machine.size(key)->standard; };
    return fmt::format("[machine]\npreset = \"{}\"\n[offsets]\nG54 = {{ X = {}, Y = {}, Z = {} }}\n"
                       "[stock]\nbox = [[-5, -5, -10], [5, 5, 0]]\n[[tool]]\nnumber = 1\n"
                       "shape = \"flat\"\ndiameter = 6\nflute_length = 20\nstick_out = 25\n",
                       machine.name, (at("x_min") + at("x_max")) / 2,
                       (at("y_min") + at("y_max")) / 2, at("z_min") - 60);
}

TEST(MachinesInChecks, ReachTheirTravelAndNoMore) {
    const test_support::ScopedFolder folder;
    for (const app::MachinePreset& machine : app::machine_presets()) {
        const auto at = [&](const char* key) { return *machine.size(key)->standard; };
        const std::string setup = folder.write("s.toml", setup_on(machine));
        const std::string within = folder.write(
            "in.ngc", fmt::format("G21 G90 G17 G49 T1 M6\nG53 G0 Z{}\nG53 G0 X{} Y{}\nG53 G0 X{} "
                                  "Y{}\nG53 G0 X0 Y0 Z0\nM2\n",
                                  at("z_max"), at("x_min"), at("y_min"), at("x_max"), at("y_max")));
        const Checked good = check_files(within, setup, {"--dialect", "linuxcnc"});
        EXPECT_EQ(good.errors(), "") << machine.name << good.err;
        for (const char* move : {"X{x}", "Y{y}", "Z{z}"}) {
            const std::string beyond = folder.write(
                "out.ngc", "G21 G90 G17 G49 T1 M6\nG53 G0 "
                               + fmt::format(fmt::runtime(move), fmt::arg("x", at("x_min") - 0.01),
                                             fmt::arg("y", at("y_max") + 0.01),
                                             fmt::arg("z", at("z_max") + 0.01))
                               + "\nM2\n");
            EXPECT_EQ(check_files(beyond, setup, {"--dialect", "linuxcnc"}).errors(),
                      "over-travel 2")
                << machine.name << move;
        }
    }
}

TEST(MachinesInChecks, LetTheStockLieOnTheBedOfARouter) {
    const test_support::ScopedFolder folder;
    const std::string setup = folder.write(
        "s.toml",
        "[machine]\npreset = \"generic-router\"\n[offsets]\nG54 = { X = -300, Y = -450, Z = "
        "-150 }\n[stock]\nbox = [[-50, -50, -10], [50, 50, 0]]\n[[tool]]\nnumber = 1\n"
        "shape = \"flat\"\ndiameter = 6\nflute_length = 60\nstick_out = 80\n");
    const std::string program = folder.write(
        "p.ngc",
        "G21 G90 G17 G54 T1 M6\nG53 G0 Z0\nG43 H1 G0 X-40 Y0\nM3 S9000\nG0 Z5\nG1 Z-5 F300\nX40\n"
        "G0 Z5\nG0 X70\nG0 Z-5\nG1 Z-10.5\nG53 G0 Z0\nM2\n");
    const Checked checked = check_files(program, setup, {"--dialect", "linuxcnc"});
    EXPECT_EQ(checked.errors(), "collision 11, collision 12"); // into the bed, and out of it
}

TEST(MachinesInChecks, StopWhereTheNoseMeetsTheTable) {
    const test_support::ScopedFolder folder;
    const std::string setup = folder.write(
        "s.toml",
        "[machine]\npreset = \"haas-vf-2\"\nnose_to_table = 500\nz_min = -600\n[offsets]\n"
        "G54 = { X = -700, Y = -203, Z = -500 }\n[stock]\nbox = [[-5, -5, 0], [5, 5, "
        "10]]\n[[tool]]\nnumber = 1\nshape = \"flat\"\ndiameter = 6\nflute_length = 5\n"
        "stick_out = 6\n");
    const auto errors = [&](double z) {
        const std::string program = folder.write(
            "p.ngc", fmt::format("G21 G90 G17 G49 T1 M6\nG53 G0 X-300 Y-203\nG53 G0 Z{}\nM2\n", z));
        return check_files(program, setup, {"--dialect", "linuxcnc"}).errors();
    };
    EXPECT_EQ(errors(-490), "");
    EXPECT_THAT(errors(-493.5), testing::AnyOf("near-miss 3", "undecided 3")); // 0.5 mm
    EXPECT_THAT(errors(-501), HasSubstr("collision 3"));
}

TEST(MachinesInChecks, AreUndecidedWhereTheyTurnAboutAnUnknownCentre) {
    const test_support::ScopedFolder folder;
    for (const app::MachinePreset& machine : app::machine_presets()) {
        if (machine.rotary == 0) continue;
        const std::string program = folder.write(
            "p.ngc", fmt::format("G21 G90 G17 G49 T1 M6\nG0 {}20\nM2\n", machine.rotary));
        const std::string open = folder.write("s.toml", setup_on(machine));
        EXPECT_THAT(check_files(program, open, {"--dialect", "linuxcnc"}).errors(),
                    HasSubstr("undecided 2"))
            << machine.name;
        std::string lines;
        for (const char* key : {"centre_x", "centre_y", "centre_z", "pivot_length"})
            if (machine.size(key)) lines += fmt::format("{} = 150\n", key);
        std::string stated = setup_on(machine);
        stated.insert(stated.find("[offsets]"), lines);
        EXPECT_EQ(check_files(program, folder.write("t.toml", stated), {"--dialect", "linuxcnc"})
                      .errors(),
                  "")
            << machine.name;
    }
}

} // namespace
} // namespace app_test
