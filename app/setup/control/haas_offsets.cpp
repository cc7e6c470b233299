#include <charconv>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/control/offset_store.h"
#include "core/formats/xml_document.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

/// The number of an element such as TOOL12; empty for any other name.
std::optional<int> tool_of_element(std::string_view name) {
    if (!name.starts_with("TOOL")) return std::nullopt;
    int number = 0;
    const char* const end = name.data() + name.size();
    const auto [rest, failure] = std::from_chars(name.data() + 4, end, number);
    if (failure != std::errc() || rest != end || number < 1) return std::nullopt;
    return number;
}

/// The number in an element; empty if it has no text.
core::Result<std::optional<double>> number_of(const core::XmlDocument& xml,
                                              const pugi::xml_node& element) {
    const std::string text = trimmed(element.child_value());
    if (text.empty()) return std::nullopt;
    const auto number = number_in(text);
    if (number) return number;
    return xml.refuse(element,
                      fmt::format("{}: '{}' is not a number", element.name(), clipped(text, 40)));
}

/// Reads one length of a tool; leaves `place` alone if the element is absent or empty.
core::Result<void> take_length(const core::XmlDocument& xml, const pugi::xml_node& tool,
                               const char* key, double factor, std::optional<ControlValue>& place,
                               const OffsetStore& store) {
    const pugi::xml_node element = tool.child(key);
    if (!element) return {};
    FEELER_TRY(const std::optional<double> number, number_of(xml, element));
    if (!number) return {};
    store.put(place, store.length(factor * *number, store.reading.unit, xml.line_of(element)),
              fmt::format("{} of {}", key, tool.name()));
    return {};
}

core::Result<void> take_tool(const core::XmlDocument& xml, const pugi::xml_node& tool, int number,
                             const OffsetStore& store) {
    ControlToolOffset& entry = store.offsets.tools[core::OffsetNumber{number}];
    const double size = store.reading.sizes_are_radii ? 2.0 : 1.0;
    struct Row {
        const char* key;
        double factor;
        std::optional<ControlValue>& place;
    };
    for (const Row& row :
         {Row{"LENGTH_GEOMETRY", 1.0, entry.length}, Row{"LENGTH_WEAR", 1.0, entry.wear},
          Row{"DIAMETER_GEOMETRY", size, entry.diameter},
          Row{"DIAMETER_WEAR", size, entry.diameter_wear}})
        if (auto taken = take_length(xml, tool, row.key, row.factor, row.place, store); !taken)
            return taken;
    return {};
}

/// The table of tools: the document's element or one in it.
pugi::xml_node tool_table_in(const pugi::xml_node& root) {
    if (const pugi::xml_node table = root.child("TOOL_OFFSET")) return table;
    for (const pugi::xml_node& child : root.children())
        if (const pugi::xml_node table = child.child("TOOL_OFFSET")) return table;
    return {};
}

} // namespace

core::Result<void> read_haas_offsets(const std::string& text, const OffsetStore& store) {
    FEELER_TRY(const core::XmlDocument xml, core::XmlDocument::parse(text, store.path));
    const pugi::xml_node table = tool_table_in(xml.root());
    if (!table)
        return tl::unexpected(core::Error{core::ErrorCode::syntax,
                                          {},
                                          "is XML, but has no TOOL_OFFSET as files of Haas have",
                                          store.path});
    for (const pugi::xml_node& tool : table.children())
        if (const auto number = tool_of_element(tool.name()))
            if (auto taken = take_tool(xml, tool, *number, store); !taken) return taken;
    for (const pugi::xml_node& other : table.parent().children())
        if (other.type() == pugi::node_element && other != table)
            store.note(fmt::format("line {}: {} is not read; write work offsets as blocks with G10",
                                   xml.line_of(other), trimmed(other.name())));
    return {};
}

} // namespace app
