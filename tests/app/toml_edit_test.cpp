#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/setup/toml_edit.h"
#include "app/setup/toml_file.h"

namespace app_test {
namespace {

using app::TomlPath;
using testing::HasSubstr;

const std::string sample = R"(# Vise 1, measured on Monday
mesh_size = 0.5 # fine enough
assumed = [
  "stock", # not measured
  "offsets",
]

[offsets]
G54 = { X = -350, Y = -200, Z = -420 }   # probed

# The left clamp.
[[fixture]]
name = "left"   # red
at = [10,
      20, 0]
  [[fixture.move]]
  line = 12
  remove = true

[[fixture]]
name = "right"

# The blank.
[stock]
box = [[0, 0, -30], [100, 100, 0]]
)";

std::string with(const std::string& text, const TomlPath& path, const std::string& value) {
    const auto edited = app::toml_with_value(text, path, value);
    EXPECT_TRUE(edited) << (edited ? "" : edited.error().message);
    return edited.value_or("");
}

std::string without(const std::string& text, const TomlPath& path) {
    const auto edited = app::toml_without(text, path);
    EXPECT_TRUE(edited) << (edited ? "" : edited.error().message);
    return edited.value_or("");
}

/// `text` with the first `what` replaced.
std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(TomlEdit, ReplacesOnlyTheValue) {
    EXPECT_EQ(with(sample, "mesh_size", "0.25"), replaced(sample, "= 0.5", "= 0.25"));
    EXPECT_EQ(with(sample, {"offsets", "G54", "Y"}, "-201.5"), replaced(sample, "-200", "-201.5"));
    EXPECT_EQ(with(sample, {"fixture", size_t{0}, "at"}, "[1, 2, 3]"),
              replaced(sample, "[10,\n      20, 0]", "[1,\n      2, 3]"));
    EXPECT_EQ(with(sample, {"stock", "box", size_t{1}, size_t{2}}, "5"),
              replaced(sample, "100, 100, 0]", "100, 100, 5]"));
    EXPECT_EQ(with(sample, {"fixture", size_t{0}, "move", size_t{0}, "line"}, "7"),
              replaced(sample, "line = 12", "line = 7"));
}

TEST(TomlEdit, KeepsTheFormOfAListOfWhichNumbersChange) {
    const std::string text = "[stock]\nbox = [[0, 0.50, 0], # front left\n       [100, 1_00,  "
                             "8.0]] # sawn\n";
    EXPECT_EQ(with(text, {"stock", "box"}, "[[0, 0.5, -2], [100, 100, 8]]"),
              replaced(text, "0.50, 0]", "0.50, -2]"));
    EXPECT_EQ(with(text, {"stock", "box"}, "[[0, 0.5, 0], [100, 100, 8]]"), text);
    EXPECT_EQ(with(text, {"stock", "box", size_t{1}}, "[9, 100, 8]"),
              replaced(text, "[100, 1", "[9, 1"));
    EXPECT_EQ(with(text, {"stock", "box"}, "[[0, 0, 0], [1, 2, 3], [4, 5, 6]]"),
              "[stock]\nbox = [[0, 0, 0], [1, 2, 3], [4, 5, 6]] # sawn\n");
    EXPECT_EQ(with(text, {"stock", "box"}, "\"none\""), "[stock]\nbox = \"none\" # sawn\n");
    EXPECT_EQ(with("a = { x = 1.0, 'y'=2 } # b\n", "a", "{ y = 3, x = 1 }"),
              "a = { x = 1.0, 'y'=3 } # b\n");
    EXPECT_EQ(with("a = { x = 1 }\n", "a", "{ y = 1 }"), "a = { y = 1 }\n");
    EXPECT_EQ(with("a = 1.50\n", "a", "1.5"), "a = 1.50\n");
    EXPECT_EQ(with("a = 'G54'\n", "a", "\"G54\""), "a = 'G54'\n");
    EXPECT_EQ(with("a = true\n", "a", "1"), "a = 1\n");
    EXPECT_EQ(with("a = 'é' # ö\n", "a", "'ü'"), "a = 'ü' # ö\n");
}

TEST(TomlEdit, AddsAValueAtTheEndOfItsTable) {
    EXPECT_EQ(with(sample, {"fixture", size_t{0}, "expendable"}, "true"),
              replaced(sample, "20, 0]\n", "20, 0]\nexpendable = true\n"));
    EXPECT_EQ(with(sample, {"fixture", size_t{1}, "at"}, "[0, 0, 1]"),
              replaced(sample, "\"right\"\n", "\"right\"\nat = [0, 0, 1]\n"));
    EXPECT_EQ(with(sample, {"fixture", size_t{0}, "move", size_t{0}, "code"}, "\"M60\""),
              replaced(sample, "  remove = true\n", "  remove = true\n  code = \"M60\"\n"));
    EXPECT_EQ(with(sample, "allowance", "2"), replaced(sample, "]\n", "]\nallowance = 2\n"));
    EXPECT_EQ(with(sample, {"offsets", "G54", "C"}, "1"),
              replaced(sample, "-420 }", "-420, C = 1 }"));
    EXPECT_EQ(with(sample, {"offsets", "G54.1 P1"}, "{ X = 1 }"),
              replaced(sample, "# probed\n", "# probed\n\"G54.1 P1\" = { X = 1 }\n"));
}

TEST(TomlEdit, AddsTheTableThatIsMissing) {
    EXPECT_EQ(with("", {"stock", "margin"}, "2"), "[stock]\nmargin = 2\n");
    EXPECT_EQ(with(sample, {"program", "dialect"}, "\"haas\""),
              sample + "\n[program]\ndialect = \"haas\"\n");
    EXPECT_EQ(with("a = 1", {"program", "dialect"}, "\"haas\""),
              "a = 1\n\n[program]\ndialect = \"haas\"\n");
    EXPECT_EQ(with("[[machine.axis]]\nname = \"X\"\n", {"machine", "file"}, "\"m.toml\""),
              "[[machine.axis]]\nname = \"X\"\n\n[machine]\nfile = \"m.toml\"\n");
}

TEST(TomlEdit, PutsAFirstKeyBeforeTheTablesAndTheirComments) {
    EXPECT_EQ(with("# About the job\n\n# The blank.\n[stock]\n", "allowance", "2"),
              "# About the job\n\nallowance = 2\n\n# The blank.\n[stock]\n");
    EXPECT_EQ(with("# About the job\n[stock]\n", "allowance", "2"),
              "# About the job\nallowance = 2\n\n[stock]\n");
}

TEST(TomlEdit, RemovesAValueOrATableWithItsComments) {
    EXPECT_EQ(without(sample, "mesh_size"),
              replaced(sample, "mesh_size = 0.5 # fine enough\n", ""));
    EXPECT_EQ(without(sample, {"fixture", size_t{0}, "at"}),
              replaced(sample, "at = [10,\n      20, 0]\n", ""));
    EXPECT_EQ(without(sample, {"offsets", "G54", "X"}), replaced(sample, " X = -350,", ""));
    EXPECT_EQ(without(sample, {"offsets", "G54", "Z"}), replaced(sample, ", Z = -420", ""));
    EXPECT_EQ(without(sample, {"fixture", size_t{1}}),
              replaced(sample, "[[fixture]]\nname = \"right\"\n\n", ""));
    const std::string left = without(sample, {"fixture", size_t{0}});
    EXPECT_EQ(left.find("left"), std::string::npos) << left;
    EXPECT_EQ(left.find("line = 12"), std::string::npos) << left;
    EXPECT_THAT(left, HasSubstr("# probed\n\n[[fixture]]\nname = \"right\""));
    EXPECT_EQ(
        without(sample, "stock"),
        replaced(sample, "\n# The blank.\n[stock]\nbox = [[0, 0, -30], [100, 100, 0]]\n", ""));
    EXPECT_EQ(without(sample, "part"), sample);
}

TEST(TomlEdit, AddsTables) {
    const auto more = app::toml_with_table(sample, "fixture", "name = \"third\"\n");
    ASSERT_TRUE(more);
    EXPECT_EQ(*more,
              replaced(sample, "\"right\"\n", "\"right\"\n\n[[fixture]]\nname = \"third\"\n"));
    const auto first = app::toml_with_table("", "tool", "number = 1\nshape = \"flat\"\n");
    EXPECT_EQ(first.value_or(""), "[[tool]]\nnumber = 1\nshape = \"flat\"\n");
    const auto inlined = app::toml_with_table("fixture = [{ name = \"a\" }]", "fixture",
                                              "name = \"b\"\nat = [1, 2, 3]\n");
    ASSERT_TRUE(inlined);
    EXPECT_THAT(*inlined, HasSubstr("[{ name = \"a\" }, {"));
}

TEST(TomlEdit, CopiesATableWithItsNestedTables) {
    const auto body = app::toml_body_of(sample, "fixture", 0);
    ASSERT_TRUE(body);
    EXPECT_EQ(*body,
              "name = \"left\"   # red\nat = [10,\n      20, 0]\n  [[fixture.move]]\n  line = 12\n"
              "  remove = true\n");
    const auto copied = app::toml_with_table(sample, "fixture", *body);
    ASSERT_TRUE(copied) << copied.error().message;
    EXPECT_EQ(
        with(*copied, {"fixture", size_t{2}, "move", size_t{0}, "line"}, "13").find("line = 13"),
        copied->rfind("line = 12"));
}

TEST(TomlEdit, KeepsLineEndsOfWindowsAndWideCharacters) {
    const std::string text = "# é\r\n\"größe\" = \"ä\" # ö\r\n[stock]\r\nmargin = 2\r\n";
    EXPECT_EQ(with(text, "größe", "\"ü\""), replaced(text, "\"ä\"", "\"ü\""));
    EXPECT_EQ(with(text, {"stock", "tolerance"}, "1"), text + "tolerance = 1\r\n");
    EXPECT_EQ(without(text, {"stock", "margin"}), replaced(text, "margin = 2\r\n", ""));
    EXPECT_EQ(with("\xEF\xBB\xBFmesh_size = 1\n", "mesh_size", "2"), "\xEF\xBB\xBFmesh_size = 2\n");
}

TEST(TomlEdit, EditsDottedKeysAndInlineTables) {
    const std::string text =
        "offsets.G54.X = 5 # x\noffsets.G54.Y = 6\nstock = { box = [[0, 0, 0], [1, 1, 1]] }\n";
    EXPECT_EQ(with(text, {"offsets", "G54", "Z"}, "7"),
              replaced(text, "Y = 6\n", "Y = 6\noffsets.G54.Z = 7\n"));
    EXPECT_EQ(with(text, {"stock", "tolerance"}, "1"),
              replaced(text, "]] }", "]], tolerance = 1 }"));
    EXPECT_EQ(without(text, {"offsets", "G54", "X"}),
              replaced(text, "offsets.G54.X = 5 # x\n", ""));
    EXPECT_EQ(without(text, "offsets"), "stock = { box = [[0, 0, 0], [1, 1, 1]] }\n");
    EXPECT_EQ(with("a = {}\n", {"a", "b"}, "1"), "a = { b = 1 }\n");
}

TEST(TomlEdit, RefusesWhatItCannotDo) {
    const auto wrong = app::toml_with_value(sample, "mesh_size", "0.5 0.5");
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code, core::ErrorCode::invalid_value);
    const auto table = app::toml_with_value(sample, "stock", "1");
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().code, core::ErrorCode::unsupported);
    EXPECT_EQ(table.error().where.line, 24U);
    const auto broken = app::toml_with_value("a = = 1\n", "b", "1");
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().code, core::ErrorCode::syntax);
    EXPECT_FALSE(app::toml_with_value(sample, {"fixture", size_t{9}, "name"}, "\"x\""));
    EXPECT_FALSE(app::toml_with_value(sample, {"mesh_size", "x"}, "1"));
}

TEST(TomlEdit, FindsTheSpanOfAValue) {
    const core::SourceSpan span = app::toml_span(sample, {"offsets", "G54", "Y"});
    EXPECT_EQ(span, (core::SourceSpan{9, 23, 4}));
    EXPECT_EQ(app::toml_span(sample, "part"), core::SourceSpan{});
}

/// A random TOML file with comments, and the paths of its values and tables.
class RandomFile {
public:
    explicit RandomFile(uint32_t seed) : random_(seed) { write(); }

    std::string text;
    std::vector<TomlPath> values, blocks;

    size_t pick(size_t count) { return random_() % count; }
    std::string value() {
        constexpr const char* values[] = {"1",
                                          "-2.5",
                                          "\"a # b\"",
                                          "true",
                                          "[1, 2]",
                                          "[1,\n 2, # two\n 3]",
                                          "{ x = 1, y = [2, 3] }",
                                          "'''\n[no]\n# header\n'''",
                                          "\"\\\"]\"",
                                          "[]"};
        return values[pick(std::size(values))];
    }

private:
    void noise() {
        constexpr const char* between[] = {
            "", "", "", "\n", "# note\n", "\n# [not.a] = table\n", "  \t\n"};
        text += between[pick(std::size(between))];
    }
    void fill(const TomlPath& table) {
        const std::string indent = pick(4) == 0 ? "  " : "";
        for (size_t i = 0, count = pick(4); i < count; ++i) {
            const std::string key = "k" + std::to_string(i);
            noise();
            if (pick(5) == 0) {
                text += indent + key + ".\"in ner\"= " + value() + "\n";
                values.push_back(table / key / "in ner");
            } else {
                text += indent + key + " = " + value() + (pick(2) == 0 ? "  # why\n" : "\n");
                values.push_back(table / key);
            }
        }
    }
    void write() {
        fill({});
        for (size_t t = 0, tables = pick(4); t < tables; ++t) {
            const std::string name = "t" + std::to_string(t);
            noise();
            if (pick(2) == 0) {
                text += "[" + name + "] # table\n";
                fill(name.c_str());
                blocks.emplace_back(name.c_str());
                continue;
            }
            for (size_t i = 0, count = 1 + pick(3); i < count; ++i) {
                noise();
                text += "[[" + name + "]]\n";
                const TomlPath element{name, i};
                fill(element);
                blocks.push_back(element);
                if (pick(3) != 0) continue;
                text += " [[" + name + ".sub]]\n";
                fill(element / "sub" / size_t{0});
                blocks.push_back(element / "sub" / size_t{0});
            }
        }
        if (pick(4) == 0 && text.ends_with("\n")) text.pop_back();
    }

    std::mt19937 random_;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream all(text);
    for (std::string line; std::getline(all, line);) lines.push_back(line);
    return lines;
}

/// How many lines of `a` are not in `b`, in order.
size_t lines_lost(const std::string& a, const std::string& b) {
    const std::vector<std::string> from = lines_of(a), to = lines_of(b);
    std::vector<size_t> row(to.size() + 1, 0);
    for (const std::string& line : from) {
        size_t diagonal = 0;
        for (size_t j = 0; j < to.size(); ++j) {
            const size_t above = row[j + 1];
            row[j + 1] = line == to[j] ? diagonal + 1 : std::max(above, row[j]);
            diagonal = above;
        }
    }
    return from.size() - row.back();
}

size_t lines_in(const std::string& text, const TomlPath& path) {
    const auto root = app::parsed_toml(text);
    const auto node = [&] {
        toml::node_view<const toml::node> view(*root);
        for (const TomlPath::Step& step : path.steps())
            view = std::holds_alternative<std::string>(step) ? view[std::get<std::string>(step)]
                                                             : view[std::get<size_t>(step)];
        return view.node();
    }();
    return node ? node->source().end.line - node->source().begin.line + 1 : 0;
}

TEST(TomlEdit, EveryEditOfARandomFileChangesOnlyItsLines) {
    size_t replaced_count = 0, removed = 0, added = 0;
    for (uint32_t seed = 1; seed <= 3000; ++seed) {
        RandomFile file(seed);
        ASSERT_TRUE(app::parsed_toml(file.text)) << file.text;
        if (!file.values.empty()) {
            const TomlPath& path = file.values[file.pick(file.values.size())];
            const std::string edited = with(file.text, path, file.value());
            EXPECT_LE(lines_lost(file.text, edited), lines_in(file.text, path))
                << file.text << text_of(path);
            const std::string left = without(file.text, path);
            EXPECT_LE(lines_lost(file.text, left), lines_in(file.text, path) + 1)
                << file.text << text_of(path);
            EXPECT_EQ(lines_lost(left, file.text), 0U) << file.text << text_of(path) << "\n"
                                                       << left;
            ++replaced_count;
        }
        TomlPath table = file.blocks.empty() || file.pick(4) == 0
                             ? TomlPath()
                             : file.blocks[file.pick(file.blocks.size())];
        const std::string more = with(file.text, table / "new key", file.value());
        EXPECT_EQ(lines_lost(file.text, more), 0U) << file.text << text_of(table) << "\n" << more;
        ++added;
        if (!table.empty()) {
            const std::string left = without(file.text, table);
            EXPECT_EQ(lines_lost(left, file.text), 0U) << file.text << text_of(table) << "\n"
                                                       << left;
            ++removed;
        }
        const auto grown = app::toml_with_table(file.text, "t9", "a = 1\n");
        ASSERT_TRUE(grown);
        EXPECT_EQ(lines_lost(file.text, *grown), 0U);
    }
    EXPECT_GT(replaced_count, 2000U);
    EXPECT_GT(added, 2000U);
    EXPECT_GT(removed, 1000U);
}

/// A random nested value in many spellings, with comments and line breaks, and another value of the
/// same form: its plain text, and what the first text becomes with it.
class RandomForm {
public:
    explicit RandomForm(uint32_t seed) : random_(seed) { list(0); }

    std::string text, plain, expected;
    size_t changed = 0, kept = 0;

private:
    size_t pick(size_t count) { return random_() % count; }
    void both(const std::string& gap) {
        text += gap;
        expected += gap;
    }
    void gap() {
        const std::string note = std::to_string(pick(100));
        const std::string gaps[] = {
            "", " ", "", "\n  ", "\r\n", "  \t ", "# [" + note + ", é\n", " # \"" + note + "\n\n"};
        both(gaps[pick(std::size(gaps))]);
    }
    void scalar() {
        constexpr const char* spellings[][2] = {{"1.50", "1.5"},
                                                {"+2", "2"},
                                                {"0x10", "16"},
                                                {"1_000", "1000.0"},
                                                {"1e3", "1000"},
                                                {"'a # ]'", "\"a # ]\""},
                                                {"-0.5", "-0.50"},
                                                {"true", "true"},
                                                {"\"\\u00e9\"", "'é'"},
                                                {"\"\"\"x\n# y\"\"\"", "\"x\\n# y\""},
                                                {"1979-05-27", "1979-05-27"}};
        constexpr const char* others[] = {"7", "-12.25", "\"G54, # ]\"", "false", "1e-3"};
        const auto& [old, same] = spellings[pick(std::size(spellings))];
        text += old;
        if (pick(2) == 0) {
            plain += same;
            expected += old;
            ++kept;
        } else {
            const std::string now = others[pick(std::size(others))];
            plain += now;
            expected += now;
            ++changed;
        }
    }
    void table() {
        both("{ a = ");
        plain += "{ a = ";
        scalar();
        both(" ,b= ");
        plain += ", b = ";
        scalar();
        both("}");
        plain += "}";
    }
    void list(int depth) {
        both("[");
        plain += "[";
        for (size_t i = 0, count = pick(4); i < count; ++i) {
            if (i > 0) both(",");
            if (i > 0) plain += ", ";
            gap();
            if (depth < 3 && pick(3) == 0)
                list(depth + 1);
            else if (pick(6) == 0)
                table();
            else
                scalar();
            gap();
            if (i + 1 == count && pick(4) == 0) both(",");
        }
        gap();
        both("]");
        plain += "]";
    }

    std::mt19937 random_;
};

TEST(TomlEdit, AValueOfTheSameFormChangesOnlyTheScalarsThatDiffer) {
    size_t changed = 0, kept = 0;
    for (uint32_t seed = 1; seed <= 5000; ++seed) {
        const RandomForm form(seed);
        const std::string before = "# é\na = 1\n[t]\nv = ", after = " # why\nw = 2\n";
        EXPECT_EQ(with(before + form.text + after, {"t", "v"}, form.plain),
                  before + form.expected + after)
            << seed << ": " << form.plain;
        changed += form.changed;
        kept += form.kept;
    }
    EXPECT_GT(changed, 5000U);
    EXPECT_GT(kept, 5000U);
}

} // namespace
} // namespace app_test
