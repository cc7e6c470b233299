#include "app/base/xml.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/base/text.h"
#include "core/base/text.h"

namespace app {
namespace {

std::vector<size_t> line_ends_of(const std::string& text) {
    std::vector<size_t> ends;
    for (size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
        ends.push_back(at);
    return ends;
}

core::SourceSpan place_of(const std::vector<size_t>& line_ends, size_t offset) {
    const auto next = std::lower_bound(line_ends.begin(), line_ends.end(), offset);
    const size_t begin = next == line_ends.begin() ? 0 : *std::prev(next) + 1;
    return {.line = static_cast<uint32_t>(next - line_ends.begin() + 1),
            .column = static_cast<uint32_t>(offset - begin + 1)};
}

} // namespace

core::Result<XmlDocument> XmlDocument::parse(const std::string& text, const std::string& path) {
    XmlDocument xml;
    xml.path_ = path;
    xml.line_ends_ = line_ends_of(text);
    const pugi::xml_parse_result parsed = xml.document_.load_buffer(text.data(), text.size());
    if (parsed) return xml;
    const auto at =
        std::min(static_cast<size_t>(std::max<ptrdiff_t>(parsed.offset, 0)), text.size());
    return tl::unexpected<core::Error>(
        {core::ErrorCode::syntax, place_of(xml.line_ends_, at),
         fmt::format("is not valid XML: {}", core::lower_case(parsed.description())), path});
}

uint32_t XmlDocument::line_of(const pugi::xml_node& node) const {
    const ptrdiff_t offset = node.offset_debug();
    return offset < 0 ? 0 : place_of(line_ends_, static_cast<size_t>(offset)).line;
}

tl::unexpected<core::Error> XmlDocument::refuse(const pugi::xml_node& node,
                                                std::string message) const {
    return tl::unexpected(line_error(path_, line_of(node), std::move(message)));
}

core::Result<std::optional<double>> XmlDocument::number_in(const pugi::xml_node& node) const {
    const std::string text = trimmed(node.child_value());
    if (text.empty()) return std::nullopt;
    const auto number = app::number_in(text);
    if (number) return number;
    return refuse(node, fmt::format("{}: '{}' is not a number", node.name(), clipped(text, 40)));
}

} // namespace app
