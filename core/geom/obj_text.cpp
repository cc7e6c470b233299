#include <fmt/format.h>

#include "core/geom/mesh_text.h"
#include "core/geom/mesh_words.h"

namespace core {
namespace {

/// The index of a face's corner counted from 1, from "7", "7/1", "7//3" or "-1" (the last vertex).
Result<int64_t> obj_index(std::string_view word, size_t vertices_before, size_t vertices,
                          uint32_t line) {
    const auto index = integer_of(word.substr(0, word.find('/')));
    if (!index) return fail_in_line(line, fmt::format("'{}' is not a corner of a face", word));
    const int64_t counted =
        *index < 0 ? static_cast<int64_t>(vertices_before) + *index + 1 : *index;
    if (counted < 1 || counted > static_cast<int64_t>(vertices))
        return fail_in_line(line, fmt::format("a face names vertex {}, but there are {} vertices",
                                              *index, vertices));
    return counted;
}

size_t count_obj_vertices(std::string_view bytes) {
    size_t count = 0;
    Words words;
    for (LineReader lines(bytes); lines.next(words, '#');)
        if (!words.empty() && words[0] == "v") ++count;
    return count;
}

} // namespace

Result<MeshText> checked_obj(std::string_view bytes) {
    const size_t vertices = count_obj_vertices(bytes); // a face may come before its vertices
    MeshText out;
    Words words;
    for (LineReader lines(bytes); lines.next(words, '#');) {
        if (words.empty()) continue;
        if (words.back().back() == '\\')
            return fail_in_line(lines.line(), "lines continued with '\\' are not supported");
        if (words[0] == "v") {
            out.text += 'v';
            FEELER_TRY([[maybe_unused]] const FloatPoint point,
                       append_point(words, 1, lines.line(), out.text));
            ++out.vertices;
        } else if (words[0] == "f") {
            if (words.size() < 4)
                return fail_in_line(lines.line(),
                                    fmt::format("a face has {} corners", words.size() - 1));
            out.text += 'f';
            for (size_t i = 1; i < words.size(); ++i) {
                FEELER_TRY(const int64_t index,
                           obj_index(words[i], out.vertices, vertices, lines.line()));
                out.text += fmt::format(" {}", index);
            }
            out.text += '\n';
            ++out.faces;
        }
    }
    if (out.faces == 0) return fail(ErrorCode::missing_value, "there are no faces in it");
    return out;
}

} // namespace core
