#include "core/formats/xml_document.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/text.h"

namespace core {
namespace {

std::vector<size_t> line_ends_of(const std::string& text) {
    std::vector<size_t> ends;
    for (size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
        ends.push_back(at);
    return ends;
}

SourceSpan place_of(const std::vector<size_t>& line_ends, size_t offset) {
    const auto next = std::lower_bound(line_ends.begin(), line_ends.end(), offset);
    const size_t begin = next == line_ends.begin() ? 0 : *std::prev(next) + 1;
    return {.line = static_cast<uint32_t>(next - line_ends.begin() + 1),
            .column = static_cast<uint32_t>(offset - begin + 1)};
}

/// Appends a character as UTF-8.
void append_utf8(std::string& text, uint32_t code) {
    const auto add = [&text](uint32_t byte) { text += static_cast<char>(byte); };
    if (code < 0x80) return add(code);
    if (code < 0x800) {
        add(0xc0 | code >> 6);
    } else {
        if (code < 0x10000) {
            add(0xe0 | code >> 12);
        } else {
            add(0xf0 | code >> 18);
            add(0x80 | (code >> 12 & 0x3f));
        }
        add(0x80 | (code >> 6 & 0x3f));
    }
    add(0x80 | (code & 0x3f));
}

/// The text as UTF-8 if it begins with the mark of UTF-16; otherwise unchanged.
std::string as_utf8(const std::string& text) {
    const bool is_little = text.starts_with("\xFF\xFE"), is_big = text.starts_with("\xFE\xFF");
    if (!is_little && !is_big) return text;
    const auto unit_at = [&](size_t at) {
        const auto first = static_cast<unsigned char>(text[at]);
        const auto second = static_cast<unsigned char>(text[at + 1]);
        return static_cast<uint32_t>(is_little ? first | second << 8 : first << 8 | second);
    };
    std::string converted;
    for (size_t at = 2; at + 1 < text.size(); at += 2) {
        uint32_t code = unit_at(at);
        const bool is_high = code >= 0xd800 && code < 0xdc00 && at + 3 < text.size();
        if (const uint32_t low = is_high ? unit_at(at + 2) : 0; low >= 0xdc00 && low < 0xe000) {
            code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
            at += 2;
        }
        append_utf8(converted, code >= 0xd800 && code < 0xe000 ? 0xfffd : code);
    }
    return converted;
}

} // namespace

Result<XmlDocument> XmlDocument::parse(const std::string& bytes, const std::string& path) {
    const std::string text = as_utf8(bytes);
    XmlDocument xml;
    xml.path_ = path;
    xml.line_ends_ = line_ends_of(text);
    const pugi::xml_parse_result parsed = xml.document_.load_buffer(
        text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (parsed) return xml;
    const auto at =
        std::min(static_cast<size_t>(std::max<ptrdiff_t>(parsed.offset, 0)), text.size());
    return tl::unexpected<Error>(
        {ErrorCode::syntax, place_of(xml.line_ends_, at),
         fmt::format("is not valid XML: {}", lower_case(parsed.description())), path});
}

uint32_t XmlDocument::line_of(const pugi::xml_node& node) const {
    const ptrdiff_t offset = node.offset_debug();
    return offset < 0 ? 0 : place_of(line_ends_, static_cast<size_t>(offset)).line;
}

tl::unexpected<Error> XmlDocument::refuse(const pugi::xml_node& node, std::string message) const {
    return tl::unexpected<Error>(
        {ErrorCode::syntax, {.line = line_of(node)}, std::move(message), path_});
}

} // namespace core
