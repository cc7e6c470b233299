#include "app/check/unit_doubt.h"

#include <algorithm>
#include <cmath>
#include <regex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/feed_use.h"
#include "app/check/prepared_check.h"
#include "app/setup/tools/program_tools.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using gcode::LengthUnit;

constexpr double doubt = 2.0; // a part and its stock differ by less than this factor

/// Whether a ratio of sizes is close to 25.4.
bool is_units_apart(double ratio) {
    return ratio > core::mm_per_inch / doubt && ratio < core::mm_per_inch * doubt;
}

LengthUnit other_than(LengthUnit unit) {
    return unit == LengthUnit::mm ? LengthUnit::inch : LengthUnit::mm;
}

const char* name_of(LengthUnit unit) { return unit == LengthUnit::mm ? "mm" : "inches"; }

/// The sizes in comments, by how they are written.
struct CommentSizes {
    std::optional<size_t> units[2];     // line of the first comment that states the unit
    std::optional<size_t> tools[2];     // of the first tool with its unit
    std::optional<size_t> distances[2]; // of the first other size with its unit
    std::vector<double> bare;           // diameters of tools without a unit
    size_t bare_line = 0;               // of the first of them
};

size_t index_of(LengthUnit unit) { return unit == LengthUnit::inch ? 1 : 0; }

void keep_first(std::optional<size_t>& line, size_t found) {
    if (!line) line = found;
}

/// The unit that a comment states for the whole program: "UNITS: INCH", "(mm)", "METRIC".
std::optional<LengthUnit> stated_unit(const std::string& capitals) {
    static const std::regex alone(
        R"(^[ *=-]*(?:UNITS?|DIMENSIONS?|MEASUREMENTS?|OUTPUT|MODE|PROGRAM|ALL|ARE|IS|IN|PROGRAMMED|)"
        R"(SET|TO|[ :=.*-])*\b(INCH|INCHES|IMPERIAL|MM|MILLIMETERS?|MILLIMETRES?|METRIC)\b)"
        R"((?:UNITS?|DIMENSIONS?|MODE|OUTPUT|PROGRAM|[ .*=-])*$)");
    std::smatch match;
    if (capitals.size() > 80 || !std::regex_match(capitals, match, alone)) return std::nullopt;
    return match[1].str()[0] == 'I' ? LengthUnit::inch : LengthUnit::mm;
}

/// The unit written after a number, as in 12MM or 4".
std::optional<LengthUnit> written_unit(const TextNumber& number) {
    if (number.suffix == "MM") return LengthUnit::mm;
    for (const char* inch : {"IN", "INCH", "INCHES", "\"", "ZOLL"})
        if (number.suffix == inch) return LengthUnit::inch;
    return std::nullopt;
}

/// A tool that a comment describes, and the unit in which it gives the diameter.
struct CommentedTool {
    double diameter = 0.0; // in mm, or as written if there is no unit
    std::optional<LengthUnit> unit;
};

std::optional<CommentedTool> tool_in(const std::string& comment) {
    const ToolComment metric = read_tool_comment(comment, LengthUnit::mm);
    if (!metric.text.diameter || metric.text.prose) return std::nullopt;
    if (!metric.whole && !metric.text.stated && !metric.text.shape) return std::nullopt;
    const ToolComment imperial = read_tool_comment(comment, LengthUnit::inch);
    const double diameter = *metric.text.diameter;
    if (!(diameter > 0.0) || !imperial.text.diameter) return std::nullopt;
    if (*imperial.text.diameter > 1.01 * diameter) return CommentedTool{diameter, {}};
    for (const TextNumber& number : numbers_of(plain_capitals(comment)))
        if (written_unit(number) == LengthUnit::mm) return CommentedTool{diameter, LengthUnit::mm};
    return CommentedTool{diameter, LengthUnit::inch};
}

/// Whether a text has quotation marks, which are not inch signs.
bool quotes(const std::string& text) {
    for (size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 1))
        if (at == 0 || (text[at - 1] != '.' && (text[at - 1] < '0' || text[at - 1] > '9')))
            return true;
    return false;
}

void read_comment(const std::string& comment, size_t line, CommentSizes& sizes) {
    constexpr size_t longest = 200;
    if (comment.size() > longest || quotes(comment)) return;
    const std::string capitals = plain_capitals(comment);
    if (const auto unit = stated_unit(capitals)) keep_first(sizes.units[index_of(*unit)], line);
    if (names_no_cutter(capitals)) return;
    if (const auto tool = tool_in(comment)) {
        if (tool->unit) {
            keep_first(sizes.tools[index_of(*tool->unit)], line);
        } else {
            if (sizes.bare.empty()) sizes.bare_line = line;
            sizes.bare.push_back(tool->diameter);
        }
        return;
    }
    if (is_prose(capitals)) return;
    for (const TextNumber& number : numbers_of(capitals))
        if (const auto unit = written_unit(number))
            keep_first(sizes.distances[index_of(*unit)], line);
}

/// A multiple of 1/64 that is not a round number of millimetres.
bool is_only_an_inch_size(double size) {
    const auto is_multiple = [&](double of, double within) {
        return std::abs(size / of - core::round(size / of)) * of < within;
    };
    constexpr double rounding = 6e-4; // .0937 for 3/32
    return is_multiple(1.0 / 64.0, rounding) && !is_multiple(0.05, 1e-6);
}

void add_clue_of_diameters(const CommentSizes& sizes, std::vector<UnitClue>& clues) {
    if (sizes.bare.empty()) return;
    const auto ends = std::minmax_element(sizes.bare.begin(), sizes.bare.end());
    const double least = *ends.first, most = *ends.second;
    constexpr double most_inches = 8.0; // face mills in inches
    constexpr double small_inches = 1.0, usual_inches = 2.0;
    const bool fractions = std::any_of(sizes.bare.begin(), sizes.bare.end(), is_only_an_inch_size);
    const auto reason = [&](const char* which) {
        return fmt::format("comments give tools of {:g}{} without a unit, {} (line {})", least,
                           least < most ? fmt::format(" to {:g}", most) : "", which,
                           sizes.bare_line);
    };
    if (most > most_inches)
        clues.push_back({LengthUnit::mm, 2, reason("too large for inches")});
    else if (fractions && most <= usual_inches)
        clues.push_back({LengthUnit::inch, 2, reason("sizes of tools in inches")});
    else if (most <= small_inches)
        clues.push_back({LengthUnit::inch, 1, reason("small for millimetres")});
}

} // namespace

std::vector<UnitClue> unit_clues_of_comments(const gcode::Program& program) {
    CommentSizes sizes;
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string_view text = program.line(line);
        if (text.find_first_of("(;[") == std::string_view::npos) continue;
        for (const std::string& comment : parts_of_line(text).comments)
            read_comment(comment, line, sizes);
    }
    std::vector<UnitClue> clues;
    for (const LengthUnit unit : {LengthUnit::mm, LengthUnit::inch}) {
        const auto add = [&](const std::optional<size_t>* lines, int weight, const char* what) {
            // Comments that use both units say nothing.
            const std::optional<size_t>& line = lines[index_of(unit)];
            if (line && !lines[index_of(other_than(unit))])
                clues.push_back(
                    {unit, weight, fmt::format("{} {} (line {})", what, name_of(unit), *line)});
        };
        add(sizes.units, 2, "a comment says that the unit is");
        add(sizes.tools, 1, "comments give tools in");
        add(sizes.distances, 1, "comments give sizes in");
    }
    add_clue_of_diameters(sizes, clues);
    return clues;
}

namespace {

constexpr double least_per_turn = 0.008;  // mm; less only rubs, unless the tool is tiny
constexpr double most_per_turn = 2.5;     // mm
constexpr double slowest_sideways = 40.0; // mm/min, of the fastest feed across the axis
constexpr double fastest_feed = 30e3;     // mm/min; of cuts on fast machines
constexpr double usual_travel = 2500.0;   // mm, of large machining centres

/// The clues if the program was run in mm: the numbers are small for millimetres.
void add_clues_of_small_numbers(const FeedFacts& facts, std::vector<UnitClue>& clues) {
    const double per_turn = facts.revolutions > 0.0 ? facts.cut_way / facts.revolutions : 0.0;
    if (per_turn > 0.0 && per_turn < least_per_turn)
        clues.push_back({LengthUnit::inch, 1,
                         fmt::format("the tools feed only {:.4f} mm per revolution", per_turn)});
    if (facts.sideways > 0.0 && facts.sideways <= slowest_sideways)
        clues.push_back(
            {LengthUnit::inch, 1,
             fmt::format("the fastest cut sideways is at {:g} mm/min", facts.sideways)});
}

/// The clues if the program was run in inches: the numbers are large for inches.
void add_clues_of_large_numbers(const FeedFacts& facts, std::vector<UnitClue>& clues) {
    const double per_turn = facts.revolutions > 0.0 ? facts.cut_way / facts.revolutions : 0.0;
    const core::Vec3 size = facts.box.size();
    const double longest = std::max(size.x, size.y);
    if (per_turn > most_per_turn)
        clues.push_back(
            {LengthUnit::mm, 1, fmt::format("the tools feed {:.1f} mm per revolution", per_turn)});
    if (facts.fastest && facts.fastest->value > fastest_feed)
        clues.push_back({LengthUnit::mm, 1,
                         fmt::format("the fastest feed is {:.0f} mm/min", facts.fastest->value)});
    if (longest > usual_travel)
        clues.push_back(
            {LengthUnit::mm, 1, fmt::format("the feeds span {:.1f} m", longest / 1000.0)});
}

} // namespace

std::vector<UnitClue> unit_clues_of_feeds(const FeedFacts& facts, LengthUnit unit,
                                          const std::optional<core::Aabb>& stock) {
    std::vector<UnitClue> clues;
    if (facts.box.empty()) return clues;
    if (unit == LengthUnit::mm)
        add_clues_of_small_numbers(facts, clues);
    else
        add_clues_of_large_numbers(facts, clues);
    if (!stock) return clues;
    const core::Vec3 path = facts.box.size(), size = stock->size();
    const double longest = std::max(path.x, path.y), widest = std::max(size.x, size.y);
    const bool fits_other = unit == LengthUnit::mm ? is_units_apart(widest / longest)
                                                   : is_units_apart(longest / widest);
    if (longest > 0.0 && widest > 0.0 && fits_other)
        clues.push_back(
            {other_than(unit), 2,
             fmt::format("the feeds span {:.1f} mm and the stock {:.1f} mm", longest, widest)});
    return clues;
}

namespace {

/// The box of the feeds and that of the stock, both from program zero.
struct FeedPlace {
    core::Aabb feeds, stock;
};

/// Where the feeds are; empty if there are none, or in several work offsets or turned.
std::optional<FeedPlace> place_of(const OffsetUses& uses, const core::Aabb& stock) {
    std::optional<FeedPlace> place;
    for (const auto& [index, use] : uses) {
        if (use.total <= 0.0) continue;
        if (place || !use.is_parallel) return std::nullopt;
        place = FeedPlace{{use.feeds.min - use.datum, use.feeds.max - use.datum},
                          {stock.min - use.datum, stock.max - use.datum}};
    }
    return place;
}

/// Whether feeds that are scaled about program zero are at the stock and reach into it, but not far
/// through it.
bool fits_scaled(const FeedPlace& place, double scale, double diameter) {
    constexpr double cut_through = 5.0; // mm
    const core::Aabb feeds{place.feeds.min * scale, place.feeds.max * scale};
    const core::Aabb room = place.stock.grown(diameter);
    return feeds.min.x >= room.min.x && feeds.max.x <= room.max.x && feeds.min.y >= room.min.y
           && feeds.max.y <= room.max.y && feeds.min.z < place.stock.max.z
           && feeds.min.z > place.stock.min.z - cut_through;
}

double wider(const core::Aabb& box) { return std::max(box.size().x, box.size().y); }

} // namespace

std::optional<UnitClue> unit_clue_of_place(const OffsetUses& uses, LengthUnit unit,
                                           const core::Aabb& stock, double diameter) {
    const auto place = place_of(uses, stock);
    if (!place) return std::nullopt;
    const double longest = wider(place->feeds), widest = wider(stock);
    if (unit == LengthUnit::mm) {
        constexpr double part = 0.25; // of the stock, that the feeds would span in inches
        if (!(longest > 0.0) || longest >= diameter || longest * core::mm_per_inch < part * widest
            || !fits_scaled(*place, core::mm_per_inch, diameter))
            return std::nullopt;
        return UnitClue{LengthUnit::inch, 1,
                        fmt::format("the feeds span {:.1f} mm, less than the diameter of the tool, "
                                    "and would fit the stock in inches",
                                    longest)};
    }
    constexpr double part = 0.1, more = 1.5; // of the stock
    const bool misses = std::all_of(uses.begin(), uses.end(), [](const auto& entry) {
        return entry.second.gap > core::air_gap;
    });
    if (!misses || longest < more * widest || longest < part * core::mm_per_inch * widest
        || !fits_scaled(*place, 1.0 / core::mm_per_inch, diameter))
        return std::nullopt;
    return UnitClue{LengthUnit::mm, 3,
                    fmt::format("the feeds span {:.1f} mm and miss the stock of {:.1f} mm, but "
                                "would fit it in mm",
                                longest, widest)};
}

std::optional<core::Finding> units_doubtful(const gcode::Program& program, const FeedFacts& facts,
                                            const core::Setup& setup,
                                            const std::optional<core::Aabb>& stock, bool unit_said,
                                            const UnitCodes& codes, const OffsetUses& uses) {
    if (!facts.first || facts.in_mm == facts.in_inches) return std::nullopt;
    const LengthUnit unit = facts.in_inches ? LengthUnit::inch : LengthUnit::mm;
    std::vector<UnitClue> clues = unit_clues_of_comments(program);
    for (UnitClue& clue : unit_clues_of_feeds(facts, unit, stock)) clues.push_back(std::move(clue));
    // Small cuts are usual, so their place only counts beside what speaks against a stated unit.
    if (stock && (unit_said || unit == LengthUnit::inch)) {
        double diameter = 0.0;
        for (const auto& [number, block] : facts.tools)
            if (const auto tool = setup.tools.find(number); tool != setup.tools.end())
                diameter = std::max(diameter, tool->second.description.diameter);
        if (auto clue = unit_clue_of_place(uses, unit, *stock, diameter))
            clues.push_back(*std::move(clue));
    }
    int excess = 0;
    std::vector<std::string> reasons;
    for (const UnitClue& clue : clues) {
        excess += clue.unit == unit ? -clue.weight : clue.weight;
        if (clue.unit != unit) reasons.push_back(clue.reason);
    }
    const int needed = unit_said ? 3 : 2;
    const bool is_weak = !unit_said && excess == 1;
    if (excess < needed && !is_weak) return std::nullopt;
    core::Finding finding;
    finding.rule = core::rule_id("units-doubtful");
    finding.severity = core::severity_of(setup, finding.rule);
    if (is_weak) finding.severity = std::min(finding.severity, core::Severity::warning);
    if (finding.severity == core::Severity::off) return std::nullopt;
    finding.block = facts.first;
    finding.message =
        fmt::format("The program was run in {}{}, but it was probably made in {}: {}.",
                    name_of(unit), unit_said ? "" : ", because it states no unit",
                    name_of(other_than(unit)), fmt::join(reasons, "; "));
    finding.cure = unit_said ? fmt::format("Check {} and the numbers of the program.",
                                           unit == LengthUnit::mm ? codes.mm : codes.inch)
                             : fmt::format("State the unit in the program: {} for inches, {} for "
                                           "mm. If the control is always in this unit, state it "
                                           "with --units or `units_at_start` under [program] in "
                                           "the set-up.",
                                           codes.inch, codes.mm);
    return finding;
}

std::optional<core::Finding> unit_mismatch(const FeedFacts& facts, const core::Setup& setup,
                                           const core::Aabb& stock, bool unit_said) {
    if (!facts.first) return std::nullopt;
    const core::Vec3 path = facts.box.size(), size = stock.size();
    const double longest = std::max(path.x, path.y), widest = std::max(size.x, size.y);
    if (!(longest > 0.0 && widest > 0.0)) return std::nullopt;
    const bool large = is_units_apart(longest / widest);
    const bool small = !unit_said && is_units_apart(widest / longest);
    if (!large && !small) return std::nullopt;
    core::Finding finding;
    finding.rule = core::rule_id("units-jump");
    finding.severity = core::severity_of(setup, finding.rule);
    finding.block = facts.first;
    finding.message = fmt::format("The feed moves span {:.1f} mm and the stock {:.1f} mm, about "
                                  "25.4 times as {}: mm and inches may be mixed up.",
                                  longest, widest, large ? "much" : "little");
    finding.cure = "Check G20 and G21, and the units of the set-up.";
    if (finding.severity == core::Severity::off) return std::nullopt;
    return finding;
}

bool PreparedCheck::is_in_inches() const {
    return unit_of_program(*program, unit_at_start(file.environment)) == gcode::LengthUnit::inch;
}

} // namespace app
