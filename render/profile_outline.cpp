#include "render/profile_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace render {
namespace {

constexpr double tiny = 1e-9; // mm

using Outline = std::vector<OutlinePoint>;

/// An arc about (r, z), angles from the radial direction upwards.
struct Arc {
    double r, z, radius, from, to;
};

void add_arc(Outline& outline, const Arc& arc, double sag) {
    const double step =
        2.0 * std::acos(std::clamp(1.0 - sag / std::max(arc.radius, sag), 0.0, 1.0));
    const double turn = arc.to - arc.from;
    const int chords =
        std::max(1, static_cast<int>(std::ceil(turn / std::clamp(step, 0.03, 0.25))));
    for (int i = 0; i <= chords; ++i) {
        const double angle = arc.from + turn * i / chords;
        outline.push_back({std::max(0.0, arc.r + arc.radius * std::cos(angle)),
                           arc.z + arc.radius * std::sin(angle)});
    }
}

/// The outline of one piece without the flat faces at its ends; heights do not decrease.
Outline outline_of(const core::ProfileElement& e, double sag) {
    if (e.margin <= 0.0) return {{e.r0, e.z0}, {e.r1, e.z1}};
    const double flank = std::atan2(-(e.r1 - e.r0), e.z1 - e.z0);
    Outline outline;
    add_arc(outline, {e.r0, e.z0, e.margin, -0.5 * std::numbers::pi, flank}, sag);
    add_arc(outline, {e.r1, e.z1, e.margin, flank, 0.5 * std::numbers::pi}, sag);
    return outline;
}

/// A straight stretch of an outline between two heights.
struct Line {
    double r0, r1;
};

/// What a piece has between two heights at which none of its stretches begins or ends.
std::optional<Line> line_between(const Outline& outline, double z0, double z1) {
    const double middle = 0.5 * (z0 + z1);
    for (size_t i = 1; i < outline.size(); ++i) {
        const OutlinePoint &a = outline[i - 1], &b = outline[i];
        if (!(a.z < middle && middle < b.z)) continue;
        const double slope = (b.r - a.r) / (b.z - a.z);
        return Line{a.r + slope * (z0 - a.z), a.r + slope * (z1 - a.z)};
    }
    return std::nullopt;
}

std::vector<double> sorted_once(std::vector<double> heights) {
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end(),
                              [](double a, double b) { return b - a < tiny; }),
                  heights.end());
    return heights;
}

/// All heights at which the outline of the union may bend.
std::vector<double> bends(const std::vector<Outline>& pieces) {
    std::vector<double> heights;
    for (const Outline& piece : pieces)
        for (const OutlinePoint& p : piece) heights.push_back(p.z);
    heights = sorted_once(std::move(heights));
    std::vector<double> crossings = heights;
    for (size_t i = 1; i < heights.size(); ++i) {
        const double z0 = heights[i - 1], z1 = heights[i];
        std::vector<Line> lines;
        for (const Outline& piece : pieces)
            if (const auto line = line_between(piece, z0, z1)) lines.push_back(*line);
        for (size_t a = 0; a < lines.size(); ++a)
            for (size_t b = a + 1; b < lines.size(); ++b) {
                const double low = lines[a].r0 - lines[b].r0, high = lines[a].r1 - lines[b].r1;
                if (low * high < 0.0) crossings.push_back(z0 + (z1 - z0) * low / (low - high));
            }
    }
    return sorted_once(std::move(crossings));
}

void add(Outline& outline, const OutlinePoint& p) {
    if (!outline.empty() && std::abs(outline.back().r - p.r) < tiny
        && std::abs(outline.back().z - p.z) < tiny)
        return;
    // A point between two others on the same line says nothing.
    while (outline.size() >= 2) {
        const OutlinePoint &a = outline[outline.size() - 2], &b = outline.back();
        const double cross = (b.r - a.r) * (p.z - a.z) - (b.z - a.z) * (p.r - a.r);
        const double along = (b.r - a.r) * (p.r - b.r) + (b.z - a.z) * (p.z - b.z);
        if (std::abs(cross) > tiny * std::hypot(p.r - a.r, p.z - a.z) || along < 0.0) break;
        outline.pop_back();
    }
    outline.push_back(p);
}

} // namespace

std::vector<OutlinePoint> outline_of(const core::RevolvedProfile& profile, double sag) {
    std::vector<Outline> pieces;
    for (const core::ProfileElement& e : profile.elements) pieces.push_back(outline_of(e, sag));
    const std::vector<double> heights = bends(pieces);
    Outline outline;
    for (size_t i = 1; i < heights.size(); ++i) {
        Line widest{0.0, 0.0};
        for (const Outline& piece : pieces) {
            const auto line = line_between(piece, heights[i - 1], heights[i]);
            if (line && line->r0 + line->r1 > widest.r0 + widest.r1) widest = *line;
        }
        if (outline.empty()) add(outline, {0.0, heights[i - 1]});
        add(outline, {std::max(widest.r0, 0.0), heights[i - 1]});
        add(outline, {std::max(widest.r1, 0.0), heights[i]});
    }
    if (!outline.empty()) add(outline, {0.0, heights.back()});
    return outline;
}

} // namespace render
