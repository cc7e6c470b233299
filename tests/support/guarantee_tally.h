#pragma once

#include <array>

#include <fmt/format.h>

#include "core/distance/rounding.h"
#include "tests/support/known_pair.h"

namespace test_support {

/// The basis of the bounds of a pair: exact geometry; columns of three scan line families, or of
/// fewer for at least one of the bodies; or no lower bound.
enum class Footing { exact, three_families, one_family, none };
constexpr size_t footings = 4, meetings = 5;

/// The results of measuring many known pairs: every violated claim, and statistics of the sample.
struct GuaranteeTally {
    std::array<std::array<size_t, meetings>, footings> counts{};
    std::array<std::vector<double>, footings> widths; // exact: mm, within 1 m; else over h
    std::vector<std::string> failures;
    size_t swept = 0, limited = 0, huge = 0, apart = 0, closed_at_zero = 0, common = 0;
    size_t to_the_bit = 0; // compared without a tolerance for the pose
    size_t tight = 0;      // exact pairs with an interval below 1e-10 of their reach

    size_t count(Footing footing) const {
        size_t sum = 0;
        for (const size_t n : counts[size_t(footing)]) sum += n;
        return sum;
    }
    size_t count(Meeting meeting) const {
        size_t sum = 0;
        for (const auto& of : counts) sum += of[size_t(meeting)];
        return sum;
    }
    /// Whether every relative position, on every basis, and every variant occurred often enough to
    /// be significant.
    bool is_representative() const {
        size_t least = std::min({4 * swept, 4 * limited, 4 * huge, 4 * apart, 4 * to_the_bit});
        size_t all = 0;
        for (const auto& of : counts)
            for (const size_t n : of) {
                least = std::min(least, 2 * n);
                all += n;
            }
        return least > all / 50;
    }
    /// The share of the exact pairs, all of whose intervals are below 1e-7 of their reach, with
    /// intervals a thousand times smaller.
    double tight_share() const { return double(tight) / double(count(Footing::exact)); }
    /// The share of the exact pairs with common points for which this was proven.
    double share_closed_at_zero() const { return double(closed_at_zero) / double(common); }

    double width(Footing footing, double share) {
        std::vector<double>& all = widths[size_t(footing)];
        if (all.empty()) return 0.0;
        const auto at = all.begin() + std::ptrdiff_t(share * double(all.size() - 1));
        std::nth_element(all.begin(), at, all.end());
        return *at;
    }

    void measure(const KnownPair& pair, const core::DistanceEngine& engine) {
        const auto found =
            core::measure(engine, pair.a->body, pair.b->body, pair.a_from_b, pair.goal);
        if (!found) return fail(pair, {}, found.error().message);
        judge(pair, *found);
        take_stock(pair, *found);
    }

    std::string report() {
        std::string text;
        const char* names[] = {"exact", "three families", "one family", "lines only"};
        for (size_t i = 0; i < footings; ++i)
            text += fmt::format(
                "{}: {} near, {} far, {} touching, {} overlapping, {} nested; width "
                "{:.2g} (median), {:.2g} (99 %), {:.2g} (most)\n",
                names[i], counts[i][0], counts[i][1], counts[i][2], counts[i][3], counts[i][4],
                width(Footing(i), 0.5), width(Footing(i), 0.99), width(Footing(i), 1.0));
        return text
               + fmt::format("{} with a sweep, {} with a limit, {} beyond 1e6 mm, {} with a lower "
                             "bound above 0; of {} with points in common {} closed at 0; {} of the "
                             "exact ones tight\n",
                             swept, limited, huge, apart, common, closed_at_zero, tight);
    }

private:
    static Footing footing(const KnownPair& pair) {
        if (pair.a->is_exact() && pair.b->is_exact()) return Footing::exact;
        const auto worst = [&](BodyForm form) {
            return pair.a->form == form || pair.b->form == form;
        };
        if (worst(BodyForm::lines)) return Footing::none;
        return worst(BodyForm::cut) || worst(BodyForm::lines_and_one_family)
                   ? Footing::one_family
                   : Footing::three_families;
    }

    /// Twice the rounding error of the pose: the bodies are where the doubles say, and the
    /// transform is a rotation to within that. Quarter turns are exact.
    static double pose_error(const KnownPair& pair) {
        return (pair.is_to_the_bit ? 2e-18 : 2e-15) * pair.reach();
    }

    void judge(const KnownPair& pair, const core::Measurement& found) {
        const Real error = pose_error(pair), truth = pair.truth;
        const double rounding =
            core::search_rounding(pair.reach()) + 2.0 * core::scan_rounding(pair.reach());
        const auto expect = [&](bool holds, const char* claim) {
            if (!holds) fail(pair, found, claim);
        };
        expect(found.lower >= 0.0 && found.lower <= found.upper, "0 <= lower <= upper");
        expect(found.lower <= truth + error, "lower <= truth");
        expect(found.lower <= pair.goal.limit, "lower <= limit");
        expect(found.upper <= found.scan.distance + 2.0 * rounding, "upper <= distance");
        expect(found.scan.distance >= truth - rounding, "distance >= truth");
        if (found.upper == core::infinity) {
            expect(truth >= pair.goal.limit - 4.0 * rounding - width_allowed(pair),
                   "nothing within the limit");
            return;
        }
        expect(found.upper >= truth - error, "upper >= truth");
        expect(found.upper < pair.goal.limit, "upper < limit");
        expect(std::abs(glm::distance(found.witness_a, found.witness_b) - found.upper)
                   <= 3.0 * rounding,
               "the witnesses are as far apart as upper says");
        expect(found.at >= 0.0 && found.at <= 1.0, "at is within the sweep");
        const core::Vec3 on_b =
            pair.a_from_b.inverse() * (found.witness_b - found.at * pair.goal.sweep);
        expect(outside(*pair.a, found.witness_a) <= 2.0 * rounding, "the witness is on A");
        expect(outside(*pair.b, on_b) <= 2.0 * rounding, "the witness is on B");
        if (footing(pair) == Footing::exact)
            expect(found.upper - found.lower <= width_allowed(pair), "closed to rounding");
        const bool open = footing(pair) == Footing::none && found.upper > 0.0;
        expect(found.reason.empty() != open, "a reason where lower is 0 for want of a model");
        expect(!open || found.lower == 0.0, "no lower bound without a model");
    }

    /// The permitted width of the interval for exact bodies: the tolerance of the search, and
    /// rounding.
    static double width_allowed(const KnownPair& pair) {
        if (footing(pair) != Footing::exact) return core::infinity;
        return pair.goal.tolerance + 1e-9 + 1e-7 * pair.reach();
    }

    static double outside(const KnownBody& body, const core::Vec3& p) {
        Real least = real_infinity;
        for (const TruePart& part : body.parts) least = std::min(least, point_to(part, RealVec(p)));
        return double(least);
    }

    void take_stock(const KnownPair& pair, const core::Measurement& found) {
        const Footing on = footing(pair);
        const double size = pair.a->size + pair.b->size;
        Meeting meeting = pair.meeting;
        if (pair.truth > 0) meeting = pair.truth > 3.0 * size ? Meeting::far : Meeting::near;
        if (pair.truth < 1e-7 * size && (pair.meeting == Meeting::touching || pair.truth > 0))
            meeting = Meeting::touching;
        ++counts[size_t(on)][size_t(meeting)];
        swept += pair.goal.sweep != core::Vec3(0.0);
        limited += pair.goal.limit < core::infinity;
        huge += pair.reach() > 1e6;
        apart += found.lower > 0.0;
        to_the_bit += pair.is_to_the_bit && pair.truth > 0;
        tight +=
            on == Footing::exact
            && (found.upper == core::infinity
                || found.upper - found.lower <= pair.goal.tolerance + 1e-9 + 1e-10 * pair.reach());
        if (meeting == Meeting::overlapping || meeting == Meeting::nested) {
            common += on == Footing::exact;
            closed_at_zero += on == Footing::exact && found.upper == 0.0;
        }
        if (found.upper == core::infinity || pair.truth == 0 || on == Footing::none) return;
        const double h = std::max(pair.a->spacing, pair.b->spacing);
        const double width = found.upper - found.lower;
        if (on != Footing::exact)
            widths[size_t(on)].push_back(width / h);
        else if (pair.reach() < 1000.0)
            widths[size_t(on)].push_back(width);
    }

    void fail(const KnownPair& pair, const core::Measurement& found, const std::string& claim) {
        failures.push_back(fmt::format(
            "{}: {} ({}) and {} ({}), meant {}, reach {:.3g}, limit {:.3g}: truth {:.17g}, lower "
            "{:.17g}, upper {:.17g}, distance {:.17g}",
            claim, pair.a->name, int(pair.a->form), pair.b->name, int(pair.b->form),
            int(pair.meeting), pair.reach(), pair.goal.limit, double(pair.truth), found.lower,
            found.upper, found.scan.distance));
    }
};

} // namespace test_support
