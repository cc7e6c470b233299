#include "core/sim/part_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/union_find.h"
#include "core/dbm/cut_model.h"
#include "core/dbm/stock_mesh.h"
#include "core/dbm/stock_record.h"
#include "core/geom/triangle_distance.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"

namespace core {
namespace {

/// Maximum number of samples on the part; a larger part is sampled more coarsely.
constexpr double most_samples = 4e6;

struct Worst {
    double amount = 0.0;
    Vec3 position = Vec3(0.0);

    void offer(double found, const Vec3& where) {
        if (found > amount) *this = {found, where};
    }
};

class Comparison {
public:
    Comparison(const CutModel& stock, const StockMesh& surface, const Part& part)
        : stock_(stock),
          surface_(surface),
          part_(part),
          worst_{std::vector<Worst>(surface.samples.size()),
                 std::vector<Worst>(surface.samples.size())} {}

    PartComparison run() {
        if (surface_.samples.empty()) {
            add_whole_part();
            return std::move(result_);
        }
        measure_stock();
        measure_part();
        for (const Deviation kind : {Deviation::gouge, Deviation::excess}) add_regions(kind);
        colour_vertices();
        return std::move(result_);
    }

private:
    std::vector<Worst>& worst(Deviation kind) { return worst_[static_cast<size_t>(kind)]; }

    const Mesh::Corners& triangle(size_t sample, size_t half) const {
        return surface_.mesh.triangles[2 * sample + half];
    }

    void add_whole_part();
    void measure_stock();
    void measure_part();
    void measure_within(const Triangle& whole, double spacing, SurfaceTracker& tracker);
    void measure_part_at(const Vec3& position, SurfaceTracker& tracker);
    double spacing_of_samples() const;
    bool has_matter_near(const Vec3& position) const;
    void add_regions(Deviation kind);
    void colour_vertices();
    double area(size_t sample) const;

    const CutModel& stock_;
    const StockMesh& surface_;
    const Part& part_;
    SolidMesh stock_solid_;
    std::array<std::vector<Worst>, 2> worst_; // for each sample of the stock, by kind
    PartComparison result_;

    std::optional<uint32_t> block_of(size_t sweep) const;
};

/// The block that made a cut; empty if it belongs to an earlier program.
std::optional<uint32_t> Comparison::block_of(size_t sweep) const {
    const uint32_t block = stock_.log.block(sweep);
    return block == earlier_block ? std::nullopt : std::optional(block);
}

/// No stock is left to measure to: the whole part is missing.
void Comparison::add_whole_part() {
    const Aabb box = part_.solid.mesh->bounds();
    DeviationRegion region;
    region.amount = result_.largest_gouge = glm::length(box.size());
    region.position = box.center();
    if (stock_.log.size() > 0) region.block = block_of(stock_.log.size() - 1);
    result_.regions.push_back(region);
}

void Comparison::measure_stock() {
    SurfaceTracker tracker(*part_.solid.bvh);
    for (size_t k = 0; k < surface_.samples.size(); ++k) {
        const Vec3& position = surface_.samples[k].position;
        const double away = tracker.at(position).distance;
        for (size_t half = 0; half < 2; ++half)
            for (const uint32_t corner : triangle(k, half))
                result_.between_samples =
                    std::max(result_.between_samples,
                             glm::distance(position, surface_.mesh.vertices[corner]));
        if (away <= resolution) continue;
        const Deviation kind = holds(part_.solid, position) ? Deviation::gouge : Deviation::excess;
        worst(kind)[k].offer(away, position);
    }
    result_.samples += surface_.samples.size();
}

double longest_side(const Triangle& t) {
    return std::max({glm::distance(t.a, t.b), glm::distance(t.b, t.c), glm::distance(t.c, t.a)});
}

/// About a mesh size, or more if that makes too many samples. Halving divides a triangle into at
/// most eight times its area over the square of the spacing, plus a number proportional to its
/// longest side.
double Comparison::spacing_of_samples() const {
    const double h = stock_.lines.grid.spacing;
    double count = 0.0;
    for (size_t i = 0; i < part_.solid.mesh->triangles.size(); ++i) {
        const Triangle t = part_.solid.mesh->triangle(i);
        const double twice_area = glm::length(glm::cross(t.b - t.a, t.c - t.a));
        count += 4.0 * twice_area / (h * h) + 2.0 * longest_side(t) / h;
    }
    return h * std::max(1.0, std::sqrt(count / most_samples));
}

void Comparison::measure_part() {
    stock_solid_ = solid_mesh(surface_.mesh);
    SurfaceTracker tracker(*stock_solid_.bvh);
    const double spacing = spacing_of_samples();
    for (size_t i = 0; i < part_.solid.mesh->triangles.size(); ++i) {
        const Triangle t = part_.solid.mesh->triangle(i);
        for (const Vec3& corner : {t.a, t.b, t.c}) measure_part_at(corner, tracker);
        measure_within(t, spacing, tracker);
    }
}

/// Halves the triangle across its longest side until that is at most `spacing`, and measures at all
/// corners of the pieces.
void Comparison::measure_within(const Triangle& whole, double spacing, SurfaceTracker& tracker) {
    std::vector<Triangle> open = {whole};
    while (!open.empty()) {
        Triangle t = open.back();
        open.pop_back();
        const double longest = longest_side(t);
        // A point of a triangle is no farther from its nearest corner than longest side / sqrt 3.
        if (longest <= spacing) {
            result_.between_samples = std::max(result_.between_samples, longest / std::sqrt(3.0));
            continue;
        }
        if (glm::distance(t.b, t.c) == longest)
            t = {t.b, t.c, t.a};
        else if (glm::distance(t.c, t.a) == longest)
            t = {t.c, t.a, t.b};
        const Vec3 middle = 0.5 * (t.a + t.b);
        measure_part_at(middle, tracker);
        open.push_back({t.a, middle, t.c});
        open.push_back({middle, t.b, t.c});
    }
}

void Comparison::measure_part_at(const Vec3& position, SurfaceTracker& tracker) {
    ++result_.samples;
    const NearestSurface nearest = tracker.at(position);
    if (nearest.distance <= part_.limit() || holds(stock_solid_, position)) return;
    // Between scan lines the mesh of the stock deviates from the true surface; the cuts are exact.
    if (has_matter_near(position)) return;
    worst(Deviation::gouge)[nearest.triangle / 2].offer(nearest.distance, position);
}

/// Whether there is material within the tolerance of a point, on nine lines along Z around it.
bool Comparison::has_matter_near(const Vec3& position) const {
    const ScanGrid& grid = stock_.lines.grid;
    const auto cell = [&](const Vec3& at, int axis) {
        const double line = (at[axis] - grid.coordinate(axis, 0)) / grid.spacing;
        return static_cast<int>(
            std::clamp(std::floor(line) + 1.0, 0.0, static_cast<double>(grid.count(axis))));
    };
    for (const double x : {0.0, -0.6, 0.6})
        for (const double y : {0.0, -0.6, 0.6}) {
            const double up = part_.limit() * std::sqrt(1.0 - x * x - y * y);
            const Vec3 at = position + part_.limit() * Vec3(x, y, 0.0);
            for (const Interval& matter : fresh_line(stock_, cell(at, 0), cell(at, 1), at.x, at.y))
                if (matter.lower <= at.z + up && matter.upper >= at.z - up) return true;
        }
    return false;
}

double Comparison::area(size_t sample) const {
    double sum = 0.0;
    for (size_t half = 0; half < 2; ++half) {
        const Triangle t = surface_.mesh.triangle(2 * sample + half);
        sum += 0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a));
    }
    return sum;
}

/// Samples that deviate by more than the tolerance are in the same region if their triangles share
/// corners.
void Comparison::add_regions(Deviation kind) {
    UnionFind groups(surface_.mesh.vertices.size());
    const auto is_off = [&](size_t k) {
        return worst(kind)[k].amount > part_.limit() + resolution;
    };
    double& largest = kind == Deviation::gouge ? result_.largest_gouge : result_.largest_excess;
    for (size_t k = 0; k < surface_.samples.size(); ++k) {
        largest = std::max(largest, worst(kind)[k].amount);
        if (!is_off(k)) continue;
        for (size_t half = 0; half < 2; ++half)
            for (const uint32_t corner : triangle(k, half)) groups.join(corner, triangle(k, 0)[0]);
    }
    std::map<uint32_t, DeviationRegion> regions;
    for (size_t k = 0; k < surface_.samples.size(); ++k) {
        if (!is_off(k)) continue;
        DeviationRegion& region = regions[groups.root(triangle(k, 0)[0])];
        region.kind = kind;
        region.area += area(k);
        if (worst(kind)[k].amount <= region.amount) continue;
        region.amount = worst(kind)[k].amount;
        region.position = worst(kind)[k].position;
    }
    // Of points with about the same deviation, a cut one is more informative than raw stock, and a
    // later cut more than an earlier one.
    std::map<uint32_t, uint32_t> sweeps;
    for (size_t k = 0; k < surface_.samples.size(); ++k) {
        const auto& sweep = surface_.samples[k].sweep;
        if (!sweep || !is_off(k)) continue;
        const uint32_t at = groups.root(triangle(k, 0)[0]);
        if (worst(kind)[k].amount < 0.99 * regions[at].amount) continue;
        uint32_t& last = sweeps.try_emplace(at, *sweep).first->second;
        last = std::max(last, *sweep);
    }
    for (const auto& [at, sweep] : sweeps) regions[at].block = block_of(sweep);
    const size_t first = result_.regions.size();
    for (const auto& [at, region] : regions) result_.regions.push_back(region);
    std::stable_sort(result_.regions.begin() + static_cast<std::ptrdiff_t>(first),
                     result_.regions.end(),
                     [](const auto& a, const auto& b) { return a.amount > b.amount; });
}

void Comparison::colour_vertices() {
    result_.deviations.assign(surface_.mesh.vertices.size(), 0.0);
    for (const Deviation kind : {Deviation::excess, Deviation::gouge}) {
        const double sign = kind == Deviation::gouge ? -1.0 : 1.0;
        for (size_t k = 0; k < surface_.samples.size(); ++k)
            for (size_t half = 0; half < 2; ++half)
                for (const uint32_t corner : triangle(k, half)) {
                    double& known = result_.deviations[corner];
                    if (worst(kind)[k].amount > std::abs(known))
                        known = sign * worst(kind)[k].amount;
                }
    }
}

} // namespace

const char* name_of(Deviation deviation) {
    return deviation == Deviation::gouge ? "gouge" : "excess";
}

PartComparison compare_with_part(const CutModel& stock, const StockMesh& surface,
                                 const Part& part) {
    return Comparison(stock, surface, part).run();
}

} // namespace core
