#include <array>

#include <fmt/format.h>

#include "core/geom/mesh_text.h"

namespace core {
namespace {

/// Reads the words of an ASCII STL, independent of line breaks.
class StlReader {
public:
    explicit StlReader(std::string_view bytes) : lines_(bytes) {}

    Result<MeshText> read() {
        while (advance()) {
            FEELER_TRY([[maybe_unused]] const bool solid, expect("solid"));
            skip_line();
            for (;;) {
                if (!advance())
                    return fail_in_line(lines_.line(), "the file ends without 'endsolid'");
                if (equals_ignoring_case(word(), "endsolid")) break;
                FEELER_TRY([[maybe_unused]] const bool facet, read_facet());
            }
            skip_line();
        }
        if (out_.faces == 0) return fail(ErrorCode::missing_value, "it has no triangles");
        return std::move(out_);
    }

private:
    /// Moves to the next word; false at the end of the file.
    bool advance() {
        ++at_;
        while (at_ >= words_.size()) {
            if (!lines_.next(words_, '\0')) return false;
            at_ = 0;
        }
        return true;
    }
    std::string_view word() const { return words_[at_]; }
    void skip_line() { at_ = words_.size(); }

    Result<bool> expect(std::string_view expected) const {
        if (equals_ignoring_case(word(), expected)) return true;
        return fail_in_line(lines_.line(),
                            fmt::format("found '{}' where '{}' is expected (triangle {})", word(),
                                        expected, out_.faces + 1));
    }
    Result<bool> expect_next(std::string_view expected) {
        if (advance()) return expect(expected);
        return fail_in_line(lines_.line(), fmt::format("the file ends in triangle {}, before '{}'",
                                                       out_.faces + 1, expected));
    }

    Result<bool> read_facet() {
        FEELER_TRY([[maybe_unused]] const bool facet, expect("facet"));
        FEELER_TRY([[maybe_unused]] const bool normal, expect_next("normal"));
        for (int i = 0; i < 3; ++i)
            advance(); // normals are ignored: readers recompute them, and they are often nan
        FEELER_TRY([[maybe_unused]] const bool outer, expect_next("outer"));
        FEELER_TRY([[maybe_unused]] const bool loop, expect_next("loop"));
        out_.text += "facet normal 0 0 0\nouter loop\n";
        std::array<FloatPoint, 3> corners{};
        for (FloatPoint& corner : corners) {
            FEELER_TRY([[maybe_unused]] const bool vertex, expect_next("vertex"));
            FEELER_TRY(corner, read_point());
        }
        FEELER_TRY([[maybe_unused]] const bool endloop, expect_next("endloop"));
        FEELER_TRY([[maybe_unused]] const bool endfacet, expect_next("endfacet"));
        out_.text += "endloop\nendfacet\n";
        ++out_.faces;
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            ++out_.degenerate_faces;
        return true;
    }

    Result<FloatPoint> read_point() {
        Words coordinates;
        for (int i = 0; i < 3 && advance(); ++i) coordinates.push_back(word());
        out_.text += "vertex";
        return append_point(coordinates, 0, lines_.line(), out_.text);
    }

    LineReader lines_;
    Words words_;
    size_t at_ = 0;
    MeshText out_;
};

} // namespace

Result<MeshText> checked_ascii_stl(std::string_view bytes) { return StlReader(bytes).read(); }

} // namespace core
