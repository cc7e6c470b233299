#include "core/geom/mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "core/base/file_reads.h"
#include "core/base/result.h"
#include "core/base/text.h"
#include "core/base/union_find.h"
#include "core/geom/line_crossing.h"
#include "core/geom/mesh.h"
#include "core/geom/mesh_text.h"

namespace core {

/// The contents of a valid binary STL.
struct StlCount {
    size_t triangles = 0;
    size_t degenerate = 0; // with two equal corners
};

/// Whether the bytes have the length that a binary STL states in its own header.
bool has_length_of_binary_stl(std::string_view bytes);

/// Errors: no triangles, a length that is not 84 + 50 n, a coordinate that is not finite.
Result<StlCount> checked_binary_stl(std::string_view bytes);

namespace {

constexpr size_t header_length = 84;
constexpr size_t triangle_length = 50;

uint32_t stated_count(std::string_view bytes) {
    std::array<unsigned char, 4> b{};
    std::memcpy(b.data(), bytes.data() + 80, 4);
    return uint32_t{b[0]} | uint32_t{b[1]} << 8U | uint32_t{b[2]} << 16U | uint32_t{b[3]} << 24U;
}

size_t stated_length(std::string_view bytes) {
    return header_length + triangle_length * size_t{stated_count(bytes)};
}

using StlCorner = std::array<float, 3>;

StlCorner corner_at(std::string_view bytes, size_t triangle, size_t corner) {
    StlCorner point{};
    std::memcpy(point.data(),
                bytes.data() + header_length + triangle * triangle_length + 12 * (corner + 1), 12);
    return point;
}

bool is_finite_corner(const StlCorner& c) {
    return std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
}

} // namespace

bool has_length_of_binary_stl(std::string_view bytes) {
    return bytes.size() >= header_length && bytes.size() == stated_length(bytes);
}

Result<StlCount> checked_binary_stl(std::string_view bytes) {
    if (bytes.size() < header_length)
        return fail(ErrorCode::syntax,
                    fmt::format("a binary STL has a header of 84 bytes, the file "
                                "{}",
                                bytes.size()));
    const uint32_t count = stated_count(bytes);
    if (bytes.size() != stated_length(bytes))
        return fail(ErrorCode::syntax,
                    fmt::format("its header states {} triangles, which take {} bytes, but the file "
                                "has {}",
                                count, stated_length(bytes), bytes.size()));
    if (count == 0) return fail(ErrorCode::missing_value, "it has no triangles");
    StlCount found{.triangles = count, .degenerate = 0};
    for (size_t i = 0; i < count; ++i) {
        const StlCorner a = corner_at(bytes, i, 0), b = corner_at(bytes, i, 1),
                        c = corner_at(bytes, i, 2);
        if (!is_finite_corner(a) || !is_finite_corner(b) || !is_finite_corner(c))
            return fail(ErrorCode::invalid_value,
                        fmt::format("triangle {} has a coordinate that is not finite", i + 1));
        if (a == b || b == c || c == a) ++found.degenerate;
    }
    return found;
}

namespace {

void turn(Mesh::Corners& triangle) { std::swap(triangle[1], triangle[2]); }

/// Joins the pieces at an edge of more than two uses that use it unequally often in the two
/// directions.
void join_at_edge(std::span<const EdgeUse> uses, UnionFind& pieces) {
    std::map<uint32_t, int> balance;
    for (const EdgeUse& use : uses) balance[pieces.root(use.triangle)] += use.upwards ? 1 : -1;
    std::optional<uint32_t> first;
    for (const auto& [piece, sum] : balance) {
        if (sum == 0) continue;
        if (first) pieces.join(*first, piece);
        first = first.value_or(piece);
    }
}

/// A shell's own triangles, its box and its volume.
struct Shell {
    std::vector<uint32_t> triangles;
    Aabb box;
    double volume = 0.0;
};

std::vector<Shell> collect(const Mesh& mesh, const Shells& shells) {
    std::vector<Shell> all(shells.count);
    const Vec3 origin = mesh.bounds().center();
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Shell& shell = all[shells.of_triangle[i]];
        const Triangle t = mesh.triangle(i);
        shell.triangles.push_back(i);
        for (const Vec3& corner : {t.a, t.b, t.c}) shell.box.extend(corner);
        shell.volume += glm::dot(t.a - origin, glm::cross(t.b - origin, t.c - origin)) / 6.0;
    }
    return all;
}

bool holds(const Aabb& outer, const Aabb& inner) {
    return glm::all(glm::lessThanEqual(outer.min, inner.min))
           && glm::all(glm::lessThanEqual(inner.max, outer.max));
}

/// Whether `inner` is within `outer`, judged by its first triangle.
bool holds(const Mesh& mesh, const Shell& outer, const Shell& inner) {
    if (!(std::abs(outer.volume) > std::abs(inner.volume)) || !holds(outer.box, inner.box))
        return false;
    const Triangle t = mesh.triangle(inner.triangles.front());
    const Vec3 p = (t.a + t.b + t.c) / 3.0;
    int winding = 0;
    for (const uint32_t i : outer.triangles) {
        const ProjectedTriangle flat = project(mesh.triangle(i), 0);
        const int step = crossing_step(flat, Vec2(p.y, p.z));
        if (step != 0 && crossing_depth(flat, Vec2(p.y, p.z)) < p.x) winding += step;
    }
    return winding != 0;
}

/// The outermost shell around this one; `shell` itself if there is none around it.
uint32_t outermost_around(const Mesh& mesh, const std::vector<Shell>& shells, uint32_t shell) {
    uint32_t outermost = shell;
    for (uint32_t i = 0; i < shells.size(); ++i)
        if (std::abs(shells[i].volume) > std::abs(shells[outermost].volume)
            && holds(mesh, shells[i], shells[shell]))
            outermost = i;
    return outermost;
}

} // namespace

std::vector<EdgeUse> edge_uses(const Mesh& mesh) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t from = mesh.triangles[i][k], to = mesh.triangles[i][(k + 1) % 3];
            uses.push_back({std::min(from, to), std::max(from, to), i, from < to});
        }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return uses;
}

size_t end_of_edge(const std::vector<EdgeUse>& uses, size_t first) {
    size_t last = first;
    while (last < uses.size() && uses[last].low == uses[first].low
           && uses[last].high == uses[first].high)
        ++last;
    return last;
}

Shells shells_of(const Mesh& mesh) {
    const std::vector<EdgeUse> uses = edge_uses(mesh);
    UnionFind pieces(mesh.triangles.size());
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        end = end_of_edge(uses, i);
        if (end - i == 2) pieces.join(uses[i].triangle, uses[i + 1].triangle);
    }
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        end = end_of_edge(uses, i);
        if (end - i > 2) join_at_edge(std::span(uses).subspan(i, end - i), pieces);
    }
    Shells shells;
    std::vector<uint32_t> number(mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint32_t root = pieces.root(i);
        if (root == i) number[i] = shells.count++;
        shells.of_triangle.push_back(number[root]);
    }
    return shells;
}

size_t turn_to_agree(Mesh& mesh) {
    struct Neighbour {
        uint32_t triangle;
        bool agrees;
    };
    std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
    const std::vector<EdgeUse> uses = edge_uses(mesh);
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        end = end_of_edge(uses, i);
        if (end - i != 2) continue;
        const bool agrees = uses[i].upwards != uses[i + 1].upwards;
        neighbours[uses[i].triangle].push_back({uses[i + 1].triangle, agrees});
        neighbours[uses[i + 1].triangle].push_back({uses[i].triangle, agrees});
    }
    enum class State : uint8_t { unseen, stays, turned };
    std::vector<State> state(mesh.triangles.size(), State::unseen);
    size_t turned = 0;
    for (uint32_t first = 0; first < state.size(); ++first) {
        if (state[first] != State::unseen) continue;
        state[first] = State::stays;
        for (std::vector<uint32_t> open = {first}; !open.empty();) {
            const uint32_t at = open.back();
            open.pop_back();
            for (const Neighbour& next : neighbours[at]) {
                if (state[next.triangle] != State::unseen) continue;
                const bool turns = (state[at] == State::turned) == next.agrees;
                state[next.triangle] = turns ? State::turned : State::stays;
                if (turns) turn(mesh.triangles[next.triangle]);
                turned += turns;
                open.push_back(next.triangle);
            }
        }
    }
    return turned;
}

size_t turn_outwards(Mesh& mesh) {
    const Shells numbers = shells_of(mesh);
    const std::vector<Shell> shells = collect(mesh, numbers);
    std::vector<uint32_t> to_turn;
    for (uint32_t i = 0; i < shells.size(); ++i)
        if (shells[outermost_around(mesh, shells, i)].volume < 0.0) to_turn.push_back(i);
    for (const uint32_t i : to_turn)
        for (const uint32_t triangle : shells[i].triangles) turn(mesh.triangles[triangle]);
    return to_turn.size();
}

namespace {

constexpr double farthest_coordinate = 1e6; // mm; no workpiece is a kilometre long

std::string position_text(const Vec3& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

Result<bool> check_coordinates(const Mesh& mesh) {
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        for (const uint32_t corner : mesh.triangles[i]) {
            if (corner >= mesh.vertices.size())
                return fail(
                    ErrorCode::invalid_value,
                    fmt::format("triangle {} refers to vertex {}, but there are {}, counted "
                                "from 0",
                                i + 1, corner, mesh.vertices.size()));
            const Vec3& p = mesh.vertices[corner];
            if (!is_finite(p))
                return fail(ErrorCode::invalid_value,
                            fmt::format("triangle {} has a coordinate that is not finite", i + 1));
            if (glm::any(glm::greaterThan(glm::abs(p), Vec3(farthest_coordinate))))
                return fail(ErrorCode::invalid_value,
                            fmt::format("triangle {} is at {} mm, more than a kilometre away",
                                        i + 1, position_text(p)));
        }
    return true;
}

/// The mesh with coinciding corners shared and unused ones left out.
Mesh welded(const Mesh& mesh) {
    std::vector<uint32_t> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), uint32_t{0});
    const auto key = [&](uint32_t i) {
        const Vec3& p = mesh.vertices[i];
        return std::tie(p.x, p.y, p.z);
    };
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
    std::vector<uint32_t> same(mesh.vertices.size()); // the least index with the same position
    for (size_t i = 0; i < order.size(); ++i)
        same[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];

    Mesh out;
    std::vector<uint32_t> index_of(mesh.vertices.size(), UINT32_MAX);
    for (Mesh::Corners triangle : mesh.triangles) {
        for (uint32_t& corner : triangle) {
            uint32_t& kept = index_of[same[corner]];
            if (kept == UINT32_MAX) {
                kept = static_cast<uint32_t>(out.vertices.size());
                out.vertices.push_back(mesh.vertices[same[corner]] + Vec3(0.0)); // no -0
            }
            corner = kept;
        }
        out.triangles.push_back(triangle);
    }
    return out;
}

size_t drop_degenerate(Mesh& mesh) {
    return std::erase_if(mesh.triangles, [](const Mesh::Corners& t) {
        return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    });
}

/// The number of edges with an odd number of triangles, and of edges not used equally often in both
/// directions.
struct EdgeCount {
    size_t open = 0;
    size_t unbalanced = 0;
    EdgeUse an_open_one{};
    EdgeUse an_unbalanced_one{};
};

EdgeCount count_edges(const Mesh& mesh) {
    const std::vector<EdgeUse> uses = edge_uses(mesh);
    EdgeCount count;
    for (size_t i = 0, end = 0; i < uses.size(); i = end) {
        end = end_of_edge(uses, i);
        int balance = 0;
        for (size_t k = i; k < end; ++k) balance += uses[k].upwards ? 1 : -1;
        if ((end - i) % 2 != 0 && count.open++ == 0) count.an_open_one = uses[i];
        if (balance != 0 && count.unbalanced++ == 0) count.an_unbalanced_one = uses[i];
    }
    return count;
}

tl::unexpected<Error> fail_at_edge(const Mesh& mesh, size_t edges, const char* what,
                                   const EdgeUse& at) {
    return fail(ErrorCode::invalid_value,
                fmt::format("the mesh is not closed: {} {}, one of them from {} to {}", edges, what,
                            position_text(mesh.vertices[at.low]),
                            position_text(mesh.vertices[at.high])));
}

/// Errors unless every edge is used equally often in both directions; flips triangles if that
/// helps.
Result<bool> close(Mesh& mesh, std::vector<std::string>& repairs) {
    EdgeCount count = count_edges(mesh);
    if (count.open > 0)
        return fail_at_edge(mesh, count.open, "edges have no second triangle", count.an_open_one);
    if (count.unbalanced == 0) return true;
    const size_t turned = turn_to_agree(mesh);
    count = count_edges(mesh);
    if (count.unbalanced > 0)
        return fail_at_edge(mesh, count.unbalanced, "edges join triangles that face opposite ways",
                            count.an_unbalanced_one);
    repairs.push_back(
        fmt::format("{} triangles faced opposite to their neighbours and were flipped", turned));
    return true;
}

} // namespace

Result<Mesh> checked_solid(Mesh mesh, std::vector<std::string>& repairs) {
    if (mesh.triangles.empty()) return fail(ErrorCode::missing_value, "it has no triangles");
    FEELER_TRY([[maybe_unused]] const bool in_range, check_coordinates(mesh));
    mesh = welded(mesh);
    if (const size_t dropped = drop_degenerate(mesh); dropped > 0)
        repairs.push_back(fmt::format("{} triangles with two equal corners were removed", dropped));
    mesh = welded(mesh); // without the corners of the removed triangles
    FEELER_TRY([[maybe_unused]] const bool closed, close(mesh, repairs));
    if (const size_t turned = turn_outwards(mesh); turned > 0)
        repairs.push_back(fmt::format("{} of its shells faced inwards and were flipped", turned));
    const double longest = glm::length(mesh.bounds().size());
    if (mesh.triangles.empty() || !(signed_volume(mesh) > 1e-12 * longest * longest * longest))
        return fail(ErrorCode::invalid_value, "the mesh encloses no volume");
    return mesh;
}

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
                    fmt::format("the file has {} bytes; the limit is 2 GiB", size));
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
    const std::string extension = lower_case(path.extension().generic_string());
    if (extension == ".stl")
        return is_text_stl(bytes) ? MeshFormat::stl_ascii : MeshFormat::stl_binary;
    if (extension == ".obj") return MeshFormat::obj;
    if (extension == ".off") return MeshFormat::off;
    if (extension == ".ply") return MeshFormat::ply;
    return fail(
        ErrorCode::unsupported,
        fmt::format("'{}' is not the ending of a mesh or CAD file (stl, obj, ply, off, step, "
                    "stp, p21, iges, igs, brep, brp, FCStd)",
                    extension));
}

/// The input of OpenMesh, and the expected counts.
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

/// The soup, checked to be complete.
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

Result<MeshFile> read_solid(const std::filesystem::path& path, std::string bytes) {
    FEELER_TRY(const MeshFormat format, format_of(path, bytes));
    FEELER_TRY(const MeshText plain, plain_form(std::move(bytes), format));
    FEELER_TRY(PolygonSoup soup, complete_soup(plain, format));
    MeshFile file;
    if (plain.degenerate_faces > 0)
        file.repairs.push_back(fmt::format("{} triangles with two equal corners were removed",
                                           plain.degenerate_faces));
    FEELER_TRY(Mesh triangles, triangulated(std::move(soup)));
    FEELER_TRY(file.mesh, checked_solid(std::move(triangles), file.repairs));
    return file;
}

} // namespace

namespace {

/// The error with the file in its message, which has the line already: `where` would repeat it.
Error about(Error error, const std::filesystem::path& path) {
    error.message = fmt::format("{}: {}", path.generic_string(), error.message);
    error.file = path.generic_string();
    error.where = {};
    return error;
}

} // namespace

Result<std::string> read_mesh_bytes(const std::filesystem::path& path) {
    return read_bytes(path).map_error([&](Error error) { return about(std::move(error), path); });
}

Result<MeshFile> read_mesh(const std::filesystem::path& path, std::string bytes) {
    return read_solid(path, std::move(bytes)).map_error([&](Error error) {
        return about(std::move(error), path);
    });
}

Result<MeshFile> read_mesh(const std::filesystem::path& path) {
    FEELER_TRY(std::string bytes, read_mesh_bytes(path));
    return read_mesh(path, std::move(bytes));
}

} // namespace core
