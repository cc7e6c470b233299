#include <fmt/format.h>

#include "core/geom/mesh_text.h"

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
        return fail_in_line(
            line,
            fmt::format("a face refers to vertex {}, but there are {} vertices", *index, vertices));
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
    if (out.faces == 0) return fail(ErrorCode::missing_value, "it has no faces");
    return out;
}

namespace {

class OffReader {
public:
    explicit OffReader(std::string_view bytes) : lines_(bytes) {}

    Result<MeshText> read() {
        FEELER_TRY([[maybe_unused]] const bool header, read_header());
        for (size_t i = 0; i < out_.vertices; ++i) {
            if (!advance()) return ends_early("vertices", i, out_.vertices);
            // What follows the three coordinates is a normal or a colour.
            std::string point;
            FEELER_TRY([[maybe_unused]] const FloatPoint checked,
                       append_point(words_, 0, lines_.line(), point));
            out_.text += point;
        }
        for (size_t i = 0; i < out_.faces; ++i) {
            if (!advance()) return ends_early("faces", i, out_.faces);
            FEELER_TRY([[maybe_unused]] const bool face, read_face());
        }
        if (out_.faces == 0) return fail(ErrorCode::missing_value, "it has no faces");
        return std::move(out_);
    }

private:
    /// Moves to the next line that is not empty.
    bool advance() {
        while (lines_.next(words_, '#'))
            if (!words_.empty()) return true;
        return false;
    }

    tl::unexpected<Error> ends_early(const char* what, size_t found, size_t promised) const {
        return fail_in_line(lines_.line(),
                            fmt::format("the file ends after {} of {} {}", found, promised, what));
    }

    Result<bool> read_header() {
        if (!advance()) return fail(ErrorCode::syntax, "the file is empty");
        const std::string kind(words_[0]);
        if (kind != "OFF" && kind != "COFF" && kind != "NOFF" && kind != "CNOFF")
            return fail_in_line(lines_.line(), fmt::format("'{}' is not a supported OFF header",
                                                           kind.substr(0, 20)));
        if (words_.size() > 1 && words_[1] == "BINARY")
            return fail(ErrorCode::unsupported, "binary OFF is not supported");
        words_.erase(words_.begin());
        if (words_.empty() && !advance())
            return fail_in_line(lines_.line(), "the file ends before its counts");
        FEELER_TRY(out_.vertices, read_count(0));
        FEELER_TRY(out_.faces, read_count(1));
        out_.text = fmt::format("OFF\n{} {} 0\n", out_.vertices, out_.faces);
        return true;
    }

    Result<size_t> read_count(size_t word_index) const {
        const auto count =
            word_index < words_.size() ? integer_of(words_[word_index]) : std::nullopt;
        if (!count || *count < 0 || *count > most_)
            return fail_in_line(lines_.line(), "the counts of vertices and faces are missing");
        return static_cast<size_t>(*count);
    }

    Result<bool> read_face() {
        const auto corners = integer_of(words_[0]);
        if (!corners || *corners < 3)
            return fail_in_line(lines_.line(), fmt::format("a face has '{}' corners", words_[0]));
        if (static_cast<size_t>(*corners) >= words_.size())
            return fail_in_line(lines_.line(), fmt::format("a face of {} corners lists only {}",
                                                           *corners, words_.size() - 1));
        out_.text += fmt::format("{}", *corners);
        for (size_t i = 1; i <= static_cast<size_t>(*corners); ++i) {
            const auto index = integer_of(words_[i]);
            if (!index || *index < 0 || *index >= static_cast<int64_t>(out_.vertices))
                return fail_in_line(lines_.line(),
                                    fmt::format("a face refers to vertex {}, but there are {}, "
                                                "counted from 0",
                                                words_[i], out_.vertices));
            out_.text += fmt::format(" {}", *index);
        }
        out_.text += '\n'; // colours would follow
        return true;
    }

    static constexpr int64_t most_ = 1000000000;
    LineReader lines_;
    Words words_;
    MeshText out_;
};

} // namespace

Result<MeshText> checked_off(std::string_view bytes) { return OffReader(bytes).read(); }

} // namespace core
