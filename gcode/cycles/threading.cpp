#include "gcode/cycles/threading.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// A thread relative to its drive line: heights are measured from there towards the material.
struct ThreadPath {
    TurningPoint start, end;
    double inward;       // X per height: +1 for an internal thread, -1 for an external one
    double along;        // +1 or -1: the direction of cutting on Z
    double crest, depth; // heights of the crest, and of the root above it
    double pitch, ramp;  // per revolution, along the thread and along a taper
    double slope;        // Z per height of the flank that the passes follow
    double entry, exit;  // lengths of the tapers
};

core::Result<void> check(const ThreadingWords& words) {
    const auto wrong = [](ErrorCode code, std::string message) {
        return core::fail(code, std::move(message));
    };
    if (!words.pitch)
        return wrong(ErrorCode::missing_value, "G76 needs a P word, the pitch of the thread");
    if (!words.i || !words.j || !words.k)
        return wrong(ErrorCode::missing_value,
                     fmt::format("G76 has no {}: it needs I, the offset of the crest, J, the first "
                                 "depth, and K, the full depth",
                                 !words.i   ? 'I'
                                 : !words.j ? 'J'
                                            : 'K'));
    if (*words.i == 0.0)
        return wrong(ErrorCode::invalid_value,
                     "G76: I must not be 0: its sign gives the side of the thread");
    if (!(*words.j > 0.0))
        return wrong(ErrorCode::invalid_value, "G76: J, the first depth, must be positive");
    if (!(*words.k > *words.j))
        return wrong(ErrorCode::invalid_value,
                     "G76: K, the full depth, must be greater than J, the first depth");
    if (words.spring_passes < -1 || words.tapered_ends < 0)
        return wrong(ErrorCode::invalid_value, fmt::format("G76: {} must not be negative",
                                                           words.tapered_ends < 0 ? 'L' : 'H'));
    if (std::abs(core::cos(words.compound_angle)) < 1e-9)
        return wrong(ErrorCode::invalid_value, "G76: the compound angle Q must not be 90 degrees");
    return {};
}

ThreadPath thread_from_words(TurningPoint start, TurningPoint end, const ThreadingWords& words) {
    ThreadPath thread{};
    thread.start = start;
    thread.end = end;
    thread.inward = *words.i > 0.0 ? 1.0 : -1.0;
    thread.along = end.z > start.z ? 1.0 : -1.0;
    thread.crest = std::abs(*words.i);
    thread.depth = *words.k;
    thread.pitch = *words.pitch;
    thread.ramp = *words.pitch;
    thread.slope = core::tan(words.compound_angle);
    if (words.taper_length > 0.0) {
        if (words.tapered_ends & 1) thread.entry = words.taper_length;
        if (words.tapered_ends & 2) thread.exit = words.taper_length;
        // Along the taper, Z must advance by the pitch with each revolution.
        thread.ramp *= core::hypot(words.taper_length, thread.depth) / words.taper_length;
    }
    return thread;
}

void add_pass(std::vector<ThreadingMove>& moves, const ThreadPath& thread, double depth) {
    const auto x = [&](double height) { return thread.start.x + thread.inward * height; };
    const double clear = depth - thread.depth;
    const double root = thread.crest + depth;
    const double surface = root - thread.depth;
    const double from = thread.start.z + thread.along * depth * thread.slope;
    const double to = thread.end.z - thread.along * (thread.depth - depth) * thread.slope;
    moves.push_back({{x(clear), from}, {}});
    if (thread.entry > 0.0) {
        moves.push_back({{x(surface), from}, thread.ramp});
        moves.push_back({{x(root), from + thread.along * thread.entry}, thread.ramp});
    } else {
        moves.push_back({{x(root), from}, {}});
    }
    moves.push_back({{x(root), to - thread.along * thread.exit}, thread.pitch});
    if (thread.exit > 0.0) moves.push_back({{x(surface), to}, thread.ramp});
    moves.push_back({{x(clear), to}, {}});
}

} // namespace

core::Result<std::vector<ThreadingMove>> threading_moves(TurningPoint start, TurningPoint end,
                                                         const ThreadingWords& words) {
    if (const auto checked = check(words); !checked) return tl::unexpected(checked.error());
    const ThreadPath thread = thread_from_words(start, end, words);
    const double power = 1.0 / std::max(words.degression, 1.0);
    std::vector<ThreadingMove> moves;
    int passes = 1;
    for (double depth = *words.j; depth < thread.depth;
         depth = *words.j * core::pow(++passes, power)) {
        if (passes > greatest_thread_passes) break;
        add_pass(moves, thread, depth);
    }
    if (passes > greatest_thread_passes || words.spring_passes > greatest_thread_passes)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("G76: these words give more than {} passes: increase J, or reduce R or H",
                        greatest_thread_passes));
    for (int i = 0; i <= words.spring_passes; ++i) add_pass(moves, thread, thread.depth);
    moves.push_back({end, {}});
    return moves;
}

} // namespace gcode
