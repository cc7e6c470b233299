#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/language.h"

namespace gcode {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Block parsed(std::string_view text, DialectId id = DialectId::fanuc) {
    Block block;
    const auto read = parse_line(text, 7, dialect(id), block);
    EXPECT_TRUE(read) << text << ": " << (read ? "" : read.error().message);
    return block;
}

/// "column: message"
std::string refused(std::string_view text, DialectId id = DialectId::fanuc) {
    Block block;
    const auto read = parse_line(text, 7, dialect(id), block);
    if (read) return "accepted";
    EXPECT_EQ(read.error().where.line, 7u);
    return std::to_string(read.error().where.column) + ": " + read.error().message;
}

TEST(Parser, ReadsWordsWithLineAndColumn) {
    const Block block = parsed("N10 g1X-2.5 Y+3");
    ASSERT_EQ(block.words.size(), 4u);
    EXPECT_EQ(block.words[0], (Word{.letter = 'N', .value = 10.0}));
    EXPECT_EQ(block.words[1], (Word{.letter = 'G', .value = 1.0}));
    EXPECT_EQ(block.words[2], (Word{.letter = 'X', .value = -2.5, .has_point = true}));
    EXPECT_EQ(block.words[3], (Word{.letter = 'Y', .value = 3.0}));
    EXPECT_EQ(block.words[2].span.line, 7u);
    EXPECT_EQ(block.words[2].span.column, 7u);
    EXPECT_EQ(block.words[2].span.length, 5u);
}

TEST(Parser, AllowsBlanksInsideNumbers) {
    // As in LinuxCNC: G0 X 1 2 . 5 Y+.5 Z5.
    const Block block = parsed("G0 X 1 2 . 5 Y+.5\tZ5.");
    ASSERT_EQ(block.words.size(), 4u);
    EXPECT_EQ(block.words[1].value, 12.5);
    EXPECT_EQ(block.words[2].value, 0.5);
    EXPECT_EQ(block.words[3].value, 5.0);
    EXPECT_TRUE(block.words[3].has_point);
}

TEST(Parser, ReadsCommentsOfBothKinds) {
    const Block block = parsed("G0 (first \xC3\xA9) X1 (a (nested) one) ; rest (of it");
    ASSERT_EQ(block.comments.size(), 3u);
    EXPECT_EQ(block.comments[0].text, "first \xC3\xA9");
    EXPECT_EQ(block.comments[1].text, "a (nested) one");
    EXPECT_EQ(block.comments[2].text, " rest (of it");
    EXPECT_EQ(block.words.size(), 2u);
}

TEST(Parser, ReadsProgramAndFractionalBlockNumbers) {
    EXPECT_EQ(parsed("O1000 (SLOT)").words[0].value, 1000.0);
    EXPECT_EQ(parsed("N10.5 G0").words[0].value, 10.5);
}

TEST(Parser, ReadsBlockDeleteWithItsSwitch) {
    EXPECT_FALSE(parsed("G0").block_delete);
    EXPECT_EQ(parsed("/G0 X1").block_delete, 1);
    EXPECT_EQ(parsed(" /3 G0").block_delete, 3);
    EXPECT_EQ(parsed("N10 /9 G0").block_delete, 9);
    EXPECT_EQ(parsed("G0 /2 X1").words_before_slash, 1u);
    EXPECT_EQ(refused("G0 / X1", DialectId::linuxcnc), "4: '/' must be at the start of the block");
}

TEST(Parser, NumbersTheSwitchesForBlockDeleteAsTheControlDoes) {
    EXPECT_EQ(parsed("/G0 X1", DialectId::siemens).block_delete, 0);
    EXPECT_EQ(parsed("/0 G0 X1", DialectId::siemens).block_delete, 0);
    EXPECT_EQ(parsed("/1 G0 X1", DialectId::siemens).block_delete, 1);
    EXPECT_EQ(parsed("/4 L X+1", DialectId::heidenhain).block_delete,
              parsed("/5 L X+1", DialectId::heidenhain).block_delete);
}

TEST(Parser, RefusesABlockAfterASemicolonWhereItEndsTheBlock) {
    const std::string_view own = ": on this control ';' ends the block, so this is a block";
    for (const DialectId id : {DialectId::fanuc, DialectId::haas}) {
        EXPECT_THAT(refused("G1 X60.; G0 Z5.; G0 Y0.", id),
                    AllOf(HasSubstr("10: 'G0 Z5.; G0 Y0.'"), HasSubstr(own)));
        for (const char* text : {";G0 X1", "G1 X1 ;; G0 Z5.", "G1 X1;(UP) Z5.", "X1; /G0 Z5.",
                                 "X1;#1=5", "X1;GOTO 10", "X1;M98 P1;", "X1; ;X2"})
            EXPECT_THAT(refused(text, id), HasSubstr(own)) << text;
        for (const char* text :
             {"G1 X60.;", "G1 X60. ; ", "X1; T1 10MM END MILL", "; G0 to the start", "X1;;",
              "X1;()", "X1;(G0 Z5.)", "X1; (G0 Z5.);", "X1; first; G0 Z5.", "; T6 D=50 - face mill",
              "X1;%"})
            EXPECT_EQ(refused(text, id), "accepted") << text;
    }
    for (const DialectId id : {DialectId::linuxcnc, DialectId::grbl, DialectId::siemens,
                               DialectId::siemens_iso, DialectId::heidenhain})
        EXPECT_EQ(refused("; G0 Z5.", id), "accepted");
}

TEST(Parser, TakesATapeMarkAndIgnoresTheRestOfItsLine) {
    EXPECT_TRUE(parsed("%").tape_mark);
    EXPECT_TRUE(parsed("%1234_NAME").tape_mark);
    EXPECT_EQ(refused("G0 %"), "4: '%' must be at the start of the line");
}

TEST(Parser, NamesALetterWithoutNumber) {
    EXPECT_EQ(refused("G0 X Y1"), "4: 'X' must be followed by a number");
    EXPECT_EQ(refused("G0 X."), "4: 'X' must be followed by a number");
    EXPECT_EQ(refused("G0 X-"), "4: 'X' must be followed by a number");
}

TEST(Parser, NamesANumberWithoutLetter) {
    EXPECT_EQ(refused("G0 X1-2"), "6: '-2' has no letter before it");
    EXPECT_EQ(refused("12 G0"), "1: '12' has no letter before it");
    EXPECT_EQ(refused("G0 X1.2.3"), "8: '.3' has no letter before it");
    EXPECT_EQ(refused("G0 X1+"), "6: '+' has no letter before it");
}

TEST(Parser, NamesARepeatedWord) {
    EXPECT_EQ(refused("G0 X1 Y2 X3"),
              "10: 'X3': a block may have only one X word; this is the second");
    EXPECT_EQ(parsed("G0 G17 M3 M8").words.size(), 4u);
}

TEST(Parser, NamesAnOpenComment) {
    EXPECT_THAT(refused("G0 X1 (to the end"),
                AllOf(HasSubstr("7: "), HasSubstr("(to the end"), HasSubstr("not closed")));
    EXPECT_EQ(refused("G0 )"), "4: ')' is not allowed here");
}

TEST(Parser, NamesAnUnknownCharacter) {
    EXPECT_EQ(refused("G0 X1 !"), "7: '!' is not allowed here");
    EXPECT_EQ(refused("G0 \xC3\xA9"), "4: the byte 0xC3 is not allowed outside comments");
}

TEST(Parser, RefusesKeywordsOfOtherControls) {
    EXPECT_THAT(refused("o100 Sub"), HasSubstr("6: 'Sub'"));
    EXPECT_THAT(refused("GOTO 10", DialectId::linuxcnc), HasSubstr("1: 'GOTO'"));
    EXPECT_THAT(refused("IF [#1 EQ 2] GOTO 5", DialectId::linuxcnc), HasSubstr("1: 'IF'"));
    EXPECT_THAT(refused("@5 ^30"), HasSubstr("1: '@'"));
    EXPECT_THAT(refused("G1 X10 ,R2", DialectId::linuxcnc), HasSubstr("8: ','"));
}

TEST(Parser, ReadsFlowStatements) {
    const Block sub = parsed("N5 o<Part A> s u b (x)", DialectId::linuxcnc);
    EXPECT_EQ(sub.flow.kind, FlowKind::sub);
    EXPECT_EQ(sub.pool.names.at(sub.flow.label_name), "parta");
    const Block call = parsed("o100 call [1] [#2*3]", DialectId::linuxcnc);
    EXPECT_EQ(call.flow.kind, FlowKind::call);
    EXPECT_EQ(call.flow.arguments.size(), 2u);
    EXPECT_EQ(parsed("IF[#1 EQ #0]GOTO 10").flow.kind, FlowKind::if_go_to);
    EXPECT_EQ(parsed("IF [#1 LT 3] THEN #1=4").assignments.size(), 1u);
    EXPECT_EQ(parsed("WHILE [#1 LT 3] DO 2").pool.names.at(0), "2");
    EXPECT_EQ(parsed("END2").flow.kind, FlowKind::end_do);
}

TEST(Parser, RefusesMoreDigitsThanANumberHas) {
    EXPECT_THAT(refused("X" + std::string(100, '1')), HasSubstr("too many digits"));
}

} // namespace
} // namespace gcode
