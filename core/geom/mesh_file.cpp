#include "core/geom/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "core/geom/mesh_check.h"
#include "core/geom/mesh_text.h"
#include "core/geom/polygon_soup.h"
#include "core/geom/stl_bytes.h"

namespace core {
namespace {

constexpr uintmax_t largest_file = uintmax_t{2} << 30U; // bytes

Result<std::string> read_bytes(const std::filesystem::path& path) {
    if (const std::string why = why_no_file(path); !why.empty()) return fail(ErrorCode::io, why);
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    if (error) return fail(ErrorCode::io, error.message());
    if (size == 0) return fail(ErrorCode::syntax, "the file is empty");
    if (size > largest_file)
        return fail(ErrorCode::unsupported,
                    fmt::format("the file has {} bytes; meshes up to 2 GiB are read", size));
    std::optional<std::string> bytes = file_bytes(path);
    if (!bytes || bytes->size() < size) return fail(ErrorCode::io, "the file cannot be read");
    return *std::move(bytes);
}

bool is_text_stl(std::string_view bytes) {
    if (has_length_of_binary_stl(bytes)) return false; // some of them begin with "solid", too
    const size_t first = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
    const bool text = bytes.find('\0') == std::string_view::npos;
    return text && bytes.substr(first, 5) == "solid";
}

Result<MeshFormat> format_of(const std::filesystem::path& path, std::string_view bytes) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".stl")
        return is_text_stl(bytes) ? MeshFormat::stl_ascii : MeshFormat::stl_binary;
    if (extension == ".obj") return MeshFormat::obj;
    if (extension == ".off") return MeshFormat::off;
    if (extension == ".ply") return MeshFormat::ply;
    return fail(ErrorCode::unsupported,
                fmt::format("'{}' is no mesh format that is read (stl, obj, ply, off)", extension));
}

/// What OpenMesh is given to read, and how much it must find there.
Result<MeshText> plain_form(std::string bytes, MeshFormat format) {
    switch (format) {
    case MeshFormat::stl_ascii:
        return checked_ascii_stl(bytes);
    case MeshFormat::obj:
        return checked_obj(bytes);
    case MeshFormat::off:
        return checked_off(bytes);
    case MeshFormat::ply:
        return checked_ply(bytes);
    case MeshFormat::stl_binary:
        break;
    }
    FEELER_TRY(const StlCount count, checked_binary_stl(bytes));
    return MeshText{std::move(bytes), 0, count.triangles, count.degenerate};
}

/// The soup, known to hold all that the file states.
Result<PolygonSoup> complete_soup(const MeshText& plain, MeshFormat format) {
    FEELER_TRY(PolygonSoup soup, read_soup(plain.text, format));
    const size_t faces = plain.faces - plain.degenerate_faces;
    if (soup.faces.size() != faces)
        return fail(ErrorCode::unsupported,
                    fmt::format("only {} of its {} faces could be read", soup.faces.size(), faces));
    const bool is_stl = format == MeshFormat::stl_ascii || format == MeshFormat::stl_binary;
    if (!is_stl && soup.vertices.size() != plain.vertices)
        return fail(ErrorCode::unsupported, fmt::format("only {} of its {} vertices could be read",
                                                        soup.vertices.size(), plain.vertices));
    return soup;
}

Result<MeshFile> read_solid(const std::filesystem::path& path) {
    FEELER_TRY(std::string bytes, read_bytes(path));
    FEELER_TRY(const MeshFormat format, format_of(path, bytes));
    FEELER_TRY(const MeshText plain, plain_form(std::move(bytes), format));
    FEELER_TRY(PolygonSoup soup, complete_soup(plain, format));
    MeshFile file;
    if (plain.degenerate_faces > 0)
        file.repairs.push_back(fmt::format("{} triangles that name a corner twice were left out",
                                           plain.degenerate_faces));
    FEELER_TRY(Mesh triangles, triangulated(std::move(soup)));
    FEELER_TRY(file.mesh, checked_solid(std::move(triangles), file.repairs));
    return file;
}

} // namespace

Result<MeshFile> read_mesh(const std::filesystem::path& path) {
    return read_solid(path).map_error([&](Error error) {
        error.message = fmt::format("{}: {}", path.string(), error.message);
        error.file = path.string();
        return error;
    });
}

} // namespace core
