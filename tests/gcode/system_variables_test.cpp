#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The final value of #100, the error, or "vacant".
std::string result_of(std::string_view text, DialectId dialect = DialectId::fanuc) {
    Environment environment = known_environment(dialect);
    environment.work_offsets[1][0] = 50.0; // G55 X
    environment.length_offsets[core::OffsetNumber(3)] = {.length = 80.0, .wear = 0.5};
    environment.tool_lengths[core::ToolNumber(4)] = 60.0;
    const Ran ran = run_text("G21 G0\n" + std::string(text), environment);
    if (ran.run.error) return "error: " + ran.run.error->message;
    const Value value = ran.run.state.parameters->numbered(100);
    return value ? fmt::format("{:.6g}", *value) : "vacant";
}

TEST(SystemVariables, HaasHasTwoNumbersForAVariable) {
    EXPECT_EQ(result_of("#10501=7\n#100=#501", DialectId::haas), "7");
    EXPECT_EQ(result_of("#10100=8", DialectId::haas), "8");
    EXPECT_EQ(result_of("#899=9\n#100=#10899", DialectId::haas), "9");
    EXPECT_EQ(result_of("#10300=6\n#100=#300", DialectId::haas), "vacant");
}

TEST(SystemVariables, PositionsAreThoseOfThePreviousBlock) {
    const std::string start = "G55 X10 Y2\nG43 H3 Z5\n";
    EXPECT_EQ(result_of(start + "#100=#5001"), "10");
    EXPECT_EQ(result_of(start + "#100=#5021"), "60");
    EXPECT_EQ(result_of(start + "#100=#5003"), "5");
    EXPECT_EQ(result_of(start + "#100=#5023"), "85.5");
    EXPECT_EQ(result_of(start + "#100=#5043"), "85.5");
    EXPECT_EQ(result_of(start + "#100=#5043", DialectId::haas), "5");
    EXPECT_EQ(result_of(start + "#100=#5083"), "80.5");
    EXPECT_EQ(result_of("X25.4\nG20\n#100=#5001"), "1");
    EXPECT_THAT(result_of("#5001=3"), HasSubstr("read-only and cannot be set"));
    Environment unknown = known_environment(DialectId::fanuc);
    unknown.start = {};
    EXPECT_EQ(run_text("#100=#5001", unknown).run.state.parameters->numbered(100), Value{});
}

TEST(SystemVariables, OffsetsAreReadAndWritten) {
    EXPECT_EQ(result_of("#100=#5241"), "50");
    EXPECT_EQ(result_of("G20\n#100=#5241"), fmt::format("{:.6g}", 50 / 25.4));
    EXPECT_EQ(result_of("#5201=3\nG55 X1\n#100=#5021"), "54");
    EXPECT_EQ(result_of("#7022=8\n#100=#14022"), "8");
    EXPECT_EQ(result_of("#7022=8\n#100=#14022", DialectId::haas), "8");
    EXPECT_EQ(result_of("#14001=8\n#100=#7001"), "8");
    EXPECT_EQ(result_of("#100=#11003+#10003"), "80.5");
    EXPECT_EQ(result_of("#100=#2203+#2003"), "80.5");
    EXPECT_EQ(result_of("#100=#2003+#2203", DialectId::haas), "80.5");
    EXPECT_EQ(result_of("#13001=4\n#100=#13001"), "4");
    EXPECT_EQ(result_of("#2401=8\n#100=#2401", DialectId::haas), "8");
    EXPECT_EQ(result_of("#8550=3\n#100=#8553", DialectId::haas), "80");
    EXPECT_EQ(result_of("#8550=-1E0", DialectId::haas).substr(0, 5), "error");
    // The length of a tool without a table entry is kept when its wear is written.
    EXPECT_EQ(result_of("#10004=1\n#100=#11004"), "60");
}

TEST(SystemVariables, OffsetsTakeEffectAtOnceAndTheMachineStays) {
    const Ran ran = run_text("G21 G0 X10 Z0\nG43 H3\n#5221=4\n#11003=7\nX10 H3 Z0\nM30");
    ASSERT_FALSE(ran.run.error) << ran.run.error->message;
    Lowering lowering = initial_lowering(known_environment(DialectId::fanuc));
    for (const BlockCommands& block : ran.run.blocks) lower(block, lowering);
    EXPECT_EQ(lowering.machine[0], 14.0);
    EXPECT_EQ(lowering.machine[2], 7.0);
    const ModalState& modal = ran.run.blocks.empty() ? ModalState{} : ran.run.state.modal;
    EXPECT_EQ(machine_from_program(modal.offsets, modal.position)[0], 14.0);
    EXPECT_EQ(result_of("X10\n#5221=4\n#100=#5001"), "6");
}

TEST(SystemVariables, AFailedBlockLeavesOffsetsAsTheyWere) {
    const Ran ran = run_text("G20\n#5221=4\n#5221=5 #11001=3 G123\n");
    ASSERT_TRUE(ran.run.error);
    EXPECT_EQ(ran.run.state.modal.offsets.work.origin[0], 4 * 25.4);
    EXPECT_EQ(ran.run.state.tables->work[0].origin[0], 4 * 25.4);
    EXPECT_TRUE(ran.run.state.tables->lengths.empty());
}

TEST(SystemVariables, ModesAndWordsAreThoseOfTheBlockBefore) {
    for (const auto& [number, value] : {std::pair{4001, "1"},
                                        {4002, "18"},
                                        {4003, "91"},
                                        {4005, "94"},
                                        {4006, "21"},
                                        {4007, "40"},
                                        {4008, "43"},
                                        {4009, "80"},
                                        {4010, "99"},
                                        {4012, "67"},
                                        {4014, "55"},
                                        {4109, "200"},
                                        {4111, "3"},
                                        {4113, "8"},
                                        {4114, "7"},
                                        {4119, "900"},
                                        {4120, "5"}})
        EXPECT_EQ(result_of(fmt::format("G55 G18 G91 G99 G43 H3\nT5 S900\nN7 G1 X5 F200 M8\n"
                                        "#100=#{}",
                                        number)),
                  value)
            << number;
    EXPECT_EQ(result_of("X1.5\n#100=#4124", DialectId::haas), "1.5");
    // The usual way in which macros save the modes of their caller.
    EXPECT_EQ(trace("G21 G90 G0\n#10=#4003\nG91 X1\nG#10 X5\nM30"),
              "straight_traverse x=1 y=0 z=0\nstraight_traverse x=5 y=0 z=0\n");
}

TEST(SystemVariables, AlarmsEndTheRunWithTheirMessage) {
    EXPECT_EQ(error_of("G21\nIF [#1 EQ #0] THEN #3000=12 (NO TOOL)\nM30"),
              "2:20: the program raises alarm 3012 here: NO TOOL; the control stops");
    EXPECT_THAT(error_of("#3000=1 (X)", DialectId::haas), HasSubstr("alarm 1001 here: X"));
    EXPECT_EQ(trace("#3006=1 (TURN THE PART)\nM30"), "message text=TURN THE PART\nprogram_stop\n");
}

TEST(SystemVariables, TheClockIsFixedAndTimersAdvance) {
    EXPECT_EQ(result_of("#100=#3011"), "2.02001e+07");
    EXPECT_THAT(warnings_of("#100=#3012\n#101=#3011"), HasSubstr("clock and timers are simulated"));
    EXPECT_EQ(result_of("#3001=0\nWHILE [#3001 LT 60000] DO 1\nEND 1\n#100=1"), "1");
    EXPECT_EQ(result_of("#3003=1\n#100=#3003+#3004"), "1");
}

TEST(SystemVariables, CommonOnesAreVacantUntilSet) {
    EXPECT_EQ(result_of("#500=3\n#100=#500\n#100=#0"), "vacant");
    EXPECT_EQ(result_of("#999=4\n#100=#[1000-1]"), "4");
    EXPECT_EQ(result_of("#100=#1005"), "0");
}

TEST(FanucFlow, LoopsNestAndAreLeft) {
    EXPECT_EQ(result_of("#100=0\n#1=0\nWHILE [#1 LT 2] DO 1\n#2=0\nWHILE [#2 LT 3] DO 2\n#3=0\n"
                        "WHILE [#3 LT 4] DO 3\n#100=#100+1\n#3=#3+1\nEND 3\n#2=#2+1\nEND 2\n"
                        "#1=#1+1\nEND 1\n"),
              "24");
    EXPECT_EQ(result_of("#100=0\nDO 1\nDO 2\n#100=#100+1\nIF [#100 GE 3] GOTO 9\nEND 2\nEND 1\n"
                        "N9\nWHILE [#100 LT 7] DO 1\n#100=#100+2\nEND 1"),
              "7");
    EXPECT_THAT(result_of("WHILE [1 EQ 1] DO 4\nEND 4"), HasSubstr("1, 2 or 3"));
    // The END of another program in the file does not end it.
    EXPECT_THAT(result_of("WHILE [#1 EQ 1] DO 1\nM30\nO5\nDO 1\nEND 1\nM99"),
                HasSubstr("'END' of 1 is missing"));
}

TEST(FanucFlow, JumpsGoForwardFirst) {
    const std::string text = "#100=0\nGOTO 2\nN1 #100=#100+10\nGOTO 3\nN2 GOTO 1\n#100=90\n"
                             "N1 #100=#100+1\nN3 M30\n";
    EXPECT_EQ(result_of(text), "1");
    EXPECT_THAT(warnings_of(text), HasSubstr("N1 is in lines 3 and 7"));
    EXPECT_EQ(result_of("#1=2\nGOTO [#1*10+1]\n#100=5\nN21 #100=6"), "6");
    EXPECT_EQ(result_of("#1=21\nGOTO#1\n#100=5\nN21 #100=6"), "6");
    EXPECT_THAT(result_of("GOTO 5\nM30\nO9\nN5 M99"), HasSubstr("no block N5"));
}

TEST(FanucFlow, ThenMayDoSeveralThings) {
    EXPECT_EQ(result_of("#100=0\nIF [#100 EQ 0] THEN #1=2 #100=3\n"), "3");
    EXPECT_EQ(result_of("#100=0\nIF [#100 EQ 1] THEN #1=2 #100=3\n"), "0");
    EXPECT_EQ(result_of("X7\nIF [1 EQ 1] THEN G91 X2\n#100=#5001"), "9");
    EXPECT_EQ(result_of("#100=1\nIF [1 EQ 2] THEN GOTO 5\n#100=2\nN5 M30"), "2");
    EXPECT_EQ(result_of("#100=1\nIF [1 EQ 1] THEN GOTO 5\n#100=2\nN5 M30"), "1");
}

TEST(FanucFlow, JumpsAndLoopsMustBeAloneInTheirBlock) {
    for (const std::string line :
         {"G0 X5 GOTO 5", "GOTO 5 X7", "#1=2 GOTO 5", "IF [1 EQ 1] GOTO 5 X7", "END 1 X5",
          "GOTO 5 GOTO 5", "IF [1 EQ 1] THEN WHILE [1] DO 1"})
        EXPECT_THAT(result_of("#100=1\n" + line + "\nN5 M30"), HasSubstr("in a block by itself"))
            << line;
    EXPECT_EQ(result_of("#100=1\nN3 GOTO 5 (AWAY)\n#100=2\nN5 M30"), "1");
}

TEST(DecimalPoints, AMixtureIsWarnedOfOnce) {
    const auto count = [](std::string_view text, DialectId dialect) {
        const std::string all = warnings_of(text, dialect);
        size_t found = 0;
        for (size_t at = all.find("decimal point"); at != std::string::npos;
             at = all.find("decimal point", at + 1))
            ++found;
        return found;
    };
    for (const DialectId dialect : {DialectId::fanuc, DialectId::haas}) {
        EXPECT_EQ(count("G21 G0 X5. Y0\nX5\nX6\nX7.\nM30", dialect), 1u);
        EXPECT_EQ(count("G21 G0 X5\nX6.\nX7\nM30", dialect), 1u);
        EXPECT_EQ(count("G21 G0 X5. Y0\nX6.\nG4 X1\nM30", dialect), 0u);
        EXPECT_EQ(count("G21 G0 X5 Y0\nX6\nG4 X1.\nM30", dialect), 0u);
    }
    EXPECT_EQ(count("G21 G0 X5. Y0\nX5\nM2", DialectId::linuxcnc), 0u);
}

TEST(DecimalPoints, SmallestStepsAreCountedWhereTheEnvironmentSaysSo) {
    Environment environment = known_environment(DialectId::fanuc);
    environment.counts_smallest_steps = true;
    const std::string text = "G21 G0 X5 Y5.\nG1 X[5] F100\nG20 X2000 Y1.\nM30";
    EXPECT_EQ(commands_of(run_text(text, environment).run),
              "straight_traverse x=0.005 y=5 z=0\nstraight_feed x=5 y=5 z=0 feed=100\n"
              "straight_feed x=5.08 y=25.4 z=0 feed=100\n");
}

} // namespace
} // namespace gcode
