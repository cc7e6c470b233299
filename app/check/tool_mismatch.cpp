#include "app/check/tool_mismatch.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <regex>

#include <fmt/format.h>

#include "app/check/feed_use.h"
#include "app/setup/setup_file.h"
#include "app/setup/tools/program_tools.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "core/sim/setup.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::ToolNumber;
using core::ToolShape;

constexpr double same_diameter = 0.05;   // mm
constexpr double same_fraction = 0.03;   // of the diameter; measured and nominal diameters
constexpr double larger_fraction = 0.10; // of the diameter; more than regrinding takes off

/// The shapes that a comment may mean by each other's names.
enum class Kind : uint8_t { square, round, pointed, other };

Kind kind_of(ToolShape shape) {
    switch (shape) {
    case ToolShape::flat:
    case ToolShape::bull:
        return Kind::square;
    case ToolShape::ball:
        return Kind::round;
    case ToolShape::drill:
    case ToolShape::chamfer:
        return Kind::pointed;
    default:
        return Kind::other;
    }
}

/// Whether a tool of one shape was described and another one is in the set-up. Drills, spot drills,
/// countersinks and chamfer mills may stand for each other.
bool differ(ToolShape in_comment, ToolShape in_setup) {
    const Kind comment = kind_of(in_comment), setup = kind_of(in_setup);
    if (comment == Kind::other || setup == Kind::other) return false;
    return comment != setup;
}

std::string described(const core::ToolDescription& tool, bool has_shape) {
    return fmt::format("{} of {:.4g} mm", has_shape ? core::description_of(tool.shape) : "a tool",
                       tool.diameter);
}

bool is_inch_apart(double a, double b) {
    constexpr double rounding = 0.02;
    return std::abs(std::max(a, b) / std::min(a, b) - core::mm_per_inch)
           < rounding * core::mm_per_inch;
}

/// A tool in a comment, if its description leaves little doubt.
std::optional<FoundTool> tool_of(const ToolComment& comment, size_t line) {
    ToolText text = comment.text;
    const bool is_sure = text.diameter && (text.sized || text.pointed || text.stated);
    if (!is_sure || text.prose) return std::nullopt;
    FoundTool found;
    found.has_shape = text.shape.has_value();
    found.source = fmt::format("the comment in line {}", line);
    if (!text.shape) text.shape = ToolShape::flat;
    const auto tool = tool_of_text(text);
    if (!tool) return std::nullopt;
    found.tool = *tool;
    return found;
}

/// The number in a T word of a line of code in capitals.
std::optional<int> tool_word(const std::string& code) {
    for (size_t at = code.find('T'); at != std::string::npos; at = code.find('T', at + 1)) {
        if (at > 0 && std::isalpha(static_cast<unsigned char>(code[at - 1]))) continue;
        int number = 0;
        const auto [rest, failure] =
            std::from_chars(code.data() + at + 1, code.data() + code.size(), number);
        if (failure == std::errc()) return number;
    }
    return std::nullopt;
}

/// Whether a comment names several tools, as in "T1 END MILL 12, T2 DRILL 8".
bool lists_tools(const std::string& comment) {
    static const std::regex tool(R"(\bT *[0-9])", std::regex::icase);
    return std::distance(std::sregex_iterator(comment.begin(), comment.end(), tool),
                         std::sregex_iterator())
           > 1;
}

/// The tools that comments describe together with their number, or next to the T word, by number.
std::multimap<ToolNumber, FoundTool> commented_tools(const gcode::Program& program,
                                                     gcode::LengthUnit unit) {
    std::multimap<ToolNumber, FoundTool> tools;
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string_view text = program.line(line);
        if (text.find_first_of("(;[") == std::string_view::npos) continue;
        const LineParts parts = parts_of_line(text);
        for (const std::string& words : parts.comments) {
            if (lists_tools(words)) continue;
            const ToolComment comment = read_tool_comment(words, unit);
            const auto number = comment.number ? comment.number : tool_word(parts.code);
            const bool names_it = comment.number || comment.text.shape;
            if (!number || *number < 0 || !names_it) continue;
            if (auto tool = tool_of(comment, line)) tools.emplace(ToolNumber{*number}, *tool);
        }
    }
    return tools;
}

/// A tool as the set-up or its library states it.
struct StatedTool {
    core::ToolDescription tool;
    bool has_shape = true, has_diameter = true;
    std::string place = "the set-up";
};

/// Of a tool that widens upwards, else its diameter.
double tip_diameter(const core::ToolDescription& tool) {
    if (tool.shape == ToolShape::taper) return tool.tip_diameter;
    if (tool.shape == ToolShape::profile && !tool.outline.empty())
        return 2.0 * tool.outline.front()[0];
    return tool.diameter;
}

std::optional<ToolMismatch> compared(const FoundTool& found, const StatedTool& listed) {
    const core::ToolDescription& stated = listed.tool;
    // A comment may give the diameter at the tip.
    const double more = std::abs(found.tool.diameter - tip_diameter(stated)) <= same_diameter
                            ? 0.0
                            : found.tool.diameter - stated.diameter;
    const bool other_size =
        listed.has_diameter
        && std::abs(more) > std::max(same_diameter, same_fraction * stated.diameter);
    const bool other_shape =
        found.has_shape && listed.has_shape && differ(found.tool.shape, stated.shape);
    if (!other_size && !other_shape) return std::nullopt;
    ToolMismatch mismatch;
    mismatch.tool = stated.number;
    mismatch.is_larger =
        listed.has_diameter && more > std::max(same_diameter, larger_fraction * stated.diameter);
    const std::string in_setup = listed.has_diameter
                                     ? described(stated, listed.has_shape)
                                     : std::string(core::description_of(stated.shape));
    mismatch.message =
        fmt::format("Tool {} is {} in {}, but {} according to {}.", core::value_of(stated.number),
                    in_setup, listed.place, described(found.tool, found.has_shape), found.source);
    if (listed.has_diameter && is_inch_apart(found.tool.diameter, stated.diameter))
        mismatch.message += " The sizes are 25.4 times apart: one of the units is probably wrong.";
    return mismatch;
}

/// The tools that a set-up states, in whole or in part, and those of its library.
std::vector<StatedTool> stated_tools(const SetupFile& file) {
    std::vector<StatedTool> tools;
    for (const auto& [number, tool] : file.setup.tools) tools.push_back({tool.description});
    for (const auto& [number, partial] : file.partial_tools) {
        StatedTool stated{partial.tool, partial.stated.contains("shape"),
                          partial.stated.contains("diameter")};
        stated.tool.number = number;
        if (stated.has_shape || stated.has_diameter) tools.push_back(std::move(stated));
    }
    for (const auto& [number, listed] : file.library) {
        if (file.setup.tools.contains(number)) continue;
        StatedTool stated{listed.tool, listed.has_shape, listed.has_diameter, "the tool library"};
        stated.tool.number = number;
        if (const auto partial = file.partial_tools.find(number);
            partial != file.partial_tools.end()) {
            stated.has_shape = stated.has_shape && !partial->second.stated.contains("shape");
            stated.has_diameter =
                stated.has_diameter && !partial->second.stated.contains("diameter");
        }
        if (stated.has_shape || stated.has_diameter) tools.push_back(std::move(stated));
    }
    return tools;
}

} // namespace

std::vector<ToolMismatch> tool_mismatches(const gcode::Program& program, const SetupFile& file) {
    std::vector<ToolMismatch> mismatches;
    const std::vector<StatedTool> all = stated_tools(file);
    if (all.empty()) return mismatches;
    const auto named =
        commented_tools(program, unit_of_program(program, unit_at_start(file.environment)));
    for (const StatedTool& stated : all) {
        std::optional<ToolMismatch> first;
        bool fits = false; // one of the comments
        const auto [begin, end] = named.equal_range(stated.tool.number);
        for (auto found = begin; found != end; ++found) {
            auto mismatch = compared(found->second, stated);
            fits = fits || !mismatch;
            if (!first) first = std::move(mismatch);
        }
        if (first && !fits) mismatches.push_back(*std::move(first));
    }
    return mismatches;
}

std::vector<core::Finding> findings_of(const std::vector<ToolMismatch>& mismatches,
                                       const FeedFacts& facts, const core::Setup& setup) {
    std::vector<core::Finding> findings;
    for (const ToolMismatch& mismatch : mismatches) {
        const auto use = facts.tools.find(mismatch.tool);
        if (use == facts.tools.end()) continue;
        core::Finding finding;
        finding.rule = core::rule_id("tool-mismatch");
        finding.severity = core::severity_of(setup, finding.rule);
        if (!mismatch.is_larger)
            finding.severity = std::min(finding.severity, core::Severity::warning);
        finding.block = use->second;
        finding.message = mismatch.message;
        finding.cure = "Load the tool that the program was made for, or correct the set-up.";
        if (finding.severity != core::Severity::off) findings.push_back(std::move(finding));
    }
    return findings;
}

} // namespace app
