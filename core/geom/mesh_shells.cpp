#include "core/geom/mesh_shells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>

#include "core/base/union_find.h"
#include "core/geom/line_crossing.h"

namespace core {
namespace {

void turn(Mesh::Corners& triangle) { std::swap(triangle[1], triangle[2]); }

/// Joins the pieces that need each other at an edge of more than two uses: those that do not pass
/// it as often one way as the other.
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

/// Whether `inner`, by its first triangle, lies within `outer`.
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

/// The shell around this one that has none around itself; `shell` if nothing is around it.
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

} // namespace core
