#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

Recognition recognised(std::string_view text, std::string file = {}) {
    const auto program = program_from_text(text, std::move(file));
    EXPECT_TRUE(program);
    return recognise(*program);
}

TEST(Dialect, IsFoundByItsName) {
    const auto names = dialect_names();
    ASSERT_FALSE(names.empty());
    for (size_t i = 0; i < names.size(); ++i) {
        const auto id = static_cast<DialectId>(i);
        EXPECT_EQ(dialect(id).id, id);
        EXPECT_EQ(dialect(id).name, names[i]);
        EXPECT_EQ(dialect_named(names[i]), id);
    }
    EXPECT_THAT(names, testing::Contains("siemens-iso"));
    EXPECT_EQ(dialect_named("mazak"), std::nullopt);
}

TEST(Dialect, IsRecognisedWithAReason) {
    const Recognition numbered = recognised("%\nO1000 (SLOT)\nG0 X1\nM30\n%\n");
    EXPECT_EQ(numbered.dialect, DialectId::fanuc);
    EXPECT_THAT(numbered.reason, HasSubstr("line 2 is a program number (O1000)"));
    EXPECT_EQ(recognised("T1 M6\nG0 G43 H1 Z5\n").dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("G0 X1\nG0 G91 G28 Z0\n").dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("G187 P1\nG0 X1").dialect, DialectId::haas);
    EXPECT_EQ(recognised("G21 G61.1\nG0 X1").dialect, DialectId::linuxcnc);
    EXPECT_EQ(recognised("#<depth>=5\nG0 X1").dialect, DialectId::linuxcnc);
    EXPECT_EQ(recognised("o100 sub\nG0 X1\no100 endsub").dialect, DialectId::linuxcnc);
    EXPECT_EQ(recognised("G21\nG0 X1\nG1 Z-1 F100\n").dialect, DialectId::grbl);
    EXPECT_EQ(recognised("T1 M6\nG0 X1").dialect, DialectId::linuxcnc);
    EXPECT_EQ(recognised("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z\n").dialect, DialectId::heidenhain);
    EXPECT_EQ(recognised("PROC MAIN\nG0 X1").dialect, DialectId::siemens);
}

TEST(Recognition, IgnoresCluesInComments) {
    const std::string mill = "G90 G94 G17\nG21\nG0 X0 Y0\nG1 Z-1. F200\n";
    for (const std::string comment : {"(T1  D=4. CR=0. - ZMIN=-2. - FLAT END MILL)",
                                      "( SUPA AP=3 )",
                                      "G0 X1 (T=\"MILL\")",
                                      "; CR=5 #<depth>",
                                      "(set #<depth> first)",
                                      "(@5 ^30)",
                                      "T1(CR=0 CR=1)",
                                      "(R1=5)",
                                      "(o100 sub)",
                                      "(DEBUG, remove later)",
                                      "(AXIS, DIAMETER 5)",
                                      "(N10 CYCLE83(1,2))",
                                      "N5 (GOTOF END)",
                                      "(MSG(\"A\"))",
                                      "G1 X1 F100 ; MCALL CYCLE81",
                                      "(UNCLOSED CR=5",
                                      "(TOOL (D=4) CR=0. AP=2)",
                                      "(CALL OMAIN G15 H1)",
                                      "; G15 H1",
                                      "(VC1=5)",
                                      "(BEGIN PGM A MM)"}) {
        const Recognition plain = recognised(mill);
        const Recognition seen = recognised(comment + "\n" + mill);
        EXPECT_TRUE(seen.dialect == plain.dialect || seen.dialect == DialectId::linuxcnc)
            << comment << ": " << seen.reason;
        EXPECT_EQ(seen.refusal, "") << comment;
        EXPECT_THAT(seen.reason, testing::AnyOf(HasSubstr("no tools"), HasSubstr("nothing in")))
            << comment;
    }
}

TEST(Recognition, TakesLinuxcncFromWeakEvidenceBeforeFanucFromG43WithH) {
    const std::string text = "G21 G90\nT1 M6\nG43 H1 Z5\nG0 X1\n";
    EXPECT_EQ(recognised(text, "part.nc").dialect, DialectId::fanuc);
    EXPECT_THAT(recognised(text, "part.ngc").reason, HasSubstr("ends in .NGC"));
    EXPECT_THAT(recognised(text + "G64 P0.01 Q0.02\n").reason, HasSubstr("has G64 with P or Q"));
    EXPECT_THAT(recognised("(Post Processor: linuxcnc_post)\n" + text).reason,
                HasSubstr("line 1 names a post-processor for LinuxCNC"));
    for (const std::string& weak :
         {"G64 P0.01\n" + text, "(Post Processor: linuxcnc_post)\n" + text})
        EXPECT_EQ(recognised(weak).dialect, DialectId::linuxcnc);
    EXPECT_EQ(recognised("G64\nG4 P1\n" + text).dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("G64 G4 P1\n" + text).dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("(NOT FOR LINUXCNC)\n" + text).dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("G21 G90\nG0 X1\n", "part.ngc").dialect, DialectId::grbl);
    // Stronger evidence stays stronger.
    EXPECT_EQ(recognised("O1000\n" + text, "part.ngc").dialect, DialectId::fanuc);
    EXPECT_EQ(recognised(text + "G187 P1\nG64 P1\n", "part.ngc").dialect, DialectId::haas);
    EXPECT_EQ(recognised(text + "G91 G28 G0 Z0\n", "part.ngc").dialect, DialectId::fanuc);
}

TEST(Recognition, IsNotDisturbedByTextAfterASemicolon) {
    EXPECT_EQ(recognised("T1 M6 ; T1\nG43 H1 Z5 ; G0\nG0 X1 ; G1 X2\n").dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("O1 ; G0 X5\nG0 X1\n").dialect, DialectId::fanuc);
}

TEST(Recognition, ReadsCodeAroundCommentsAndInExpressions) {
    const DialectId siemens = DialectId::siemens, linuxcnc = DialectId::linuxcnc;
    EXPECT_EQ(recognised("(COMMENT) G2 X1 Y1 CR=5").dialect, siemens);
    EXPECT_EQ(recognised("MSG(\"A;B\")\nG0 X1").dialect, siemens);
    EXPECT_EQ(recognised("N10 G0 X=AC(5) ; X").dialect, siemens);
    EXPECT_EQ(recognised("N10 R1=(2+3)*R2").dialect, siemens);
    EXPECT_EQ(recognised("IF (R1==5) GOTOF ENDE").dialect, siemens);
    EXPECT_EQ(recognised("G1 X=(R1+2) CR=5").dialect, siemens);
    EXPECT_EQ(recognised("(a) G0 X#<a> (b)").dialect, linuxcnc);
    EXPECT_EQ(recognised("(DEBUG, #5)\nG0 X1").dialect, linuxcnc);
    EXPECT_EQ(recognised("(AXIS,hide)\nG0 X1").dialect, linuxcnc);
    EXPECT_EQ(recognised("(a) O100 SUB (b)\n").dialect, linuxcnc);
    EXPECT_EQ(recognised("O1\nG71 U2. R1.\nG71 P10 Q20 U0.5\n").dialect, DialectId::fanuc);
    EXPECT_EQ(recognised("O1\nG81 Z-5 R1 L0\nG70 I30 J0 L6\n").dialect, DialectId::haas);
    EXPECT_EQ(recognised("G21\nPOPEN\nDPRNT[X#1[44]]\nPCLOS\n").dialect, DialectId::fanuc);
}

TEST(Recognition, RefusesOtherControlsByName) {
    for (const std::string text :
         {"$PART.MIN%\nG0 X1\n", "O1001\nG15 H1\nG0 X0\n", "N1 G90\nN2 CALL OSUB\n",
          "G0 X1\nVC1=VC2+5\n", "NOEX V1=5\n", "T1 M6\nG56 HA Z50\n", "G15H02 X0 Y0\n"}) {
        const Recognition seen = recognised(text);
        EXPECT_THAT(seen.refusal, HasSubstr("Okuma")) << text;
        EXPECT_FALSE(supported(seen));
    }
    EXPECT_THAT(recognised("%PART G71 *\nN10 G30 G17 X+0 Y+0 Z-40*\n").refusal,
                HasSubstr("DIN/ISO"));
    EXPECT_EQ(recognised("%\nO1000\nG15\nG43 H1 Z5\n").refusal, "");
    EXPECT_EQ(recognised("CALL ORIGINAL\n").refusal, ""); // a variable of Siemens
    EXPECT_EQ(recognised("% PART\nG71 X5\n").refusal, "");
    EXPECT_TRUE(supported(recognised("O1\nG56 H1 Z5\n")));
}

} // namespace
} // namespace gcode
