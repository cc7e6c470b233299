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

/// The vertices and faces of a mesh file as text; all numbers are valid, everything else is left
/// out.
struct MeshText {
    std::string text;
    size_t vertices = 0; // 0 for STL
    size_t faces = 0;
    size_t degenerate_faces = 0; // STL only: triangles that use a vertex twice, kept in `text`
};

/// Check a file word by word and return it in the simplest form of its format.
///
/// Errors:  the line and the problem: not a number, not finite, an index out of range, an
///          incomplete facet, a missing end, no faces. Textures, normals, colours and names are
///          skipped.
Result<MeshText> checked_ascii_stl(std::string_view bytes);
Result<MeshText> checked_obj(std::string_view bytes);
Result<MeshText> checked_off(std::string_view bytes);

/// Checks a PLY file in any of its three forms, up to its last face, in the same way.
Result<MeshText> checked_ply(std::string_view bytes);

using Words = std::vector<std::string_view>;
using FloatPoint = std::array<float, 3>;

/// Reads a text line by line as words.
class LineReader {
public:
    explicit LineReader(std::string_view text) : rest_(text) {}

    /// The words of the next line (may be empty), up to `comment`; false at the end.
    bool next(Words& words, char comment);
    uint32_t line() const { return line_; }
    std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
    uint32_t line_ = 0;
};

/// The word as a finite coordinate within the range of single precision.
std::optional<double> coordinate_of(std::string_view word);
std::optional<int64_t> integer_of(std::string_view word);
bool equals_ignoring_case(std::string_view a, std::string_view b);

/// An error in a line, with the line number also in the message.
tl::unexpected<Error> fail_in_line(uint32_t line, const std::string& message);

/// Appends the words `first` .. `first` + 2 to `text` as coordinates that end a line, and returns
/// them. Errors: name the word that is not a coordinate.
Result<FloatPoint> append_point(const Words& words, size_t first, uint32_t line, std::string& text);

/// Faces as stated in a file: no vertices merged, none removed, no surface built.
struct PolygonSoup {
    std::vector<Vec3> vertices;
    std::vector<std::vector<uint32_t>> faces;
};

enum class MeshFormat : uint8_t { stl_ascii, stl_binary, obj, off, ply };

/// Reads the faces of a file that was checked before, through the readers of OpenMesh.
///
/// Result:  single precision, as OpenMesh reads; STL triangles that use a vertex twice are left
///          out.
/// Errors:  indices out of range, coordinates that are not finite, a truncated stream.
Result<PolygonSoup> read_soup(const std::string& bytes, MeshFormat format);

/// The faces as triangles. A concave face is cut within its outline.
///
/// Errors:  a face whose outline crosses itself.
Result<Mesh> triangulated(PolygonSoup soup);

} // namespace core
