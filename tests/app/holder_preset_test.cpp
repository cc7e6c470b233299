#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/holder_library.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/presets/preset_solid.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_changes.h"
#include "app/setup/setup_file.h"
#include "core/geom/mesh_features.h"
#include "core/geom/mesh_file.h"

/// The presets of holders, compared with tables of the standards and with the samples.

namespace app_test {
namespace {

using app::HolderPreset;
using app::PresetValues;
using core::ConeStep;
using testing::HasSubstr;

std::vector<ConeStep> cones(std::string_view name) {
    const auto made = app::holder_cones(name);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    return made.value_or(std::vector<ConeStep>{});
}

std::string error_of_name(std::string_view name) {
    const auto made = app::holder_cones(name);
    return made ? std::string() : made.error().message;
}

/// The diameter of a holder so far below the gauge line.
double diameter_below(const std::vector<ConeStep>& steps, double below) {
    double z = 0.0;
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        if (below < z + step->length) {
            const double share = (below - z) / step->length;
            return step->upper_diameter + (step->lower_diameter - step->upper_diameter) * share;
        }
        z += step->length;
    }
    return 0.0;
}

double volume(const std::vector<ConeStep>& steps, double grown = 0.0) {
    double sum = 0.0;
    for (const ConeStep& step : steps) {
        const double a = step.lower_diameter / 2 + grown, b = step.upper_diameter / 2 + grown;
        sum += M_PI * step.length * (a * a + a * b + b * b) / 3;
    }
    return sum;
}

/// The stated sizes of a taper, from tables of the standards, mm: flange diameter, and how far
/// below the gauge line the flange begins and ends.
struct Flange {
    const char* taper;
    double diameter, begin, end, taper_diameter;
};
constexpr Flange flanges[] = {
    {"BT30", 46, 2, 22, 31.75},           {"BT40", 63, 2, 27, 44.45},
    {"CAT40", 63.5, 3.175, 19.05, 44.45}, {"CAT50", 98.425, 3.175, 19.05, 69.85},
    {"SK40", 63.55, 3.2, 19.1, 44.45},    {"HSK-A63", 63, 0, 26, 0},
};

TEST(HolderPreset, HasTheFlangeOfItsTaper) {
    for (const Flange& flange : flanges)
        for (const char* end : {"ER16", "EM10", "SF6", "SF12"}) {
            const auto steps = cones(fmt::format("{}-{}-120", flange.taper, end));
            for (const double below : {flange.begin + 0.01, flange.end - 0.01})
                EXPECT_NEAR(diameter_below(steps, below), flange.diameter, 1e-9) << flange.taper;
            EXPECT_LT(diameter_below(steps, flange.end + 0.01), flange.diameter - 1);
            if (flange.begin > 0) {
                EXPECT_LT(diameter_below(steps, flange.begin - 0.01), flange.diameter);
                EXPECT_GE(diameter_below(steps, 0.0), flange.taper_diameter) << flange.taper;
            }
        }
}

TEST(HolderPreset, HasTheNutOfItsCollets) {
    // Outer diameter and length of the hexagonal and slotted nuts of DIN 6499.
    constexpr double nuts[][3] = {{11, 19, 11.3}, {16, 28, 17.5}, {20, 34, 19},
                                  {25, 42, 20},   {32, 50, 22.5}, {40, 63, 25.5}};
    for (const auto& [size, diameter, length] : nuts)
        for (const char* taper :
             {"BT30", "BT40", "CAT40", "CAT50", "SK40", "HSK-A63", "R8", "ROUTER"}) {
            const double whole = 90;
            const auto steps =
                cones(fmt::format("{}-ER{}-{}", taper, static_cast<int>(size), whole));
            EXPECT_NEAR(diameter_below(steps, whole - length + 0.01), diameter, 1e-9) << size;
            EXPECT_LE(diameter_below(steps, whole - 0.01), diameter);
            EXPECT_GE(diameter_below(steps, whole - 0.01), size); // the collet is in it
        }
}

TEST(HolderPreset, HasTheDiametersOfSideLockAndShrinkFit) {
    constexpr double side_locks[][2] = {{6, 25},  {8, 28},  {10, 35}, {12, 42}, {14, 44},
                                        {16, 48}, {18, 50}, {20, 52}, {25, 65}, {32, 72}};
    for (const auto& [size, diameter] : side_locks)
        EXPECT_EQ(diameter_below(cones(fmt::format("SK40-EM{}-130", size)), 100), diameter);
    constexpr double shrink_fits[][3] = {{6, 21, 27},  {8, 21, 27},  {10, 24, 32}, {12, 24, 32},
                                         {14, 27, 34}, {16, 27, 34}, {18, 33, 42}, {20, 33, 42},
                                         {25, 44, 53}, {32, 44, 53}};
    for (const auto& [size, lower, upper] : shrink_fits) {
        const auto steps = cones(fmt::format("CAT40-SF{}-130", size));
        EXPECT_NEAR(steps.front().lower_diameter, lower, 1e-12);
        EXPECT_NEAR(steps.front().upper_diameter, upper, 1e-12);
        const double flank = std::atan((upper - lower) / 2 / steps.front().length);
        EXPECT_NEAR(flank * 180 / M_PI, 4.5, 0.01) << size;
    }
}

TEST(HolderPreset, IsTheSampleOfTheSameName) {
    const std::filesystem::path samples =
        std::filesystem::path(FEELER_SOURCE_DIR) / "assets" / "holders";
    size_t holders = 0;
    for (const auto& file : std::filesystem::directory_iterator(samples)) {
        const auto library = app::read_holder_library(file.path().string());
        ASSERT_TRUE(library) << app::error_text(library.error());
        for (const auto& [name, expected] : *library) {
            const auto made = cones(name);
            ASSERT_EQ(made.size(), expected.size()) << name;
            for (size_t i = 0; i < made.size(); ++i) {
                EXPECT_EQ(made[i].lower_diameter, expected[i].lower_diameter) << name;
                EXPECT_EQ(made[i].upper_diameter, expected[i].upper_diameter) << name;
                EXPECT_EQ(made[i].length, expected[i].length) << name;
            }
            ++holders;
        }
    }
    EXPECT_GE(holders, 40u);
}

TEST(HolderPreset, IsClosedAndHasItsCones) {
    EXPECT_GT(app::holder_presets().size(), 250u);
    for (const HolderPreset& holder : app::holder_presets()) {
        SCOPED_TRACE(holder.preset.name);
        const auto steps = app::holder_cones(holder);
        const auto mesh = app::preset_mesh(holder.preset);
        ASSERT_TRUE(steps && mesh);
        const double length = holder.preset.parameter("length")->standard;
        EXPECT_NEAR(core::total_length(*steps), length, 1e-9);
        for (const ConeStep& step : *steps) {
            EXPECT_GT(step.length, 0.0);
            EXPECT_GT(std::fmin(step.lower_diameter, step.upper_diameter), 0.0);
        }
        std::vector<std::string> repairs;
        EXPECT_TRUE(core::checked_solid(*mesh, repairs));
        EXPECT_TRUE(repairs.empty());
        EXPECT_EQ(core::shells_of(*mesh).count, 1u);
        EXPECT_EQ(mesh->bounds().min.z, 0.0);
        EXPECT_NEAR(mesh->bounds().max.z, length, 1e-9);
        EXPECT_GE(core::signed_volume(*mesh), volume(*steps));
        EXPECT_LE(core::signed_volume(*mesh), volume(*steps, app::round_deviation));
    }
}

TEST(HolderPreset, FollowsItsSizes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> share(0, 1);
    int made = 0, refused = 0;
    for (const HolderPreset& holder : app::holder_presets())
        for (int i = 0; i < 20; ++i) {
            PresetValues values;
            for (const app::PresetParameter& p : holder.preset.parameters)
                if (share(random) < 0.4)
                    values.emplace(
                        p.key, p.least + (std::fmin(p.greatest, 120) - p.least) * share(random));
            const auto steps = app::holder_cones(holder, values);
            if (!steps) {
                ++refused;
                EXPECT_THAT(steps.error().message,
                            testing::AnyOf(HasSubstr("length must be"), HasSubstr("front_height")));
                continue;
            }
            ++made;
            const app::PresetSizes sizes(holder.preset.parameters, values);
            EXPECT_NEAR(core::total_length(*steps), sizes["length"], 2e-6);
            const auto mesh = app::preset_mesh(holder.preset, values);
            ASSERT_TRUE(mesh);
            EXPECT_GE(core::signed_volume(*mesh), volume(*steps) * (1 - 1e-12));
            EXPECT_LE(core::signed_volume(*mesh), volume(*steps, app::round_deviation));
            if (!sizes.has("flange_diameter")) continue;
            const double below = sizes.has("gap") ? sizes["gap"] + 1e-3 : 1e-3;
            EXPECT_NEAR(diameter_below(*steps, below), sizes["flange_diameter"], 1e-12);
        }
    EXPECT_GT(made, 1000);
    EXPECT_GT(refused, 100);
}

// --- names ---

TEST(HolderName, MayHaveALength) {
    EXPECT_EQ(core::total_length(cones("CAT40-ER16")), 70);
    EXPECT_EQ(core::total_length(cones("CAT40-ER16-62.5")), 62.5);
    EXPECT_EQ(core::total_length(cones("CAT40-EM0.5in-100")), 100);
    EXPECT_EQ(core::total_length(cones("HSK-A63-ER32-160")), 160);
    EXPECT_EQ(core::total_length(cones("HSK63A-ER32-160")), 160);
}

TEST(HolderName, IsFoundFromTheCones) {
    std::mt19937 random(9);
    for (const HolderPreset& holder : app::holder_presets()) {
        const auto usual = app::holder_cones(holder).value();
        EXPECT_EQ(cones(app::name_of_holder(usual)).size(), usual.size());
        const double length =
            holder.preset.parameter("length")->standard + static_cast<double>(random() % 400) / 10;
        const auto longer = app::holder_cones(holder, {{"length", length}}).value();
        const auto again = cones(app::name_of_holder(longer));
        ASSERT_EQ(again.size(), longer.size()) << holder.preset.name;
        for (size_t i = 0; i < again.size(); ++i) {
            EXPECT_EQ(again[i].lower_diameter, longer[i].lower_diameter);
            EXPECT_EQ(again[i].upper_diameter, longer[i].upper_diameter);
            EXPECT_EQ(again[i].length, longer[i].length);
        }
    }
    EXPECT_EQ(app::name_of_holder(cones("BT40-ER32-100")), "BT40-ER32-100");
    EXPECT_EQ(app::name_of_holder(cones("HSK63A-ER32")), "HSK-A63-ER32");
    EXPECT_EQ(app::name_of_holder({}), "");
    EXPECT_EQ(app::name_of_holder({{50, 50, 70}, {63, 63, 20}}), "");
}

TEST(HolderName, IsRefusedWithTheNearestOrTheReason) {
    EXPECT_THAT(error_of_name("BT40-ER33"), HasSubstr("did you mean \"BT40-ER32\"?"));
    EXPECT_THAT(error_of_name("bt40-er32"), HasSubstr("did you mean \"BT40-ER32\"?"));
    EXPECT_THAT(error_of_name("ISO20-ER40"), HasSubstr("ER40 is too large for ISO20"));
    EXPECT_THAT(error_of_name("ISO20-ER40-50"), HasSubstr("ER40 is too large for ISO20"));
    EXPECT_THAT(error_of_name("R8-SF6"), HasSubstr("there is no shrink-fit chuck, 6 mm with R8"));
    EXPECT_THAT(error_of_name("BT40-EM0.5in"), HasSubstr("BT40 holders have shanks in mm"));
    EXPECT_THAT(error_of_name(""), HasSubstr("\"feeler presets\" lists all"));
    EXPECT_THAT(error_of_name("BT40-ER32-20"), HasSubstr("length must be at least 49.5 mm"));
    for (const char* length : {"1001", "0", "99999999999"})
        EXPECT_THAT(error_of_name(fmt::format("BT40-ER32-{}", length)),
                    HasSubstr("length must be from 1 to 1000 mm"));
    for (const char* length : {"", "-5", "nan", "inf", "1e3", "1.2.3", ".5", "100mm", "100 ",
                               "999999999999999999999999"})
        EXPECT_THAT(error_of_name(fmt::format("BT40-ER32-{}", length)),
                    HasSubstr("there is no holder \"BT40-ER32-"))
            << length;
}

TEST(HolderName, IsOfEachTaperAndAttachment) {
    for (const char* name : {"CAT40-ER11", "CAT50-ER40", "BT30-ER16", "BT40-ER20", "SK40-HC12",
                             "HSK-A63-SF10", "ISO20-ER16", "R8-ER32", "ROUTER-ER20",
                             "CAT40-EM0.75in", "BT40-DC13", "BT40-TC12", "CAT50-SM40", "R8-SM22"})
        EXPECT_FALSE(cones(name).empty());
}

// --- in set-ups ---

core::Result<app::SetupFile> setup_with(const std::string& holder, const std::string& head = {}) {
    const double unit = head.empty() ? 1 : 25.4;
    return app::read_setup_text(
        fmt::format("{}[[tool]]\nnumber = 4\nshape = \"flat\"\ndiameter = {}\nflute_length = {}\n"
                    "stick_out = {}\nholder = {}\n",
                    head, 10 / unit, 20 / unit, 40 / unit, holder),
        "s.toml", {});
}

std::string error_in(const std::string& holder, const std::string& head = {}) {
    const auto file = setup_with(holder, head);
    return file ? std::string() : app::error_text(file.error());
}

const std::vector<ConeStep>& holder_of(const core::Result<app::SetupFile>& file) {
    return file->setup.tools.at(core::ToolNumber{4}).description.holder;
}

TEST(HolderInSetup, IsANameOrAPresetWithSizes) {
    const auto named = setup_with("\"CAT40-ER16-80\"");
    const auto stated = setup_with("{ preset = \"CAT40-ER16\", length = 80 }");
    const auto wide = setup_with("{ preset = \"CAT40-ER16-80\", nut_diameter = 32 }");
    ASSERT_TRUE(named && stated && wide);
    EXPECT_EQ(core::total_length(holder_of(named)), 80);
    EXPECT_EQ(app::name_of_holder(holder_of(stated)), "CAT40-ER16-80");
    EXPECT_NEAR(diameter_below(holder_of(wide), 70), 32, 1e-12);
    const auto in_inch = setup_with("{ preset = \"CAT40-ER16\", length = 4, nut_diameter = 1.25 }",
                                    "length_unit = \"inch\"\n");
    ASSERT_TRUE(in_inch) << app::error_text(in_inch.error());
    EXPECT_NEAR(core::total_length(holder_of(in_inch)), 101.6, 1e-9);
    EXPECT_NEAR(diameter_below(holder_of(in_inch), 90), 31.75, 1e-12);
}

TEST(HolderInSetup, RefusesMistakesWithTheirPlace) {
    EXPECT_THAT(error_in("\"CAT40-ER17\""),
                HasSubstr("s.toml:7:10: [[tool]] 1: holder = there is no holder \"CAT40-ER17\""));
    EXPECT_THAT(error_in("{ length = 70 }"), HasSubstr("s.toml:7:10:"));
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER17\" }"), HasSubstr("s.toml:7:21:"));
    EXPECT_THAT(error_in("{ preset = \"vise-6\" }"), HasSubstr("there is no holder \"vise-6\""));
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER16\", lenth = 70 }"),
                HasSubstr("did you mean \"length\"?"));
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER16\", length = 1001 }"), HasSubstr("s.toml:7:44: "));
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER16\", length = 10 }"),
                HasSubstr("length must be at least 36.55 mm"));
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER16-80\", length = 90 }"),
                HasSubstr("is part of the name already"));
    for (const char* value : {"nan", "inf", "-inf", "\"70\"", "[70]", "{}", "1e300", "-1e300"})
        EXPECT_THAT(error_in(fmt::format("{{ preset = \"CAT40-ER16\", length = {} }}", value)),
                    HasSubstr("s.toml:7:"))
            << value;
    EXPECT_THAT(error_in("{ preset = \"CAT40-ER16\", length = 50 }", "length_unit = \"inch\"\n"),
                HasSubstr("between 0.039 in and 39.37 in"));
}

TEST(HolderInSetup, IsReplacedInEitherForm) {
    const std::string head = "[[tool]]\nnumber = 4\ndiameter = 10\n";
    for (const std::string& form :
         {std::string("holder = \"BT40-ER16\" # mine\n"),
          std::string("holder = { preset = \"BT40-ER16\", nut_diameter = 30 } # mine\n")}) {
        const auto changed =
            app::with_tool_value(head + form, core::ToolNumber{4}, "holder", "\"BT40-ER32\"");
        ASSERT_TRUE(changed) << form;
        EXPECT_THAT(*changed, HasSubstr("holder = \"BT40-ER32\"")) << form;
        EXPECT_TRUE(app::read_setup_text(*changed, "s.toml", {})) << *changed;
        const auto removed =
            app::with_tool_value(head + form, core::ToolNumber{4}, "holder", std::nullopt);
        ASSERT_TRUE(removed) << form;
        EXPECT_THAT(*removed, testing::Not(HasSubstr("BT40"))) << form;
    }
    const auto table = app::with_tool_value(head + "[tool.holder]\npreset = \"BT40-ER16\"\n",
                                            core::ToolNumber{4}, "holder", "\"BT40-ER32\"");
    ASSERT_FALSE(table);
    EXPECT_THAT(table.error().message, HasSubstr("holder"));
}

} // namespace
} // namespace app_test
