#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// The vertices and faces of a mesh file in text form, each number known to be one, and nothing
/// else.
struct MeshText {
    std::string text;
    size_t vertices = 0; // of an STL: 0
    size_t faces = 0;
    size_t degenerate_faces = 0; // of an STL: triangles that name a corner twice, kept in `text`
};

/// Check a file word by word and give it back in the plainest form of its format.
///
/// Errors: the line and what is wrong with it: no number, not finite, an index out of range, a
///         facet that is not complete, no end, no faces. Textures, normals, colours and names are
///         left out unread.
Result<MeshText> checked_ascii_stl(std::string_view bytes);
Result<MeshText> checked_obj(std::string_view bytes);
Result<MeshText> checked_off(std::string_view bytes);

/// The same for a PLY file of any of its three forms, up to its last face.
Result<MeshText> checked_ply(std::string_view bytes);

using Words = std::vector<std::string_view>;
using FloatPoint = std::array<float, 3>;

/// Walks through the lines of a text; gives each as its words.
class LineReader {
public:
    explicit LineReader(std::string_view text) : rest_(text) {}

    /// The words of the next line (perhaps none), cut off at `comment`; false at the end.
    bool next(Words& words, char comment);
    uint32_t line() const { return line_; }
    std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
    uint32_t line_ = 0;
};

/// The word as a finite coordinate that single precision can hold.
std::optional<double> coordinate_of(std::string_view word);
std::optional<int64_t> integer_of(std::string_view word);
bool equals_ignoring_case(std::string_view a, std::string_view b);

/// The error that something is wrong with a line; says its number in the message too.
tl::unexpected<Error> fail_in_line(uint32_t line, const std::string& message);

/// Appends the words `first` .. `first` + 2 to `text` as the coordinates that end a line, and
/// returns them. Errors: name the word that is no coordinate.
Result<FloatPoint> append_point(const Words& words, size_t first, uint32_t line, std::string& text);

/// Faces as a file states them: nothing welded, nothing dropped, nothing joined to a surface.
struct PolygonSoup {
    std::vector<Vec3> vertices;
    std::vector<std::vector<uint32_t>> faces;
};

enum class MeshFormat : uint8_t { stl_ascii, stl_binary, obj, off, ply };

/// Reads the faces of a file whose bytes were checked before (mesh_text.h, stl_bytes.h), through
/// OpenMesh's readers.
///
/// Result: single precision, as OpenMesh reads; triangles of an STL that name a corner twice are
///         left out.
/// Errors: indices out of range, coordinates that are not finite, a stream that ends early.
Result<PolygonSoup> read_soup(const std::string& bytes, MeshFormat format);

/// The faces as triangles. A face with a dent is cut along its own corners, never across the dent.
///
/// Errors: a face whose outline crosses itself.
Result<Mesh> triangulated(PolygonSoup soup);

} // namespace core
