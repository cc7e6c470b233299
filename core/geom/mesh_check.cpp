#include "core/geom/mesh_check.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "core/geom/mesh_shells.h"

namespace core {
namespace {

constexpr double farthest_coordinate = 1e6; // mm; a kilometre is no workpiece

std::string place_of(const Vec3& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

Result<bool> check_coordinates(const Mesh& mesh) {
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        for (const uint32_t corner : mesh.triangles[i]) {
            if (corner >= mesh.vertices.size())
                return fail(ErrorCode::invalid_value,
                            fmt::format("triangle {} names vertex {}, but there are {}, counted "
                                        "from 0",
                                        i + 1, corner, mesh.vertices.size()));
            const Vec3& p = mesh.vertices[corner];
            if (!is_finite(p))
                return fail(ErrorCode::invalid_value,
                            fmt::format("triangle {} has a coordinate that is not finite", i + 1));
            if (glm::any(glm::greaterThan(glm::abs(p), Vec3(farthest_coordinate))))
                return fail(ErrorCode::invalid_value,
                            fmt::format("triangle {} lies at {} mm, more than a kilometre away",
                                        i + 1, place_of(p)));
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
    std::vector<uint32_t> same(mesh.vertices.size()); // the least index at the same place
    for (size_t i = 0; i < order.size(); ++i)
        same[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];

    Mesh out;
    std::vector<uint32_t> place(mesh.vertices.size(), UINT32_MAX);
    for (Mesh::Corners triangle : mesh.triangles) {
        for (uint32_t& corner : triangle) {
            uint32_t& kept = place[same[corner]];
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

/// How many edges an odd number of triangles meets, and how many are not passed as often one way as
/// the other.
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
                            place_of(mesh.vertices[at.low]), place_of(mesh.vertices[at.high])));
}

/// Errors unless every edge is passed as often one way as the other; turns triangles if that helps.
Result<bool> close(Mesh& mesh, std::vector<std::string>& repairs) {
    EdgeCount count = count_edges(mesh);
    if (count.open > 0)
        return fail_at_edge(mesh, count.open, "edges have no second triangle", count.an_open_one);
    if (count.unbalanced == 0) return true;
    const size_t turned = turn_to_agree(mesh);
    count = count_edges(mesh);
    if (count.unbalanced > 0)
        return fail_at_edge(mesh, count.unbalanced, "edges have triangles that face both ways",
                            count.an_unbalanced_one);
    repairs.push_back(fmt::format("{} triangles faced the other way than their neighbours and were "
                                  "turned",
                                  turned));
    return true;
}

} // namespace

Result<Mesh> checked_solid(Mesh mesh, std::vector<std::string>& repairs) {
    if (mesh.triangles.empty())
        return fail(ErrorCode::missing_value, "there are no triangles in it");
    FEELER_TRY([[maybe_unused]] const bool in_range, check_coordinates(mesh));
    mesh = welded(mesh);
    if (const size_t dropped = drop_degenerate(mesh); dropped > 0)
        repairs.push_back(
            fmt::format("{} triangles that name a corner twice were left out", dropped));
    mesh = welded(mesh); // without the corners of those
    FEELER_TRY([[maybe_unused]] const bool closed, close(mesh, repairs));
    if (const size_t turned = turn_outwards(mesh); turned > 0)
        repairs.push_back(fmt::format("{} of its shells faced inwards and were turned", turned));
    const double longest = glm::length(mesh.bounds().size());
    if (mesh.triangles.empty() || !(signed_volume(mesh) > 1e-12 * longest * longest * longest))
        return fail(ErrorCode::invalid_value, "the mesh encloses no volume");
    return mesh;
}

} // namespace core
