#pragma once

#include <memory>
#include <optional>

#include "tests/support/known_pair.h"
#include "tests/support/random_body.h"

namespace test_support {

inline RealVec farthest(const TruePart& part, const RealVec& n) {
    if (const auto* box = std::get_if<TrueBox>(&part))
        return {n.x > 0 ? box->max.x : box->min.x, n.y > 0 ? box->max.y : box->min.y,
                n.z > 0 ? box->max.z : box->min.z};
    if (const auto* c = std::get_if<TrueCapsule>(&part))
        return (glm::dot(n, c->b - c->a) > 0 ? c->b : c->a) + c->radius * n;
    const auto& c = std::get<TrueCylinder>(part);
    const Real across = std::hypot(n.x, n.y);
    const Real r = across > 0 ? c.radius / across : 0;
    return {r * n.x, r * n.y, n.z > 0 ? c.z1 : c.z0};
}

/// A point inside a part other than a torus.
inline RealVec inner_point(const TruePart& part, std::mt19937& rng) {
    const RealVec n = RealVec(random_direction(rng));
    const Real share = uniform(rng, 0.02, 0.98);
    return share * farthest(part, n) + (1 - share) * farthest(part, -n);
}

/// Generates pairs of bodies in random poses, several poses for each pair.
class PairGenerator {
public:
    explicit PairGenerator(unsigned seed) : rng_(seed) {}

    const core::DistanceEngine& engine() const { return *engine_; }

    KnownPair next() {
        if (poses_left_-- == 0) change_bodies();
        KnownPair pair{&*a_, &*b_, {random_turn(), core::Vec3(0)}, {}, Meeting(rng_() % 5), 0};
        if (placed_)
            place(pair);
        else
            approach(pair);
        pair.is_to_the_bit = !placed_ && is_quarter_turns(pair.a_from_b.rotation);
        if (one_in(rng_, 20)) pair.goal.limit = std::pow(10.0, uniform(rng_, -3.0, 1.5));
        return pair;
    }

private:
    void change_bodies() {
        poses_left_ = 24;
        engine_ = one_in(rng_, 2) ? core::paper_engine() : core::fast_engine();
        do {
            a_ = random_body(rng_, *engine_);
            b_ = random_body(rng_, *engine_);
            const bool single = a_->parts.size() == 1 && b_->parts.size() == 1;
            placed_ = single && is_convex(*a_) && is_convex(*b_)
                      && (one_in(rng_, 4) || !is_known(a_->parts[0], b_->parts[0]));
        } while (!placed_ && !all_known());
    }

    static bool is_convex(const KnownBody& body) {
        return !std::holds_alternative<TrueTorus>(body.parts[0]);
    }

    bool all_known() const {
        for (const TruePart& p : a_->parts)
            for (const TruePart& q : b_->parts)
                if (!is_known(p, q)) return false;
        return true;
    }

    static bool is_quarter_turns(const core::Mat3& turn) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (turn[i][j] != 0.0 && std::abs(turn[i][j]) != 1.0) return false;
        return true;
    }

    core::Mat3 random_turn() {
        if (one_in(rng_, 6))
            return core::rotation_xyz_deg(90.0 * core::Vec3(rng_() % 4, rng_() % 4, rng_() % 4));
        return random_pose(rng_, 1.0).rotation;
    }

    /// Places two convex bodies so that their distance is known: separated by a slab of that width,
    /// or with a common point.
    void place(KnownPair& pair) {
        const TruePart& p = a_->parts[0];
        const TruePart& q = b_->parts[0];
        const RealMat turn(pair.a_from_b.rotation);
        if (pair.meeting == Meeting::overlapping || pair.meeting == Meeting::nested) {
            pair.a_from_b.translation =
                core::Vec3(inner_point(p, rng_) - turn * inner_point(q, rng_));
            return;
        }
        const RealVec n =
            glm::normalize(RealVec(one_in(rng_, 4) ? core::Vec3(0, 0, 1) : random_direction(rng_)));
        const Real gap = random_gap(pair.meeting);
        const RealVec on_b = farthest(q, glm::transpose(turn) * -n);
        pair.a_from_b.translation = core::Vec3(farthest(p, n) + gap * n - turn * on_b);
        pair.truth = gap;
    }

    Real random_gap(Meeting meeting) {
        const double size = a_->size + b_->size;
        if (meeting == Meeting::touching)
            return one_in(rng_, 2) ? 0.0 : std::pow(10.0, uniform(rng_, -13.0, -8.0));
        if (meeting == Meeting::far)
            return std::min(1e11, size * std::pow(10.0, uniform(rng_, 0.5, 5.0)));
        return size * std::pow(10.0, uniform(rng_, -4.0, 0.0));
    }

    /// Moves B towards A along a line to the intended relative position, and calculates the true
    /// distance there.
    void approach(KnownPair& pair) {
        const core::Vec3 n = one_in(rng_, 5) ? core::Vec3(1, 0, 0) : random_direction(rng_);
        const double size = a_->size + b_->size;
        const core::Vec3 aside = uniform(rng_, 0.0, 0.4) * size * random_direction(rng_);
        const core::Vec3 meeting_point =
            a_->middle - pair.a_from_b.rotation * b_->middle
            + (pair.meeting == Meeting::nested ? core::Vec3(0) : aside);
        const auto move_to = [&](double s) {
            pair.a_from_b.translation = meeting_point + s * n;
            return true_distance(*a_, *b_, pair.a_from_b);
        };
        pair.truth = move_to(place_on_line(pair.meeting, size, move_to));
        if (one_in(rng_, 4)) sweep_past(pair, size);
    }

    template <typename Move>
    double place_on_line(Meeting meeting, double size, const Move& move_to) {
        if (meeting == Meeting::nested) return uniform(rng_, 0.0, 0.1) * size;
        if (meeting == Meeting::far) return double(random_gap(meeting));
        const double gap = meeting == Meeting::near ? double(random_gap(meeting)) : 0.0;
        double inside = 0.0, outside = 4.0 * size;
        for (int i = 0; i < (meeting == Meeting::touching ? 70 : 14); ++i) {
            const double middle = 0.5 * (inside + outside);
            (move_to(middle) <= gap ? inside : outside) = middle;
        }
        if (meeting == Meeting::overlapping) return inside * uniform(rng_, 0.0, 1.0);
        if (meeting == Meeting::near) return outside;
        const double beyond = one_in(rng_, 2) ? 0.0 : double(random_gap(meeting));
        return one_in(rng_, 3) ? inside : outside + beyond;
    }

    /// Moves B past A, if one of them is a ball: over a straight motion a ball is a capsule.
    void sweep_past(KnownPair& pair, double size) {
        const core::Vec3 sweep = size * uniform(rng_, 0.0, 3.0) * random_direction(rng_);
        const core::Vec3 start =
            pair.a_from_b.translation - (one_in(rng_, 3) ? 0.0 : uniform(rng_, 0.0, 1.0)) * sweep;
        const core::Transform a_from_b{pair.a_from_b.rotation, start};
        const auto truth = swept_distance(a_from_b, RealVec(sweep));
        if (!truth) return;
        pair.a_from_b = a_from_b;
        pair.goal.sweep = sweep;
        pair.truth = *truth;
    }

    std::optional<Real> swept_distance(const core::Transform& a_from_b, const RealVec& sweep) {
        const RealPose pose = exactly(a_from_b);
        if (const auto ball = only_ball(*b_)) {
            const RealVec at = pose * ball->a;
            return to_parts({at, at + sweep, ball->radius}, *a_, {});
        }
        if (const auto ball = only_ball(*a_))
            return to_parts({ball->a, ball->a - sweep, ball->radius}, *b_, pose);
        return std::nullopt;
    }

    static std::optional<TrueCapsule> only_ball(const KnownBody& body) {
        const auto* capsule = std::get_if<TrueCapsule>(&body.parts[0]);
        if (!capsule || body.parts.size() > 1 || capsule->a != capsule->b) return std::nullopt;
        return *capsule;
    }

    static std::optional<Real> to_parts(const TrueCapsule& c, const KnownBody& body,
                                        const RealPose& pose) {
        Real least = real_infinity;
        for (const TruePart& part : body.parts) {
            if (!is_known(c, part)) return std::nullopt;
            least = std::min(least, distance(c, part, pose));
        }
        return least;
    }

    std::mt19937 rng_;
    std::unique_ptr<core::DistanceEngine> engine_;
    std::optional<KnownBody> a_, b_;
    bool placed_ = false;
    int poses_left_ = 0;
};

} // namespace test_support
