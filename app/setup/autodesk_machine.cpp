#include "app/setup/autodesk_machine.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/setup/tools/json_file.h"
#include "core/base/file_reads.h"
#include "core/base/math.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "core/formats/xml_document.h"
#include "core/motion/event.h"

namespace app {
namespace {

using nlohmann::json;

/// An axis as either format describes it: mm or degrees, mm/min.
struct LibraryAxis {
    char letter = 0;
    bool is_rotary = false, is_on_table = false;
    std::optional<double> min, max, home, rapid;
};

// --- notes
// ----------------------------------------------------------------------------------------

std::string range_text(const LibraryAxis& axis) {
    if (!axis.min || !axis.max) return "without limits";
    return fmt::format("{:g} to {:g} degrees", *axis.min, *axis.max);
}

std::string rotary_note(const std::vector<LibraryAxis>& axes) {
    std::string list;
    for (const LibraryAxis& axis : axes)
        if (axis.is_rotary)
            list += fmt::format("{}{} (side = \"{}\", {})", list.empty() ? "" : ", ", axis.letter,
                                axis.is_on_table ? "table" : "tool", range_text(axis));
    return fmt::format("rotary axes are not taken over, because the file does not say where their "
                       "centres are in the machine, and blocks that move them are undecided: add "
                       "each as [[machine.axis]] with direction and point: {}",
                       list);
}

std::string axis_note(const LibraryAxis& axis) {
    if (!axis.min || !axis.max)
        return fmt::format("the file states no travel of {}, so its limits are not checked",
                           axis.letter);
    if (axis.home && (*axis.home < *axis.min || *axis.home > *axis.max))
        return fmt::format(
            "the home position of {}, {:g}, is outside its travel and not taken over", axis.letter,
            *axis.home);
    return {};
}

/// The axis as a machine file states it.
toml::table table_of(const LibraryAxis& axis) {
    toml::table table{{"name", std::string(1, axis.letter)},
                      {"side", axis.is_on_table ? "table" : "tool"}};
    if (axis.min && axis.max) {
        table.insert("min", *axis.min);
        table.insert("max", *axis.max);
    }
    const bool is_reached =
        !axis.min || !axis.max || (axis.home && *axis.home >= *axis.min && *axis.home <= *axis.max);
    if (axis.home && is_reached) table.insert("home", *axis.home);
    if (axis.rapid) table.insert("rapid", *axis.rapid);
    return table;
}

AutodeskMachine machine_of(const std::vector<LibraryAxis>& axes) {
    AutodeskMachine made;
    toml::array list;
    for (const LibraryAxis& axis : axes) {
        if (axis.is_rotary) {
            made.rotary += axis.letter;
            continue;
        }
        list.push_back(table_of(axis));
        if (std::string note = axis_note(axis); !note.empty())
            made.notes.push_back(std::move(note));
    }
    if (!made.rotary.empty()) made.notes.push_back(rotary_note(axes));
    made.machine.insert("axis", std::move(list));
    return made;
}

/// The letter of an axis: its name if that is one, else by the coordinate, X or A for 0.
char letter_of(const std::string& name, std::optional<size_t> coordinate, bool is_rotary) {
    if (name.size() == 1) {
        const size_t axis = core::axis_letters.find(core::upper(name[0]));
        if (axis < core::axis_count && core::is_rotary(axis) == is_rotary)
            return core::axis_letters[axis];
    }
    if (!coordinate || *coordinate > 2) return 0;
    return core::axis_letters[*coordinate + (is_rotary ? 3 : 0)];
}

/// Whether an axis with this letter is there already.
bool has_letter(const std::vector<LibraryAxis>& axes, char letter) {
    return std::any_of(axes.begin(), axes.end(),
                       [letter](const LibraryAxis& axis) { return axis.letter == letter; });
}

// --- XML
// ------------------------------------------------------------------------------------------

/// The factor from a unit to mm, degrees, mm/min or degrees/min; empty for unknown units.
std::optional<double> factor_of_unit(std::string_view unit) {
    double per_minute = 1.0;
    const auto ends = [&unit](std::string_view end) {
        if (!unit.ends_with(end)) return false;
        unit.remove_suffix(end.size());
        return true;
    };
    if (!ends("/min") && ends("/s")) per_minute = core::seconds_per_minute;
    if (unit == "mm" || unit == "deg") return per_minute;
    if (unit == "cm") return 10.0 * per_minute;
    if (unit == "m") return 1000.0 * per_minute;
    if (unit == "in") return core::mm_per_inch * per_minute;
    if (unit == "ft") return 12.0 * core::mm_per_inch * per_minute;
    if (unit == "rad") return per_minute / core::radians_of(1.0);
    return std::nullopt;
}

/// A value such as `-800mm`, `0deg` or `25400mm/min`.
std::optional<double> quantity_in(const std::string& text) {
    const size_t end = text.find_first_not_of("+-.0123456789eE");
    if (end == std::string::npos) return std::nullopt;
    const auto number = number_in(std::string_view(text).substr(0, end));
    const auto factor = factor_of_unit(std::string_view(text).substr(end));
    return number && factor ? std::optional(*number * *factor) : std::nullopt;
}

/// Reads the attributes of an axis.
struct AxisElement {
    const core::XmlDocument& xml;
    const pugi::xml_node& node;

    std::string text(const char* key) const { return trimmed(node.attribute(key).as_string()); }

    core::Result<std::optional<double>> quantity(const char* key) const {
        if (text(key).empty()) return std::nullopt;
        if (const auto value = quantity_in(text(key))) return value;
        return refuse(key);
    }

    /// Two values; both are empty if they are equal, which is how travels are left open.
    core::Result<void> range(std::optional<double>& min, std::optional<double>& max) const {
        const std::vector<std::string> words = words_of_line(text("range"));
        if (words.empty()) return {};
        const auto first = quantity_in(words[0]);
        const auto second = words.size() == 2 ? quantity_in(words[1]) : std::nullopt;
        if (!first || !second || *first > *second) return refuse("range");
        if (*first == *second) return {};
        min = first;
        max = second;
        return {};
    }

    tl::unexpected<core::Error> refuse(const char* key) const {
        return xml.refuse(node, fmt::format("{} = \"{}\" of axis {} cannot be read: values need a "
                                            "unit, as in 800mm or 0deg",
                                            key, clipped(text(key), 40), clipped(text("id"), 40)));
    }
};

std::optional<size_t> coordinate_in(const std::string& text) {
    const size_t axis =
        text.size() == 1 ? core::axis_letters.find(core::upper(text[0])) : std::string::npos;
    return axis < 6 ? std::optional(axis % 3) : std::nullopt;
}

core::Result<LibraryAxis> axis_of_element(const AxisElement& element) {
    LibraryAxis axis;
    axis.is_rotary = element.text("actuator") == "rotational";
    axis.is_on_table = element.text("link") == "table";
    axis.letter =
        letter_of(element.text("name"), coordinate_in(element.text("coordinate")), axis.is_rotary);
    if (axis.letter == 0)
        return element.xml.refuse(element.node,
                                  fmt::format("axis \"{}\" has neither a name nor a coordinate "
                                              "that is the letter of an axis",
                                              clipped(element.text("id"), 40)));
    if (auto read = element.range(axis.min, axis.max); !read) return tl::unexpected(read.error());
    FEELER_TRY(axis.home, element.quantity("homePosition"));
    FEELER_TRY(axis.rapid, element.quantity("rapidFeed"));
    if (axis.rapid && *axis.rapid <= 0.0) axis.rapid.reset();
    return axis;
}

core::Result<AutodeskMachine> machine_of_xml(const std::string& text, const std::string& path) {
    FEELER_TRY(const core::XmlDocument xml, core::XmlDocument::parse(text, path));
    const pugi::xml_node root = xml.root().child("machine");
    std::vector<LibraryAxis> axes;
    for (const pugi::xml_node& node : root.children("axis")) {
        FEELER_TRY(const LibraryAxis axis, axis_of_element({xml, node}));
        if (has_letter(axes, axis.letter))
            return xml.refuse(node, fmt::format("axis {} is there twice", axis.letter));
        axes.push_back(axis);
    }
    if (axes.empty())
        return tl::unexpected(core::Error{
            core::ErrorCode::syntax, {}, "is no machine of Autodesk: it has no axis", path});
    return machine_of(axes);
}

// --- JSON
// -----------------------------------------------------------------------------------------

std::optional<double> number_or_none(const json& object, const char* key) {
    const json& member = member_at(object, key);
    return member.is_number() ? std::optional(member.get<double>()) : std::nullopt;
}

/// What the end of a chain of parts carries.
enum class ChainEnd : uint8_t { none, head, table };

/// Collects the axes of a tree of parts, from the base outwards.
class PartTree {
public:
    PartTree(const json& controls, const std::string& path) : controls_(controls), path_(path) {}

    /// Adds the axes of a list of parts. Returns what they lead to.
    core::Result<ChainEnd> add(const json& parts, int depth);

    std::vector<LibraryAxis> axes{};

private:
    core::Result<ChainEnd> add_part(const json& part, int depth);
    LibraryAxis axis_of(const json& part, bool is_rotary) const;
    tl::unexpected<core::Error> refuse(std::string why) const {
        return tl::unexpected(core::Error{core::ErrorCode::syntax, {}, std::move(why), path_});
    }

    const json& controls_;
    const std::string& path_;
};

LibraryAxis PartTree::axis_of(const json& part, bool is_rotary) const {
    const json& control = member_at(controls_, text_at(part, "id").c_str());
    const auto coordinate = number_or_none(control, "coordinate");
    LibraryAxis axis{.is_rotary = is_rotary};
    axis.letter = letter_of(text_at(part, "name"),
                            coordinate && *coordinate >= 0.0 && *coordinate <= 2.0
                                ? std::optional(static_cast<size_t>(*coordinate))
                                : std::nullopt,
                            is_rotary);
    axis.min = number_or_none(part, "min");
    axis.max = number_or_none(part, "max");
    if (axis.min && axis.max && !(*axis.min < *axis.max)) axis.min.reset();
    axis.rapid = number_or_none(control, "max_rapid_speed");
    if (axis.rapid && !(*axis.rapid > 0.0)) axis.rapid.reset();
    return axis;
}

core::Result<ChainEnd> PartTree::add_part(const json& part, int depth) {
    const std::string type = text_at(part, "type");
    if (type == "head") return ChainEnd::head;
    if (type == "table") return ChainEnd::table;
    const bool is_axis = type == "linear" || type == "rotary";
    const size_t place = axes.size();
    if (is_axis) axes.push_back(axis_of(part, type == "rotary"));
    FEELER_TRY(const ChainEnd end, add(member_at(part, "parts"), depth + 1));
    if (!is_axis) return end;
    LibraryAxis& axis = axes[place];
    axis.is_on_table = end == ChainEnd::table;
    if (axis.letter == 0 || end == ChainEnd::none)
        return refuse(fmt::format("the part \"{}\" is an axis {}",
                                  clipped(printable(text_at(part, "id")), 40),
                                  axis.letter == 0 ? "without a name or a coordinate"
                                                   : "that carries neither a head nor a table"));
    for (size_t i = 0; i < axes.size(); ++i)
        if (i != place && axes[i].letter == axis.letter)
            return refuse(fmt::format("axis {} is there twice", axis.letter));
    return end;
}

core::Result<ChainEnd> PartTree::add(const json& parts, int depth) {
    constexpr int deepest = 32;
    if (depth > deepest) return refuse("its parts are nested more than 32 deep");
    ChainEnd end = ChainEnd::none;
    if (!parts.is_array()) return end;
    for (const json& part : parts) {
        FEELER_TRY(const ChainEnd found, add_part(part, depth));
        if (found != ChainEnd::none) end = found;
    }
    return end;
}

core::Result<AutodeskMachine> machine_of_json(const std::string& text, const std::string& path) {
    FEELER_TRY(const json machine, parse_json(text, path));
    const json& controls =
        member_at(member_at(member_at(machine, "controller"), "default"), "parts");
    PartTree tree(controls, path);
    const json& parts = member_at(member_at(member_at(machine, "kinematics"), "default"), "parts");
    if (auto added = tree.add(parts, 0); !added) return tl::unexpected(added.error());
    if (tree.axes.empty())
        return tl::unexpected(core::Error{core::ErrorCode::syntax,
                                          {},
                                          "is no machine of Autodesk: it has no axis in "
                                          "kinematics.default.parts",
                                          path});
    return machine_of(tree.axes);
}

} // namespace

bool is_autodesk_machine(const std::string& path) {
    const std::string extension =
        core::lower_case(std::filesystem::path(path).extension().generic_string());
    return extension == ".machine" || extension == ".mch";
}

core::Result<AutodeskMachine> read_autodesk_machine(const std::string& path) {
    constexpr size_t largest = size_t(16) << 20; // bytes
    if (std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, std::move(why), path});
    const auto bytes = core::file_bytes(path, largest);
    if (!bytes || bytes->size() > largest)
        return tl::unexpected(core::Error{
            core::ErrorCode::io, {}, bytes ? "is larger than 16 MiB" : "cannot be read", path});
    const size_t first = bytes->find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    const bool is_json = first != std::string::npos && (*bytes)[first] == '{';
    return is_json ? machine_of_json(*bytes, path) : machine_of_xml(*bytes, path);
}

} // namespace app
