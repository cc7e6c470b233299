#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/report/text/text_report.h"
#include "app/setup/tools/tool_library.h"
#include "core/sim/tool_assembly.h"
#include "gcode/language/modal_state.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/zip_writer.h"

namespace app {
namespace {

using core::ToolNumber;
using core::ToolShape;
using Json = nlohmann::json;
using Library = std::map<ToolNumber, FoundTool>;

const test_support::ScopedFolder& fusion_folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

core::Result<Library> library_in(const std::string& name, const std::string& bytes) {
    return read_tool_library(fusion_folder().write(name, bytes), gcode::LengthUnit::mm);
}

std::string text_of(const std::vector<Json>& tools) {
    return Json{{"data", tools}, {"version", 36}}.dump();
}

/// The tools of a library in an archive.
Library tools_in(const std::vector<Json>& tools) {
    const auto read =
        library_in("a.tools", test_support::packed_zip_of({{"tools.json", text_of(tools)}}));
    EXPECT_TRUE(read.has_value()) << error_text(read.error());
    return read.value_or(Library{});
}

Json tool_json(const std::string& type, const Json& geometry, int number = 1) {
    return {{"type", type},
            {"unit", "millimeters"},
            {"description", "x"},
            {"geometry", geometry},
            {"post-process", {{"number", number}}}};
}

FoundTool only_tool(const Json& tool) {
    const Library tools = tools_in({tool});
    EXPECT_EQ(tools.size(), 1u);
    return tools.empty() ? FoundTool{} : tools.begin()->second;
}

/// The tool as it is checked; it must fit together without further assumptions.
core::ToolAssembly assembled_of(const FoundTool& found) {
    const auto assembled = core::assemble(complete(found).tool);
    EXPECT_TRUE(assembled.has_value()) << assembled.error().message;
    return assembled.value_or(core::ToolAssembly{});
}

/// The radius of a part of a tool at a height above the tip.
double radius_at(const core::ToolAssembly& tool, core::PartKind kind, double z) {
    double r = 0.0;
    for (const auto& part : tool.parts)
        if (part.kind == kind)
            for (const core::ProfileElement& element : part.profile.elements)
                if (z >= element.z0 && z <= element.z1)
                    r = std::max(r, element.r0
                                        + (element.r1 - element.r0) * (z - element.z0)
                                              / std::max(1e-9, element.z1 - element.z0));
    return r;
}

const Json slender = {
    {"DC", 10}, {"LCF", 20}, {"shoulder-length", 40}, {"shoulder-diameter", 9}, {"SFDM", 12},
    {"LB", 60}, {"OAL", 100}};

TEST(FusionLibrary, ReadsShoulderAndShank) {
    const auto tool = assembled_of(only_tool(tool_json("flat end mill", slender)));
    EXPECT_EQ(tool.length, 60.0);
    EXPECT_EQ(radius_at(tool, core::PartKind::flutes, 10.0), 5.0);
    EXPECT_EQ(radius_at(tool, core::PartKind::shank, 30.0), 4.5);
    EXPECT_EQ(radius_at(tool, core::PartKind::shank, 50.0), 6.0);
}

TEST(FusionLibrary, ReadsTheSegmentsOfTheShaft) {
    Json tool = tool_json("flat end mill", slender);
    tool["shaft"] = {{"segments",
                      {{{"height", 10}, {"lower-diameter", 9}, {"upper-diameter", 12}},
                       {{"height", 4}, {"lower-diameter", 11}, {"upper-diameter", 11}}}}};
    const auto made = assembled_of(only_tool(tool));
    EXPECT_EQ(made.length, 60.0);
    EXPECT_DOUBLE_EQ(radius_at(made, core::PartKind::shank, 45.0), 5.25);
    EXPECT_EQ(radius_at(made, core::PartKind::shank, 52.0), 5.5);
    EXPECT_EQ(radius_at(made, core::PartKind::shank, 58.0), 6.0);
    tool["shaft"]["segments"][0]["height"] = 40; // reaches into the holder
    const auto cut = assembled_of(only_tool(tool));
    EXPECT_EQ(cut.length, 60.0);
    EXPECT_DOUBLE_EQ(radius_at(cut, core::PartKind::shank, 60.0), 5.25);
}

TEST(FusionLibrary, TheHolderEndsAtTheGaugeLine) {
    Json tool = tool_json("flat end mill", slender);
    tool["holder"] = {{"description", "chuck"},
                      {"gaugeLength", 50},
                      {"segments",
                       {{{"height", 30}, {"lower-diameter", 30}, {"upper-diameter", 40}},
                        {{"height", 40}, {"lower-diameter", 50}, {"upper-diameter", 70}}}}};
    const FoundTool shorter = only_tool(tool);
    EXPECT_EQ(assembled_of(shorter).length, 110.0);
    EXPECT_TRUE(shorter.assumed.empty());
    ASSERT_EQ(shorter.tool.holder.size(), 2u);
    EXPECT_EQ(shorter.tool.holder[1].upper_diameter, 60.0);
    tool["holder"]["gaugeLength"] = 75;
    const FoundTool longer = only_tool(tool);
    EXPECT_EQ(assembled_of(longer).length, 135.0);
    EXPECT_NE(complete(longer).assumed.find("the upper 5 mm of its holder"), std::string::npos)
        << complete(longer).assumed;
    tool["holder"].erase("gaugeLength");
    EXPECT_EQ(assembled_of(only_tool(tool)).length, 130.0);
    tool["geometry"]["assemblyGaugeLength"] = 115;
    EXPECT_EQ(assembled_of(only_tool(tool)).length, 115.0);
}

TEST(FusionLibrary, EachPartHasItsUnit) {
    Json tool = tool_json("flat end mill", {{"DC", 0.5}, {"LCF", 1}, {"LB", 2}, {"SFDM", 0.5}});
    tool["unit"] = "inches";
    tool["holder"] = {
        {"segments", {{{"height", 1}, {"lower-diameter", 1}, {"upper-diameter", 1}}}}};
    EXPECT_EQ(only_tool(tool).tool.diameter, 12.7);
    EXPECT_DOUBLE_EQ(assembled_of(only_tool(tool)).length, 76.2); // the holder, too
    tool["holder"]["unit"] = "millimeters";
    EXPECT_DOUBLE_EQ(assembled_of(only_tool(tool)).length, 51.8);
    tool.erase("unit");
    tool["expressions"] = {{"tool_unit", "'inches'"}};
    EXPECT_EQ(only_tool(tool).tool.diameter, 12.7);
}

TEST(FusionLibrary, TakesPlainExpressionsInPlaceOfNumbers) {
    Json tool = tool_json("flat end mill", {{"LCF", 10}});
    tool["expressions"] = {{"tool_diameter", "0.25 in"},
                           {"tool_bodyLength", "max(tool_fluteLength; 3 mm)"},
                           {"tool_shaftDiameter", "6 mm"}};
    const FoundTool found = only_tool(tool);
    EXPECT_EQ(found.tool.diameter, 6.35);
    EXPECT_EQ(found.tool.shank_diameter, 6.0);
    EXPECT_FALSE(found.tool.stick_out);
}

TEST(FusionLibrary, ReadsEveryTypeOfMill) {
    // Fusion's sample tools.
    const std::pair<const char*, Json> samples[] = {
        {"drill",
         {{"DC", 1}, {"LB", 25}, {"LCF", 15}, {"SFDM", 1}, {"SIG", 118}, {"shoulder-length", 22}}},
        {"flat end mill",
         {{"DC", 1},
          {"LB", 10},
          {"LCF", 3},
          {"SFDM", 1},
          {"shoulder-diameter", 1},
          {"shoulder-length", 8}}},
        {"ball end mill",
         {{"DC", 1},
          {"LB", 10},
          {"LCF", 3},
          {"RE", 0.5},
          {"SFDM", 1},
          {"shoulder-diameter", 1},
          {"shoulder-length", 8}}},
        {"bull nose end mill",
         {{"DC", 6},
          {"LB", 24},
          {"LCF", 18},
          {"RE", 0.75},
          {"SFDM", 6},
          {"shoulder-diameter", 6},
          {"shoulder-length", 21},
          {"tip-diameter", 4.5}}},
        {"chamfer mill",
         {{"DC", 12},
          {"LB", 36},
          {"LCF", 18},
          {"SFDM", 12},
          {"TA", 45},
          {"shoulder-diameter", 12},
          {"shoulder-length", 27}}},
        {"face mill",
         {{"DC", 50},
          {"DCX", 50},
          {"LB", 48},
          {"LCF", 12},
          {"SFDM", 50},
          {"shoulder-diameter", 50},
          {"shoulder-length", 12},
          {"tip-diameter", 50}}},
        {"tapered mill",
         {{"DC", 12},
          {"LB", 72},
          {"LCF", 24},
          {"RE", 2.5},
          {"SFDM", 20.46},
          {"TA", 10},
          {"shoulder-diameter", 20.46},
          {"shoulder-length", 24},
          {"tip-diameter", 7}}},
        {"radius mill",
         {{"DC", 12},
          {"LB", 36},
          {"LCF", 12},
          {"RE", 6},
          {"SFDM", 24},
          {"shoulder-diameter", 24},
          {"shoulder-length", 12}}},
        {"dovetail mill",
         {{"DC", 20},
          {"LB", 40},
          {"LCF", 10},
          {"SFDM", 10},
          {"TA", 30},
          {"shoulder-diameter", 8.45},
          {"shoulder-length", 20},
          {"tip-diameter", 20}}},
        {"lollipop mill",
         {{"DC", 12},
          {"LB", 36},
          {"LCF", 10.8},
          {"RE", 6},
          {"SFDM", 6},
          {"shoulder-diameter", 6},
          {"shoulder-length", 10.8}}},
        {"slot mill",
         {{"DC", 20},
          {"LB", 60},
          {"LCF", 4},
          {"SFDM", 6.67},
          {"shoulder-diameter", 6.67},
          {"shoulder-length", 20},
          {"tip-diameter", 20}}},
        {"thread mill",
         {{"DC", 10},
          {"LB", 50},
          {"LCF", 20},
          {"SFDM", 10},
          {"TP", 1.5},
          {"shoulder-diameter", 8.27},
          {"shoulder-length", 30},
          {"tip-diameter", 10}}},
        {"boring bar",
         {{"DC", 10}, {"LB", 50}, {"LCF", 20}, {"SFDM", 10}, {"shoulder-length", 30}}},
        {"counter bore",
         {{"DC", 6}, {"LB", 24}, {"LCF", 12}, {"SFDM", 4.8}, {"shoulder-length", 12}}},
        {"counter sink",
         {{"DC", 12},
          {"LB", 24},
          {"LCF", 5.4},
          {"SFDM", 7.2},
          {"SIG", 90},
          {"shoulder-length", 8.1},
          {"tip-diameter", 1.2}}},
        {"spot drill",
         {{"DC", 6}, {"LB", 18}, {"LCF", 12}, {"SFDM", 6}, {"SIG", 120}, {"shoulder-length", 15}}},
        {"center drill",
         {{"DC", 6},
          {"LB", 18},
          {"LCF", 12},
          {"SFDM", 6},
          {"SIG", 118},
          {"TA", 90},
          {"shoulder-length", 15},
          {"tip-diameter", 2},
          {"tip-length", 2}}},
        {"reamer", {{"DC", 6}, {"LB", 48}, {"LCF", 18}, {"SFDM", 5.4}, {"shoulder-length", 18}}},
        {"tap left hand",
         {{"DC", 10}, {"LB", 50}, {"LCF", 20}, {"SFDM", 10}, {"shoulder-length", 30}}},
    };
    for (const auto& [type, geometry] : samples) {
        const FoundTool found = only_tool(tool_json(type, geometry));
        EXPECT_TRUE(found.has_shape) << type;
        const auto tool = assembled_of(found);
        EXPECT_NEAR(tool.length, geometry.at("LB").get<double>(), 1e-9) << type;
        EXPECT_EQ(complete(found).assumed.find("flutes"), std::string::npos)
            << complete(found).assumed;
    }
}

TEST(FusionLibrary, FormsHaveTheirOutline) {
    const auto radius = assembled_of(only_tool(
        tool_json("radius mill", {{"DC", 12}, {"RE", 6}, {"LCF", 12}, {"LB", 36}, {"SFDM", 24}})));
    EXPECT_NEAR(radius_at(radius, core::PartKind::flutes, 0.0), 6.0, 1e-9);
    for (const double z : {0.7, 2.0, 3.5, 5.9}) {
        const double exact = 12.0 - std::sqrt(36.0 - z * z);
        EXPECT_GE(radius_at(radius, core::PartKind::flutes, z), exact - 1e-9) << z;
        EXPECT_LE(radius_at(radius, core::PartKind::flutes, z), exact + 0.2) << z;
    }
    EXPECT_NEAR(radius_at(radius, core::PartKind::flutes, 8.0), 12.0, 1e-9);
    const auto centre = assembled_of(only_tool(tool_json("center drill", {{"DC", 6},
                                                                          {"LCF", 12},
                                                                          {"LB", 18},
                                                                          {"SIG", 118},
                                                                          {"TA", 90},
                                                                          {"tip-diameter", 2},
                                                                          {"tip-length", 2}})));
    EXPECT_NEAR(radius_at(centre, core::PartKind::flutes, 1.5), 1.0, 1e-9);
    EXPECT_NEAR(radius_at(centre, core::PartKind::flutes, 3.0), 2.0, 1e-9);
    EXPECT_NEAR(radius_at(centre, core::PartKind::flutes, 8.0), 3.0, 1e-9);
    const auto face = assembled_of(only_tool(
        tool_json("face mill", {{"DC", 50}, {"DCX", 63}, {"LCF", 6}, {"LB", 48}, {"SFDM", 50}})));
    EXPECT_NEAR(radius_at(face, core::PartKind::flutes, 3.0), 28.25, 1e-9);
    EXPECT_EQ(only_tool(tool_json("tap left hand", {{"DC", 6}})).tool.cuts,
              core::SpindleDirection::counterclockwise);
    EXPECT_EQ(only_tool(tool_json("flat end mill", {{"DC", 6}, {"HAND", false}})).tool.cuts,
              core::SpindleDirection::counterclockwise);
}

TEST(FusionLibrary, SaysWhichOfSeveralToolsWithANumberCounts) {
    const Json six = tool_json("flat end mill", {{"DC", 6}}, 4);
    const Library same = tools_in({six, six});
    EXPECT_TRUE(same.at(ToolNumber{4}).assumed.empty());
    const Library tools = tools_in(
        {six, tool_json("flat end mill", {{"DC", 8}}, 4), tool_json("drill", {{"DC", 6}}, 4), six});
    ASSERT_EQ(tools.size(), 1u);
    EXPECT_EQ(tools.at(ToolNumber{4}).tool.diameter, 6.0);
    EXPECT_NE(complete(tools.at(ToolNumber{4}))
                  .assumed.find("the first of 3 different tools with this number"),
              std::string::npos);
}

TEST(FusionLibrary, LeavesOutWhatCannotBeCalled) {
    const auto read = library_in(
        "b.json",
        text_of({tool_json("holder", {{"DC", 6}}), tool_json("probe", {{"DC", 6}}),
                 tool_json("turning general", {{"DC", 6}}), tool_json("drill", {{"DC", 6}}, 0),
                 tool_json("drill", {{"DC", 6}}, -3), tool_json("drill", {{"DC", 0}}, 3)}));
    ASSERT_FALSE(read.has_value());
    EXPECT_NE(read.error().message.find("no milling tool with a number"), std::string::npos);
    Json huge = tool_json("drill", {{"DC", 6}});
    huge["post-process"]["number"] = 9223372036854775807LL;
    EXPECT_FALSE(library_in("c.json", text_of({huge})).has_value());
}

TEST(FusionLibrary, RefusesArchivesThatAreNoLibrary) {
    const auto no_library = library_in("d.tools", test_support::zip_of({{"readme.txt", "x"}}));
    ASSERT_FALSE(no_library.has_value());
    EXPECT_NE(no_library.error().message.find("without tools.json"), std::string::npos);
    EXPECT_FALSE(library_in("e.tools", "PK").has_value());
    EXPECT_FALSE(library_in("f.tools", test_support::zip_of({{"tools.json", "{"}})).has_value());
    EXPECT_TRUE(
        library_in("G.TOOLS", test_support::zip_of(
                                  {{"mine.json", text_of({tool_json("drill", {{"DC", 6}})})}}))
            .has_value());
}

// --- HSM
// ------------------------------------------------------------------------------------------

const char* const hsm = R"(<?xml version="1.0" encoding="UTF-16" standalone="no"?>
<tool-library xmlns="http://www.hsmworks.com/xml/2004/cnc/tool-library" version="14">
  <tool type="flat end mill" unit="millimeters" id="1">
    <description>Aluminium &lt;10&gt;</description>
    <nc number="4" diameter-offset="4" length-offset="4"/>
    <body diameter="10" flute-length="22" shoulder-length="30" body-length="40" overall-length="72"
          shaft-diameter="12"/>
    <holder description="ER20">
      <section diameter="25" length="0"/>
      <section diameter="33" length="2"/>
      <section diameter="33" length="16"/>
      <section diameter="24" length="0"/>
      <section diameter="24" length="10"/>
    </holder>
  </tool>
  <tool type="chamfer mill" unit="inches"><nc number="5"/>
    <body diameter="0.25" taper-angle="45" tip-diameter="0" flute-length="0.125" shoulder-length="1" body-length="1.5" shaft-diameter="0.25"/>
  </tool>
  <tool type="drill" unit="millimeters"><nc number="6"/><body diameter="2.5" taper-angle="118" flute-length="30" body-length="40" shaft-diameter="2.5"/></tool>
  <tool type="turning general"><nc number="7"/></tool>
</tool-library>
)";

std::string utf16_of(const std::string& ascii) {
    std::string text = "\xFF\xFE";
    for (const char c : ascii) text += c, text += '\0';
    return text;
}

TEST(HsmLibrary, ReadsBothEncodings) {
    for (const std::string& bytes : {std::string(hsm), utf16_of(hsm)}) {
        const auto read = library_in("a.hsmlib", bytes);
        ASSERT_TRUE(read.has_value()) << error_text(read.error());
        ASSERT_EQ(read->size(), 3u);
        const FoundTool& mill = read->at(ToolNumber{4});
        EXPECT_EQ(mill.tool.name, "Aluminium <10>");
        const auto tool = assembled_of(mill);
        EXPECT_EQ(tool.length, 68.0);
        EXPECT_EQ(radius_at(tool, core::PartKind::shank, 26.0), 5.0);
        EXPECT_EQ(radius_at(tool, core::PartKind::shank, 35.0), 6.0);
        EXPECT_EQ(radius_at(tool, core::PartKind::holder, 41.0), 14.5);
        EXPECT_EQ(radius_at(tool, core::PartKind::holder, 65.0), 12.0);
        const auto chamfer = assembled_of(read->at(ToolNumber{5}));
        EXPECT_NEAR(radius_at(chamfer, core::PartKind::flutes, 3.0), 3.0, 1e-9);
        EXPECT_EQ(radius_at(chamfer, core::PartKind::shank, 20.0), 3.175);
        EXPECT_EQ(read->at(ToolNumber{6}).tool.point_deg, 118.0);
    }
}

TEST(HsmLibrary, RefusesOtherXml) {
    EXPECT_NE(error_text(library_in("b.hsmlib", "<a/>").error()).find("tool-library is missing"),
              std::string::npos);
    const auto open = library_in("c.hsmlib", "<tool-library>\n<tool>");
    ASSERT_FALSE(open.has_value());
    EXPECT_EQ(open.error().where.line, 2u);
    EXPECT_FALSE(library_in("d.hsmlib", utf16_of("<tool-library/>")).has_value());
    EXPECT_FALSE(library_in("e.hsmlib", std::string("\xFF\xFE<", 3)).has_value());
}

TEST(FusionLibrary, DamagedLibrariesAreReadOrRefused) {
    Json tool = tool_json("bull nose end mill", slender);
    tool["geometry"]["RE"] = 1;
    tool["holder"] = {
        {"gaugeLength", 50},
        {"segments", {{{"height", 30}, {"lower-diameter", 30}, {"upper-diameter", 40}}}}};
    const std::string samples[] = {
        text_of({tool, tool_json("radius mill", {{"DC", 12}, {"RE", 6}}, 2)}), hsm};
    std::mt19937 random(5);
    size_t accepted = 0;
    for (int round = 0; round < 800; ++round) {
        std::string text = samples[round % 2];
        for (unsigned change = 0; change < 1 + random() % 3; ++change) {
            const size_t at = random() % text.size();
            // Mostly numbers, so that most files remain libraries.
            const bool digit = text[at] >= '0' && text[at] <= '9';
            if (digit || random() % 4 == 0) text[at] = "0123456789.-eE\"<"[random() % 16];
        }
        const auto read = library_in(round % 2 == 0 ? "z.json" : "z.hsmlib", text);
        if (!read) continue;
        ++accepted;
        for (const auto& [number, found] : *read) {
            (void)core::assemble(complete(found).tool); // an error, or a tool
            EXPECT_GT(core::value_of(number), 0);
        }
    }
    EXPECT_GT(accepted, 300u);
}

TEST(FusionLibrary, KeepsTheHolderWhereTheBodyEnds) {
    Json tool = tool_json("flat end mill", {{"DC", 12}, {"LB", 20}, {"LCF", 26}, {"SFDM", 12}});
    EXPECT_EQ(only_tool(tool).tool.stick_out, 20.0);
    EXPECT_EQ(only_tool(tool).tool.flute_length, 20.0);
    static_cast<void>(assembled_of(only_tool(tool)));
}

TEST(FusionLibrary, LeavesOutAHolderWithSizesThatAreNoNumbers) {
    for (const char* damage : {R"("lower-diameter": "32")", R"("upper-diameter": null)"}) {
        const std::string whole = R"({"height": 30, "lower-diameter": 32, "upper-diameter": 40})";
        Json segment = Json::parse(whole);
        segment.update(Json::parse(std::string("{") + damage + "}"));
        Json tool = tool_json("flat end mill", {{"DC", 12}, {"LB", 40}, {"LCF", 26}});
        tool["holder"] = {{"segments", Json::array({Json::parse(whole), segment})}};
        const FoundTool found = only_tool(tool);
        EXPECT_TRUE(found.tool.holder.empty());
        ASSERT_EQ(found.assumed.size(), 1u);
        EXPECT_EQ(found.assumed[0].find("no holder"), 0u);
    }
}

TEST(FusionLibrary, KnowsUnitsInAnyCaseAndRefusesOthers) {
    Json tool = tool_json("flat end mill", {{"DC", 0.5}});
    tool["unit"] = "Inch";
    EXPECT_EQ(only_tool(tool).tool.diameter, 12.7);
    for (const Json& unit : {Json("centimeters"), Json(25.4), Json(true)}) {
        tool["unit"] = unit;
        const auto read =
            library_in("cm.tools", test_support::packed_zip_of({{"tools.json", text_of({tool})}}));
        ASSERT_FALSE(read) << unit;
        EXPECT_NE(error_text(read.error()).find(unit.is_string() ? "centimeters" : unit.dump()),
                  std::string::npos);
    }
}

TEST(FusionLibrary, TakesNumbersHoweverTheyAreWritten) {
    for (const Json& number : {Json(7), Json(7.0), Json("7")}) {
        Json tool = tool_json("flat end mill", {{"DC", 6}});
        tool["post-process"]["number"] = number;
        EXPECT_EQ(core::value_of(only_tool(tool).tool.number), 7);
    }
}

} // namespace
} // namespace app
