#include "app/tolerance/limit_search.h"

namespace app {
namespace {

constexpr size_t most_runs = 12;
constexpr double finest = 0.01; // mm

double step_of(double by) { return std::max(finest, 0.04 * by); }

/// Chooses the deviations to try.
struct Guesses {
    struct Failure {
        double by, missing;
    };
    std::optional<Failure> last, before; // with a known shortfall
    bool was_guessed = false;            // the last try came from the shortfall
    int guesses = 0;                     // in a row

    void fail(double by, const std::optional<double>& missing) {
        before = last;
        last.reset();
        if (missing) last = Failure{by, *missing};
    }

    /// The deviation at which nothing would be missing. Mostly, the clearance shrinks as fast as
    /// the deviation grows; two failures tell how fast it does.
    double extrapolated() const {
        const bool has_slope = before && before->by > last->by && before->missing > last->missing;
        const double slope =
            has_slope ? (before->missing - last->missing) / (before->by - last->by) : 1.0;
        return last->by - last->missing / slope - 1e-6;
    }

    double next(double proven, double failed) {
        const bool held = was_guessed && !last;
        was_guessed = false;
        // The shortfall of a thin body says little about how far the limit is.
        if (last && guesses < 2) {
            const double guess = extrapolated();
            was_guessed = guess > proven && guess < failed;
            if (was_guessed) {
                ++guesses;
                return guess;
            }
        }
        guesses = 0;
        // A guess that held is probably the limit: try just beyond it.
        if (held && proven + step_of(proven) < failed) return proven + step_of(proven);
        return proven > 0.0 ? 0.5 * (proven + failed) : 0.25 * failed;
    }
};

} // namespace

ProvenLimit proven_limit(double most,
                         const std::function<std::optional<LimitingPair>(double)>& shown) {
    ProvenLimit found;
    Guesses guesses;
    double by = most;
    while (found.runs < most_runs) {
        ++found.runs;
        if (const auto limit = shown(by)) {
            found.limit = limit;
            found.not_shown = by;
            guesses.fail(by, limit->missing);
        } else {
            guesses.last.reset();
            found.by = by;
        }
        if (!found.not_shown || *found.not_shown - found.by <= step_of(found.by)) break;
        by = guesses.next(found.by, *found.not_shown);
    }
    return found;
}

} // namespace app
