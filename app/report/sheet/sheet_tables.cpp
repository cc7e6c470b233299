#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/text.h"
#include "app/check/check_run.h"
#include "app/report/html/html_text.h"
#include "app/report/sheet/html_sheet.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/tolerance/tolerances.h"
#include "core/base/text.h"
#include "gcode/language/canonical.h"
#include "render/setup_scene.h"

namespace app {
namespace {

constexpr const char* nothing = "\xE2\x80\x93"; // a dash
constexpr const char* assumed_mark = "\xE2\x97\x8B ";

std::string header(const std::string& title, const std::vector<const char*>& columns) {
    std::string html = "<h2>" + html_text(title) + "</h2>\n<table class=\"data\"><thead><tr>";
    for (const char* column : columns) html += fmt::format("<th scope=\"col\">{}</th>", column);
    return html + "</tr></thead>\n";
}

std::string cell(const std::string& text) { return "<td>" + html_text(text) + "</td>"; }

std::string number_cell(const std::string& text) {
    return "<td class=\"number\">" + html_text(text) + "</td>";
}

std::string row_head(const std::string& text) {
    return "<th scope=\"row\">" + html_text(text) + "</th>";
}

std::string marked(SetupSource source, const std::string& text) {
    return source == SetupSource::assumed ? assumed_mark + text : text;
}

/// The values of a set-up with their tolerances, if the run has any.
class AllowedWords {
public:
    AllowedWords(const CheckRun& run, const SheetUnit& unit) : run_(run), unit_(unit) {}

    /// A row with the tolerances of the deviations that `is_meant` selects; empty if there are
    /// none.
    template <typename Meant>
    std::string row(size_t columns, const Meant& is_meant) const {
        if (!run_.tolerances) return {};
        std::vector<Part> parts;
        for (const Tolerance& tolerance : run_.tolerances->list)
            if (is_meant(tolerance.deviation)) add(parts, tolerance);
        if (parts.empty()) return {};
        std::vector<std::string> texts;
        for (const Part& part : parts) texts.push_back(part.names + " " + part.range);
        return fmt::format("<tr><td class=\"allowed\" colspan=\"{}\">may be off: {}</td></tr>\n",
                           columns, html_text(fmt::format("{}", fmt::join(texts, "; "))));
    }

    const Tolerance* stick_out_of(core::ToolNumber tool) const {
        if (!run_.tolerances) return nullptr;
        for (const Tolerance& tolerance : run_.tolerances->list)
            if (tolerance.deviation.quantity == Quantity::stick_out
                && tolerance.deviation.tool == tool && tolerance.is_known())
                return &tolerance;
        return nullptr;
    }

private:
    /// Quantities with the same tolerance: "X, Y" and "20 mm or more either way".
    struct Part {
        std::string names, range;
    };

    void add(std::vector<Part>& parts, const Tolerance& tolerance) const {
        const std::string name = quantity_of(tolerance.deviation), range = range_of(tolerance);
        if (!parts.empty() && parts.back().range == range)
            parts.back().names += ", " + name;
        else
            parts.push_back({name, range});
    }

    /// "-3.1 to +12.4 mm (less: line 210: holder of tool 3 near clamp left)".
    std::string range_of(const Tolerance& tolerance) const {
        std::string text = range_text(tolerance, unit_.inch);
        if (!tolerance.is_known()) return text;
        std::vector<std::string> causes;
        for (const auto& [name, limit] :
             {std::pair("less", &tolerance.less), std::pair("more", &tolerance.more)})
            if (const std::string cause = limit_text(*limit); !cause.empty())
                causes.push_back(fmt::format("{}: {}", name, cause));
        if (!causes.empty()) text += fmt::format(" ({})", fmt::join(causes, "; "));
        return text;
    }

    /// The title without the subject: "X", "stick-out".
    static std::string quantity_of(const Deviation& deviation) {
        std::string title = title_of(deviation).substr(deviation.subject().size());
        title.erase(0, title.find_first_not_of(", "));
        return title;
    }

    const CheckRun& run_;
    const SheetUnit& unit_;
};

/// A work offset on the sheet.
struct ShownOffset {
    size_t index = 0;
    NamedZero zero;
    SetupSource source = SetupSource::stated;
    core::Vec3 origin = core::Vec3(0.0); // machine coordinates
    ZeroUse use;
};

std::string offset_words(const SheetContent& content, size_t index) {
    if (content.calls_zero_datum) return "datum";
    return index >= gcode::no_work_offset ? "no work offset" : gcode::name_of_offset(index);
}

core::Transform pose_named(const SetupSheet& sheet, const std::string& name) {
    const auto found = sheet.frames.find(name);
    return found == sheet.frames.end() ? core::Transform{} : found->second;
}

/// The zero of an offset, where the program may have set it.
ShownOffset shown_offset(const SheetContent& content, size_t index, const ZeroUse& use) {
    const SetupSheet& sheet = content.sheet;
    const std::string name = gcode::name_of_offset(index);
    ShownOffset shown{.index = index, .origin = use.origin, .use = use};
    shown.zero.name = offset_words(content, index);
    const auto stated =
        std::find_if(sheet.offsets.begin(), sheet.offsets.end(),
                     [&](const SheetOffset& offset) { return offset.name == name; });
    const bool is_listed = stated != sheet.offsets.end();
    shown.source = is_listed ? stated->source : SetupSource::assumed;
    if (use.set_in) shown.source = SetupSource::stated;
    const core::Transform machine = pose_named(sheet, "machine");
    if (is_listed && sheet.frames.contains(name)) {
        shown.zero.stock_from_zero = sheet.frames.at(name);
        shown.zero.stock_from_zero.translation += machine.rotation * (use.origin - stated->origin);
    } else {
        shown.zero.stock_from_zero = machine * core::translation(use.origin);
    }
    return shown;
}

std::vector<ShownOffset> shown_offsets(const SheetContent& content) {
    std::vector<ShownOffset> shown;
    for (const auto& [index, use] : content.use.offsets)
        shown.push_back(shown_offset(content, index, use));
    return shown;
}

/// The frame to which positions refer: the first zero, else that of the stock.
core::Transform first_zero_from_stock(const std::vector<ShownOffset>& offsets) {
    return offsets.empty() ? core::Transform{} : offsets[0].zero.stock_from_zero.inverse();
}

bool has_stock(const CheckRun& run) { return !stands_for_no_stock(run.setup.stock); }

std::string place_words(const CheckRun& run, const SheetContent& content,
                        const ShownOffset& offset) {
    if (!has_stock(run)) return "the stock is not known";
    const core::Transform zero_from_stock = offset.zero.stock_from_zero.inverse();
    const core::Solid& stock = run.setup.stock;
    const auto box = stock_extents(stock, zero_from_stock);
    if (!box) return "the stock is turned against this zero: see the picture";
    const std::string place =
        place_on_stock(*box, is_round_about_z(stock, zero_from_stock), content.unit);
    return marked(content.sheet.stock_source, place);
}

std::string machine_words(const SheetContent& content, const ShownOffset& offset) {
    if (offset.source == SetupSource::assumed)
        return std::string(assumed_mark) + "not stated: touch it off";
    const SheetUnit& unit = content.unit;
    std::string text = fmt::format("X{} Y{} Z{}", unit.length(offset.origin.x),
                                   unit.length(offset.origin.y), unit.length(offset.origin.z));
    if (offset.use.set_in) text += fmt::format(", set by the program: line {}", *offset.use.set_in);
    return text;
}

std::string datum_table(const CheckRun& run, const SheetContent& content,
                        const std::vector<ShownOffset>& offsets, const AllowedWords& allowed) {
    std::string html = header("Datum", {"Offset", "Zero on the stock", "Machine coordinates"});
    for (const ShownOffset& offset : offsets) {
        std::string place = place_words(run, content, offset);
        if (offset.use.shifted_in)
            place +=
                fmt::format("; line {} moves program zero away from it", *offset.use.shifted_in);
        html += "<tbody><tr>" + row_head(offset.zero.name) + cell(place)
                + cell(machine_words(content, offset)) + "</tr>\n"
                + allowed.row(3,
                              [&](const Deviation& deviation) {
                                  return deviation.quantity == Quantity::work_offset
                                         && deviation.offset == offset.index;
                              })
                + "</tbody>\n";
    }
    if (offsets.empty())
        html += "<tbody><tr><td colspan=\"3\">the program uses none</td></tr></tbody>\n";
    return html + "</table>\n";
}

std::string range_words(const core::Aabb& box, int axis, const SheetUnit& unit) {
    return fmt::format("{} to {}", unit.length(box.min[axis]), unit.length(box.max[axis]));
}

std::string size_words(const core::Solid& stock, const SheetUnit& unit) {
    if (const auto* cylinder = std::get_if<core::SolidCylinder>(&stock.shape))
        return fmt::format("\xE2\x8C\x80{} x {} along {}", unit.length(2.0 * cylinder->radius),
                           unit.length(cylinder->height), "XYZ"[cylinder->axis]);
    const core::Vec3 size = core::bounds(stock).size();
    return fmt::format("{}{} x {} x {}",
                       std::holds_alternative<core::SolidMesh>(stock.shape) ? "mesh in a box of "
                                                                            : "",
                       unit.length(size.x), unit.length(size.y), unit.length(size.z));
}

/// Height of the material above the jaws, and how much larger the raw stock may be.
std::string stock_notes(const CheckRun& run, const SheetContent& content,
                        const core::Transform& zero_from_stock) {
    const SheetUnit& unit = content.unit;
    const core::Solid& stock = run.setup.stock;
    std::string text;
    if (const auto box = stock_extents(stock, zero_from_stock))
        if (const auto out = height_above_jaws(placed_fixtures(run.setup, zero_from_stock), *box))
            text = fmt::format("stands {} {} out of the jaws; ", unit.length(*out), unit.name());
    if (stock.tolerance > 0.0)
        return text
               + fmt::format("may be larger by {} {} on every side", unit.length(stock.tolerance),
                             unit.name());
    return text + "must not be larger than this";
}

std::string stock_table(const CheckRun& run, const SheetContent& content,
                        const core::Transform& zero_from_stock, const std::string& frame,
                        const AllowedWords& allowed) {
    const std::string title = frame.empty() ? "Stock" : "Stock, positions from " + frame;
    std::string html = header(title, {"Size", "X", "Y", "Z: bottom to top", ""});
    if (!has_stock(run))
        return html + "<tbody><tr><td colspan=\"5\">not known</td></tr></tbody></table>\n";
    const core::Solid& stock = run.setup.stock;
    html += "<tbody><tr>"
            + row_head(marked(content.sheet.stock_source, size_words(stock, content.unit)));
    const auto box = stock_extents(stock, zero_from_stock);
    for (int axis = 0; axis < 3; ++axis)
        html += number_cell(box ? range_words(*box, axis, content.unit) : nothing);
    html += cell(stock_notes(run, content, zero_from_stock)) + "</tr>\n";
    html += allowed.row(
        5, [](const Deviation& deviation) { return deviation.quantity == Quantity::stock; });
    return html + "</tbody></table>\n";
}

/// "clamp, mesh fork.stl", "box".
std::string kind_of(const core::Fixture& fixture, const StatedSetup& stated) {
    std::string kind = render::is_clamp(fixture.name)  ? "clamp, "
                       : render::is_vise(fixture.name) ? "vise, "
                                                       : "";
    const StatedBody* body = stated.fixture(fixture.name);
    if (body && !body->preset.empty())
        kind += body->preset;
    else if (body && !body->mesh.empty())
        kind += (body->solid.empty() ? "mesh " : body->solid + " of ")
                + body->mesh.substr(body->mesh.find_last_of('/') + 1);
    else if (body && !body->model.empty())
        kind += "model " + body->model.substr(body->model.find_last_of('/') + 1);
    else if (body && body->cylinder)
        kind += "cylinder";
    else
        kind += std::holds_alternative<core::SolidMesh>(fixture.body) ? "mesh" : "box";
    if (fixture.expendable) kind += ", may be cut";
    if (!fixture.is_there) kind += ", put in later";
    return kind;
}

std::string fixture_table(const CheckRun& run, const SheetContent& content,
                          const core::Transform& zero_from_stock, const std::string& frame,
                          const AllowedWords& allowed) {
    const std::string title = frame.empty() ? "Fixtures" : "Fixtures, positions from " + frame;
    std::string html =
        header(title, {"Name", "Kind", "X: left to right", "Y: front to back", "Z: bottom to top"});
    const std::vector<PlacedFixture> fixtures = placed_fixtures(run.setup, zero_from_stock);
    for (const PlacedFixture& placed : fixtures) {
        const std::string& name = placed.fixture->name;
        html += "<tbody><tr>" + row_head(name) + cell(kind_of(*placed.fixture, content.stated));
        for (int axis = 0; axis < 3; ++axis)
            html += number_cell(range_words(placed.box, axis, content.unit));
        html += "</tr>\n" + allowed.row(5, [&](const Deviation& deviation) {
            return deviation.quantity == Quantity::fixture && deviation.fixture == name;
        }) + "</tbody>\n";
    }
    if (fixtures.empty())
        html += fmt::format("<tbody><tr><td colspan=\"5\">{}</td></tr></tbody>\n",
                            content.sheet.knows_fixtures
                                ? "none"
                                : "not described: the check knows nothing of what holds the work");
    return html + "</table>\n";
}

std::string without_article(const std::string& words) {
    const size_t blank = words.find(' ');
    return blank == std::string::npos ? words : words.substr(blank + 1);
}

std::string tool_kind(const core::ToolDescription& tool) {
    std::string kind = without_article(core::description_of(tool.shape));
    if (!tool.name.empty()) kind = fmt::format("{} ({})", clipped(trimmed(tool.name), 40), kind);
    return kind;
}

std::string corner_words(const core::ToolDescription& tool, const SheetUnit& unit) {
    if (tool.shape == core::ToolShape::ball) return unit.length(0.5 * tool.diameter);
    return tool.corner_radius ? unit.length(*tool.corner_radius) : nothing;
}

std::string holder_words(const SheetTool& shown) {
    if (shown.tool.holder.empty()) return "not described";
    const std::string name = holder_name(shown.tool);
    const std::string words = name.empty() ? fmt::format("of {}, as in the set-up",
                                                         counted(shown.tool.holder.size(), "cone"))
                                           : name;
    return marked(shown.source_of("holder"), words);
}

/// From the tip to the holder's lower face, mm; empty if nothing says where the holder begins.
std::optional<double> stick_out_of(const core::ToolDescription& tool) {
    if (tool.stick_out) return tool.stick_out;
    const auto head = core::tool_head(tool);
    if (!head || (tool.shank.empty() && tool.holder.empty())) return {};
    return head->length + core::total_length(tool.shank);
}

/// The stick-out of a tool as checked; with a tolerance, also the least.
std::string stick_out_words(const SheetTool& shown, const core::Setup& setup,
                            const Tolerance* tolerance, const SheetUnit& unit) {
    const auto stick_out = stick_out_of(setup.tools.at(shown.tool.number).description);
    if (!stick_out) return nothing;
    std::string text = marked(shown.source_of("stick_out"), unit.length(*stick_out));
    if (tolerance)
        text += fmt::format(" (at least {})", unit.at_least(*stick_out - tolerance->less.by));
    return text;
}

std::string number_words(const std::optional<double>& least, const std::optional<double>& most,
                         const char* unit) {
    if (!least) return nothing;
    const std::string low = core::number_text(*least, 1), high = core::number_text(*most, 1);
    return (low == high ? low : low + " to " + high) + unit;
}

/// Whether the lengths follow from a tool that is only assumed, and no table states them.
bool assumes_length_of(const ToolUse& use, const SheetTool* shown, const SheetContent& content) {
    if (use.length_is_assumed || (shown && shown->tool.length_is_guess)) return true;
    const auto& stated = content.stated_lengths;
    const bool all_stated =
        !use.lengths.empty()
        && std::includes(stated.begin(), stated.end(), use.lengths.begin(), use.lengths.end());
    return shown && shown->source == SetupSource::assumed && !all_stated;
}

/// "H1: 120". An assumed length is not shown: nobody should enter it in the control.
std::string length_words(const ToolUse& use, const SheetTool* shown, const SheetContent& content) {
    if (use.control_lengths.empty()) return use.feeds_without_length ? "none" : nothing;
    std::vector<std::string> names, lengths;
    for (const core::OffsetNumber number : use.lengths)
        names.push_back(fmt::format("H{}", core::value_of(number)));
    for (const double length : use.control_lengths) lengths.push_back(content.unit.length(length));
    if (use.feeds_without_length) lengths.emplace_back("none");
    if (use.control_lengths.size() == most_kept_values) lengths.emplace_back("others");
    const bool is_assumed = assumes_length_of(use, shown, content);
    return fmt::format("{}{}{}{}", is_assumed ? assumed_mark : "", fmt::join(names, ", "),
                       names.empty() ? "" : ": ",
                       is_assumed ? "measure it" : fmt::format("{}", fmt::join(lengths, " or ")));
}

std::string radius_words(const ToolUse& use) {
    std::vector<std::string> names;
    for (const int number : use.radii) names.push_back(fmt::format("D{}", number));
    if (names.size() == most_kept_values) names.emplace_back("others");
    return names.empty() ? nothing : fmt::format("{}", fmt::join(names, ", "));
}

std::string tool_row(const ToolUse& use, const SheetTool* shown, const core::Setup& setup,
                     const AllowedWords& allowed, const SheetContent& content) {
    const SheetUnit& unit = content.unit;
    const std::string speed = number_words(use.least_speed, use.most_speed,
                                           use.has_surface_speed ? " (surface speed)" : "");
    const std::string number =
        use.tool ? fmt::format("T{}", core::value_of(*use.tool)) : std::string(nothing);
    std::string html = "<tr>" + row_head(number);
    if (!shown) {
        html += cell(std::string(assumed_mark) + "no tool is described");
        for (int i = 0; i < 5; ++i) html += cell(nothing);
    } else {
        const core::ToolDescription& tool = shown->tool;
        const Tolerance* least = allowed.stick_out_of(tool.number);
        html +=
            cell(marked(shown->source_of("shape"), tool_kind(tool)))
            + number_cell(marked(shown->source_of("diameter"), unit.length(tool.diameter)))
            + number_cell(corner_words(tool, unit))
            + number_cell(marked(shown->source_of("flute_length"), unit.length(tool.flute_length)))
            + cell(stick_out_words(*shown, setup, least, unit)) + cell(holder_words(*shown));
    }
    return html + cell(length_words(use, shown, content)) + cell(radius_words(use)) + cell(speed)
           + "</tr>\n";
}

std::string tool_table_html(const CheckRun& run, const SheetContent& content,
                            const AllowedWords& allowed) {
    std::string html = header("Tools, in the order of their use",
                              {"Tool", "Kind", "\xE2\x8C\x80", "Corner R", "Flutes", "Stick-out",
                               "Holder", "Length on the control", "D", "Speed, rev/min"});
    for (const ToolUse& use : content.use.tools) {
        const auto shown = std::find_if(
            content.sheet.tools.begin(), content.sheet.tools.end(), [&](const SheetTool& tool) {
                return tool.is_described && tool.tool.number == use.tool;
            });
        html += "<tbody>"
                + tool_row(use, shown == content.sheet.tools.end() ? nullptr : &*shown, run.setup,
                           allowed, content)
                + allowed.row(10,
                              [&](const Deviation& deviation) {
                                  return !deviation.is_place() && use.tool == deviation.tool;
                              })
                + "</tbody>\n";
    }
    if (content.use.tools.empty())
        html += "<tbody><tr><td colspan=\"10\">the program moves none</td></tr></tbody>\n";
    if (run.stopped)
        html += "<tbody><tr><td colspan=\"10\">The program stopped: later tools are missing."
                "</td></tr></tbody>\n";
    return html + "</table>\n";
}

} // namespace

std::vector<NamedZero> zeros_of(const SheetContent& content) {
    std::vector<NamedZero> zeros;
    for (const ShownOffset& offset : shown_offsets(content)) zeros.push_back(offset.zero);
    return zeros;
}

std::string sheet_tables(const CheckRun& run, const SheetContent& content) {
    const AllowedWords allowed(run, content.unit);
    const std::vector<ShownOffset> offsets = shown_offsets(content);
    const core::Transform zero_from_stock = first_zero_from_stock(offsets);
    const std::string frame = offsets.empty() ? std::string() : offsets[0].zero.name;
    return datum_table(run, content, offsets, allowed)
           + stock_table(run, content, zero_from_stock, frame, allowed)
           + fixture_table(run, content, zero_from_stock, frame, allowed)
           + tool_table_html(run, content, allowed);
}

} // namespace app
