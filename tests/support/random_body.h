#pragma once

#include <stdexcept>

#include <fmt/format.h>

#include "tests/support/convex_oracle.h"
#include "tests/support/known_body.h"

namespace test_support {

inline double uniform(std::mt19937& rng, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
}

inline bool one_in(std::mt19937& rng, unsigned n) { return rng() % n == 0; }

inline TrueBox box_round(const core::Vec3& at, const core::Vec3& half) {
    return {RealVec(at - half), RealVec(at + half)};
}

inline TrueCapsule ball_at(const core::Vec3& at, double radius) {
    return {RealVec(at), RealVec(at), radius};
}

/// A position for a needle or fin on a block of half size `half` where no parallel scan line meets
/// it: scan lines are half a mesh size off its multiples.
inline double between_lines(std::mt19937& rng, double h, double half) {
    const int most = static_cast<int>((half - 0.2 * h) / h);
    return h * (int(rng() % unsigned(2 * most + 1)) - most);
}

/// A block with something thin on top: a needle between all scan lines, or a fin between those of
/// two families.
inline std::vector<TruePart> block_with_sliver(std::mt19937& rng, double h, bool needle) {
    const double half = h * uniform(rng, 1.3, 3.0), thick = h * uniform(rng, 0.001, 0.2);
    const double top = half + h * uniform(rng, 0.2, 4.0);
    const core::Vec3 at(between_lines(rng, h, half), needle ? between_lines(rng, h, half) : 0.0,
                        0.5 * top);
    return {box_round(core::Vec3(0), core::Vec3(half)),
            box_round(at, {thick, needle ? thick : half, 0.5 * top})};
}

/// The rest of a box after two or three slots along X: a floor and walls, some thinner than h.
inline std::vector<TruePart> floor_and_walls(std::mt19937& rng, double h) {
    const double x = h * uniform(rng, 1.0, 3.0), top = h * uniform(rng, 1.0, 4.0);
    double y = 0.0;
    std::vector<TruePart> parts(1);
    const unsigned walls = 2 + rng() % 3;
    for (unsigned i = 0; i < walls; ++i) {
        const double thick =
            h * (one_in(rng, 2) ? uniform(rng, 0.01, 0.3) : uniform(rng, 0.3, 2.0));
        parts.emplace_back(TrueBox{{-x, y, 0.0}, {x, y + thick, top}});
        y += thick + h * uniform(rng, 0.5, 2.0);
    }
    const auto& last = std::get<TrueBox>(parts.back());
    parts[0] = TrueBox{{-x, 0.0, 0.0}, {x, last.max.y, h * uniform(rng, 0.1, 0.9)}};
    return parts;
}

enum class BodyKind {
    ball,
    box,
    cylinder,
    capsule,
    wall,
    needle,
    fin,
    torus,
    ball_nose,
    slots,
    sliver
};
constexpr unsigned body_kinds = 11;

inline KnownBody with_forms(std::mt19937& rng, std::string name, std::vector<TruePart> parts,
                            double spacing, std::initializer_list<BodyForm> exact) {
    std::vector<BodyForm> forms(exact);
    if (forms.empty() || one_in(rng, 3))
        forms = {BodyForm::lines, BodyForm::lines_and_one_family, BodyForm::lines_and_columns,
                 BodyForm::lines_and_columns};
    KnownBody known{std::move(name), std::move(parts), forms[rng() % forms.size()], spacing};
    return known;
}

inline KnownBody random_body(std::mt19937& rng, BodyKind kind, double h) {
    const double l = h * uniform(rng, 1.2, 3.5), r = h * uniform(rng, 0.6, 2.5);
    const core::Vec3 half(h * uniform(rng, 0.6, 3), h * uniform(rng, 0.6, 3), l);
    switch (kind) {
    case BodyKind::ball:
        return with_forms(rng, "ball", {ball_at(core::Vec3(0), l)}, h,
                          {BodyForm::primitive, BodyForm::profile});
    case BodyKind::box:
        return with_forms(rng, "box", {box_round(core::Vec3(0), half)}, h,
                          {BodyForm::primitive, BodyForm::mesh});
    case BodyKind::cylinder:
        return with_forms(rng, "cylinder", {TrueCylinder{-l, l, r}}, h,
                          {BodyForm::primitive, BodyForm::profile});
    case BodyKind::capsule:
        return with_forms(rng, "capsule", {TrueCapsule{{0, 0, -r}, {0, 0, l}, r}}, h,
                          {BodyForm::profile});
    case BodyKind::wall: {
        core::Vec3 thin = half;
        thin[int(rng() % 3)] = h * uniform(rng, 0.001, 0.2);
        return with_forms(rng, "wall", {box_round(core::Vec3(0), thin)}, h,
                          {BodyForm::primitive, BodyForm::mesh});
    }
    case BodyKind::needle:
        return with_forms(rng, "needle", block_with_sliver(rng, h, true), h, {BodyForm::mesh});
    case BodyKind::fin:
        return with_forms(rng, "fin", block_with_sliver(rng, h, false), h, {BodyForm::mesh});
    case BodyKind::torus:
        return with_forms(rng, "torus", {TrueTorus{l, uniform(rng, 0.5, 0.9) * l}}, h, {});
    case BodyKind::ball_nose:
        return with_forms(rng, "ball nose",
                          {ball_at({0, 0, r}, r), TrueCylinder{r, Real(r) + l, r}}, h,
                          {BodyForm::profile});
    case BodyKind::slots:
        return {"slots", floor_and_walls(rng, h), BodyForm::cut, h};
    default: // no scan line of a typical mesh size would meet it
        return with_forms(rng, "sliver", {TrueCapsule{{0, 0, -l}, {0, 0, l}, 0.06 * h}}, 0.05 * h,
                          {BodyForm::profile});
    }
}

inline bool only_boxes(const KnownBody& known) {
    return std::all_of(known.parts.begin(), known.parts.end(),
                       [](const TruePart& part) { return std::holds_alternative<TrueBox>(part); });
}

/// Moves the body far from the origin of its own frame; possible for boxes, not for round bodies.
inline void move_away(KnownBody& known, const core::Vec3& by) {
    if (known.form < BodyForm::mesh || known.form == BodyForm::cut || !only_boxes(known)) return;
    for (TruePart& part : known.parts) {
        auto& box = std::get<TrueBox>(part);
        box = {RealVec(core::Vec3(box.min) + by), RealVec(core::Vec3(box.max) + by)};
    }
}

/// A body of random kind, form, size and position. Throws if the program refuses it.
inline KnownBody random_body(std::mt19937& rng, core::DistanceEngine& engine) {
    double h = 1.0;
    if (one_in(rng, 6)) h = std::pow(10.0, uniform(rng, -2.0, 3.0));
    if (one_in(rng, 12)) h = std::pow(10.0, uniform(rng, 4.0, 7.0));
    KnownBody known = random_body(rng, BodyKind(rng() % body_kinds), h);
    if (known.form == BodyForm::cut && h > 100.0) known = random_body(rng, BodyKind::slots, 1.0);
    if (one_in(rng, 5))
        move_away(known, std::pow(10.0, uniform(rng, 1, 9)) * random_direction(rng));
    if (known.form > BodyForm::cut && only_boxes(known)) known.by_mesh = one_in(rng, 2);
    auto result = built(engine, known);
    if (!result)
        throw std::runtime_error(
            fmt::format("{} ({}): {}", known.name, int(known.form), result.error().message));
    return *std::move(result);
}

} // namespace test_support
