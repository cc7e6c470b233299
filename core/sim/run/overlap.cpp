#include "core/sim/run/overlap.h"

#include <algorithm>
#include <memory>
#include <numbers>

#include "core/base/math.h"
#include "core/distance/inner_depth.h"
#include "core/sim/leg/leg_check.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double farthest_way_out = 1000.0; // mm, longest translation that is tried
constexpr double way_out_step = 5e-4;       // mm, precision of its length
constexpr double rounding_gap = 1e-7;       // mm, distance that proves that bodies are apart
constexpr size_t most_pieces = 400;

/// A part of a block's path in which the pair overlaps.
struct Piece {
    RelativeLeg leg;
    Mat3 target_from_stock = Mat3(1.0); // rotation only
    std::shared_ptr<const CutModel> before, after;
    int halvings = 0;
};

/// A translation after which the bodies of a piece no longer overlap.
struct WayOut {
    double length = infinity;
    Vec3 towards = Vec3(0.0);

    /// The direction in the target's frame, if it is in that of the stock.
    Vec3 towards_in(const Piece& piece) const { return piece.target_from_stock * towards; }
};

/// A ball inside the moving body: its centre in the frame of the body, and a moment of a piece.
struct Ball {
    size_t piece = 0;
    Vec3 centre = Vec3(0.0);
    double fraction = 0.0;
    double depth = 0.0; // lower bound of the depth that it proves, mm
    int axis = -1;      // of the scan lines that prove it
};

class OverlapSearch {
public:
    OverlapSearch(const OverlapQuery& query, const Pair& pair)
        : query_(query), pair_(pair), bodies_(moving_bodies(query.setup, query.tool)) {
        for (const MovingBody& body : bodies_)
            if (pair_of(body, pair.fixture) == pair) body_ = &body;
        if (!body_ || !body_->profile) return;
        shrink_ = contact_shrink(allowance_of(query.setup, pair), *body_->profile);
        shrunk_ = shrunk_around(*body_->profile, shrink_);
    }

    std::optional<Overlap> run() {
        if (!body_ || (!pair_.fixture && !query_.stock)) return std::nullopt;
        // Of a mesh, only the surface is measured against the stock.
        if (!pair_.fixture && body_->body && std::holds_alternative<SolidMesh>(*body_->body))
            return std::nullopt;
        if (!collect() || pieces_.empty()) return std::nullopt;
        Overlap overlap{.least = least(farthest_way_out)};
        const WayOut way = way_out(overlap.least);
        if (way.length == infinity) return overlap;
        overlap.most = way.length;
        overlap.way_out = way.towards;
        // `least` counts contact as overlap, `most` does not.
        overlap.least = std::min(overlap.least, way.length);
        return overlap;
    }

private:
    const Mount& target() const {
        return pair_.fixture ? query_.setup.fixtures[*pair_.fixture].mount
                             : query_.setup.stock_mount;
    }

    /// The stock before and after a leg.
    struct LegStock {
        std::shared_ptr<const CutModel> before, after;
        // Before it, but without what the flutes have run into, as the check goes on.
        std::shared_ptr<const CutModel> left;
    };

    /// Collects the pieces in which the bodies may overlap. False: the path is not known well
    /// enough.
    bool collect() {
        std::shared_ptr<const CutModel> now;
        if (query_.stock) now = std::make_shared<CutModel>(*query_.stock);
        std::shared_ptr<const CutModel> left = now;
        for (const TimedLeg& timed : query_.legs) {
            if (!timed.leg.straight || timed.leg.positions.empty()) return false;
            const bool cuts = !pair_.fixture && timed.use == FluteUse::cutting;
            std::shared_ptr<const CutModel> after = now;
            if (cuts) after = cut_along(timed.leg, *now);
            // Flutes that cut meet the stock as intended.
            const bool is_intended = cuts && body_->kind == PartKind::flutes;
            const bool counts = !is_intended && (timed.is_rapid || !query_.only_rapids);
            const size_t known = pieces_.size();
            if (counts && !add_pieces(timed.leg, {now, after, left}, 6)) return false;
            const bool is_crash = !pair_.fixture && !cuts && body_->kind == PartKind::flutes
                                  && pieces_.size() > known;
            if (cuts || is_crash) left = cuts && left == now ? after : cut_along(timed.leg, *left);
            now = after;
        }
        return true;
    }

    std::shared_ptr<const CutModel> cut_along(const Leg& leg, const CutModel& stock) const {
        auto after = std::make_shared<CutModel>(stock);
        CheckMemory memory;
        Statistics statistics;
        const std::vector<bool> no_fixtures(query_.setup.fixtures.size(), false);
        LegCheck(query_.setup, query_.tool, FluteUse::cutting, query_.block, no_fixtures, memory,
                 statistics)
            .only_cut(leg, *after);
        return after;
    }

    bool add_pieces(const Leg& leg, const LegStock& stock, int halvings) {
        constexpr double sharp = 0.01; // mm, error of a turning body
        const RelativeLeg relative = leg_against(query_.setup, pair_.fixture, *body_, leg);
        const bool is_vague = relative.turns && relative.reducible_error() > sharp;
        if (is_vague && halvings > 0 && leg.positions.size() == 2)
            return add_pieces(stretch(leg, 0.0, 0.5), stock, halvings - 1)
                   && add_pieces(stretch(leg, 0.5, 1.0), stock, halvings - 1);
        if (relative.error == infinity || relative.positions.size() > 2) return false;
        Piece piece{.leg = relative, .before = stock.before, .after = stock.after};
        const Leg middle = leg.positions.size() == 2 ? still_half_way(leg) : leg;
        piece.target_from_stock = target_from_mover(query_.setup.machine, target(),
                                                    query_.setup.stock_mount, middle.positions[0])
                                      .rotation;
        if (is_apart(piece, Vec3(0.0), Form::shrunk)) return true;
        const bool cuts = stock.before != stock.after;
        if (!pair_.fixture && !cuts) {
            // Each takes up to a second, and a motion that turns has hundreds of pieces.
            constexpr size_t most_checks = 32;
            if (++checks_ > most_checks) return false;
            if (is_clear(leg, *stock.left)) return true;
        }
        pieces_.push_back(std::move(piece));
        return pieces_.size() <= most_pieces;
    }

    /// Whether the check finds the pair clear on a leg on which nothing is cut. It knows what
    /// is_apart does not: flutes that leave their own cut are clear.
    bool is_clear(const Leg& leg, const CutModel& stock) const {
        TrackedPairs pairs;
        CheckMemory memory;
        Statistics statistics;
        const std::vector<bool> no_fixtures(query_.setup.fixtures.size(), false);
        LegCheck(query_.setup, query_.tool, FluteUse::not_cutting, query_.block, no_fixtures,
                 memory, statistics)
            .pass(leg, 0.0, stock, pairs);
        return std::none_of(pairs.begin(), pairs.end(), [&](const TrackedPair& pair) {
            return pair.pair == pair_ && pair.verdict != Verdict::clear;
        });
    }

    /// The body as it is, or shrunk by what counts as contact.
    enum class Form : uint8_t { whole, shrunk };

    /// Whether the body, moved by a vector, is certainly apart from the other one over a piece.
    bool is_apart(const Piece& piece, const Vec3& by, Form form) {
        ++trials_;
        RelativeLeg leg = piece.leg;
        for (Vec3& position : leg.positions) position += by;
        const double enough = leg.error + rounding_gap;
        MovingBody body = *body_;
        if (form == Form::shrunk && body.profile) body.profile = &shrunk_;
        if (pair_.fixture) {
            size_t tests = 0;
            const ExactBody& fixture = query_.setup.fixtures[*pair_.fixture].body;
            return distance_over(leg, body, fixture, 2.0 * enough, tests).lower >= enough;
        }
        const std::vector<ConvexShape> shapes =
            body.profile ? shapes_of(*body.profile, leg) : shapes_of(*body.body, leg);
        // Material found on a scan line ends the search before any column is divided, and a square
        // of the finest side that is too near ends the division: they are not proven apart.
        const StockGoal goal{.limit = 2.0 * enough,
                             .threshold = enough,
                             .finest = 0.1,
                             .work_limit = 250,
                             .futile_limit = 0,
                             .kept = &kept_of(piece.before)};
        return separation(shapes, *piece.before, goal).separation.lower >= enough;
    }

    /// What the searches against a stock have recomputed.
    KeptSquares& kept_of(const std::shared_ptr<const CutModel>& stock) {
        constexpr size_t most_trials = 1000; // so much may be kept in memory
        if (kept_stock_ != stock || ++kept_trials_ > most_trials) {
            kept_stock_ = stock;
            kept_.emplace(*stock);
            kept_trials_ = 0;
        }
        return *kept_;
    }

    /// Shortens a translation that separates the bodies.
    void shorten(const Piece& piece, WayOut& way, Form form, double precision) {
        double low = 0.0;
        while (way.length - low > precision) {
            const double middle = 0.5 * (low + way.length);
            (is_apart(piece, middle * way.towards, form) ? way.length : low) = middle;
        }
    }

    /// Takes a direction if it separates the bodies after a shorter way.
    bool try_direction(const Piece& piece, const Vec3& towards, WayOut& best) {
        // Once a way is known, better ones are looked for only as long as that is cheap.
        if (best.length < infinity && trials_ > (pair_.fixture ? 3000U : 250U)) return false;
        WayOut way{.length = 0.97 * best.length, .towards = towards};
        if (best.length == infinity) {
            way.length = 0.5;
            while (way.length <= farthest_way_out
                   && !is_apart(piece, way.length * towards, Form::shrunk))
                way.length *= 2.0;
            if (way.length > farthest_way_out) return false;
        } else if (!is_apart(piece, way.length * towards, Form::shrunk)) {
            return false;
        }
        shorten(piece, way, Form::shrunk, std::max(way_out_step, 0.02 * way.length));
        best = way;
        return true;
    }

    /// Turns the direction step by step while the way becomes shorter.
    void turn_direction(const Piece& piece, WayOut& best) {
        const size_t end = trials_ + (pair_.fixture ? 400 : 40);
        for (double angle = 0.5; angle > 0.02 && trials_ < end;) {
            const Vec3 axis = std::abs(best.towards.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
            const Vec3 u = glm::normalize(glm::cross(axis, best.towards));
            const Vec3 v = glm::cross(best.towards, u);
            bool is_better = false;
            for (const Vec3& side : {u, -u, v, -v})
                is_better =
                    is_better
                    || try_direction(piece, glm::normalize(best.towards + core::tan(angle) * side),
                                     best);
            if (!is_better) angle *= 0.5;
        }
    }

    /// The shortest translation found that separates the bodies over a piece. Frame: the target's.
    WayOut shortest_way(const Piece& piece) {
        WayOut best;
        std::vector<Vec3> directions = {piece.leg.orientation[2]};
        for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0),
                                 Vec3(0, -1, 0), Vec3(0, 0, -1)})
            directions.push_back(piece.target_from_stock * axis);
        for (const Vec3& direction : directions) try_direction(piece, direction, best);
        if (best.length == infinity) return best;
        turn_direction(piece, best);
        shorten(piece, best, Form::shrunk, way_out_step);
        WayOut whole = best; // the body as it is, unless it stays in contact on the way
        whole.length += 1.5 * shrink_ + way_out_step;
        if (is_apart(piece, whole.length * whole.towards, Form::whole)) {
            shorten(piece, whole, Form::whole, way_out_step);
            best = whole;
        }
        return best;
    }

    /// The halves of a piece in which the bodies may overlap.
    std::vector<Piece> halves_of(const Piece& piece) {
        const Vec3 from = piece.leg.positions.front(), to = piece.leg.positions.back();
        std::vector<Piece> halves(2, piece);
        halves[0].leg.positions = {from, 0.5 * (from + to)};
        halves[1].leg.positions = {0.5 * (from + to), to};
        std::erase_if(halves,
                      [&](const Piece& half) { return is_apart(half, Vec3(0.0), Form::shrunk); });
        for (Piece& half : halves) ++half.halvings;
        return halves;
    }

    /// The longest of the shortest ways of all pieces. Pieces for which it is much longer than
    /// `least`, the depth that is proven, are halved. Frame: the stock's.
    WayOut way_out(double least) {
        constexpr int most_halvings = 4;
        size_t searches_left = pair_.fixture ? 40 : 4;
        const double near_enough = 1.03 * least + 0.03;
        WayOut worst{.length = 0.0};
        std::vector<Piece> open(pieces_.rbegin(), pieces_.rend());
        while (!open.empty() && worst.length < infinity) {
            const Piece piece = std::move(open.back());
            open.pop_back();
            if (worst.length > 0.0
                && is_apart(piece, worst.length * worst.towards_in(piece), Form::shrunk))
                continue;
            WayOut way = shortest_way(piece);
            if (searches_left > 0) --searches_left;
            const bool can_halve = searches_left > 0 && piece.halvings < most_halvings
                                   && piece.leg.positions.size() == 2;
            if (way.length > near_enough && way.length > worst.length && can_halve) {
                for (Piece& half : halves_of(piece)) open.push_back(std::move(half));
                continue;
            }
            way.towards = glm::transpose(piece.target_from_stock) * way.towards;
            if (way.length > worst.length) worst = way;
        }
        return worst;
    }

    double radius_inside(const Ball& ball) const {
        return (body_->profile ? inner_depth(*body_->profile, ball.centre)
                               : inner_depth(*body_->body, ball.centre))
               - pieces_[ball.piece].leg.error;
    }

    /// The centre of a ball at its moment. Frame: the target's.
    Vec3 centre_of(const Ball& ball) const {
        const RelativeLeg& leg = pieces_[ball.piece].leg;
        const Vec3 &from = leg.positions.front(), &to = leg.positions.back();
        return leg.orientation * ball.centre + from + ball.fraction * (to - from);
    }

    /// Measures the depth that a ball proves; it need not be found if it is not above
    /// `goal.enough`.
    void measure(Ball& ball, const CoverGoal& goal) const {
        ball.depth = 0.0;
        const double radius = radius_inside(ball);
        if (radius <= 0.0) return;
        const Vec3 centre = centre_of(ball);
        if (pair_.fixture) {
            ball.depth = inner_depth(query_.setup.fixtures[*pair_.fixture].body, centre) + radius;
            return;
        }
        // The ball cannot be deeper than in the box of the stock.
        const CutModel& stock = *pieces_[ball.piece].after;
        const Vec3 inside = glm::min(centre - stock.outer_box.min, stock.outer_box.max - centre);
        if (std::min({inside.x, inside.y, inside.z}) + radius <= goal.enough) return;
        const CoveredRadius found = covered_radius(stock.lines, centre, radius, goal);
        ball.depth = found.radius;
        ball.axis = found.axis;
    }

    /// Points inside the body at which balls are tried first.
    std::vector<Vec3> first_centres() const {
        std::vector<Vec3> centres;
        if (!body_->profile) {
            const Aabb box = bounds(*body_->body);
            for (const double x : {0.1, 0.5, 0.9})
                for (const double y : {0.1, 0.5, 0.9})
                    for (const double z : {0.1, 0.3, 0.5, 0.7, 0.9})
                        centres.push_back(box.min + Vec3(x, y, z) * box.size());
            return centres;
        }
        for (const ProfileElement& element : body_->profile->elements)
            for (const double up : {0.05, 0.25, 0.5, 0.75, 0.95}) {
                const double bottom = element.z0 - 0.7 * element.margin;
                const double top = element.z1 + 0.7 * element.margin;
                const double z = bottom + up * (top - bottom);
                const double r = element.r0 + up * (element.r1 - element.r0) + 0.7 * element.margin;
                centres.emplace_back(0.0, 0.0, z);
                for (const double out : {0.5, 0.85})
                    for (int turn = 0; turn < 8; ++turn) {
                        const double angle = 0.25 * std::numbers::pi * turn;
                        centres.emplace_back(out * r * core::cos(angle), out * r * core::sin(angle),
                                             z);
                    }
            }
        return centres;
    }

    /// Moves a ball, in space and time, while the depth that it proves grows.
    void improve(Ball& ball, double limit) const {
        const Aabb box = body_->profile ? bounds(*body_->profile) : bounds(*body_->body);
        const double finest = pair_.fixture ? 1e-3 : 0.02;
        double step = 0.2 * std::max({box.size().x, box.size().y, box.size().z}), later = 0.25;
        while (step > finest && ball.depth < limit - way_out_step) {
            Ball best = ball;
            const auto consider = [&](Ball other) {
                other.fraction = std::clamp(other.fraction, 0.0, 1.0);
                measure(other, {.limit = limit, .enough = best.depth, .axis = ball.axis});
                if (other.depth > best.depth) best = other;
            };
            for (int axis = 0; axis < 3; ++axis)
                for (const double by : {-step, step}) {
                    Ball other = ball;
                    other.centre[axis] += by;
                    consider(other);
                }
            for (const double by : {-later, later}) {
                Ball other = ball;
                other.fraction += by;
                consider(other);
            }
            const bool is_better = best.depth > ball.depth + 0.1 * finest;
            ball = best;
            if (!is_better) step *= 0.5, later *= 0.5;
        }
    }

    /// The deepest of the balls that are tried first, one at each of some moments.
    std::vector<Ball> first_balls(double limit) const {
        std::vector<double> moments = {1.0};
        if (pieces_.size() <= 3) moments = {0.0, 0.25, 0.5, 0.75, 1.0};
        const size_t stride = (pieces_.size() + 11) / 12;
        const std::vector<Vec3> centres = first_centres();
        std::vector<Ball> best;
        double deepest = 0.0;
        for (size_t i = 0; i < pieces_.size(); i += stride)
            for (const double fraction : moments)
                for (const Vec3& centre : centres) {
                    Ball ball{.piece = i, .centre = centre, .fraction = fraction};
                    measure(ball, {.limit = limit, .enough = deepest});
                    if (ball.depth <= deepest) continue;
                    deepest = ball.depth;
                    best.push_back(ball);
                }
        std::reverse(best.begin(), best.end());
        return best;
    }

    double least(double limit) const {
        constexpr size_t most_balls = 2;
        std::vector<Ball> balls = first_balls(limit);
        double deepest = 0.0;
        for (size_t i = 0; i < std::min(balls.size(), most_balls); ++i) {
            improve(balls[i], limit);
            deepest = std::max(deepest, balls[i].depth);
            measure(balls[i], {.limit = limit, .enough = deepest, .fineness = 16});
            deepest = std::max(deepest, balls[i].depth);
        }
        return std::min(deepest, limit);
    }

    const OverlapQuery& query_;
    const Pair& pair_;
    std::vector<MovingBody> bodies_;
    const MovingBody* body_ = nullptr;
    RevolvedProfile shrunk_;
    double shrink_ = 0.0;
    std::vector<Piece> pieces_;
    size_t trials_ = 0;
    std::shared_ptr<const CutModel> kept_stock_; // of kept_
    std::optional<KeptSquares> kept_;
    size_t kept_trials_ = 0;
    size_t checks_ = 0; // of contact: is_clear
};

} // namespace

std::optional<Overlap> overlap_of(const OverlapQuery& query, const Pair& pair) {
    return OverlapSearch(query, pair).run();
}

} // namespace core
