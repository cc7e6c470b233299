#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

Recognition recognised(std::string_view text) {
    const auto program = program_from_text(text);
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

} // namespace
} // namespace gcode
