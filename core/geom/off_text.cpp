#include <fmt/format.h>

#include "core/geom/mesh_text.h"
#include "core/geom/mesh_words.h"

namespace core {
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
        if (out_.faces == 0) return fail(ErrorCode::missing_value, "there are no faces in it");
        return std::move(out_);
    }

private:
    /// Moves to the next line that says something.
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
            return fail_in_line(lines_.line(), fmt::format("'{}' is no OFF header that is "
                                                           "understood",
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

    Result<size_t> read_count(size_t place) const {
        const auto count = place < words_.size() ? integer_of(words_[place]) : std::nullopt;
        if (!count || *count < 0 || *count > most_)
            return fail_in_line(lines_.line(), "the counts of vertices and faces are not there");
        return static_cast<size_t>(*count);
    }

    Result<bool> read_face() {
        const auto corners = integer_of(words_[0]);
        if (!corners || *corners < 3)
            return fail_in_line(lines_.line(), fmt::format("a face has '{}' corners", words_[0]));
        if (static_cast<size_t>(*corners) >= words_.size())
            return fail_in_line(lines_.line(), fmt::format("a face of {} corners names {}",
                                                           *corners, words_.size() - 1));
        out_.text += fmt::format("{}", *corners);
        for (size_t i = 1; i <= static_cast<size_t>(*corners); ++i) {
            const auto index = integer_of(words_[i]);
            if (!index || *index < 0 || *index >= static_cast<int64_t>(out_.vertices))
                return fail_in_line(lines_.line(),
                                    fmt::format("a face names vertex {}, but there are {}, counted "
                                                "from 0",
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
